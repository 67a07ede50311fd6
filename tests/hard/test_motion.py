"""Hard motions: gimbal lock, poles, long times, extreme speeds, each with its figure."""

import numpy as np
import pytest
import sympy as sp

from geomtorsion.curves import autoparallel, geodesic
from geomtorsion.errors import AccuracyError
from geomtorsion.geometry import Frame, cartan, from_coefficients
from geomtorsion.ode import RungeKutta, Stiff, solve
from geomtorsion.ode.engines.taylor import is_available
from geomtorsion.prices import truth_of
from geomtorsion.spaces import load
from tests.chosen import few, one_in
from tests.ode.engines import ENGINES, every_engine, needs_heyoka
from tests.rounding import ROUNDED

SO3 = load("so3").frame
TOP = [1.0, 2.0, 3.0]


@pytest.mark.parametrize(("nearest", "engine"), one_in(2, [1e-4, 1e-8, 0.0], ENGINES))
def test_gimbal_lock(nearest, engine):
    """Approached to sin(phi2) = 1e-8 and crossed, the lock leaves the attitude right to 1e-10."""
    # Rotation around the body's second axis with phi1 = 0 passes straight through phi2 = 0.
    start = [nearest, 0.5, 0.2]
    problem = autoparallel(cartan(SO3), start, frame_velocity=[0.0, -1.0, 0.0])
    if nearest == 1e-8 and engine.precision == 53:
        # The angles themselves have no more than eight digits there.
        with pytest.raises(AccuracyError):
            solve(problem, 1.0, 1e-11, engine)
        return
    sol = solve(problem, 1.0, 1e-11, engine)
    closed = truth_of(problem, sol.times)
    assert closed.name == "the closed form"
    assert closed.error(sol) < 1e-11
    assert np.sin(sol.coordinates[:, 1]).min() > -1e-12
    assert sol.in_chart("quaternion")[-1, 2] == pytest.approx(
        sol.in_chart("quaternion")[0, 2] * np.cos(0.5)
        - sol.in_chart("quaternion")[0, 0] * np.sin(0.5),
        abs=1e-10,
    )


@every_engine
def test_gimbal_lock_in_two_sets_of_angles(engine):
    """As above without the quaternion: angles change over the lock and keep their accuracy."""
    problem = autoparallel(cartan(SO3), [1e-3, 1.2, 0.2], frame_velocity=[0.0, -1.0, 0.0])
    hops = solve(problem.with_charts("so3", "so3_xyz"), 2.4, 1e-11, engine)
    hub = solve(problem, 2.4, 1e-11, engine)
    assert len(hops.charts) >= 2
    one, two = hops.in_chart("quaternion"), hub.in_chart("quaternion")
    assert np.minimum(abs(one - two).max(axis=1), abs(one + two).max(axis=1)).max() < 5e-11


@needs_heyoka
@pytest.mark.parametrize("last", few(1, [1e4, 1e5]))
def test_long_times(last):
    """so3 to t = 1e5: invariants drift by less than 1e-12."""
    problem = geodesic(SO3, [0.3, 1.0, 0.2], frame_velocity=[0.9, 0.4, 0.7], metric=TOP)
    sol = solve(problem, last, 1e-8)
    assert sol.error < 1e-8
    assert max(sol.drift.values()) < 1e-12


@every_engine
@pytest.mark.parametrize("size", [1e6, 1e-6, 1e-30, 1e30])
def test_speeds_from_slow_to_fast(size, engine):
    """Relative accuracy does not depend on the unit of time."""
    u = np.array([0.9, 0.4, 0.7])
    plain = geodesic(SO3, [0.3, 1.0, 0.2], frame_velocity=u, metric=TOP)
    scaled = geodesic(SO3, [0.3, 1.0, 0.2], frame_velocity=size * u, metric=TOP)
    one, two = solve(plain, 10.0, 1e-11, engine), solve(scaled, 10.0 / size, 1e-11, engine)
    assert two.frame_velocity / size == pytest.approx(one.frame_velocity, abs=2e-11)
    assert two.in_chart("quaternion") == pytest.approx(one.in_chart("quaternion"), abs=2e-11)


@every_engine
def test_photon_sphere(engine):
    """Kerr: light near the unstable circular orbit, half a turn: the estimate holds at 1e-9."""
    mass, a = 1.0, 0.5
    radius = 2 * mass * (1 + np.cos(2 / 3 * np.arccos(-a / mass)))
    start = [0.0, radius * (1 + 1e-6), np.pi / 2, 0.0]
    # In Carter's tetrad on the equator: no radial velocity, and eta u u = 0.
    problem = geodesic(
        load("kerr").frame,
        start,
        frame_velocity=[1.0, 0.0, 0.0, 1.0],
        parameters={"M": mass, "a": a},
        causal="null",
    )
    sol = solve(problem, 20.0, 1e-9, engine)
    assert truth_of(problem, sol.times).error(sol) <= min(1e-9, 10 * sol.error)
    assert max(sol.drift.values()) < 1e-9


def test_stiff_problem():
    """A velocity that decays at a rate of 1e6 is solved by the implicit engine."""
    x, y, k = sp.symbols("x y k", positive=True)
    frame = Frame([x, y], [[1, 0], [0, 1]], parameters=[k])
    # x'' + k x' y' = 0 with y' = 1: x' = exp(-k t).
    bent = from_coefficients(frame, [[[0, 0], [k / 2, 0]], [[k / 2, 0], [0, 0]]])
    problem = autoparallel(bent, [1.0, 0.5], frame_velocity=[1.0, 1.0], parameters={"k": 1e6})
    sol = solve(problem, [0.5, 1.0], 1e-6, Stiff("LSODA"))
    assert sol.coordinates[-1] == pytest.approx([1.0 + 1e-6, 1.5], rel=1e-6)
    assert abs(sol.frame_velocity[-1, 0]) < 1e-6


@every_engine
def test_start_on_a_chart_edge(engine):
    """phi2 = 1e-300 is inside the chart; the motion starts in another chart."""
    problem = geodesic(SO3, [0.3, 1e-300, 0.2], frame_velocity=[1.0, 0.5, 0.2], metric=TOP)
    sol = solve(problem, 3.0, 1e-10, engine)
    assert sol.complete
    assert max(sol.drift.values()) < 1e-9


@every_engine
def test_zero_velocity(engine):
    """A body at rest stays exactly at rest."""
    for problem in (
        geodesic(SO3, [0.3, 1.0, 0.2], [0, 0, 0], metric=TOP),
        autoparallel(cartan(SO3), [0.3, 1.0, 0.2], [0, 0, 0]),
        geodesic(load("s2").frame, [1.0, 0.3], [0, 0], parameters={"R": 1}),
    ):
        sol = solve(problem, 10.0, 1e-12, engine)
        rest = np.array([float(x) for x in problem.start or ()])
        assert np.abs(sol.coordinates - rest).max() < ROUNDED
        assert (sol.frame_velocity == 0).all()
        # A check starts one unit in the last place aside; the claim is twenty times the change.
        assert sol.error < 2e-14


@every_engine
def test_ill_conditioned_coframe(engine):
    """Rows that differ in size by 1e10, far from any edge: the plane in odd units."""
    r, phi = sp.symbols("r phi", positive=True)
    big = sp.Integer(10) ** 10
    frame = Frame([r, phi], [[big, 0], [0, r]], name="odd")
    # With r = s / 1e10 the metric is ds^2 + (s / 1e10)^2 dphi^2: a cone of a tiny angle.
    problem = geodesic(frame, [1.0, 0.0], velocity=[1e-10, 0.5])
    sol = solve(problem, 5.0, 1e-10, engine)
    s = np.sqrt((1e10 + 5.0) ** 2 + (0.5 * 5.0) ** 2)
    assert sol.coordinates[-1, 0] == pytest.approx(s / 1e10, rel=1e-9)
    assert truth_of(problem, sol.times).error(sol) <= 1e-10
    assert is_available() or sol.engine == "RungeKutta"


@every_engine
def test_removable_singularity(engine):
    """Near the north pole of a sphere, outside its own chart, motions do not stall."""
    problem = geodesic(load("s2").frame, [1e-7, 0.0], [0.0, 1e7], parameters={"R": 1})
    # At 1e-7 from the pole phi has nine digits.
    sol = solve(problem, 2.0, 1e-7, engine)
    assert max(v for k, v in sol.drift.items() if k == "norm") < 1e-9


@needs_heyoka
@pytest.mark.parametrize(
    ("start", "near", "accuracy"),
    one_in(2, [None, [0.3, 1.0, 0.2]], [1e-1, 1e-3, 1e-5], [1e-6, 1e-9, 1e-12]),
)
def test_near_the_unstable_axis(start, near, accuracy):
    """Conditioned like 1e7 and worse: doubles give their best, more digits do the rest.

    Two runs in doubles agree by chance where they share rounding errors; therefore the run that
    checks an answer is moved on the way, by one unit in the last place.
    """
    problem = geodesic(SO3, start, frame_velocity=[near, 1.0, 0.0], metric=TOP)
    truth = truth_of(problem, np.linspace(0, 60.0, 65))
    sol = solve(problem, 60.0, accuracy)
    error = truth.error(sol)
    assert error <= accuracy
    assert sol.error >= 0.1 * error
    try:
        plain = solve(problem, 60.0, accuracy, RungeKutta())
    except AccuracyError:
        return
    error = truth.error(plain)
    assert error <= accuracy
    assert plain.error >= 0.1 * error
