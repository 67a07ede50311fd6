"""Distance: agrees with chords and arcs, without jumps where angles wrap."""

import numpy as np
import pytest
import sympy as sp

from geomtorsion.curves import distance_apart, geodesic
from geomtorsion.errors import GeomtorsionError, UnknownNameError
from geomtorsion.geometry import Frame
from geomtorsion.ode import solve
from geomtorsion.spaces import load
from tests.ode.engines import every_engine

R, PHI = sp.symbols("r phi", positive=True)
POLAR = Frame([R, PHI], [[1, 0], [0, R]], name="polar")


@every_engine
def test_two_points_on_one_circle_of_latitude(engine):
    """On the equator, one point ahead of the other, the arc is the shorter way around."""
    sphere, times = load("s2").frame, np.linspace(0, 6, 61)
    fast, slow = (
        solve(
            geodesic(sphere, [np.pi / 2, 0], [0, speed], parameters={"R": 2}), times, 1e-10, engine
        )
        for speed in (1.5, 0.25)
    )
    ahead = 1.25 * times
    arc = np.abs(np.remainder(ahead + np.pi, 2 * np.pi) - np.pi)
    assert distance_apart(slow, fast) == pytest.approx(2 * arc, abs=1e-8)
    assert distance_apart(fast, slow) == pytest.approx(2 * arc, abs=1e-8)


@every_engine
def test_an_angle_that_the_space_does_not_know_of(engine):
    """A frame of the user has no atlas: its angles are given by name; near points are right."""
    one = solve(geodesic(POLAR, [1, 3.1], [0.0, 0.0]), [1.0], 1e-10, engine)
    two = solve(geodesic(POLAR, [1, -3.1], [0.0, 0.0]), [1.0], 1e-10, engine)
    gap = 2 * np.pi - 6.2
    assert distance_apart(one, two) == pytest.approx([6.2], rel=1e-9)
    assert distance_apart(one, two, angles=["phi"]) == pytest.approx([gap], rel=1e-9)
    assert gap == pytest.approx(2 * np.sin(gap / 2), rel=1e-3)
    with pytest.raises(UnknownNameError, match="expected coordinates of this chart"):
        distance_apart(one, two, angles=["theta"])
    with pytest.raises(GeomtorsionError):
        distance_apart(one, two, angles=3)  # type: ignore[arg-type]


def test_an_angle_that_the_domain_of_a_frame_names():
    """Two motions around a cylinder meet behind it: the domain of the chart names the angle."""
    z, phi = sp.symbols("z phi", real=True)
    tube = Frame([z, phi], [[1, 0], [0, 2]], domain=[phi > 0, phi < 2 * sp.pi])
    there, back = (solve(geodesic(tube, [1, 1], [0, turn]), [3.0, np.pi]) for turn in (1, -1))
    assert distance_apart(there, back) == pytest.approx([4 * (np.pi - 3), 0], abs=1e-9)
    assert distance_apart(there, back, angles=[]) == pytest.approx([12, 4 * np.pi])


def test_nothing_jumps_where_the_metric_mixes_time_and_angle():
    """One of two orbits around Kerr's hole laps the other: the distance changes without jumps."""
    kerr, numbers = load("kerr").frame, {"M": 1, "a": 0.6}
    times = np.linspace(0, 700, 1401)
    inner, outer = (
        solve(geodesic(kerr, start, velocity, parameters=numbers), times, 1e-9)
        for start, velocity in (
            ([0, 10.0, 1.4, 0.0], [1.2, 0, 0, 0.036]),
            ([0, 12.0, 1.5, 0.0], [1.2, 0, 0, 0.027]),
        )
    )
    ahead = inner.coordinates[:, 3] - outer.coordinates[:, 3]
    assert ahead.max() > np.pi
    gaps = distance_apart(inner, outer)
    # The distance changes no faster than both frame velocities together.
    speeds = [np.linalg.norm(one.frame_velocity, axis=1).max() for one in (inner, outer)]
    assert np.abs(np.diff(gaps)).max() <= sum(speeds) * 0.5
    assert np.abs(np.diff(gaps)).max() < 0.2


def test_indefinite_metrics_have_no_distance():
    """Points separated by a null vector have a gap; the docstring names the measured quantity."""
    t, x = sp.symbols("t x")
    plane = Frame([t, x], [[1, 0], [0, 1]], signature=(-1, 1))
    one = solve(geodesic(plane, [0, 0], [1, 0]), [1.0])
    two = solve(geodesic(plane, [3, 3], [1, 0]), [1.0])
    assert distance_apart(one, two) == pytest.approx([np.sqrt(18)])
    words = " ".join((distance_apart.__doc__ or "").split())
    assert "neither a distance nor an invariant" in words
