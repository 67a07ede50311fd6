"""Evaluate: numbers of exact expressions, however much cancels."""

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
    """Numbers of 6,500 digits leave a value on which two precisions agree; of longer ones none is
    told, and no zero.
    """
    element = Field([x]).read((sp.sqrt(x**2 + 1) - x) * x)
    place = {x: sp.Integer(10) ** power}
    if known:
        assert element.evaluate(place) == 0.5
    else:
        with pytest.raises(SingularPointError, match="drowns in cancellation"):
            element.evaluate(place)


def test_what_vanishes_is_zero_at_large_numbers_too() -> None:
    """With as many bits as the numbers have, and more, nothing is left."""
    large = sp.Integer(10) ** 1000
    element = Field([x]).read((sp.sqrt(x**2 + 1) - x) * x * (x - large))
    assert element.evaluate({x: large}) == 0.0
    assert element.evaluate({x: large + 2}) == 1.0


@pytest.mark.parametrize("bits", [1, 300])
def test_bits_at_the_beginning_decide_nothing(bits: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same value, to the last bit, and the same zero."""
    element = Field([x, y]).read((sp.sqrt(x**2 + 1) - x) * sp.exp(y) / 7)
    place = {x: sp.Integer(10) ** 20, y: sp.Rational(1, 3)}
    before = element.evaluate(place), element.evaluate(place, precision=90)
    monkeypatch.setattr(evaluate, "_GUARD", bits)
    assert (element.evaluate(place), element.evaluate(place, precision=90)) == before
