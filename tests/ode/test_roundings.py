"""Roundings: reported errors hold where a motion amplifies the roundings of its steps."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from geomtorsion.curves import geodesic
from geomtorsion.errors import AccuracyError
from geomtorsion.ode import ODE, At, RungeKutta, Taylor, When, solve, solve_many
from geomtorsion.prices import truth_of
from geomtorsion.rigid import free_top
from geomtorsion.spaces import load
from tests.ode.engines import every_engine, needs_heyoka
from tests.rounding import ROUNDED

TOP = ODE.of({"w1": "-w2*w3", "w2": "w1*w3", "w3": "-w1*w2/3"}, [0, 1, 0])
WELL = ODE.of({"x": "v", "v": "x - x**3"}, [0, 0])
LORENZ = ODE.of({"x": "10*(y - x)", "y": "x*(28 - z) - y", "z": "x*y - 8*z/3"}, [1, 1, 1])
# Two runs in doubles agree by chance, or one critical step dominates the error of both.
SHARP = [
    (TOP, [1.0370409686981138e-05, 1, 0], 77.48598928679364, 1.0343150791136168e-10),
    (
        WELL,
        [5.667385433559342e-07, -1.909323855152521e-07],
        27.35720342292524,
        1.5094656512510867e-11,
    ),
    (
        LORENZ,
        [3.8251199424363023, 7.531123730701481, 26.03932054373712],
        16.05385422234238,
        4.299634206977186e-07,
    ),
]


def tops(number, seed):
    """Starts near the middle axis, and times."""
    random = np.random.default_rng(seed)
    for _ in range(number):
        yield float(10 ** random.uniform(-5, -1.5)), float(random.uniform(20, 90))


def top_error(away, times, states):
    """The true error of a top that starts with (away, 1, 0)."""
    exact = np.array(free_top((1, 2, 3), (away, 1, 0)).omega(times))
    return float(np.abs(states - exact).max() / np.abs(exact).max())


@needs_heyoka
@pytest.mark.parametrize(("problem", "start", "end", "accuracy"), SHARP, ids=["top", "well", "C"])
def test_what_two_runs_did_not_show(problem, start, end, accuracy):
    """Each of these errors was once reported too small, by a factor of up to 70."""
    solution = solve(problem.with_start(start=start), end, accuracy)
    grid = solution.times
    assert truth_of(solution.problem, grid).error(solution) <= solution.error <= accuracy


@needs_heyoka
def test_tops_near_the_middle_axis():
    """The errors of 200 tops in doubles are below the reported ones, and not far below."""
    parts = []
    for away, end in tops(200, 1):
        problem = TOP.with_start(start=[away, 1, 0])
        accuracy = 1e-3 if away < 1e-3 else 1e-6
        try:
            solution = solve(problem, end, accuracy, Taylor())
        except AccuracyError:
            continue
        parts.append(top_error(away, solution.times, solution.states) / solution.error)
    assert len(parts) > 150
    assert max(parts) <= 1
    assert np.median(parts) > 0.02


@needs_heyoka
def test_roundings_decide_how_many_digits_a_step_has():
    """Six standard deviations beyond the accuracy in doubles: the solver takes more digits."""
    for away, end in tops(12, 2):
        solution = solve(TOP.with_start(start=[away, 1, 0]), end, 1e-10)
        true = top_error(away, solution.times, solution.states)
        # The closed form is in doubles.
        assert true <= solution.error + ROUNDED
        assert solution.error <= 1e-10


def test_tops_by_runge_kutta():
    """The rule is the same for each engine."""
    for away, end in tops(6, 3):
        solution = solve(TOP.with_start(start=[away, 1, 0]), end, 1e-3, RungeKutta())
        assert top_error(away, solution.times, solution.states) <= solution.error


@every_engine
def test_tops_side_by_side(engine):
    """Members of an ensemble report what roundings do to each of them."""
    starts = np.array([away for away, _ in tops(24, 4)])
    many = solve_many(TOP, {"w1": starts}, np.linspace(0, 40, 9), 1e-4, engine)
    for away, states, error in zip(starts.tolist(), many.states, many.errors, strict=True):
        assert top_error(away, many.times, states) <= error <= 1e-4


@every_engine
def test_roundings_move_the_time_of_a_stop(engine):
    """x'' = x from close to the axis along which it comes to rest: where it leaves is random."""
    start = [1e-8, -1e-8 * (1 - 1e-7)]
    problem = ODE.of({"x": "v", "v": "x"}, start, events=[When("1 - x")])
    solution = solve(problem, 60.0, 1e-7, engine)
    with mpmath.workdps(40):
        rising = (mpmath.mpf(start[0]) + mpmath.mpf(start[1])) / 2
        falling = (mpmath.mpf(start[0]) - mpmath.mpf(start[1])) / 2
        exact = mpmath.log((1 + mpmath.sqrt(1 - 4 * rising * falling)) / (2 * rising))
        away = float(abs(mpmath.mpf(float(solution.times[-1])) / exact - 1))
    assert solution.outcome == "stopped"
    assert away <= solution.error <= 1e-7


@every_engine
def test_what_jumps_to_a_value_loses_its_roundings(engine):
    """Growth by exp(20) before a jump of the state does not count after it."""
    rates = {"x": "a*x", "y": "-y"}
    events = [At(20.0, {"x": 1, "a": 0})]
    problem = ODE.of(rates, [1, 1], parameters={"a": 1}, events=events)
    solution = solve(problem, [20.0, 21.0, 30.0], 1e-8, engine)
    assert solution["x"][1:].tolist() == [1.0, 1.0]
    assert solution.error <= 1e-8


@needs_heyoka
def test_roundings_pass_from_chart_to_chart():
    """A great circle close to the poles, in many charts: errors are below the reported ones."""
    sphere = load("s2").frame
    for slow in (0.1, 0.003):
        problem = geodesic(sphere, [1.0, 0.3], frame_velocity=[1, slow], parameters={"R": 1})
        solution = solve(problem, 60.0, 1e-12)
        assert len(solution.trajectory.segments) > 1
        true = truth_of(problem, solution.times * problem.time_unit).error(solution)
        assert true <= solution.error <= 1e-12


def test_roundings_of_equal_calls_are_equal():
    """Equal calls report equal errors, to the last bit."""
    first, again = (solve(LORENZ, 5.0, 1e-8, RungeKutta()) for _ in range(2))
    assert first.error == again.error


def test_nothing_moves():
    """Without motion there are no roundings of steps."""
    solution = solve(ODE.of({"x": "0"}, [1]), 5.0, 1e-12, RungeKutta())
    assert solution["x"].tolist() == [1.0] * len(solution.times)
    assert solution.error <= 1e-12
