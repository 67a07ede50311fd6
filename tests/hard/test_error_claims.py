"""Claims of error on long motions, where rounding accumulates alike in runs of doubles."""

from __future__ import annotations

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest

from geomtorsion import scenes
from geomtorsion.curves import autoparallel, geodesic, parallel_transport
from geomtorsion.errors import AccuracyError
from geomtorsion.geometry import cartan
from geomtorsion.ode import ODE, RungeKutta, Taylor, solve, solve_many
from geomtorsion.prices import truth_of
from geomtorsion.spaces import load
from tests.ode.engines import every_engine, needs_heyoka

pytestmark = needs_heyoka
FORCE = {"u": "-x/(x*x + y*y)**(3/2)", "v": "-y/(x*x + y*y)**(3/2)"}


def orbit(near, speed):
    """Around a mass of one, from the pericentre."""
    return ODE.of({"x": "u", "y": "v", **FORCE}, {"x": near, "y": 0, "u": 0, "v": speed})


def eccentric(e):
    """An orbit with a major half axis of about one."""
    return orbit(1 - e, math.sqrt((1 + e) / (1 - e)))


def orbit_error(solution):
    """The largest error against Kepler's equation, each state relative to its size."""
    near, _, _, speed = (mpmath.mpf(float(x)) for x in solution.states[0])
    with mpmath.workdps(40):
        axis = 1 / (2 / near - speed**2)
        e, rate = 1 - near / axis, axis ** mpmath.mpf("-1.5")
        width = axis * mpmath.sqrt(1 - e**2)
        exact = []
        for t in solution.times:
            mean = mpmath.mpf(float(t)) * rate
            angle = mpmath.findroot(
                lambda x, m=mean: x - e * mpmath.sin(x) - m,
                (mean - e, mean + e), solver="anderson", tol=1e-60,
            )  # fmt: skip
            turn = rate / (1 - e * mpmath.cos(angle))
            place = axis * (mpmath.cos(angle) - e), width * mpmath.sin(angle)
            exact.append(
                [*place, -axis * mpmath.sin(angle) * turn, width * mpmath.cos(angle) * turn]
            )
        gaps = [
            [float(abs(mpmath.mpf(float(x)) - y)) for x, y in zip(row, there, strict=True)]
            for row, there in zip(solution.states, exact, strict=True)
        ]
    return float((np.max(gaps, axis=0) / np.abs(solution.states).max(axis=0)).max())


def assert_claim(true, solution, accuracy, most=100):
    """The claim is between half and `most` times the true error, which is within the accuracy."""
    assert true <= accuracy
    assert 0.5 * true <= solution.error <= max(most * true, 1e-14)


@pytest.mark.parametrize(
    ("problem", "end", "accuracy", "engine"),
    [
        (orbit(0.2, 3), 170.0, 1e-9, RungeKutta()),
        (eccentric(0.6), 200.0, 1e-10, RungeKutta()),
        (eccentric(0.6), 2000.0, 1e-8, Taylor()),
        (eccentric(0.6), 2000.0, 1e-10, None),
    ],
    ids=["0.8", "0.6", "0.6, series", "0.6, series, finer"],
)
def test_orbits_by_keplers_equation(problem, end, accuracy, engine):
    """Claims hold on orbits whose errors two runs in doubles share, or which agree by chance."""
    solution = solve(problem, end, accuracy, engine)
    assert_claim(orbit_error(solution), solution, accuracy)


@every_engine
def test_orbits_side_by_side(engine):
    """Errors of a batch hold where rounding is as large as truncation."""
    speeds = np.array([2.0, 2.01, 1.99])
    problem, times = orbit(0.4, 2.0), np.linspace(0, 60, 41)
    many = solve_many(problem, {"v": speeds}, times, 1e-10, engine)
    for k, speed in enumerate(speeds):
        truth = truth_of(problem.with_start(start=[0.4, 0, 0, speed]), times)
        exact = truth.trajectory.segments[0].states.astype(float)
        gaps = np.abs(many.states[k] - exact).max(axis=0) / np.abs(exact).max(axis=0)
        assert gaps.max() <= 1e-10
        assert 0.5 * gaps.max() <= many.errors[k] <= 100 * gaps.max()


def test_components_that_never_change_are_not_rounded():
    """A symmetric top keeps its spin to the last digit: doubles give 1e-10 over 500 s."""
    scene = replace(scenes.load("lagrange_wave"), t=500.0, samples=51)
    solution = scene.run().solution
    truth = scene.run(Taylor(precision=64)).solution
    gaps = np.abs(solution.states - truth.states).max(axis=0)
    true = float((gaps / np.abs(truth.states).max(axis=0)).max())
    assert solution.engine == "Taylor"
    assert_claim(true, solution, 1e-10)


@pytest.mark.slow
@every_engine
@pytest.mark.parametrize("turns", [10, 100, 1000, 10000])
@pytest.mark.parametrize("e", [0.0, 0.3, 0.6, 0.8, 0.95])
def test_many_orbits(e, turns, engine):
    """Up to ten thousand turns there is an honest claim, or a refusal."""
    if turns > 100 and not isinstance(engine, Taylor):
        pytest.skip("minutes in Python")
    for accuracy in (1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12):
        try:
            solution = solve(eccentric(e), 2 * np.pi * turns * 1.01, accuracy, engine)
        except AccuracyError:
            continue
        assert_claim(orbit_error(solution), solution, accuracy)


MOTIONS = {
    "free top": ODE.of(
        {"a": "-b*c", "b": "c*a", "c": "-a*b/3"}, [0.3, 1.0, 0.01], norm_groups=["abc"]
    ),
    "heavy top": ODE.of(
        {
            "x": "(y*z + 3/2*q)/2", "y": "(-z*x - 3/2*p)/2", "z": "0",
            "p": "q*z - r*y", "q": "r*x - p*z", "r": "p*y - q*x",
        },
        [0.9, 0.4, 0.7, 0.6, 0.0, 0.8],
    ),
    "pendulum": ODE.of({"x": "v", "v": "-sin(x)"}, [3.0, 0.0]),
    "swing": ODE.of({"x": "v", "v": "-sin(x)"}, [1.0, 0.0]),
    "Kerr": geodesic(
        load("kerr").frame, [0, 8.0, 1.4, 0], frame_velocity=[1.2, 0.05, 0.2, 0.6],
        parameters={"M": 1, "a": 0.6},
    ),
}  # fmt: skip


@pytest.mark.slow
@every_engine
@pytest.mark.parametrize("end", [30.0, 300.0, 1000.0])
@pytest.mark.parametrize("name", list(MOTIONS))
def test_long_motions(name, end, engine):
    """Claims on tops, pendulums and a black hole hold, compared with 113 bits."""
    problem = MOTIONS[name]
    truth = truth_of(problem, np.linspace(0, end, 65))
    for accuracy in (1e-6, 1e-8, 1e-10, 1e-11, 1e-12):
        try:
            solution = solve(problem, np.linspace(0, end, 65), accuracy, engine)
        except AccuracyError:
            continue
        assert_claim(truth.error(solution), solution, accuracy)


@pytest.mark.slow
@every_engine
@pytest.mark.parametrize("end", [10.0, 15.0, 18.0])
def test_chaos(end, engine):
    """Lorenz's equations from many starts: errors of the first steps grow a billionfold."""
    for start in np.random.default_rng(3).normal(size=(20, 3)) * 5 + [0, 0, 20]:
        problem = ODE.of(
            {"x": "10*(y - x)", "y": "x*(28 - z) - y", "z": "x*y - 8*z/3"}, start.tolist()
        )
        truth = truth_of(problem, np.linspace(0, end, 65))
        for accuracy in (1e-6, 1e-8):
            try:
                solution = solve(problem, np.linspace(0, end, 65), accuracy, engine)
            except AccuracyError:
                continue
            # One unlucky rounding in the first steps is decisive: most motions have smaller errors.
            assert_claim(truth.error(solution), solution, accuracy, most=10_000)


@pytest.mark.parametrize("end", [1700.0, 2000.0])
def test_the_first_number_holds_on_long_orbits(end):
    """Kepler's equation: the error is not below the truth after hundreds of turns."""
    solution = solve(eccentric(0.8), end, 1e-8)
    assert orbit_error(solution) <= solution.error <= 1e-8


def test_the_first_number_holds_where_roundings_decide():
    """A damped forced double well: roundings grow late, and those at the start are forgotten."""
    well = ODE.of({"x": "v", "v": "x - x**3 - v/5 + 3*cos(t)/10"}, [0.5, 0])
    solution = solve(well, 60.0, 1e-9)
    assert truth_of(well, solution.times).error(solution) <= solution.error <= 1e-9


TOP = geodesic(load("so3").frame, [2.1, 0.02, 0.4], frame_velocity=[0.3, 1, 0.2], metric=(1, 2, 3))
LINE = autoparallel(cartan(load("so3").frame), [2.1, 0.02, 0.4], frame_velocity=[0.3, 1, 0.2])


@pytest.mark.parametrize(
    "problem",
    [
        TOP,
        TOP.with_charts("so3"),
        LINE.with_charts("so3"),
        parallel_transport(
            geodesic(load("s2").frame, [0.02, 0.5], frame_velocity=[0.3, 0.9], parameters={"R": 1}),
            [1, 2],
        ),
        eccentric(0.7),
        scenes.load("lagrange_cusp").ode,
    ],
    ids=["top", "top in angles", "line in angles", "transport", "orbit", "scene"],
)
@pytest.mark.parametrize("accuracy", [1e-5, 1e-9, 1e-12])
def test_the_error_is_the_largest_of_all(problem, accuracy):
    """`error` holds for each state, coordinate and velocity, also near a pole of the angles."""
    solution = solve(problem, 3.0, accuracy)
    names = [name for name in solution.moment.values if problem.together(name)]
    names += [name for name in ("velocity", "coordinates") if name in solution.moment.values]
    claims = [solution.error_of(name) for name in names]
    assert max(claims) <= solution.error * (1 + 1e-6)
    assert max(claims) >= solution.error / 100
    exact = solve(problem, 3.0, 1e-17, Taylor(113))
    for name in names:
        here, there = (np.asarray(x[name], dtype=float) for x in (solution, exact))
        together = problem.together(name) or (name,)
        size = max(np.abs(exact[word].astype(float)).max() for word in together)
        assert np.abs(here - there).max() <= (solution.error + 4e-16) * size


def test_members_near_a_pole():
    """The errors of an ensemble belong to the coordinates that it gives."""
    random = np.random.default_rng(0)
    starts, spins = random.uniform(0.02, 0.5, (12, 3)), random.normal(size=(12, 3))
    many = solve_many(TOP, starts, [0, 1, 2], 1e-6, frame_velocities=spins)
    exact = solve_many(TOP, starts, [0, 1, 2], 1e-12, frame_velocities=spins)
    gap = np.abs(many.coordinates - exact.coordinates).max(axis=(1, 2))
    size = np.abs(exact.coordinates).max(axis=(1, 2))
    assert (gap <= many.errors * size).all()
    assert many.error <= 1e-6
