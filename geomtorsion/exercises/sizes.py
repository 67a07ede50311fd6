"""Sizes: constants of an answer, estimated in floats before anything exact is made of them.

An exact cosh(cosh(300000)) is a number with more digits than any memory has room for, and even to
ask for its sign takes for ever.
"""

from __future__ import annotations

import cmath
import contextlib
import math
from collections.abc import Callable, Collection, Mapping
from typing import Any

from geomtorsion.errors import LimitError
from geomtorsion.exact.syntax import Node, parse
from geomtorsion.exact.tokens import Limits, Source

LARGEST_ARGUMENT = 1e4
LARGEST_POWER = 100
_CONSTANTS: Mapping[str, complex] = {"pi": math.pi, "π": math.pi, "E": math.e, "I": 1j}
# Functions that shrink what they are given: any argument will do.
_TAME = ("sqrt", "cbrt", "log", "ln")
_INVERSE = {"cot": "tan", "sec": "cos", "csc": "sin", "coth": "tanh", "sech": "cosh",
            "csch": "sinh"}  # fmt: skip
_ENDLESS = complex(math.inf)


def check_constants(text: str, symbols: Collection[str], where: str, limits: Limits) -> None:
    """Refuse functions and powers of constants beyond all use.

    Raises
    ------
    LimitError
        A function of a constant above LARGEST_ARGUMENT, or a constant to a power that is no whole
        number, above LARGEST_POWER.
    ExpressionError
        The text is no expression.

    Examples
    --------
    >>> check_constants("sin(100*pi) + x^2", ["x"], "answer", Limits())
    >>> check_constants("sec(cosh(9^9))", ["x"], "answer", Limits())
    Traceback (most recent call last):
    geomtorsion.errors.LimitError: answer: cosh of a number above 10,000. Write it shorter.
    """
    with contextlib.suppress(RecursionError, MemoryError):
        # What is too deep is refused by the parser proper, which says so.
        _Estimate(symbols, where).of(parse(Source(text, where), symbols, limits))


class _Estimate:
    """Values of constant parts as floats; None for what contains a symbol or has no value."""

    def __init__(self, symbols: Collection[str], where: str) -> None:
        self.symbols, self.where = symbols, where

    def of(self, node: Node) -> complex | None:
        """The value of a part, after a look at all that is inside."""
        if node.kind == "number":
            return _float(int(node.text))
        if node.kind == "name":
            return None if node.text in self.symbols else _CONSTANTS.get(node.text)
        values = [self.of(part) for part in node.parts]
        if node.kind == "call":
            return self.called(node.text, values)
        if node.kind == "power":
            return self.power(*values)
        return self.joined(node, values)

    def joined(self, node: Node, values: list[complex | None]) -> complex | None:
        """Sum or product of parts."""
        total: complex = 0 if node.kind == "sum" else 1
        for value, sign in zip(values, node.signs, strict=True):
            if value is None or (node.kind == "product" and sign < 0 and not value):
                return None
            if node.kind == "sum":
                total += sign * value
            else:
                total = total * value if sign > 0 else total / value
        return total

    def power(self, base: complex | None, exponent: complex | None) -> complex | None:
        """A power; what grows beyond floats counts as endless."""
        if exponent is not None:
            whole = not exponent.imag and exponent.real == _whole(exponent.real)
            if abs(exponent) > LARGEST_POWER and not whole:
                raise LimitError(
                    f"{self.where}: a power above {LARGEST_POWER} that is no whole number. "
                    "Write it shorter."
                )
        if base is None or exponent is None:
            return None
        return _computed(lambda: base**exponent)

    def called(self, name: str, arguments: list[complex | None]) -> complex | None:
        """A function of parts."""
        for value in arguments:
            if value is not None and name not in _TAME and not abs(value) <= LARGEST_ARGUMENT:
                raise LimitError(
                    f"{self.where}: {name[:20]} of a number above {LARGEST_ARGUMENT:,.0f}. "
                    "Write it shorter."
                )
        if len(arguments) != 1 or arguments[0] is None:
            return None
        value = arguments[0]
        plain = {"ln": "log", "cbrt": "sqrt"}.get(name, _INVERSE.get(name, name))
        function = getattr(cmath, plain, None)
        if function is None:
            return None
        found = _computed(lambda: function(value))
        if name in _INVERSE and found is not None:
            return 1 / found if found else _ENDLESS
        return found


def _float(value: object) -> complex:
    """A number as it is written."""
    try:
        return complex(value) if isinstance(value, int | float) else _ENDLESS
    except OverflowError:
        return _ENDLESS


def _whole(value: float) -> float:
    return float(round(value)) if math.isfinite(value) else math.nan


def _computed(make: Callable[[], Any]) -> complex | None:
    """A value, endless where floats end, None where there is none."""
    try:
        return complex(make())
    except OverflowError:
        return _ENDLESS
    except (ArithmeticError, ValueError):
        return None
