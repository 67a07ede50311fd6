"""Absolute values: read with the sign that the argument has in the domain, stated as a branch."""

from __future__ import annotations

import pickle
from typing import Any

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import ChartEdgeError, ExpressionError
from geomtorsion.exact import Field

x, y, theta = sp.symbols("x y theta", real=True)
f = sp.Function("f", real=True)


def line(entry: object, **options: Any) -> gt.Frame:
    """A plane whose second form is entry dy."""
    return gt.Frame([x, y], [[1, 0], [0, entry]], **options)


@pytest.mark.parametrize("entry", [sp.Abs(x), sp.sqrt(x**2), "abs(x)", "Abs(x)", "sqrt(x**2)"])
@pytest.mark.parametrize(("domain", "sign"), [(["x > 0"], 1), (["x < 0"], -1), (["x <= -3"], -1)])
def test_an_absolute_value_has_the_sign_of_the_domain(entry, domain, sign):
    """|x| is x or -x; the branch states where."""
    frame = line(entry, domain=domain)
    assert frame.coframe[1, 1] == sign * x
    (branch,) = frame.branches
    assert (branch.read_as, branch.condition) == (sign * x, f"{sign * x} >= 0")


@pytest.mark.parametrize("entry", ["abs(sin(theta))", "sqrt(sin(theta)^2)", "abs(-sin(theta))"])
def test_a_sign_that_follows_from_the_domain(entry):
    """The sphere with |sin(theta)|, in its own domain."""
    sphere = gt.Frame([theta, y], [[1, 0], [0, entry]], domain="theta > 0, theta < pi")
    assert sphere.coframe[1, 1] == sp.sin(theta)
    assert gt.levi_civita(sphere).curvature.scalar == 2
    below = gt.Frame([theta, y], [[1, 0], [0, entry]], domain="theta > pi, theta < 2*pi")
    assert below.coframe[1, 1] == -sp.sin(theta)


def test_declared_signs_leave_no_choice():
    """A positive symbol, a sum of squares, a number: no branch is stated."""
    r, n = sp.Symbol("r", positive=True), sp.Symbol("n", negative=True)
    for entry in (sp.Abs(r), sp.Abs(n), sp.Abs(1 + x**2), sp.Abs(sp.cosh(x)), sp.Abs(-3)):
        assert line(entry, parameters=[r, n]).branches == ()


@pytest.mark.parametrize(
    ("entry", "domain"),
    [
        ("abs(x)", ["x > -1"]),
        ("1 + abs(x)", ["x > -1", "x < 1"]),
        ("abs(sin(x))", ["x > 0", "x < 4"]),
        ("abs(x*y)", ["x > 0"]),
        ("exp(abs(x - y))", ["x > 0", "y > 0"]),
    ],
)
def test_both_signs_in_the_domain_are_refused(entry, domain):
    """The message names the argument and asks for one side."""
    with pytest.raises(ExpressionError, match="expected an argument of one sign .* both. Declare"):
        line(entry, domain=domain)


def test_the_absolute_value_of_a_complex_number_is_refused():
    """|x + I y| does not belong to a differential field; its square does."""
    with pytest.raises(ExpressionError, match="expected a real argument"):
        line(sp.Abs(1 + sp.I * sp.cos(x + sp.I), evaluate=False), complex=True)
    assert line(sp.Abs(x), complex=True, domain=[x < 0]).coframe[1, 1] == -x


def test_a_motion_ends_where_the_sign_changes():
    """Beyond zero the frame is not the written one."""
    frame = line("1 + abs(x)")
    with pytest.raises(ChartEdgeError, match=r"Abs\(x\) read as x: right where x >= 0"):
        gt.solve(gt.geodesic(frame, [1, 0], [-1, 0]), 2.0)


def test_a_chosen_sign():
    """The user's choice has priority, and is checked."""
    root = sp.sqrt(x**2)
    frame = line(root, branches={root: -x})
    assert (frame.coframe[1, 1], frame.branches) == (-x, ())
    with pytest.raises(ExpressionError, match="power 2 is not"):
        line(root, branches={root: 2 * x})
    assert frame.subs({}).coframe[1, 1] == -x


def test_copies_have_the_same_sign():
    """A pickled field refuses what the field refuses."""
    frame = line("abs(x)", domain=["x < 0"])
    assert pickle.loads(pickle.dumps(frame)).coframe[1, 1] == -x
    field = line("x + 2", domain=["x > -1"]).field
    with pytest.raises(ExpressionError, match="which has both"):
        field.read(sp.Abs(x))
    assert Field([x]).read(sp.Abs(x - 9)).sympy == 9 - x


def test_values_that_become_absolute_values():
    """sqrt(f) with a square for f, whose root has one sign in the domain; another chart."""
    with_function = line(sp.sqrt(f(x)), domain=[x > 3])
    frame = with_function.subs({f(x): (1 - x) ** 2})
    assert frame.coframe[1, 1] == x - 1
    moved = line(sp.sqrt(x**2 * y**2), domain=[x > 0, y > 0])
    turned = moved.in_coordinates([x, y], [-x, y])
    assert turned.metric[1, 1] == x**2 * y**2


def test_the_root_of_an_invariant():
    """sqrt(R_abcd R^abcd) of Schwarzschild's metric is 4 sqrt(3) M / r^3."""
    hole = gt.spaces.load("schwarzschild").frame
    r, M = (hole.field.symbols[k] for k in (1, 4))
    equations = gt.gravity.equations(gt.levi_civita(hole), "sqrt(R1)")
    assert equations.E[0, 0] == 2 * sp.sqrt(3) * (2 * M - r) / r**3
