"""Dual: a number with its derivatives by all states, for Jacobians of straight-line code."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, eq=False)
class Dual:
    """A value and its slope.

    value: a float; slope: array, one derivative for each state.

    Examples
    --------
    >>> import numpy as np
    >>> x = Dual(3.0, np.array([1.0]))
    >>> (2 * x**2 + 1 / x).slope.round(6).tolist()
    [11.888889]
    """

    value: float
    slope: Any

    def __add__(self, other: Any) -> Dual:
        if isinstance(other, Dual):
            return Dual(self.value + other.value, self.slope + other.slope)
        return Dual(self.value + other, self.slope)

    __radd__ = __add__

    def __mul__(self, other: Any) -> Dual:
        if isinstance(other, Dual):
            slope = self.slope * other.value + self.value * other.slope
            return Dual(self.value * other.value, slope)
        return Dual(self.value * other, self.slope * other)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Dual:
        return self * (1 / other)

    def __rtruediv__(self, other: float) -> Dual:
        return Dual(other / self.value, -other / self.value**2 * self.slope)

    def __pow__(self, exponent: Any) -> Dual:
        if isinstance(exponent, Dual):
            return _exp(exponent * _log(self))
        slope = exponent * self.value ** (exponent - 1) * self.slope
        return Dual(self.value**exponent, slope)

    def __rpow__(self, base: float) -> Dual:
        return _exp(self * math.log(base))


def _lifted(function: Callable[[float], float], slope: Callable[[float], float]) -> Any:
    """A function of floats, on floats and on duals."""

    def lifted(x: Any) -> Any:
        if isinstance(x, Dual):
            return Dual(function(x.value), slope(x.value) * x.slope)
        return function(x)

    return lifted


def _arctan2(y: Any, x: Any) -> Any:
    """The angle of a point."""
    a, b = (v.value if isinstance(v, Dual) else v for v in (y, x))
    da, db = (v.slope if isinstance(v, Dual) else 0.0 for v in (y, x))
    if not isinstance(y, Dual) and not isinstance(x, Dual):
        return math.atan2(a, b)
    return Dual(math.atan2(a, b), (b * da - a * db) / (a * a + b * b))


_exp = _lifted(math.exp, math.exp)
_log = _lifted(math.log, lambda x: 1 / x)

DUAL_NAMES: dict[str, Any] = {
    "sin": _lifted(math.sin, math.cos),
    "cos": _lifted(math.cos, lambda x: -math.sin(x)),
    "tan": _lifted(math.tan, lambda x: 1 + math.tan(x) ** 2),
    "exp": _exp,
    "log": _log,
    "sinh": _lifted(math.sinh, math.cosh),
    "cosh": _lifted(math.cosh, math.sinh),
    "tanh": _lifted(math.tanh, lambda x: 1 - math.tanh(x) ** 2),
    "sqrt": _lifted(math.sqrt, lambda x: 0.5 / math.sqrt(x)),
    "arcsin": _lifted(math.asin, lambda x: 1 / math.sqrt(1 - x * x)),
    "arccos": _lifted(math.acos, lambda x: -1 / math.sqrt(1 - x * x)),
    "arctan": _lifted(math.atan, lambda x: 1 / (1 + x * x)),
    "arcsinh": _lifted(math.asinh, lambda x: 1 / math.sqrt(1 + x * x)),
    "arccosh": _lifted(math.acosh, lambda x: 1 / math.sqrt(x * x - 1)),
    "arctanh": _lifted(math.atanh, lambda x: 1 / (1 - x * x)),
    "arctan2": _arctan2,
}
