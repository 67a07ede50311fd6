"""Roots of high order and many roots: read, derived and decided, or refused, quickly."""

from __future__ import annotations

from math import prod

import mpmath
import pytest
import sympy as sp

from geomtorsion.errors import LimitError
from geomtorsion.exact import Field
from geomtorsion.geometry import Frame, cartan, identities, levi_civita
from tests.chosen import few

x, y = sp.symbols("x y", positive=True)
R = sp.Rational

ROOTS = {
    "one of order 100": x ** R(1, 100),
    "of a sum": (1 + x) ** R(1, 50),
    "a power of one": (x * y + 1) ** R(3, 100),
    "of two orders": x ** R(1, 97) + x ** R(1, 89),
    "below the line": 1 / (x ** R(1, 97) + y ** R(1, 50) + 1),
    "of a root": (x ** R(1, 100) + 1) ** R(1, 100),
    "of two roots": (x ** R(1, 50) + y ** R(1, 50)) ** R(7, 50),
    "a product of thirty": prod(sp.sqrt(x + k) for k in range(1, 31)),
    "a product of thirty orders": prod((x + k) ** R(1, k + 2) for k in range(1, 31)),
    "a sum of nineteen": sum(sp.sqrt(x + k) for k in range(1, 20)),
    "a product of sums": prod(sp.sqrt(x + k) + sp.sqrt(y + k) for k in range(1, 9)),
    "a root of a sum of roots": sp.sqrt(sum(sp.sqrt(x + k) for k in range(1, 12))),
    "in functions": sp.exp(x ** R(1, 100)) * sp.sin(y ** R(1, 100)),
}
PLACE = {x: R(7, 5), y: R(9, 7)}


@pytest.mark.parametrize("name", ROOTS)
def test_curvature_of_a_line_element_with_roots(name):
    """dx**2 + f**2 dy**2 has Gaussian curvature -f_xx/f: its numbers agree to thirty digits."""
    f = ROOTS[name]
    curvature = levi_civita(Frame([x, y], [[1, 0], [0, f]])).curvature
    found = curvature.scalar.element().evaluate(PLACE, 120)
    with mpmath.workdps(60):
        value = sp.lambdify((x, y), f, "mpmath")
        at = [mpmath.mpf(PLACE[s].p) / PLACE[s].q for s in (x, y)]
        slope = mpmath.diff(lambda u: value(u, at[1]), at[0], 2)
        want = -2 * slope / value(*at)
        assert abs(found - want) < mpmath.mpf(10) ** -30 * (1 + abs(want))


# Fifteen roots of roots have no values together at any point that is quickly found.
DECIDED = sorted(set(ROOTS) - {"a product of thirty orders"})


@pytest.mark.parametrize("name", DECIDED)
def test_identities_of_a_frame_with_roots(name):
    """Metricity and the Bianchi identities are decided."""
    frame = Frame([x, y], [[1, 0], [0, ROOTS[name]]])
    for check in identities(cartan(frame)):
        assert check.holds is True, check


def test_many_roots_of_roots_are_refused():
    """A decision that would take very long is refused with a remedy."""
    frame = Frame([x, y], [[1, 0], [0, ROOTS["a product of thirty orders"]]])
    with pytest.raises(LimitError, match="which is the limit. Replace a power"):
        identities(cartan(frame))


@pytest.mark.parametrize("name", DECIDED)
def test_zeros_with_roots_are_decided(name):
    """f * (1/f) is 1, the derivative of log(f) is f'/f, and f is not f + 10**-50."""
    field = Field([x, y])
    element = field.read(ROOTS[name])
    inverse = 1 / element
    assert (element * inverse - 1).is_zero is True
    slope = element.diff(x)
    assert (slope * inverse + element * inverse.diff(x)).is_zero is True
    assert (slope * inverse + element * inverse.diff(x) + 1).is_zero is False
    assert (element + R(1, 10**50).p * field.rational(1, 10**50) - element).is_zero is False


@pytest.mark.parametrize(
    "expression",
    [
        prod(sp.sqrt(x + k) + sp.sqrt(x * y + k) for k in range(1, 16)),
        prod(sp.sqrt(x + k) + sp.sqrt(y + k) for k in range(1, 31)),
    ],
)
def test_products_of_many_sums_of_roots_are_refused(expression):
    """Products of many sums of roots, which would fill the memory expanded, are refused."""
    with pytest.raises(LimitError, match="the limit.* Replace a power"):
        Frame([x, y], [[1, 0], [0, expression]])


@pytest.mark.parametrize("count", few(1, [12, 30]))
def test_squares_are_found_among_many_roots(count):
    """A root of a product of others is not a new root, whatever roots of higher order exist."""
    field = Field([x, y])
    roots = [(x + k) ** R(1, k + 2) for k in range(1, count + 1)]
    field.read(sum(roots))
    known = len(field.generators)
    assert (field.read(sp.sqrt((x + 2) * (x + 4))) ** 2 - field.read((x + 2) * (x + 4))).is_zero
    assert (field.read((x + 6) ** R(1, 4)) - field.read((x + 6) ** R(1, 8)) ** 2).is_zero is True
    assert len(field.generators) == known
    # (x + 2)**(1/8) is new: only its square was known.
    assert (field.read((x + 2) ** R(1, 8)) ** 2 - field.read((x + 2) ** R(1, 4))).is_zero is True
    assert len(field.generators) == known + 1
