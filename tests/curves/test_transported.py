"""Transport, holonomy, separations, exponential map and its inverse."""

import numpy as np
import pytest
import sympy as sp

from geomtorsion.curves import (
    autoparallel,
    exponential_map,
    geodesic,
    geodesic_deviation,
    holonomy,
    log_map,
    parallel_transport,
)
from geomtorsion.errors import AccuracyError, ChartEdgeError, EndpointError, ShapeError, StartError
from geomtorsion.geometry import cartan, levi_civita
from geomtorsion.geometry.connections import blend
from geomtorsion.ode import RungeKutta, solve
from geomtorsion.spaces import load
from tests.ode.engines import every_engine

S = sp.Symbol("s")
S2 = load("s2").frame
UNIT = {"R": 1}


@every_engine
@pytest.mark.parametrize("theta", [0.3, 1.0, 2.5])
def test_holonomy_of_a_circle_of_latitude(theta, engine):
    """A vector rotates by 2 pi cos(theta) against the compass."""
    turn = holonomy(levi_civita(S2), [theta, 2 * sp.pi * S], parameters=UNIT, engine=engine)
    angle = 2 * np.pi * np.cos(theta)
    c, s = np.cos(angle), np.sin(angle)
    assert np.abs(turn - np.array([[c, s], [-s, c]])).max() < 1e-9


@every_engine
def test_cartan_transport_turns_nothing(engine):
    """Legs are parallel: the holonomy is the identity."""
    turn = holonomy(cartan(S2), [1 + S / 3, 2 * S], 2.0, parameters=UNIT, engine=engine)
    assert turn.tolist() == np.eye(2).tolist()


@every_engine
def test_transport_along_a_geodesic_keeps_the_angle(engine):
    """The velocity is carried into the velocity; lengths are kept."""
    problem = geodesic(S2, [1.0, 0.5], [0.4, 0.9], parameters={"R": 2})
    u = problem.frame_velocity
    sol = solve(parallel_transport(problem, [u, [1, 2]]), 2.0, 1e-10, engine)
    assert sol.transported[:, :2] == pytest.approx(sol.frame_velocity, abs=1e-9)
    assert np.hypot(*sol.transported[:, 2:].T) == pytest.approx(np.sqrt(5), rel=1e-9)
    matrix = holonomy(levi_civita(S2), problem, 2.0, engine=engine)
    assert matrix @ np.array(u) == pytest.approx(sol.frame_velocity[-1], abs=1e-9)


@every_engine
@pytest.mark.parametrize("share", [0, sp.Rational(1, 2), 1])
def test_separation_is_the_derivative_of_the_motion(share, engine):
    """With and without torsion: the difference of neighbours over their distance."""
    frame = load("flat_polar").frame
    connection = blend(levi_civita(frame), cartan(frame), share)
    start, u = np.array([1.0, 0.2]), np.array([0.3, 0.8])
    offset, rate = np.array([0.2, -0.1]), np.array([0.05, 0.3])
    problem = autoparallel(connection, start, frame_velocity=u)
    sol = solve(geodesic_deviation(problem, offset, rate), 2.0, 1e-10, engine)
    h = 1e-4
    ends = [
        solve(
            problem.with_start(start + k * h * offset, frame_velocity=u + k * h * rate), 2.0, 1e-12
        )
        for k in (1, -1)
    ]
    q = (ends[0].coordinates[-1] - ends[1].coordinates[-1]) / (2 * h)
    v = (ends[0].frame_velocity[-1] - ends[1].frame_velocity[-1]) / (2 * h)
    # Central differences: h^2 of the third derivative, and 1e-12 / h.
    assert sol.transported[-1] == pytest.approx([*q, *v], abs=1e-6)


@every_engine
def test_neighbouring_meridians(engine):
    """Jacobi's equation on the sphere: two great circles part like sin(t)."""
    problem = geodesic(S2, [np.pi / 2, 0.0], [0.0, 1.0], parameters=UNIT)
    sol = solve(geodesic_deviation(problem, [0, 0], [1, 0]), 3.0, 1e-10, engine)
    assert sol.transported[:, 0] == pytest.approx(np.sin(sol.times), abs=1e-9)


def test_exponential_map_of_the_sphere():
    """A motion of length 1.2 from the equator along a meridian ends at its angle."""
    end = exponential_map(levi_civita(S2), [np.pi / 2, 0.3], [-1.2, 0.0], parameters=UNIT)
    assert end == pytest.approx([np.pi / 2 - 1.2, 0.3], abs=1e-9)


def test_connecting_points_of_the_sphere():
    """The shooting finds the great circle; its length is the angle."""
    found = log_map(levi_civita(S2), [1.0, 0.0], [2.0, 1.0], parameters=UNIT)
    angle = np.arccos(np.cos(1) * np.cos(2) + np.sin(1) * np.sin(2) * np.cos(1))
    assert np.linalg.norm(found.vector) == pytest.approx(angle, rel=1e-9)
    assert found.miss < 1e-8
    assert exponential_map(
        levi_civita(S2), [1.0, 0.0], found.vector, parameters=UNIT
    ) == pytest.approx([2.0, 1.0], abs=1e-8)


def test_connecting_by_an_autoparallel():
    """so3: the rotation vector between two attitudes is found again."""
    frame = load("so3").frame
    vector = [0.4, -0.3, 0.5]
    end = exponential_map(cartan(frame), [0.3, 1.0, 0.2], vector)
    assert log_map(cartan(frame), [0.3, 1.0, 0.2], end).vector == pytest.approx(vector, abs=1e-8)


def test_cut_locus():
    """Antipodes have no unique answer; close to them a guess gives one."""
    start, end = [np.pi / 2, 0.0], [np.pi / 2, np.pi]
    with pytest.raises(EndpointError, match="unique|no motion"):
        log_map(levi_civita(S2), start, end, parameters=UNIT)
    near = [np.pi / 2, np.pi - 0.05]
    found = log_map(levi_civita(S2), start, near, parameters=UNIT, guess=[0.0, 3.0])
    assert found.vector == pytest.approx([0, np.pi - 0.05], abs=1e-8)


def test_refused_paths():
    """Wrong length, two symbols, a path off the chart and too high accuracy are refused."""
    bar = levi_civita(S2)
    with pytest.raises(ShapeError, match="path: expected one for each of 2 coordinates, got 1"):
        holonomy(bar, [S], parameters=UNIT)
    with pytest.raises(StartError, match="one symbol"):
        holonomy(bar, [S, sp.Symbol("w")], parameters=UNIT)
    hole = levi_civita(load("schwarzschild").frame)
    with pytest.raises(ChartEdgeError, match="leaves the chart"):
        holonomy(hole, [0, 3 - S, 1, S], 2.0, parameters={"M": 1}, engine=RungeKutta())
    with pytest.raises(AccuracyError, match="gets to"):
        holonomy(bar, [1 + S / 9, 9 * S], parameters=UNIT, accuracy=1e-18, engine=RungeKutta())


@every_engine
@pytest.mark.parametrize("speed", [1.0, 8.0, 0.03])
@pytest.mark.parametrize("name", ["s2", "flat_polar", "so3"])
def test_separation_at_any_speed(speed, name, engine):
    """Scaled start speeds and rates give the same offset at scaled times, with scaled rates."""
    frame = load(name).frame
    start, velocity, offset, rate = {
        "s2": ([1.1, 0.2], [0.3, 0.7], [0.1, -0.2], [0.05, 0.3]),
        "flat_polar": ([1.0, 0.2], [0.3, 0.8], [0.2, -0.1], [0.05, 0.3]),
        "so3": ([0.3, 1.0, 0.2], [0.3, 0.8, 0.1], [0.2, -0.1, 0.1], [0.05, 0.3, -0.2]),
    }[name]
    numbers = {"R": 1.5} if name == "s2" else {}
    u, w = np.array(velocity), np.array(rate)
    one = geodesic(frame, start, frame_velocity=u, parameters=numbers)
    fast = geodesic(frame, start, frame_velocity=speed * u, parameters=numbers)
    n, times = len(start), np.linspace(0.0, 1.2, 7)
    plain = solve(geodesic_deviation(one, offset, w), times, 1e-11, engine).transported
    scaled = solve(geodesic_deviation(fast, offset, speed * w), times / speed, 1e-11, engine)
    assert scaled.transported[:, :n] == pytest.approx(plain[:, :n], abs=1e-9)
    assert scaled.transported[:, n:] == pytest.approx(speed * plain[:, n:], abs=1e-9 * speed)


@pytest.mark.parametrize("speed", [8.0, 0.125, 3.0])
def test_separation_at_any_speed_is_the_derivative(speed):
    """At speeds other than one the separation is the difference of two geodesics."""
    start, u = np.array([1.1, 0.2]), speed * np.array([0.3, 0.7])
    offset, rate = np.array([0.1, -0.2]), np.array([0.4, -0.9])
    problem = geodesic(S2, start, frame_velocity=u, parameters=UNIT)
    end = 1.5 / speed
    sol = solve(geodesic_deviation(problem, offset, rate), end, 1e-11)
    h = 1e-4
    one, two = (
        solve(
            problem.with_start(start + k * h * offset, frame_velocity=u + k * h * rate), end, 1e-12
        )
        for k in (1, -1)
    )
    q = (one.coordinates[-1] - two.coordinates[-1]) / (2 * h)
    v = (one.frame_velocity[-1] - two.frame_velocity[-1]) / (2 * h)
    # Central differences: h^2 of the third derivative, and 1e-12 / h.
    assert sol.transported[-1] == pytest.approx([*q, *v], rel=1e-6, abs=1e-6)
