"""Evaluate: numeric values of exact expressions, also after strong cancellation."""

from __future__ import annotations

import mpmath
import pytest
import sympy as sp

from geomtorsion.errors import SingularPointError
from geomtorsion.exact import Field

x, y = sp.symbols("x y", real=True)


@pytest.mark.parametrize(
    ("power", "known"), [(380, True), (1000, True), (6500, True), (6700, False)]
)
def test_how_much_may_cancel(power: int, known: bool) -> None:
    """x (sqrt(x^2 + 1) - x) is 1/2 up to x = 10^6500; its value at 10^6700 is refused."""
    element = Field([x]).read((sp.sqrt(x**2 + 1) - x) * x)
    place = {x: sp.Integer(10) ** power}
    if known:
        assert element.evaluate(place) == 0.5
    else:
        with pytest.raises(SingularPointError, match="is lost in cancellation"):
            element.evaluate(place)


def test_what_vanishes_is_zero_at_large_numbers_too() -> None:
    """At x = 10^1000 the expression is exactly zero, and at 10^1000 + 2 it is one."""
    large = sp.Integer(10) ** 1000
    element = Field([x]).read((sp.sqrt(x**2 + 1) - x) * x * (x - large))
    assert element.evaluate({x: large}) == 0.0
    assert element.evaluate({x: large + 2}) == 1.0


@pytest.mark.parametrize("precision", [20, 53, 90, 300])
def test_each_precision_rounds_the_same_number(precision: int) -> None:
    """A value of few bits is the value of many bits, rounded, where all digits cancel at first."""
    element = Field([x, y]).read((sp.sqrt(x**2 + 1) - x) * sp.exp(y) / 7)
    value = element.evaluate({x: sp.Integer(10) ** 20, y: sp.Rational(1, 3)}, precision=precision)
    with mpmath.workprec(600):
        large = mpmath.mpf(10) ** 20
        exact = (mpmath.sqrt(large**2 + 1) - large) * mpmath.exp(mpmath.mpf(1) / 3) / 7
        assert abs(value / exact - 1) <= mpmath.mpf(2) ** -precision
