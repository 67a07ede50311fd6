"""Events: first falls through zero, in order, and those that only touch."""

from dataclasses import replace

import pytest
from flint import arb

import geomtorsion as gt
from geomtorsion.errors import ProofError
from geomtorsion.proofs import events
from geomtorsion.support.precision import ball_precision

SWING = {"x": "v", "v": "-x", "s": "1"}


def fall(stop, start=(1, 0, 0), end=20.0, digits=20):
    """The time of the first fall, as given by a clock state in the proof."""
    problem = gt.ODE.of(SWING, list(start), events=[gt.When(stop)])
    proof = gt.prove(gt.solve(problem, end), digits)
    assert proof.holds
    return proof.balls[-1][2]


def test_first_of_many():
    """cos t falls through zero at pi / 2, and through -1/2 at 2 pi / 3."""
    with ball_precision(120):
        assert fall("x").overlaps(arb.pi() / 2)
        assert fall("x + 1/2").overlaps(2 * arb.pi() / 3)
        assert fall("x").rad() < 1e-19


def test_a_near_miss_does_not_end_the_motion():
    """A term that falls to a billionth and rises again is not an end; the next zero is."""
    with ball_precision(120):
        # x falls to -1 at pi and the first factor stays positive; the second one is zero at s = 9.
        found = fall("(x + 1 + 1/10**9)*(9 - s)")
        assert found.overlaps(arb(9))


def test_a_fall_by_less_than_rounding_is_found():
    """A term that dips below zero for a short time ends the motion where it enters."""
    found = fall("x + 1 - 1/10**6")
    with ball_precision(120):
        assert (arb.pi() - (1 - arb(1) / 10**6).acos()).overlaps(found)


def test_a_start_on_the_stop_may_rise():
    """From zero a term may rise; the motion ends where it returns to zero."""
    with ball_precision(120):
        assert fall("v", start=(-1, 0, 0)).overlaps(arb.pi())


def test_touching_is_refused():
    """A double zero cannot be proved to be a fall or not."""
    problem = gt.ODE.of(SWING, [1, 0, 0], events=[gt.When("1 + x")])
    plain = gt.solve(gt.ODE.of(SWING, [1, 0, 0]), 5.0)
    with pytest.raises(ProofError, match="touches the stop") as caught:
        gt.prove(replace(plain, problem=problem))
    assert caught.value.time is not None
    assert 2 < caught.value.time < 3.2


def test_a_stop_may_depend_on_time():
    """A stop may depend only on the time."""
    problem = gt.ODE.of({"x": "-x"}, [1], events=[gt.When("2 - t")])
    proof = gt.prove(gt.solve(problem, 5.0), 20)
    assert proof.holds
    with ball_precision(120):
        assert proof.balls[-1][0].overlaps(arb(-2).exp())


def test_a_wrong_slope_would_be_seen(monkeypatch):
    """With half of the slope Newton's method gains no digits: the proof is refused."""
    plain = events.Fall.rate
    monkeypatch.setattr(events.Fall, "rate", lambda self, states: plain(self, states) / 2)
    problem = gt.ODE.of(SWING, [1, 0, 0], events=[gt.When("x")])
    solution = gt.solve(problem, 20.0)
    with pytest.raises(ProofError, match="got no more than with fewer"):
        gt.prove(solution)
