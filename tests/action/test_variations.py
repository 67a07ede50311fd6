"""Variations: (15) on so3 and the corrected (23) on r3xso3 follow from the same code."""

from itertools import product

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import spaces
from geomtorsion.errors import ShapeError, UnknownNameError

U, D, DOT = (
    sp.symbols("u1:7"),
    sp.symbols("dPhi1:7"),
    sp.symbols([f"dPhi{k}dot" for k in range(1, 7)]),
)


def cross(one, two):
    """Cross product of two triples."""
    return list(sp.Matrix(one).cross(sp.Matrix(two)))


def same(found, expected):
    """Whether all differences expand to zero."""
    pairs = zip(found, expected, strict=True)
    return all(sp.expand(one - two) == 0 for one, two in pairs)


def test_equation_15_on_so3():
    """delta-bar Phi'^i = d/dt dPhi^i + eps^i_jk Phi'^j dPhi^k."""
    found = gt.variation(spaces.load("so3").frame)
    assert same(found.changes, [d + c for d, c in zip(DOT, cross(U[:3], D[:3]), strict=False)])
    assert found.proved is True


def test_corrected_equation_23_on_r3xso3():
    """delta-bar X'^i = d/dt dX^i + eps^i_jk (Phi'^j dX^k - dPhi^j X'^k); not the sign in print."""
    found = gt.variation(spaces.load("r3xso3").frame)
    one, two = cross(U[:3], D[3:]), cross(D[:3], U[3:])
    right = [d + a - b for d, a, b in zip(DOT[3:], one, two, strict=True)]
    printed = [d + b - a for d, a, b in zip(DOT[3:], one, two, strict=True)]
    assert same(found.changes[3:], right)
    assert not same(found.changes[3:], printed)
    assert found.proved is True


@pytest.mark.parametrize("name", ["so3", "so3_zxz", "r3xso3", "s2", "flat_polar", "sl2r", "kerr"])
def test_variations_are_proved_by_the_chain_rule(name):
    """Closed in coordinates and closed in the image are variations of a path; naive is not."""
    frame = spaces.load(name).frame
    assert gt.variation(frame).proved is True
    assert gt.variation(frame, "closed_in_image").proved is True
    assert gt.variation(frame, "naive").proved is False


def test_naive_variation_is_right_in_a_coordinate_frame():
    """If the forms are integrable, naive and closed variation are equal."""
    x, y = sp.symbols("x y")
    frame = gt.Frame([x, y], [[1, 2 * x * y], [0, 1 + y**2]])
    bent = gt.Frame([x, y], [[1, 2 * x], [0, 1]])
    closed = gt.Frame([x, y], [[2 * x, 1], [y, x]])
    assert gt.variation(frame, "naive").proved is False
    assert gt.variation(bent, "naive").proved is False
    assert gt.variation(closed, "naive").proved is True
    assert same(gt.variation(closed).changes, gt.variation(closed, "naive").changes)


def test_coefficients_are_the_torsion():
    """A_kj^i = 2 S_kj^i, by derivatives of the coframe computed here."""
    frame = spaces.load("so3_zxz").frame
    n, q = range(3), frame.coordinates
    e, legs = frame.coframe.to_sympy(), frame.legs.to_sympy()
    found = gt.variation(frame).coefficients
    for k, j, i in product(n, n, n):
        curl = sum(
            legs[a, k] * legs[b, j] * (sp.diff(e[i, b], q[a]) - sp.diff(e[i, a], q[b]))
            for a in n
            for b in n
        )
        assert sp.simplify(found[k, j, i] - curl) == 0


def test_gap_is_the_burgers_vector_of_the_varied_strip():
    """closed_in_image: b'^i = - C_kj^i u^j (dPhi^k + b^k); the coordinates move by E (dPhi + b)."""
    found = gt.variation(spaces.load("so3").frame, "closed_in_image")
    moved = [d + b for d, b in zip(D, found.gaps, strict=False)]
    assert same(found.gap_rates, [-x for x in cross(U[:3], moved)])
    assert gt.variation(spaces.load("so3").frame).gap_rates == (0, 0, 0)


def test_image_with_another_connection():
    """Without torsion, closed in the image is closed in coordinates; a blend is between them."""
    frame = spaces.load("so3").frame
    half = gt.blend(gt.cartan(frame), gt.levi_civita(frame), sp.Rational(1, 2))
    bar = gt.levi_civita(frame)
    assert gt.variation(frame, "closed_in_image", bar).changes == gt.variation(frame).changes
    between = gt.variation(frame, "closed_in_image", half)
    middle = [d + c / 2 for d, c in zip(DOT, cross(U[:3], D[:3]), strict=False)]
    assert same(between.changes, middle)
    assert between.proved is True


def test_text_and_latex():
    """Lines name velocities and images; LaTeX has one row for each."""
    found = gt.variation(spaces.load("so3").frame)
    assert str(found).splitlines()[0] == "delta u1 = dPhi1' - dPhi2*u3 + dPhi3*u2"
    assert found.latex.count(r"\bar\delta") == 3
    assert "closed_in_coordinates on so3" in repr(found)
    assert gt.variation(spaces.load("so3").frame, "naive").text.splitlines()[0].endswith("dPhi1'")
    assert found._repr_latex_().startswith("$$")


def test_bad_requests():
    """An unknown principle is refused with the nearest name; another frame is refused."""
    frame = spaces.load("so3").frame
    with pytest.raises(UnknownNameError, match="Did you mean closed_in_image"):
        gt.variation(frame, "closed_in_imge")
    with pytest.raises(ShapeError, match="another frame"):
        gt.variation(frame, "closed_in_image", gt.cartan(spaces.load("s2").frame))
