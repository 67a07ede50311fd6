"""Form: the written form of polynomials, and up to which length it is searched for."""

from __future__ import annotations

import pytest
import sympy as sp
from sympy import cos, sin

from geomtorsion.exact import Field
from geomtorsion.exact.form import Sum, form

x, y, z = sp.symbols("x y z", real=True)


@pytest.mark.parametrize(("power", "written"), [(20, 20), (21, 1)])
def test_how_long_a_polynomial_is_factored(power: int, written: int) -> None:
    """A power of 1,771 terms is written as a power; one of 2,024 terms stays a sum."""
    field = Field([x, y, z])
    base = whole = field.read(1 + x + 2 * y + 3 * z)
    for _ in range(power - 1):
        whole = whole * base
    short = field.brief(whole)
    assert short is not None
    ((_, exponent),) = form(short).powers
    assert exponent == written


def test_how_high_powers_of_waves_are_written() -> None:
    """cos(x)**8 stays a power, at a loss of two digits at most; cos(x)**9 gets multiple angles."""
    field = Field([x, y])
    assert field.read(cos(x) ** 8 + y).sympy == cos(x) ** 8 + y
    ninth = 126 * cos(x) + 84 * cos(3 * x) + 36 * cos(5 * x) + 9 * cos(7 * x) + cos(9 * x)
    assert sp.expand(field.read(cos(x) ** 9 + y).sympy - ninth / 256 - y) == 0


def test_how_many_waves_stay_a_sum() -> None:
    """A sum of four cosines stays a sum; a sum of five becomes a product."""
    field = Field([x])
    four = sum(cos(k * x) for k in (3, 5, 7, 9))
    assert field.read(four).sympy == four
    assert field.read(four + cos(x)).sympy.is_Mul


def test_squares_are_exchanged_in_long_sums_too() -> None:
    """A sum of 144 terms times sin(x)**2 plus 1 is written with 145 terms, without cosines."""
    field = Field([x, y, z])
    table = [y**j * z**k for j in range(12) for k in range(12)]
    long = sum((2 * k + 3) * term for k, term in enumerate(table)) * sin(x) ** 2
    ((base, _),) = form(field.read(long + 1)).powers
    assert isinstance(base, Sum)
    assert len(base.terms) == len(table) + 1
