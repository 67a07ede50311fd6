"""Checking: which run an answer is held against, by which share, and where the search ends."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from geomtorsion.geometry import blend, cartan, levi_civita
from geomtorsion.motion import RungeKutta, Stiff, Taylor, autoparallel, flow, geodesic, solve
from geomtorsion.motion.checking import CAUTION, TAKEN, checked, rounding
from geomtorsion.motion.compare import difference
from geomtorsion.motion.engines.store import order_of, tolerance_of
from geomtorsion.motion.journey import travel
from geomtorsion.spaces import load
from tests.motion.engines import every_engine, needs_heyoka


@dataclass(frozen=True)
class Try:
    """A run that is wrong by a multiple of its tolerance."""

    tolerance: float
    steps: int = 50
    outcome: str = "done"
    wrong: float = 1.0


def asked(engine, accuracy, growth=1.0, floor=0.0):
    """`checked` on runs whose errors are growth times the tolerance, and no less than a floor."""

    def attempt(tolerance):
        return Try(tolerance, wrong=max(growth * tolerance, floor))

    return checked(
        engine,
        accuracy,
        engine.first(accuracy),
        attempt,
        lambda one, two: (abs(one.wrong - two.wrong), 65),
        lambda _: False,
    )


def test_orders_and_tolerances():
    """Each order has one tolerance; heyoka's rule is p = ceil(1 - log(tol) / 2)."""
    for order in range(2, 60):
        assert order_of(tolerance_of(order)) == order
    assert [order_of(x) for x in (1e-6, 1e-9, 1e-12)] == [8, 12, 15]


@needs_heyoka
def test_orders_are_those_of_heyoka():
    """The rule holds for the integrators themselves."""
    import heyoka as hy

    x = hy.make_vars("x")
    for tolerance in (1e-3, 1e-6, 1e-9, 1e-12, 1e-16):
        made = hy.taylor_adaptive([(x, -x)], [1.0], tol=tolerance, opt_level=0)
        assert made.order == order_of(tolerance)


@pytest.mark.parametrize("growth", [0.01, 1.0, 30.0, 100.0])
@pytest.mark.parametrize("accuracy", [1e-5, 1e-7, 1e-9])
def test_error_is_told_by_the_coarser_run(growth, accuracy):
    """The estimate is near the error, the answer good enough, and no more is spent than needed."""
    found = asked(Taylor(), accuracy, growth)
    assert found.check.tolerance > found.answer.tolerance
    assert found.answer.wrong <= found.error <= 5 * found.answer.wrong
    assert found.error <= TAKEN * accuracy
    assert found.error >= 1e-4 * accuracy or growth < 1
    assert len(found.spent) <= 6


def test_near_rounding_a_finer_run_checks():
    """Where rounding matters the coarser run says too little."""
    engine = Taylor()
    assert engine.coarser(tolerance_of(16)) == tolerance_of(12)
    assert engine.coarser(tolerance_of(17)) is None
    assert engine.coarser(tolerance_of(5)) is None
    found = asked(engine, 1e-14)
    assert found.check.tolerance < found.answer.tolerance
    assert found.error >= rounding(engine, 50)


def test_the_best_is_returned_where_nothing_is_good_enough():
    """No infinite error, no endless search."""

    def attempt(tolerance):
        # Errors stop at 1e-9 and change sign there from run to run.
        return Try(tolerance, wrong=tolerance + 1e-9 * math.copysign(1, math.sin(1e9 * tolerance)))

    engine = Taylor()
    found = checked(
        engine,
        1e-13,
        engine.first(1e-13),
        attempt,
        lambda one, two: (max(abs(one.wrong - two.wrong), 1e-9), 65),
        lambda _: False,
    )
    assert 1e-13 < found.error < 1e-7


def test_runge_kutta_trusts_its_steps():
    """The share is the eighth power of the steps' ratio; too few steps say nothing."""
    engine = RungeKutta()
    share = engine.shrinks(Try(1e-8, 100), Try(1e-6, 60))
    assert share == pytest.approx(0.6**8 / (1 - 0.6**8))
    assert engine.shrinks(Try(1e-8, 100), Try(1e-6, 20)) == pytest.approx(1 / 99)
    assert engine.shrinks(Try(1e-8, 100), Try(1e-6, 95)) is None
    assert engine.shrinks(Try(1e-8, 8), Try(1e-6, 5)) is None
    assert engine.shrinks(Try(1e-8, 100), Try(1e-7, 60)) is None
    assert engine.coarser(1e-14) is None
    assert Stiff().coarser(1e-6) is None


@every_engine
def test_solutions_say_what_they_were_held_against(engine):
    """error = share times the largest difference to the witness, block by block."""
    top = geodesic(load("so3").frame, frame_velocity=[0.9, 0.4, 0.7], metric=[1.1, 2.2, 3.3])
    sol = solve(top, 60.0, 1e-8, engine)
    assert sol.witness is not None
    states, other = (j.segments[0].states for j in (sol.journey, sol.witness))
    gap = np.abs(states - other).max() / np.abs(states).max()
    assert sol.witness.tolerance > sol.journey.tolerance
    assert sol.share < 0.5 * CAUTION
    assert sol.error == pytest.approx(sol.share * gap, rel=1e-9)


def test_few_steps_are_held_against_more():
    """A motion of a step or two ends before its steps do: the coarser run would say nothing."""
    straight = autoparallel(cartan(load("flat_polar").frame), [1.0, 0.0], [0.1, 0.05])
    sol = solve(straight, 0.1, 1e-8, RungeKutta())
    assert sol.cost.steps < 12
    assert sol.witness is not None
    assert sol.witness.tolerance < sol.journey.tolerance


@needs_heyoka
@pytest.mark.parametrize(
    ("start", "accuracy"),
    [
        ([1.9407494008594477, -0.09104621441818508, -0.9165974717600273], 1e-8),
        ([1.9407494008594477, -0.09104621441818508, -0.9165974717600273], 1e-10),
        ([0.270613704172437, -0.4439808545171319, 1.2105047438502337], 1e-9),
        ([0.6373623593766596, -1.3068504934903284, 1.057242123986707], 1e-10),
    ],
)
def test_states_of_uneven_size_are_held_against_a_finer_run(start, accuracy):
    """Coordinates grow like exp(t) beside velocities near one, by which steps are not measured."""
    frame = load("bianchi_v").frame
    law = blend(levi_civita(frame), cartan(frame))
    problem = autoparallel(law, [0.1, 0.2, 0.3], frame_velocity=start)
    sol = solve(problem, 20.0, accuracy, Taylor())
    assert sol.witness is not None
    assert sol.witness.tolerance < sol.journey.tolerance
    fine = travel(problem, Taylor(64), 1e-19, sol.times * problem.speed)
    true, _ = difference(sol.journey, fine)
    assert true <= accuracy
    assert 0.1 * true <= sol.error <= 100 * true


@needs_heyoka
def test_roundings_of_what_has_grown():
    """Autoparallels of Sol: z grows a hundredfold, and e^z takes all of its roundings."""
    problem = autoparallel(
        cartan(load("sol").frame),
        [0.3, -0.4, 0.6],
        frame_velocity=[0.7, 0.2, -1.3],
    )
    for end in (60.0, 75.0, 91.0):
        sol = solve(problem, end, 1e-12)
        times = np.asarray(sol.times) * problem.speed
        truth = travel(problem, Taylor(113), 1e-30, times).segments[0].states.astype(float)
        gap = np.abs(sol.journey.segments[0].states - truth).max() / np.abs(truth).max()
        assert gap <= 1e-12
        assert sol.error >= 0.3 * gap


@needs_heyoka
@pytest.mark.parametrize("near", [1e-3, 3e-4, 1e-4])
def test_more_digits_near_a_separatrix(near):
    """A pendulum that lingers upside down: what is said and asked is held by 64 bits, too."""
    for end, accuracy in ((30.0, 1e-11), (45.0, 1e-11), (38.0, 1e-13)):
        made = flow({"x": "y", "y": "sin(x)"}, {"x": near, "y": 0.0})
        truth = solve(made, end, 1e-20, Taylor(113)).states.astype(float)
        sol = solve(made, end, accuracy)
        gap = float(np.abs(sol.states - truth).max() / np.abs(truth).max())
        assert gap <= accuracy
        assert sol.error >= 0.3 * gap


@needs_heyoka
@pytest.mark.parametrize("end", [0.0021, 0.00215, 0.0022, 0.0023])
def test_roundings_beside_a_pole(end):
    """A millionth from the pole of s2, where theta is rounded as everywhere: phi takes it all."""
    sphere = load("s2").frame
    between = blend(levi_civita(sphere), cartan(sphere))
    numbers = {symbol.name: 1.2 for symbol in sphere.field.symbols[2:]} | {"R": 1.3}
    problem = autoparallel(
        between,
        [1.0, 0.5],
        frame_velocity=[-4542.008374395556, 0.004829829911202137],
        parameters=numbers,
    )
    sol = solve(problem, end, 1e-9)
    truth = travel(problem, Taylor(64), 2.0**-68, np.asarray(sol.times) * problem.speed)
    gap, _ = difference(sol.journey, truth)
    assert gap <= 1e-9
    assert sol.error >= 0.3 * gap
