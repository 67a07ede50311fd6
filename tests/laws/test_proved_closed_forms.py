"""Laws: balls of every engine contain the closed form, at the exact time of the result."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import arb, fmpq

import geomtorsion as gt
from geomtorsion.ode.engines.taylor import is_available
from geomtorsion.support.precision import ball_precision

pytestmark = pytest.mark.skipif(not is_available(), reason="needs heyoka")

ENGINES = [gt.RungeKutta(), gt.Stiff(), *(gt.Taylor(bits) for bits in (53, 64, 113, 160))]
# Times that no decimal digits of 20 or 37 places name exactly.
TIMES = [0.1, 1 / 3, 1 - 2.0**-30]


def exact(time):
    """A float as an exact ratio."""
    return arb(fmpq(*float(time).as_integer_ratio()))


CLOSED = {
    "clock": ({"x": "1"}, 0, lambda t: t),
    "pole of order 1": ({"x": "x**2"}, 1, lambda t: 1 / (1 - t)),
    "pole of order 2": ({"x": "x**(3/2)"}, 4, lambda t: 4 / (1 - t) ** 2),
    "logarithm": ({"x": "exp(x)"}, 0, lambda t: -(1 - t).log()),
    "growth": ({"x": "x"}, 1, lambda t: t.exp()),
}


# Times depend on the engine and closed forms on the proof; pytest -m slow has every pair.
PAIRS = [
    pytest.param(
        engine,
        name,
        marks=[]
        if name in ("clock", "pole of order 1") or engine == gt.Taylor()
        else pytest.mark.slow,
    )
    for engine in ENGINES
    for name in CLOSED
]


@pytest.mark.parametrize(("engine", "name"), PAIRS, ids=str)
def test_balls_contain_the_closed_form(engine, name):
    """Each sample of a motion up to a blow-up, and of a clock, is at its own exact time."""
    rates, start, truth = CLOSED[name]
    blows_up = name not in ("clock", "growth")
    times = TIMES[:2] if blows_up and engine.precision == 53 else TIMES
    solution = gt.solve(gt.ODE.of(rates, [start]), times, 1e-6, engine)
    proof = gt.prove(solution, 60)
    with ball_precision(400):
        for time, (ball,) in zip(times, proof.balls, strict=True):
            assert ball.contains(truth(exact(time))), (time, ball)
            assert ball.rad() < 1e-30


@pytest.mark.parametrize("engine", ENGINES, ids=str)
def test_backwards(engine):
    """Negative times are exact as well."""
    proof = gt.prove(gt.solve(gt.ODE.of({"x": "1"}, [0]), [-1 / 3, -0.7], 1e-6, engine), 60)
    with ball_precision(400):
        for time, (ball,) in zip((-1 / 3, -0.7), proof.balls, strict=True):
            assert ball.contains(exact(time))


@pytest.mark.parametrize("engine", ENGINES, ids=str)
def test_times_of_events_and_of_stops_are_exact(engine):
    """A rate that changes at 0.1, and a motion that stops where it is 1/3."""
    changing = gt.ODE.of({"x": "k"}, [0], parameters={"k": 1}, events=[gt.At(0.1, {"k": 3})])
    proof = gt.prove(gt.solve(changing, 0.7, 1e-6, engine), 60)
    stopped = gt.ODE.of({"x": "1", "y": "1"}, [0, Fraction(1, 7)], events=[gt.When("1/3 - x")])
    end = gt.prove(gt.solve(stopped, 2.0, 1e-6, engine), 60)
    with ball_precision(400):
        first = exact(0.1)
        assert proof.balls[-1][0].contains(first + 3 * (exact(0.7) - first))
        x, y = end.balls[-1]
        assert x.contains(arb(1) / 3)
        assert y.contains(arb(1) / 3 + arb(1) / 7)
        assert x.rad() < 1e-30
