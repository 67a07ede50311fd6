"""Exact circle: the closed forms of any loop, by exact steps only."""

import pytest
import sympy as sp

from geomtorsion.errors import ChartEdgeError, LoopError, UndecidedError
from geomtorsion.geometry import Frame
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
    with pytest.raises(UndecidedError, match="choices of sign"):
        exact_circle(load("schwarzschild").frame, (0, 10, 1, 0), R, (1, 2))
    with pytest.raises(UndecidedError, match="no closed form"):
        exact_circle(load("frw_flat").frame, (0, 0, 0, 0), R)


x, y = sp.symbols("x y", real=True)
b = sp.Symbol("b", positive=True)
HALF_PLANES = Frame([x, y], [[1, 0], [b * x * y, 1]], parameters=(b,), domain=[x > 0, y < b])


@pytest.mark.parametrize(
    "exact", [exact_circle, lambda f, *a: exact_burgers_vector(f, Loop.circle(*a)).vector]
)
def test_circles_of_numbers_stay_inside_the_domain(exact):
    """Numbers are checked against each edge without parameters; symbols are up to the caller."""
    half = sp.Rational(1, 2)
    for frame, centre in ((HALF_PLANES, (0, 0)), (HALF_PLANES, (half - half**9, 9)),
                          (load("flat_polar").frame, (0, 0))):  # fmt: skip
        with pytest.raises(ChartEdgeError, match="the domain is . > 0, got the point"):
            exact(frame, centre, half)
    # Outside y < b for small b, and x > 0 for R above 1.
    assert exact(HALF_PLANES, (1, 9), half)[0] == 0
    assert exact(load("flat_polar").frame, (1, 0), R) == (0, sp.pi * R**2)


@pytest.mark.parametrize(("centre", "plane"), [((0, 0), (0, 1)), ((0, 0, 0), (1, 1))])
def test_a_circle_needs_centre_and_plane(centre, plane):
    """The centre needs one entry per coordinate, and the plane two different coordinates."""
    with pytest.raises(LoopError, match="circle: expected 3 coordinates"):
        exact_circle(load("heisenberg").frame, centre, R, plane)
