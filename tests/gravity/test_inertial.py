"""Inertial: a rotated coframe with the spin connection of its flat limit."""

import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity as g

LAGRANGIAN = "T + c*T**2"


def test_a_bad_tetrad_becomes_good() -> None:
    """With it the diagonal tetrad of Schwarzschild has the equations of the Cartesian tetrad."""
    diagonal = gt.spaces.load("schwarzschild").frame
    cartesian = gt.spaces.load("schwarzschild_cartesian").frame
    assert not g.equations(gt.cartan(diagonal), LAGRANGIAN).antisymmetric.is_zero
    found = g.equations(g.inertial(diagonal, {"M": 0}), LAGRANGIAN)
    assert found.antisymmetric.is_zero
    wanted = g.equations(gt.cartan(cartesian), LAGRANGIAN)
    assert wanted.antisymmetric.is_zero
    one, two = (x.E.in_coordinates() for x in (found, wanted))
    for index in [(0, 0), (1, 1), (2, 2), (3, 3), (0, 1), (1, 2)]:
        assert (diagonal.scalar(one[index]) - two[index]).is_zero
    assert not one.is_zero


def test_a_cosmos_in_spherical_coordinates() -> None:
    """T = 6 H^2 again, with a(t) set to one in the flat limit."""
    t, r, theta, _ = q = sp.symbols("t r theta phi")
    a = sp.Function("a")(t)
    frame = gt.Frame(q, sp.diag(1, a, a * r, a * r * sp.sin(theta)), (-1, 1, 1, 1))
    found = g.equations(g.inertial(frame, {a: 1}), g.f_of("T"))
    assert found.scalar("T") == 6 * (sp.diff(a, t) / a) ** 2
    assert found.antisymmetric.is_zero
