"""Charts: motions continue where coordinates end, and keep their accuracy at the change."""

from functools import partial

import numpy as np
import pytest
import sympy as sp

from geomtorsion.curves import autoparallel, geodesic
from geomtorsion.curves.atlas import TransitionMap, atlas_of
from geomtorsion.errors import (
    ArgumentError,
    ChartEdgeError,
    GeomtorsionError,
    UnknownNameError,
)
from geomtorsion.geometry import cartan
from geomtorsion.ode import solve
from geomtorsion.spaces import load, names
from tests.chosen import one_in
from tests.ode.engines import every_engine
from tests.rounding import ROUNDED

PARAMETERS = {
    "s2": {"R": 2.0},
    "schwarzschild": {"M": 1.0},
    "schwarzschild_cartesian": {"M": 1.0},
    "schwarzschild_isotropic": {"M": 1.0},
    "kerr": {"M": 1.0, "a": 0.6},
    "de_sitter": {"L": 9.0},
}
POINTS = {
    "s2": [1.0, 0.5],
    "flat_polar": [1.2, 0.3],
    "flat_cylindrical": [1.2, 0.3, 0.4],
    "flat_spherical": [1.2, 0.7, 0.4],
    "schwarzschild": [0.3, 6.0, 1.1, 0.4],
    "schwarzschild_cartesian": [0.3, 6.0, 1.1, 0.4],
    "schwarzschild_isotropic": [0.3, 3.0, 1.1, 0.4],
    "kerr": [0.3, 6.0, 1.1, 0.4],
    "de_sitter": [0.3, 6.0, 1.1, 0.4],
    "s7": [0.3, 0.2, -0.5, 0.1, 0.4, 0.6, -0.2],
    "so3_quaternion": [0.3, -0.4, 0.2],
    "r3xso3": [0.3, 1.0, 0.2, 1.0, 2.0, 3.0],
}


def changes():
    """Every shipped space with every further chart that it has."""
    found = []
    for name in names():
        atlas = atlas_of(load(name).frame)
        found += [(name, other) for other in atlas.makers if other != atlas.home]
    return found


def test_there_are_as_many_charts_as_stated():
    """Seven sets of angles, five of them with a second set; spheres, flat spaces, horizons."""
    assert len(changes()) == 29


@pytest.mark.parametrize("change", one_in(2, changes()))
def test_changes_keep_the_frame(change):
    """There and back is the identity; the frame vectors are equal, or rotated by an isometry."""
    name, other = change
    frame = load(name).frame
    atlas = atlas_of(frame)
    problem = geodesic(
        frame,
        POINTS.get(name, [0.3, 1.0, 0.2]),
        frame_velocity=[1] * frame.dimension,
        parameters=PARAMETERS.get(name, {}),
    )
    numbers = PARAMETERS.get(name, {})
    home, q = atlas.chart(atlas.home), np.array(problem.start)
    there, slopes = q, np.eye(len(q))
    for change in atlas.route(atlas.home, other):
        names = atlas.chart(change.source).names
        here = dict(zip(names, map(float, there), strict=True)) | numbers
        slopes = change.slopes.at(here) @ slopes
        there = change(there, numbers)
    back = there
    for change in atlas.route(other, atlas.home):
        back = change(back, numbers)
    assert back == pytest.approx(q, abs=1e-13)
    chart = atlas.chart(other)
    pushed = slopes @ home.frame_vectors.at(
        dict(zip(home.names, q.tolist(), strict=True)) | numbers
    )
    point = dict(zip(chart.names, map(float, there), strict=True)) | numbers
    if chart.keeps_frame:
        assert pushed == pytest.approx(chart.frame_vectors.at(point), abs=ROUNDED)
    else:
        assert chart.frame is not None
        turn = chart.coframe.at(point) @ pushed
        eta = np.array(frame.eta.to_sympy().tolist(), dtype=float)
        assert turn.T @ eta @ turn == pytest.approx(eta, abs=1e-13)


@every_engine
def test_two_sets_of_angles_against_the_quaternion(engine):
    """so3: changing between zyz and xyz angles agrees with the quaternion."""
    problem = geodesic(
        load("so3").frame, [0.3, 1.0, 0.2], frame_velocity=[0.9, 1.3, -0.4], metric=[1.0, 2.0, 3.0]
    )
    hub = solve(problem, 20.0, 1e-11, engine)
    hops = solve(problem.with_charts("so3", "so3_xyz"), 20.0, 1e-11, engine)
    assert hub.charts == ("quaternion",)
    assert len(hops.charts) >= 3
    assert set(hops.charts) == {"so3", "so3_xyz"}
    one, two = hub.in_chart("quaternion"), hops.in_chart("quaternion")
    # A quaternion and its negative are the same rotation.
    gap = np.minimum(np.abs(one - two).max(axis=1), np.abs(one + two).max(axis=1))
    assert gap.max() < 5e-11


@every_engine
def test_through_the_pole_of_the_sphere(engine):
    """s2: a meridian goes over the pole, around and back to its start."""
    problem = geodesic(load("s2").frame, [1.0, 0.5], [-1.0, 0.0], parameters={"R": 1})
    sol = solve(problem, [0.5, 1.0 + 0.7, 2 * np.pi], 1e-11, engine)
    assert set(sol.charts) == {"s2", "s2_x"}
    assert sol.coordinates[0] == pytest.approx([0.5, 0.5], abs=1e-10)
    assert sol.coordinates[1, 0] == pytest.approx(0.7, abs=1e-10)
    assert abs(sol.coordinates[1, 1] - 0.5) == pytest.approx(np.pi, abs=1e-10)
    assert sol.coordinates[2] == pytest.approx([1.0, 0.5], abs=1e-10)


@every_engine
def test_through_the_origin(engine):
    """Polar and spherical frames: a straight line passes through r = 0."""
    polar = geodesic(load("flat_polar").frame, [1.0, 0.4], [-1.0, 0.0])
    end = solve(polar, [3.0], 1e-11, engine).coordinates[-1]
    assert end[0] == pytest.approx(2.0, abs=1e-10)
    assert abs(end[1] - 0.4) == pytest.approx(np.pi, abs=1e-10)
    ball = geodesic(load("flat_spherical").frame, [1.0, 0.8, 0.4], [-1.0, 0.0, 0.0])
    end = solve(ball, [3.0], 1e-11, engine).coordinates[-1]
    assert end[:2] == pytest.approx([2.0, np.pi - 0.8], abs=1e-10)


@every_engine
@pytest.mark.parametrize("name", ["schwarzschild", "kerr"])
def test_through_the_horizon(name, engine):
    """A fall with the energy of rest at infinity crosses r_+ smoothly and keeps its invariants."""
    numbers = {"M": 1.0} if name == "schwarzschild" else {"M": 1.0, "a": 0.5}
    frame = load(name).frame
    f = 1 - 2 / 8.0
    start, velocity = [0.0, 8.0, 1.2, 0.3], [1 / f, -np.sqrt(2 / 8.0), 0.0, 0.0]
    if name == "schwarzschild":
        problem = geodesic(frame, start, velocity, parameters=numbers, causal="timelike")
    else:
        problem = geodesic(
            frame, start, frame_velocity=[1.25, -0.75, 0, 0], parameters=numbers, causal="timelike"
        )
    sol = solve(problem, 9.8 if name == "schwarzschild" else 8.6, 1e-9, engine)
    inside = sol.charts[-1]
    assert inside in ("kerr_schild", "ingoing")
    with pytest.raises(ChartEdgeError, match="does not reach"):
        sol.coordinates  # noqa: B018  (reading it raises the error)
    radii = sol.in_chart(inside)
    r = np.linalg.norm(radii[:, 1:], axis=1) if inside == "kerr_schild" else radii[:, 1]
    assert r[-1] < 1.8
    if name == "schwarzschild":
        # From rest at infinity: r^(3/2) falls linearly in proper time.
        expected = (8**1.5 - 1.5 * np.sqrt(2.0) * sol.times) ** (2 / 3)
        assert r == pytest.approx(expected, rel=1e-7)
    assert max(sol.drift.values()) < 1e-8


def test_laws_about_the_frame_stay_with_it():
    """Autoparallels depend on the frame: a chart with a rotated frame is not used for them."""
    problem = autoparallel(
        cartan(load("s2").frame), [1.0, 0.0], frame_velocity=[0, 1], parameters={"R": 1}
    )
    assert problem.charts == ("s2",)
    assert geodesic(load("s2").frame, [1, 0], [0, 1], parameters={"R": 1}).charts == ("s2", "s2_x")


def test_unknown_charts():
    """The message lists the available charts."""
    problem = geodesic(load("s2").frame, [1, 0], [0, 1], parameters={"R": 1})
    with pytest.raises(UnknownNameError, match="s2_x"):
        problem.with_charts("mercator")
    with pytest.raises(UnknownNameError, match="s2_x"):
        solve(problem, 1.0).in_chart("mercator")


def carter(q, rates, numbers):
    """Energy, angular momentum and Carter's constant in Boyer-Lindquist coordinates."""
    (_, r, theta, _), (mass, a) = q.T, (numbers["M"], numbers["a"])
    sigma, delta = r**2 + a**2 * np.cos(theta) ** 2, r**2 - 2 * mass * r + a**2
    s2 = np.sin(theta) ** 2
    t, radial, polar, azimuth = rates.T
    clock, turn = t - a * s2 * azimuth, (r**2 + a**2) * azimuth - a * t
    energy = (delta * clock + a * s2 * turn) / sigma
    momentum = s2 * (delta * a * clock + (r**2 + a**2) * turn) / sigma
    square = (-delta * clock**2 + s2 * turn**2) / sigma + sigma * (radial**2 / delta + polar**2)
    own = (sigma * polar) ** 2 - np.cos(theta) ** 2 * a**2 * (energy**2 + square)
    return energy, momentum, own + np.cos(theta) ** 2 * momentum**2 / np.maximum(s2, 1e-300)


@every_engine
@pytest.mark.parametrize("end", [115.0, pytest.param(240.0, marks=pytest.mark.slow)])
def test_polar_orbit_of_kerr(engine, end):
    """An orbit without angular momentum passes through both poles of the axis repeatedly."""
    numbers = {"M": 1.0, "a": 0.6}
    frame = load("kerr").frame
    # In Carter's tetrad u3 = 0 at the equator and L = 0: u3 = -a u0 sqrt(Delta) / (r^2 + a^2).
    r, a = 8.0, 0.6
    tilt = a * np.sqrt(r**2 - 2 * r + a**2) / (r**2 + a**2)
    polar = 0.48
    u0 = np.sqrt((1 + polar**2) / (1 - tilt**2))
    problem = geodesic(
        frame,
        [0.0, r, np.pi / 2, 0.0],
        frame_velocity=[u0, 0.0, polar, -tilt * u0],
        parameters=numbers,
        causal="timelike",
    )
    # Samples off the axis, where Boyer-Lindquist angles have values.
    count = round(end / 6)
    sol = solve(problem, np.linspace(1.0, end, count), 1e-9, engine)
    assert set(sol.charts) == {"kerr", "axis"}
    assert max(sol.drift.values()) < 1e-8
    height = np.cos(sol.in_chart("ingoing")[:, 2])
    assert (np.diff(np.sign(height)) != 0).sum() >= (2 if end > 200 else 1)
    energy, momentum, constant = carter(sol.coordinates, sol.velocity, numbers)
    assert np.abs(momentum).max() < 1e-7
    assert energy == pytest.approx(np.full(count, energy[0]), rel=1e-7)
    assert constant == pytest.approx(np.full(count, constant[0]), rel=1e-6)


X, Y, K = sp.symbols("x y k")


@pytest.mark.parametrize(
    ("coordinates", "parameters", "message"),
    [
        ([1.0], {"k": 1}, r"coordinates: expected one for each of 2 names x, y, got 1"),
        ([1.0, 2.0, 3.0], {"k": 1}, r"coordinates: expected one for each of 2 names x, y, got 3"),
        (3, {"k": 1}, "coordinates: expected a list, got 3"),
        (["1", 2.0], {"k": 1}, "expected a number.*, got '1'"),
        ([1.0, 2j], {"k": 1}, "expected a number.*, got 2j"),
        ([1.0, 2.0], None, "parameters: expected a value for k, got none"),
        ([1.0, 2.0], {"k": "1"}, "parameter k: expected a number, got '1'"),
    ],
)
def test_wrong_changes_of_charts_are_refused(coordinates, parameters, message):
    """Floats and precise numbers refuse the same input; parameters may be keyed by symbols."""
    change = TransitionMap("one", "other", (X, Y), (X + K * Y, X * Y), (K,))
    assert change([1.0, 2.0], {K: 2}).tolist() == [5.0, 2.0]
    assert change.precisely([1, 2], {"k": 2}, 100) == [5, 2]
    for ask in (change, partial(change.precisely, bits=100)):
        with pytest.raises(GeomtorsionError, match=message):
            ask(coordinates, parameters)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ((1, "b", (X, Y), (X, Y)), "source: expected text"),
        (("a", "b", "xy", (X, Y)), "coordinates: expected a list"),
        (("a", "b", (X, "y"), (X, Y)), r"coordinates\[1\]: expected a Symbol"),
        (("a", "b", (X, Y), 5), "expressions: expected a list"),
        (("a", "b", (X, Y), (X, Y), (), (2,)), r"angles\[0\]: expected a whole number from 0 to 1"),
    ],
)
def test_a_change_of_charts_is_written_wrongly(given, message):
    """A wrong argument is refused by the constructor."""
    with pytest.raises(ArgumentError, match=message):
        TransitionMap(*given)
