"""Geodesics that fall apart: constants of single coordinates, and what rounding does to them."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from geomtorsion.geometry import Frame
from geomtorsion.motion import Taylor, geodesic
from geomtorsion.motion.charts import Chart
from geomtorsion.motion.engines.store import tolerance_of
from geomtorsion.motion.engines.taylor import is_available
from geomtorsion.motion.equations import written
from geomtorsion.motion.journey import departure, travel
from geomtorsion.motion.laws import Hamel
from geomtorsion.motion.reduced import constants as constants_module
from geomtorsion.motion.reduced.rates import in_parts
from geomtorsion.spaces import load
from tests.motion.reduced_truth import compare, reduction_of, split_of

X, Y, Z, W, STRENGTH = sp.symbols("x y z w k", positive=True)
with_heyoka = pytest.mark.skipif(not is_available(), reason="needs more than double precision")

one_coordinate = st.sampled_from(
    [sp.Integer(1), X, 1 + X**2, 2 + sp.sin(X), sp.exp(X), STRENGTH * X, 1 / (1 + X), sp.cosh(X)]
)


@st.composite
def separable_frames(draw):
    """Frames over x, y, z, w whose geodesics fall apart, x first: as with spherical coordinates."""
    radial, polar, one, two = (draw(one_coordinate) for _ in range(4))
    size = draw(one_coordinate)
    rows = sp.diag(radial, size, size * polar.subs(X, Y), one)
    rows[1, 1] = size * two.subs(X, Y)
    rows[3, 2] = draw(st.sampled_from([sp.Integer(0), STRENGTH * one]))
    signs = draw(st.sampled_from([(1, 1, 1, 1), (1, 1, 1, -1)]))
    frame = Frame((X, Y, Z, W), rows.tolist(), signature=signs, parameters=(STRENGTH,))
    return frame, frame.field.read(size**2)


@settings(max_examples=25, deadline=None)
@given(separable_frames())
def test_rates_of_single_coordinates(found):
    """q' and v' are those of the frame, exactly, once all constants are put in."""
    frame, scale = found
    equations = written(frame, Hamel(), Chart.of(frame))
    if not equations.moves:
        return
    parts = split_of(equations)
    small = in_parts(parts, scale, ())
    assert small is not None
    assert len(small.separators) == len(parts.others)
    compare(equations, parts, small)


@pytest.mark.parametrize("name", ["kerr", "schwarzschild", "de_sitter"])
def test_rates_of_single_coordinates_in_known_spaces(name):
    """Carter's constant, and what is left of it without rotation."""
    frame = load(name).frame
    equations = written(frame, Hamel(), Chart.of(frame))
    small = reduction_of(equations).written
    assert list(small.separators) == ["c_r", "c_theta"]
    compare(equations, split_of(equations), small)


def test_what_does_not_fall_apart():
    """x, y and z of isotropic coordinates hang together."""
    frame = load("schwarzschild_isotropic").frame
    equations = written(frame, Hamel(), Chart.of(frame))
    parts = split_of(equations)
    assert in_parts(parts, frame.field.one, ()) is None
    assert not reduction_of(equations).written.separators


# -- as numbers ------------------------------------------------------------------------------------

ORBITS = {
    "bound": ([0, 8.0, 1.4, 0], [1.2, 0.05, 0.2, 0.36], 600.0),
    "light": ([0, 8.0, 1.4, 0], [0.55, -0.4, 0.12, 0.36], 40.0),
    "far away": ([0, 800.0, 1.4, 0], [1.0, 0.005, 0.01, 0.03], 2e4),
    "near the pole": ([0, 8.0, 1.0, 0], [1.2, 0.05, 0.47, 1e-3], 200.0),
    "falling": ([0, 8.0, 1.4, 0], [1.05, -0.2, 0.1, 0.2], 20.0),
    "no angular momentum": ([0, 8.0, 1.2, 0], [1.2, 0.05, 0.1, 0.0], 8.0),
}


def orbit(start, velocity):
    """A geodesic of Kerr's space, in one chart."""
    numbers = {"M": 1, "a": 0.6}
    frame = load("kerr").frame
    found = geodesic(frame, start, frame_velocity=velocity, parameters=numbers, causal=None)
    return found.with_charts("kerr")


@with_heyoka
@pytest.mark.parametrize("name", ORBITS)
def test_rounding_alone_is_left(name):
    """At a high order what is left are roundings, relative to the size of each state."""
    start, velocity, end = ORBITS[name]
    problem = orbit(start, velocity)
    grid = np.linspace(0, end, 17) * problem.speed
    truth = travel(problem, Taylor(113), 1e-28, grid)
    found = travel(problem, Taylor(), tolerance_of(20), grid)
    assert truth.outcome == found.outcome == "done"
    (precise,), (rounded,) = truth.segments, found.segments
    sizes = np.abs(precise.states).max(axis=0).astype(float)
    gaps = np.abs(rounded.states - precise.states.astype(float)).max(axis=0)
    # Near the pole angles turn fast: what they are off is told to all others there.
    most = 1500 if name == "near the pole" else 300
    assert (gaps < most * 2.0**-53 * sizes).all()


@with_heyoka
def test_a_circle_stays_a_circle():
    """On the equator, at r = 8, for four thousand units of time: v_r grows by rounding alone."""
    a, r = 0.6, 8.0
    below = np.sqrt(1 - 3 / r + 2 * a * r**-1.5)
    energy = (1 - 2 / r + a * r**-1.5) / below
    turn = np.sqrt(r) * (1 - 2 * a * r**-1.5 + a * a / r**2) / below
    root = np.sqrt(r * r - 2 * r + a * a)
    legs = np.array([[root, a], [a * root, r * r + a * a]]) / r
    u1, u4 = np.linalg.solve(legs, [energy, turn])
    problem = orbit([0, r, np.pi / 2, 0], [u1, 0, 0, u4])
    (segment,) = travel(problem, Taylor(), 1e-16, np.linspace(0, 4000.0, 9)).segments
    assert np.abs(segment.states[:, 1] - r).max() < 1e-12
    assert np.abs(segment.states[:, 2] - np.pi / 2).max() < 1e-12


@pytest.mark.parametrize("orbit_name", ORBITS)
def test_constants_have_all_their_digits(orbit_name, monkeypatch):
    """Against 200 bits; also where the machine has no longer numbers."""
    start, velocity, _ = ORBITS[orbit_name]
    problem = orbit(start, velocity)
    _, _, vector, parameters = departure(problem, 53)
    small = reduction_of(problem.equations("kerr"))
    exact = [float(x) for x in small.constants(vector, parameters, 200)]
    assert len(exact) == len(small.names) >= 10
    size = max(map(abs, exact))
    for enough in (constants_module.ENOUGH, 1000):
        monkeypatch.setattr(constants_module, "ENOUGH", enough)
        found = small.constants(vector, parameters)
        assert found == pytest.approx(exact, rel=1e-14, abs=1e-17 * size)
        table = dict(zip(small.names, found, strict=True))
        assert abs(table["c_r"] + table["c_theta"]) < 1e-15 * size


def test_starts_without_finite_constants():
    """On the axis the smaller system does not serve: the full one answers, as it can."""
    problem = orbit([0, 8.0, 1.0, 0], [1.2, 0.05, 0.1, 0.0])
    equations = problem.equations("kerr")
    _, _, vector, parameters = departure(problem, 53)
    on_axis = [*vector[:2], 0.0, *vector[3:]]
    assert reduction_of(equations).opened(Taylor(), on_axis, parameters) is None
    assert reduction_of(equations).opened(Taylor(), vector, parameters) is not None
