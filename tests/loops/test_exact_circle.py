"""Exact circle: the closed forms of any loop, by exact steps only."""

import pytest
import sympy as sp

from geomtorsion.errors import LoopError, UndecidedError
from geomtorsion.loops import Loop, burgers_vector, exact_burgers_vector
from geomtorsion.loops.exact_circle import exact_circle
from geomtorsion.spaces import load

R = sp.Symbol("R", positive=True)


@pytest.mark.parametrize(
    ("space", "centre"),
    [("heisenberg", (0, 0, 0)), ("so3", (0, 1, 0)), ("s2", (1, 0)), ("flat_polar", (2, 0)),
     ("screw_core", (0, 0, 0)), ("bianchi_vii_h", (0, 0, 0)), ("bianchi_viii", (0, 0, 0))],
)  # fmt: skip
def test_as_any_loop(space, centre):
    """The vector equals the result of `exact_burgers_vector`, which checks poles by numbers."""
    frame = load(space).frame
    right = exact_burgers_vector(frame, Loop.circle(centre, R)).vector
    found = exact_circle(frame, centre, R)
    assert [sp.simplify(a - b) for a, b in zip(found, right, strict=True)] == [0] * len(right)


def test_a_line_keeps_its_vector():
    """Around a screw dislocation b does not depend on the radius (Volterra)."""
    frame = load("screw_dislocation").frame
    [b] = frame.parameters
    assert exact_circle(frame, (0, 0, 0), R) == (0, 0, b)
    assert exact_circle(frame, (0, 0, 0), sp.Rational(1, 7)) == (0, 0, b)


def test_a_denominator_may_change_if_it_has_no_zero():
    """The denominator exp(x2 + x3) is not constant on the circle; numbers give the same."""
    half = sp.Rational(1, 2)
    centre = (1, half, half)
    for plane in ((0, 1), (1, 2)):
        found = exact_circle(load("bianchi_viii").frame, centre, half, plane)
        loop = Loop.circle([float(x) for x in centre], 0.5, plane)
        right = burgers_vector(load("bianchi_viii").frame, loop)
        assert [float(x) for x in found] == pytest.approx(right.vector.tolist(), abs=1e-12)


def test_what_only_numbers_decide_is_refused():
    """Refused: a denominator that changes, a root whose sign changes, no closed form."""
    with pytest.raises(UndecidedError, match="changes along the circle"):
        exact_circle(load("screw_dislocation").frame, (2, 0, 0), R)
    with pytest.raises(UndecidedError, match="roots whose sign"):
        exact_circle(load("schwarzschild").frame, (0, 10, 1, 0), R, (1, 2))
    with pytest.raises(UndecidedError, match="no closed form"):
        exact_circle(load("frw_flat").frame, (0, 0, 0, 0), R)


@pytest.mark.parametrize(("centre", "plane"), [((0, 0), (0, 1)), ((0, 0, 0), (1, 1))])
def test_a_circle_needs_centre_and_plane(centre, plane):
    """The centre needs one entry per coordinate, and the plane two different coordinates."""
    with pytest.raises(LoopError, match="circle: expected 3 coordinates"):
        exact_circle(load("heisenberg").frame, centre, R, plane)
