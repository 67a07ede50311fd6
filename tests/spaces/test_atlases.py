"""Charts of shipped spaces continue motions where coordinates end, as closed forms show."""

import numpy as np
import pytest

from geomtorsion.curves import autoparallel, geodesic
from geomtorsion.curves.atlas import atlas_of
from geomtorsion.geometry import cartan
from geomtorsion.ode import solve
from geomtorsion.rigid.attitude import product
from geomtorsion.spaces import load
from tests.ode.engines import every_engine

# Starts, and the share of u by which the quaternion rotates.
GROUPS = {
    "so3_quaternion": ([0.1, 0.2, 0.3], 0.5),
    "so3_rodrigues": ([0.1, 0.2, 0.3], 0.5),
    "so3_axis_angle": ([0.5, 1.2, 0.3], 0.5),
    "bianchi_ix": ([0.5, 1.2, 0.3], 0.5),
    "s3": ([0.5, 1.2, 0.3], 1.0),
}


@every_engine
@pytest.mark.parametrize("charts", [(), ("home", "quaternion")], ids=["preferred", "home first"])
@pytest.mark.parametrize("name", GROUPS)
def test_turning_at_a_constant_rate(name, charts, engine):
    """Q = Q(0) exp(share u t), beyond half turns, and the home coordinates of the same points."""
    start, share = GROUPS[name]
    frame, u = load(name).frame, np.array([0.2, 0.1, 1.0])
    atlas = atlas_of(frame)
    problem = geodesic(frame, start, frame_velocity=u.tolist())
    if charts:
        problem = problem.with_charts(name, "quaternion")
    times, rate = np.array([1.0, 2.6, 3.0, 9.0, 17.0]), np.linalg.norm(u)
    sol = solve(problem, times, 1e-9, engine)
    first = atlas.route(name, "quaternion")[0](start, {})
    angles = share * rate * times
    turns = [[np.cos(x), *(np.sin(x) * u / rate)] for x in angles]
    want = np.array([product(first, np.array(turn)) for turn in turns])
    (there,) = atlas.route(name, "quaternion")
    for found in (sol.in_chart("quaternion"), there(sol.coordinates.T, {}).T):
        signs = np.sign((found * want).sum(axis=1, keepdims=True))
        # The error of Hopf's angles is relative to their size, which grows.
        assert np.abs(signs * found - want).max() < 5e-9
    assert np.isfinite(sol.at(2.8).coordinates).all()
    if name == "so3_quaternion":
        assert (np.linalg.norm(sol.coordinates, axis=1) < 1).all()


@pytest.mark.parametrize(("least", "left"), [(0.24, True), (0.26, False)])
def test_how_near_a_pole_angles_are_kept(least, left):
    """A great circle leaves its angles where the sine at a pole is below a quarter."""
    away = np.arccos(least)
    problem = geodesic(
        load("s2").frame, [np.pi / 2, 0.3], frame_velocity=[-np.sin(away), least],
        parameters={"R": 1},
    )  # fmt: skip
    assert ("s2_x" in solve(problem, 3.0, 1e-6).charts) == left


@pytest.mark.parametrize(("least", "left"), [(0.095, True), (0.105, False)])
def test_how_near_an_axis_angles_are_kept(least, left):
    """A straight line leaves polar coordinates within a tenth of their origin."""
    sine = least / 2
    problem = geodesic(
        load("flat_polar").frame, [2, 0.3], frame_velocity=[-np.sqrt(1 - sine**2), sine]
    ).with_charts("flat_polar", "cartesian")
    assert ("cartesian" in solve(problem, 4.0, 1e-6).charts) == left


def test_autoparallels_continue():
    """Rotation around a fixed axis of the body, an autoparallel: its chart keeps the frame."""
    so3 = load("so3_quaternion").frame
    sol = solve(autoparallel(cartan(so3), [0.1, 0.2, 0.3], frame_velocity=[0.2, 0.1, 1]), 3.0)
    assert sol.charts == ("quaternion",)


@every_engine
def test_a_great_circle_of_the_seven_sphere(engine):
    """Through the antipode, which is at infinity: x = n tan(t / 2)."""
    n = np.array([2.0, -1.0, 0.0, 1.0, 1.0, 1.0, 1.0]) / 3
    problem = geodesic(load("s7").frame, [0.0] * 7, frame_velocity=n.tolist())
    times = np.array([1.0, 3.0, 3.2, 5.0])
    sol = solve(problem, times, 1e-10, engine)
    want = np.tan(times / 2)[:, None] * n
    assert np.abs(sol.coordinates - want).max() < 1e-9 * np.abs(want).max() ** 2
    assert "s7_far" in sol.charts


@every_engine
def test_out_through_the_horizon_of_de_sitter(engine):
    """At rest in the flow of space: r = r0 exp(t / L), past r = L."""
    r, length = 3.0, 9.0
    rate = 1 / np.sqrt(1 - (r / length) ** 2)
    problem = geodesic(
        load("de_sitter").frame, [0, r, 1.2, 0.3],
        frame_velocity=[rate, rate * r / length, 0, 0], parameters={"L": length},
        causal="timelike",
    )  # fmt: skip
    times = np.array([5.0, 12.0, 20.0])
    sol = solve(problem, times, 1e-10, engine)
    found = np.linalg.norm(sol.in_chart("painleve")[:, 1:], axis=1)
    assert found == pytest.approx(r * np.exp(times / length), rel=1e-9)


@every_engine
def test_into_the_isotropic_hole(engine):
    """From rest at infinity r^(3/2) falls evenly, through the horizon s = M / 2."""
    place, mass = np.array([2.0, -4.0, 4.0]), 1.0
    s = np.linalg.norm(place)
    r = s * (1 + mass / (2 * s)) ** 2
    f = 1 - 2 * mass / r
    inwards = -np.sqrt(1 / f - 1) * place / s
    problem = geodesic(
        load("schwarzschild_isotropic").frame, [0, *place],
        frame_velocity=[1 / np.sqrt(f), *inwards], parameters={"M": mass}, causal="timelike",
    )  # fmt: skip
    times = np.linspace(1.0, 7.8, 5)
    sol = solve(problem, times, 1e-10, engine)
    found = np.linalg.norm(sol.in_chart("kerr_schild")[:, 1:], axis=1)
    assert found[-1] < 1.9
    want = (r**1.5 - 1.5 * np.sqrt(2.0) * times) ** (2 / 3)
    assert found == pytest.approx(want, rel=1e-8)


@every_engine
def test_two_tetrads_of_the_black_hole_have_one_fall(engine):
    """Geodesics do not depend on the legs: Cartesian and static ones agree across the horizon."""
    start, velocity = [0.0, 6.0, 1.2, 0.3], [1.6, -0.5, 0.01, 0.03]
    times = [2.0, 6.5]
    static, cartesian = (
        solve(
            geodesic(load(name).frame, start, velocity, parameters={"M": 1}), times, 1e-10, engine
        )
        for name in ("schwarzschild", "schwarzschild_cartesian")
    )
    assert cartesian.charts == ("diagonal", "kerr_schild")
    one, two = (sol.in_chart("kerr_schild") for sol in (static, cartesian))
    assert np.linalg.norm(two[:, 1:], axis=1).min() < 2
    assert two == pytest.approx(one, abs=1e-9 * np.abs(one).max())
    outside = [solve(sol.problem, 2.0, 1e-10, engine) for sol in (static, cartesian)]
    assert outside[1].velocity[-1] == pytest.approx(outside[0].velocity[-1], abs=1e-9)
    # Both answer in their own legs, which carry the same norm and the same leg along time.
    one, two = (sol.frame_velocity[-1] for sol in outside)
    assert two[0] == pytest.approx(one[0], abs=1e-9)
    assert np.linalg.norm(two[1:]) == pytest.approx(np.linalg.norm(one[1:]), abs=1e-9)
    assert abs(two[3] - one[3]) > 0.1
