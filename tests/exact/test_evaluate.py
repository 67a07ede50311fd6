"""Evaluate: numeric values of exact expressions, also after strong cancellation."""

from __future__ import annotations

import pytest
import sympy as sp

from geomtorsion.errors import SingularPointError
from geomtorsion.exact import Field, evaluate

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


@pytest.mark.parametrize("bits", [1, 300])
def test_bits_at_the_beginning_decide_nothing(bits: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The number of guard bits at the start does not change a single bit of the value."""
    element = Field([x, y]).read((sp.sqrt(x**2 + 1) - x) * sp.exp(y) / 7)
    place = {x: sp.Integer(10) ** 20, y: sp.Rational(1, 3)}
    before = element.evaluate(place), element.evaluate(place, precision=90)
    monkeypatch.setattr(evaluate, "_GUARD", bits)
    assert (element.evaluate(place), element.evaluate(place, precision=90)) == before
