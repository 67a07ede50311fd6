"""Walls and bumps that a step does not see in advance."""

import mpmath
import numpy as np
import pytest
import sympy as sp

from geomtorsion.curves import autoparallel
from geomtorsion.errors import AccuracyError
from geomtorsion.geometry import Frame, cartan
from geomtorsion.ode import ODE, Taylor, solve, solve_many
from tests.ode.engines import every_engine, needs_heyoka
from tests.rounding import ROUNDED

X, Y = sp.symbols("x y", real=True)
WALL, BUMP = 2 + sp.tanh(Y), 1 + sp.exp(-(Y**2))


def across(entry, begin, lasts, accuracy, engine):
    """The motion x' = 1/entry, y' = 1 from y = begin, and x at its end by quadrature."""
    frame = Frame([X, Y], [[entry, 0], [0, 1]])
    motion = autoparallel(cartan(frame), [0, begin], frame_velocity=[1, 1])
    places = np.unique([*np.linspace(begin, begin + lasts, 301), *np.linspace(-3, 3, 13)])
    places = places[(places >= begin) & (places <= begin + lasts)]
    exact = mpmath.quad(sp.lambdify(Y, 1 / entry, "mpmath"), places.tolist())
    return solve(motion, lasts, accuracy, engine), float(exact)


@every_engine
@pytest.mark.parametrize(
    ("entry", "begin", "lasts"),
    [
        (WALL, -15, 30),
        pytest.param(WALL, -40, 80, marks=pytest.mark.slow),
        (WALL, -100, 130),
        (BUMP, -15, 30),
        (BUMP + sp.exp(-((Y - 100) ** 2)), -3, 150),
        (1 + 1 / (1 + Y**2) ** 4, -1000, 2000),
    ],
    ids=["near", "wall", "far", "bump", "two bumps", "power"],
)
def test_walls_ahead_are_seen(entry, begin, lasts, engine):
    """The error is honest although rates at the start show no sign of the wall."""
    solution, exact = across(entry, begin, lasts, 1e-9, engine)
    away = abs(float(solution.coordinates[-1, 0]) - exact) / exact
    assert away < 1e-9
    assert away < 2 * solution.error


@every_engine
@pytest.mark.parametrize("times", [[150], [0, 149, 150], [-150]], ids=["end", "three", "back"])
def test_few_samples_see_as_much(times, engine):
    """With few samples, forwards or backwards, the end agrees with a run of many samples."""
    side = 1 if times[-1] > 0 else -1
    entry = BUMP + sp.exp(-((Y - 100 * side) ** 2))
    frame = Frame([X, Y], [[entry, 0], [0, 1]])
    motion = autoparallel(cartan(frame), [0, -3 * side], frame_velocity=[1, 1])
    few, many = solve(motion, times, 1e-9, engine), solve(motion, 150.0 * side, 1e-9, engine)
    assert few.coordinates[-1] == pytest.approx(many.coordinates[-1], rel=1e-9)
    assert abs(few.coordinates[-1, 0]) < 148


@every_engine
@pytest.mark.parametrize("steep", [5, 20, 80])
def test_a_steep_step_far_ahead(steep, engine):
    """x' = tanh(k (y - 50)), y' = 1, narrower than a step: a true answer or an error."""
    ode = ODE.of({"x": f"tanh({steep}*(y - 50))", "y": 1}, {"x": 60, "y": 0})
    try:
        solution = solve(ode, 110.0, 1e-9, engine)
    except AccuracyError:
        assert steep > 5
        return
    away = np.abs(solution.times - 50)
    exact = 10 + away + np.log1p(np.exp(-2 * steep * away)) / steep
    gap = np.abs(solution["x"] - exact).max() / 110
    assert gap < 1e-9
    assert gap < 2 * solution.error


@needs_heyoka
@pytest.mark.parametrize(
    ("engine", "accuracy"), [(None, 1e-15), (None, 1e-25), (Taylor(113), 1e-25)]
)
def test_a_straight_line_has_all_digits(engine, accuracy):
    """x' = 1/3, y' = x in a single step: reading samples as doubles adds no error."""
    start = [sp.Rational(3, 10), sp.Rational(9, 10)]
    line = ODE.of({"x": "1/3", "y": "x"}, start)
    solution = solve(line, 7.5, accuracy, engine)
    assert solution.error <= accuracy
    found = [float(x) for x in solution.states[-1]]
    assert found == pytest.approx([14 / 5, 501 / 40], rel=ROUNDED, abs=0)


def test_members_on_straight_lines_have_all_digits():
    """Members on straight lines reach 1e-14."""
    start = np.array([[0.3, 0.9], [0.7, -0.2], [-1 / 7, 0.1]])
    many = solve_many(ODE.of({"x": "1/3", "y": "1/7"}, start[0]), start, 7.5, 1e-14)
    assert many.error <= 1e-14
    assert many.finished.all()


@every_engine
@pytest.mark.parametrize("samples", [13, 14, 65])
def test_samples_at_whole_turns_hide_no_steps(samples, engine):
    """Samples at whole periods, where the rates are equal, do not hide the steps between."""
    times = np.linspace(0, 2 * np.pi * (samples - 1), samples)
    solution = solve(ODE.of({"x": "v", "v": "-x"}, [1, 0]), times, 1e-9, engine)
    assert np.abs(solution["x"] - 1).max() < 1e-8
    assert solution.cost.steps > samples


@every_engine
@pytest.mark.parametrize("times", [80, np.linspace(0, 80, 200)], ids=["end", "samples"])
def test_members_of_an_ensemble_meet_it_too(times, engine):
    """x' = 2 + tanh(x) from both sides of the wall; 2x - log(2 cosh x + sinh x) grows by 3t."""
    ode = ODE.of({"x": "2 + tanh(x)"}, [0])
    starts = np.array([-40.0, -1, -60, 2, -25])
    many = solve_many(ode, {"x": starts}, times, 1e-9, engine)
    assert many.finished.all()

    def grown(x):
        return 2 * x - (np.abs(x) + np.log(1.5 * np.exp(x - abs(x)) + 0.5 * np.exp(-x - abs(x))))

    for row, begin in enumerate(starts.tolist()):
        last = float(many["x"][row, -1])
        away = abs(grown(last) - grown(begin) - 240) / abs(last)
        assert away < 1e-9
        assert away < max(2 * many.errors[row], 1e-14)


@needs_heyoka
def test_what_stays_far_from_walls_stays_in_the_batch(monkeypatch):
    """Members with similar steps, and Kepler orbits, are not solved one by one."""
    monkeypatch.setattr("geomtorsion.ode.singles.verified_motion", None)
    swing = ODE.of({"x": "v", "v": "-k*x"}, [1, 0], parameters={"k": 1})
    assert solve_many(swing, {"k": np.linspace(1, 9, 20)}, 10.0).finished.all()
    rates = {"x": "u", "y": "v", "u": "-x/(x**2+y**2)**(3/2)", "v": "-y/(x**2+y**2)**(3/2)"}
    orbit = ODE.of(rates, [1, 0, 0, 1])
    speeds = {"v": np.sqrt(1 + np.array([0.0, 0.3, 0.6, 0.8]))}
    assert solve_many(orbit, speeds, 30.0, 1e-9).finished.all()


@every_engine
@pytest.mark.parametrize("samples", [100, 3000])
def test_few_cuts_show_all_that_is_behind_a_wall(samples, engine):
    """A step across a wall makes all later intervals wrong; fewer than 200 segments mend it."""
    ode = ODE.of({"x": "2 + tanh(x)"}, [-40])
    solution = solve(ode, np.linspace(0, 60, samples), 1e-9, engine)
    # Here 2 x - log(2 cosh(x) + sinh(x)) has grown by 180.
    assert solution["x"][-1] == pytest.approx(61.09861228866811, rel=1e-10)
    assert len(solution.trajectory.segments) < 200


@every_engine
def test_many_samples_in_a_step_add_no_segments(engine):
    """The error of a loose tolerance is reported; samples within a step add no segments."""
    swing = ODE.of({"x": "v", "v": "-x"}, [1, 0])
    solution = solve(swing, np.linspace(0, 1, 50_000), 1e-6, engine)
    assert len(solution.trajectory.segments) == 1
    assert np.abs(solution["x"] - np.cos(solution.times)).max() < solution.error
