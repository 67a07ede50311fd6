"""Kept: elements that are not multiplied out have the same values as those that are."""

import copy
import pickle

import mpmath
import pytest
import sympy as sp

from geomtorsion.errors import LimitError
from geomtorsion.exact import Field
from tests.rounding import ROUNDED

x, y = sp.symbols("x y")
LONG = sp.Add(*[(i + 2 * j + 1) * x**i * sp.sin(y) ** j for i in range(20) for j in range(20)])
OTHER = sp.Add(1, *[(i - j) * x**i * sp.exp(y) ** j for i in range(20) for j in range(20)])


@pytest.fixture
def field() -> Field:
    """A field of two symbols."""
    return Field([x, y])


def test_long_products_are_kept_and_short_ones_are_not(field):
    """A long product is not multiplied out until that is necessary; a short one is."""
    a, b = field.read(LONG), field.read(OTHER)
    assert (a * b).is_kept
    assert not (a * 2).is_kept
    assert not (field.read(x + y) * field.read(x - y)).is_kept


def test_values_and_derivatives_agree_with_the_product(field):
    """A kept quotient agrees with mpmath to 50 digits, and its derivative to 25."""
    a, b = field.read(LONG), field.read(OTHER)
    value = (a * b + a) / (b * b + 1)
    assert value.is_kept
    point = {x: sp.Rational(7, 5), y: sp.Rational(2, 7)}
    with mpmath.workdps(70):
        one, two = (sp.lambdify((x, y), e, "mpmath") for e in (LONG, OTHER))

        def exact(s, t):
            return (one(s, t) * two(s, t) + one(s, t)) / (two(s, t) ** 2 + 1)

        place = (mpmath.mpf(7) / 5, mpmath.mpf(2) / 7)
        assert abs(value.evaluate(point, 200) - exact(*place)) < mpmath.mpf(10) ** -50
        slope = mpmath.diff(exact, place, (0, 1))
        assert abs(value.diff(y).evaluate(point, 200) / slope - 1) < mpmath.mpf(10) ** -25


def test_equality_and_zero(field):
    """A kept product equals the same product in another order; a difference of 1e-30 counts."""
    a, b = field.read(LONG), field.read(OTHER)
    assert a * b == b * a
    assert (a * b - b * a).is_zero is True
    assert (a * b - b * a + field.read(sp.Rational(1, 10**30))).is_zero is False
    assert (a + b) * (a - b) == a * a - b * b
    assert ((a * b) / (b * a)).sympy == 1


def test_a_kept_zero_is_written_as_zero(field):
    """A difference of two long products that vanishes is written as 0."""
    a, b = field.read(LONG), field.read(OTHER)
    assert (a * b * a * b - b * b * a * a).sympy == 0


def test_division_by_a_kept_zero(field):
    """Division by a kept zero raises ZeroDivisionError."""
    a, b = field.read(LONG), field.read(OTHER)
    with pytest.raises(ZeroDivisionError):
        _ = 1 / (a * b - b * a)


def test_earlier_queries_change_no_text(field):
    """The text of an element is the same after one of its parts was multiplied out."""
    a, b = field.read(LONG), field.read(OTHER)
    first = str((a * b + b) / (a + b * b))
    other = Field([x, y])
    c, d = other.read(LONG), other.read(OTHER)
    part = c * d + d
    assert other.lift(part) is not None
    assert str(part / (c + d * d)) == first


def test_copies(field):
    """A deep copy is the same element; an unpickled element has the same value."""
    powers = range(20)
    terms = [(i, j, x**i * y**j) for i in powers for j in powers]
    a = field.read(sp.Add(*[(i + j + 1) * term for i, j, term in terms]))
    product = a * field.read(sp.Add(*[(2 * i + j + 1) * term for i, j, term in terms]))
    assert product.is_kept
    assert copy.deepcopy(product) is product
    again = pickle.loads(pickle.dumps(product))
    point = {x: 1.25, y: 0.5}
    assert abs(again.evaluate(point) / product.evaluate(point) - 1) < ROUNDED


def test_too_long_polynomials_are_refused_with_a_remedy(field):
    """The root of a long product is refused, and the message states a remedy."""
    powers = range(70)
    a = field.read(sp.Add(*[(i + j + 1) * x**i * y**j for i in powers for j in powers]))
    b = field.read(sp.Add(*[(i + j + 1) * x**i * sp.exp(y * j) for i in powers for j in powers]))
    with pytest.raises(LimitError, match="by an unknown function"):
        (a * b * a).sqrt()


def test_read_as_written():
    """An entry that is shorter than each rewritten form is written as entered."""
    z, m, n, c = sp.symbols("z m n c")
    potential = 1 + m / sp.sqrt(x**2 + y**2 + z**2) + n / sp.sqrt(x**2 + y**2 + (z - c) ** 2)
    element = Field([x, y, z, m, n, c]).read(1 / potential**2)
    assert element.sympy == 1 / potential**2


def test_products_in_pieces(field):
    """A product of more than a million pairs of terms equals the product term by term."""
    powers = range(32)
    a, b = (
        field.read(sp.Add(*[(i + m * j + 1) * x**i * y**j for i in powers for j in powers]))
        for m in (1, 2)
    )
    whole = field.lift(a * b)
    assert len(field.lift(a)) * len(field.lift(b)) > 10**6
    assert whole == field.lift(a) * field.lift(b)


@pytest.mark.parametrize("shared", [True, False])
def test_a_denominator_that_terms_share_counts_once(shared):
    """A sum over one long denominator is read; one over as many different ones is refused."""
    z = sp.Symbol("z")
    field, base = Field([x, y, z]), (x + y + z + 1) ** 6 + sp.sin(y) + sp.exp(x)
    apart = {k: 0 if shared else k for k in range(1, 6)}
    terms = [(x + k * y + z**k) ** 5 / (base + d * x) ** 3 / (x**k + k) for k, d in apart.items()]
    total = sp.Add(*terms, evaluate=False)
    if not shared:
        with pytest.raises(LimitError, match="terms over a common denominator"):
            field.read(total)
    else:
        parts = [field.read(term * base**3) for term in terms]
        assert (field.read(total) * field.read(base**3) - sum(parts, field.zero)).is_zero
