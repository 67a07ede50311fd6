"""Refusals of exact expressions: each call, the class of its error, and words of its message."""

from collections.abc import Callable
from typing import Any

import pytest
import sympy as sp

from geomtorsion.errors import CoordinateError, ExpressionError, MissingValueError
from geomtorsion.exact import Field, parse_expression

x, y, m = sp.symbols("x y m", positive=True)
z = sp.Symbol("z", real=True)
FIELD = Field([x, y, z, m])
# Without types, for calls that are wrong on purpose.
parse: Any = parse_expression
ZERO = sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1
ENTRIES = [("coframe[0, 0]", x), ("coframe[0, 1]", sp.sign(z)), ("coframe[1, 1]", y)]

REFUSALS = [
    (lambda: FIELD.read(x / m).evaluate({x: 3}), MissingValueError, "m"),
    (lambda: bool(FIELD.read(x)), TypeError, "is_zero"),
    *((lambda number=number: FIELD.read(number, where="coframe[0, 0]"),
       ExpressionError, r"coframe\[0, 0\].*" + rational)
      for number, rational in [
          (0.5, "1/2"), (sp.Float("0.1") * x, "1/10"), (sp.Float(0.1) * x, "1/10"), (1.25, "5/4"),
          (sp.sin(0.3 * x), "3/10"), (2.0 * x, "2"),
      ]),
    (lambda: FIELD.read(1 / ZERO, where="coframe[0, 1]"),
     (ExpressionError, ZeroDivisionError), "zero|vanish"),
    (lambda: FIELD.read_all(ENTRIES), ExpressionError, r"coframe\[0, 1\]"),
    (lambda: Field([x, y, x]), CoordinateError, "repeat"),
    (lambda: parse(0.5, {}), ExpressionError, "text, got 0.5"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "error", "words"), REFUSALS)
def test_bad_calls_are_refused(
    call: Callable[[], object], error: type[Exception], words: str
) -> None:
    """Each bad argument has an error of its own class, which names the mistake."""
    with pytest.raises(error, match=words):
        call()
