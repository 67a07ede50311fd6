"""Algebraic constants: zero tests of nested roots and of functions of fractions of pi."""

import pytest
import sympy as sp
from sympy import Rational, cbrt, cos, pi, sin, sqrt, tan

from geomtorsion.exact import Field, algebraic_constants
from tests.rounding import ROUNDED

x = sp.Symbol("x")
w, golden = cbrt(2 + sqrt(5)), (1 + sqrt(5)) / 2
inner, outer = sqrt(34 - 2 * sqrt(17)), sqrt(34 + 2 * sqrt(17))
GAUSS = sqrt(17 + 3 * sqrt(17) - inner - 2 * outer)
ZEROS = {
    "heptagon": cos(pi / 7) - cos(2 * pi / 7) + cos(3 * pi / 7) - Rational(1, 2),
    "ninths": cos(pi / 9) * cos(2 * pi / 9) * cos(4 * pi / 9) - Rational(1, 8),
    "elevenths": tan(3 * pi / 11) + 4 * sin(2 * pi / 11) - sqrt(11),
    "thirteenths": sp.prod([2 * cos(k * pi / 13) for k in range(1, 7)]) - 1,
    "Gauss": 16 * cos(2 * pi / 17) + 1 - sqrt(17) - inner - 2 * GAUSS,
    "period of seventeenths": sqrt(17) - 1 - 4 * sum(cos(2**k * pi / 17) for k in range(1, 5)),
    "29ths": sp.prod([2 * sin(k * pi / 29) for k in range(1, 15)]) - sqrt(29),
    "97ths": sum(cos(2 * k * pi / 97) for k in range(1, 49)) + Rational(1, 2),
    "Cardano": cbrt(2 + sqrt(5)) + cbrt(2 - sqrt(5)) - 1,
    "golden cube root": w - golden,
    "two cube roots": cbrt(20 + 14 * sqrt(2)) + cbrt(20 - 14 * sqrt(2)) - 4,
    "Ramanujan": sqrt(cbrt(5) - cbrt(4)) - (cbrt(2) + cbrt(20) - cbrt(25)) / 3,
    "fifth root": sp.root((11 + 5 * sqrt(5)) / 2, 5) - golden,
}  # fmt: skip
# Zeros from above with another root of the same polynomial equation: these are not zero.
NOT_ZERO = {
    "conjugate of the golden cube root": w**2 + w * golden + golden**2,
    "Gauss with a minus": 16 * cos(2 * pi / 17) + 1 - sqrt(17) - inner + 2 * GAUSS,
    "Gauss of another angle": 16 * cos(4 * pi / 17) + 1 - sqrt(17) - inner - 2 * GAUSS,
    "period of odd seventeenths": sqrt(17) + 1 + 4 * sum(cos(2**k * pi / 17) for k in range(1, 5)),
    "cube root and its square": w**2 + w,
}
TINY = Rational(1, 10**60)


def every(cases):
    return pytest.mark.parametrize(
        "value", cases.values(), ids=[k.replace(" ", "-") for k in cases]
    )


@every(ZEROS)
def test_zeros_are_found(value):
    """A zero is proved, is written as 0 (also in a product), and has no inverse."""
    field = Field([x])
    zero = field.read(value)
    assert zero.is_zero is True
    assert zero.certainty.proved
    assert zero.sympy == 0
    assert (zero * field.read(sp.sin(x))).sympy == 0
    with pytest.raises(ZeroDivisionError):
        zero.inverse()


@every({**ZEROS, **NOT_ZERO})
def test_near_zeros_are_not_zero(value):
    """Each value plus 1e-60 is not zero, and neither is x times this sum."""
    field = Field([x])
    assert field.read(value + TINY).is_zero is False
    assert field.read((value + TINY) * x).is_zero is False


@every(NOT_ZERO)
def test_other_roots_are_not_taken_for_this_one(value):
    """A number of absolute value above one is not zero, and its inverse has the right value."""
    field = Field([x])
    element = field.read(value)
    assert element.is_zero is False
    number = complex(value.evalf(30)).real
    assert abs(number) > 1
    assert element.inverse().evaluate({}) == pytest.approx(1 / number, rel=1e-12)
    assert (element * element.inverse() - 1).is_zero is True


def test_roots_of_negative_numbers_are_real():
    """The cube root of a negative number is the real root, and the field states this branch."""
    field = Field([x])
    element = field.read(cbrt(2 - sqrt(5)))
    assert element.evaluate({}) == pytest.approx(-0.6180339887498949, rel=ROUNDED)
    (branch,) = field.branches
    assert "the real root" in branch.condition


def test_in_complex_fields_the_root_is_the_principal_one():
    """In a complex field the two cube roots of Cardano do not add up to one."""
    value = cbrt(2 + sqrt(5)) + cbrt(2 - sqrt(5))
    field = Field([x], complex=True)
    assert field.read(value - 1).is_zero is False
    assert field.read(cbrt(2 - sqrt(5)) - cbrt(sqrt(5) - 2) * (1 + sp.I * sqrt(3)) / 2).is_zero


def test_where_the_degree_is_too_high_nothing_is_claimed(monkeypatch):
    """The proof of a zero needs more bits for a higher degree; a near-zero needs few bits."""
    gauss = ZEROS["Gauss"]
    monkeypatch.setattr(algebraic_constants, "LARGEST_BITS", 512)
    assert Field([x]).read(gauss).is_zero is None
    assert Field([x]).read(gauss + TINY).is_zero is False


def test_functions_beside_constants():
    """A sum vanishes if and only if the constant factor of each function vanishes."""
    field = Field([x])
    one, two = ZEROS["golden cube root"], ZEROS["heptagon"]
    assert field.read(one * sp.exp(x) + two * sp.sqrt(x + 1)).is_zero is True
    assert field.read(one * sp.exp(x) + (two + TINY) * sp.sqrt(x + 1)).is_zero is False
