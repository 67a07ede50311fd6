"""Developments that are numerically hard: near singularities, wild curves, extreme sizes."""

import numpy as np
import pytest
import sympy as sp

import geomtorsion.spaces as spaces
from geomtorsion.errors import LoopError, SingularPointError
from geomtorsion.geometry import Connection, Frame, cartan, levi_civita
from geomtorsion.loops import Loop, develop, dispiration, parallel_screws
from geomtorsion.loops.edges import EdgeList
from geomtorsion.loops.network import Network
from tests.rounding import ROUNDED


@pytest.fixture(scope="module")
def sphere() -> Connection:
    theta, phi = sp.symbols("theta phi", real=True)
    return levi_civita(Frame([theta, phi], [[1, 0], [0, sp.sin(theta)]]))


@pytest.fixture(scope="module")
def screw() -> Connection:
    return cartan(parallel_screws([(0, 0)], [1]))


@pytest.mark.parametrize("gap", [1e-3, 1e-6])
@pytest.mark.parametrize("side", [1, -1])
def test_near_miss_of_a_line(screw, gap, side):
    """A unit circle passes the line at a small distance, inside or outside."""
    loop = Loop.circle([1 - side * gap, 0, 0], 1)
    turn = develop(screw, loop)
    expected = 1.0 if side > 0 else 0.0
    assert abs(turn.burgers[2] - expected) <= max(turn.error, 1e-9)
    assert turn.error < 1e-6
    assert [one.turns for one in turn.enclosed] == ([1] if side > 0 else [])


def test_polygon_side_beside_a_line(screw):
    """A straight side 1e-6 from the line."""
    square = [[-1, -1e-6, 0], [1, -1e-6, 0], [1, 1, 0], [-1, 1, 0]]
    turn = develop(screw, Loop.polygon(square))
    assert abs(turn.burgers[2] - 1) <= turn.error + 1e-12
    assert turn.error < 1e-6


@pytest.mark.parametrize("waves", [30, 200, pytest.param(1000, marks=pytest.mark.slow)])
def test_wild_curve_on_the_sphere_turns_by_its_area(sphere, waves):
    """A circle with many wiggles: the angle is still the exact area."""
    s = sp.Symbol("s", real=True)
    radius = sp.Rational(1, 5) * (1 + sp.cos(waves * s) / 10)
    curve = Loop.parametric(
        [radius * sp.cos(s), radius * sp.sin(s)], s, (0, 2 * sp.pi), centre=[1.0, 0.5]
    )
    turn = develop(sphere, curve, 1e-11)
    t = 2 * np.pi * np.arange(200_000) / 200_000
    r = 0.2 * (1 + np.cos(waves * t) / 10)
    slope = -0.02 * waves * np.sin(waves * t) * np.sin(t) + r * np.cos(t)
    area = -(np.cos(1 + r * np.cos(t)) * slope).mean() * 2 * np.pi
    assert abs(turn.angle - area) < 1e-12
    assert abs(turn.angle - area) < max(turn.turn_error, 1e-15)


def test_gimbal_lock_nearby():
    """SO(3), 1e-6 from beta = 0: the Levi-Civita angle of a small circle is curvature by area."""
    frame = spaces.load("so3").frame
    radius = 1e-8
    turn = develop(levi_civita(frame), Loop.circle([0.3, 1e-6, 0.2], radius, (0, 1)))
    # Riemann in the frame is 1/4 (d_mk d_nl - ...), the area element of alpha, beta is sin(beta).
    exact = np.pi * radius**2 / 4
    assert abs(turn.angle / exact - 1) < 1e-3
    assert turn.turn_error < 1e-6 * turn.angle


def test_self_intersecting_loops(sphere):
    """Both halves of a figure of eight count with their sign; two turns count twice."""
    eight = Loop.parametric(
        ["3/10*sin(2*s)", "3/10*sin(s)"], "s", (0, "2*pi"), centre=[sp.pi / 2, 0]
    )
    turn = develop(sphere, eight)
    assert abs(turn.angle) < ROUNDED
    assert np.abs(turn.burgers).max() > 1e-4
    once = develop(sphere, Loop.circle([1.0, 0.3], 0.2))
    twice = develop(sphere, Loop.circle([1.0, 0.3], 0.2).times(2))
    assert abs(twice.angle - 2 * once.angle) < ROUNDED


@pytest.mark.parametrize("radius", [1e-150, 1e-9, 1e6, 1e75])
def test_extreme_sizes_about_a_disclination(radius):
    """The wedge is the same at every size; the chord scales."""
    cone = levi_civita(dispiration("4/5", 0))
    turn = develop(cone, Loop.circle([0, 0, 0], radius))
    assert abs(turn.angle - 2 * np.pi / 5) < 1e-12
    chord = 2 * radius * np.sin(np.pi / 5)
    assert abs(np.hypot(*(turn.burgers[:2] / radius)) * radius / chord - 1) < 1e-12


def test_edges_beside_and_through_a_line(screw):
    """An edge 1e-6 from the line converges; one through the line is an error that names it."""
    pairs = np.array([[0, 1], [1, 2], [2, 0]])
    beside = np.array([[-1, -1e-6, 0], [1, -1e-6, 0], [0, 1, 0.0]])
    net = Network(screw.frame, EdgeList(beside, pairs))
    assert abs(net.burgers([0, 1, 2]).vector[2] - 1) < 1e-9
    through = np.array([[-1, 0, 0], [0.7, 0, 0], [0, 1, 0.0]])
    with pytest.raises(SingularPointError, match="edge 0 passes through the singular line"):
        _ = Network(screw.frame, EdgeList(through, pairs)).integrals


def test_horizon_is_an_error_and_no_nan():
    """A loop that crosses r = 2M in Schwarzschild coordinates has no development there."""
    bar = levi_civita(spaces.load("schwarzschild").frame)
    loop = Loop.plaquette([0.0, 1.5, 1.2, 0.3], (1.0, 1.0), (1, 2))
    with pytest.raises((LoopError, SingularPointError)):
        develop(bar, loop, parameters={"M": 1.0})
