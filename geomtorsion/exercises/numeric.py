"""Numeric: values of expressions at points, in floats for all points or in many digits at one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import mpmath
import numpy as np
import sympy

from geomtorsion.errors import ExpressionError
from geomtorsion.precision import working_digits

# A complex array or a number of mpmath: one code computes with both.
Number = Any
Arrays = Mapping[sympy.Symbol, np.ndarray]
# Enough for answers in which a hundred digits cancel.
DIGITS = 200
# Binary exponents beyond these are not followed: exp(exp(exp(9))) would take minutes.
LARGEST_EXPONENT = 4000
# Name in sympy -> name in NumPy; mpmath calls them as sympy does.
_NUMPY = {
    "sin": "sin", "cos": "cos", "tan": "tan", "sinh": "sinh", "cosh": "cosh", "tanh": "tanh",
    "exp": "exp", "log": "log", "asin": "arcsin", "acos": "arccos", "atan": "arctan",
    "asinh": "arcsinh", "acosh": "arccosh", "atanh": "arctanh", "atan2": "arctan2",
    "Abs": "absolute",
}  # fmt: skip
INVERSE = {"cot": "tan", "sec": "cos", "csc": "sin", "coth": "tanh", "sech": "cosh",
            "csch": "sinh"}  # fmt: skip
_TURNED = {"acot": "atan"}


def at_points(expr: sympy.Expr, points: Arrays) -> np.ndarray:
    """Values at many points at once, complex array; nan or infinite where there is none.

    Examples
    --------
    >>> import numpy as np
    >>> x = sympy.Symbol("x")
    >>> at_points(sympy.sqrt(x), {x: np.array([4.0, -1.0])}).tolist()
    [(2+0j), 1j]
    """
    return at_points_with_size(expr, points)[0]


def at_points_with_size(expr: sympy.Expr, points: Arrays) -> tuple[np.ndarray, np.ndarray]:
    """Values at many points, and the largest number that occurred on the way to each.

    A value far below that size has lost digits by cancellation.
    """
    shape = next(iter(points.values())).shape if points else (1,)
    values = {symbol: array.astype(complex) for symbol, array in points.items()}
    table = _Arrays(np.zeros(shape))
    with np.errstate(all="ignore"):
        found = _value(expr, values, table, {})
    return np.broadcast_to(np.asarray(found, dtype=complex), shape), table.largest


def at_point(
    expr: sympy.Expr, point: Mapping[sympy.Symbol, sympy.Rational], digits: int = DIGITS
) -> mpmath.mpc | None:
    """Value at one point to many digits, None where there is none or it is beyond all size.

    Examples
    --------
    >>> x = sympy.Symbol("x")
    >>> mpmath.nstr(at_point(sympy.exp(x) - 1, {x: sympy.Rational(1, 2)}), 20)
    '(0.64872127070012814685 + 0.0j)'
    """
    with working_digits(digits):
        values = {
            symbol: mpmath.mpc(mpmath.mpf(int(x.p)) / int(x.q)) for symbol, x in point.items()
        }
        try:
            found = _value(expr, values, _Digits(), {})
        except (ArithmeticError, ValueError):
            return None
        return found if mpmath.isfinite(found) else None


class _Arrays:
    """Arithmetic of complex arrays that notes the largest size."""

    def __init__(self, largest: np.ndarray) -> None:
        self.largest = largest

    def number(self, expr: sympy.Expr) -> Number:
        return complex(int(expr.p) / int(expr.q)) if expr.is_Rational else complex(expr)

    def power(self, base: Number, exponent: Number) -> Number:
        return np.sqrt(base) if np.ndim(exponent) == 0 and exponent == 0.5 else base**exponent

    def call(self, name: str, arguments: list[Number]) -> Number:
        if name == "atan2":
            return np.arctan2(arguments[0].real, arguments[1].real)
        return getattr(np, _NUMPY[name])(*arguments)

    def checked(self, value: Number) -> Number:
        self.largest = np.fmax(self.largest, np.abs(value))
        return value


class _Digits:
    """Arithmetic of mpmath numbers, with an end to their size."""

    def number(self, expr: sympy.Expr) -> Number:
        if expr.is_Rational:
            return mpmath.mpc(mpmath.mpf(int(expr.p)) / int(expr.q))
        return mpmath.mpc(expr._to_mpmath(mpmath.mp.prec))

    def power(self, base: Number, exponent: Number) -> Number:
        self._check_argument(exponent)
        real = mpmath.re(exponent)
        whole = not mpmath.im(exponent) and real == int(real)
        return base ** int(real) if whole else mpmath.power(base, exponent)

    def call(self, name: str, arguments: list[Number]) -> Number:
        for argument in () if name in ("log", "Abs") else arguments:
            self._check_argument(argument)
        if name == "atan2":
            return mpmath.mpc(mpmath.atan2(arguments[0].real, arguments[1].real))
        return mpmath.mpc(getattr(mpmath, "fabs" if name == "Abs" else name)(*arguments))

    def _check_argument(self, value: Number) -> None:
        # A periodic function of a larger argument has no digit that can be trusted.
        if value and mpmath.mag(value) > DIGITS:
            raise OverflowError("an argument beyond all size")

    def checked(self, value: Number) -> Number:
        if value and mpmath.mag(value) > LARGEST_EXPONENT:
            raise OverflowError("beyond all size")
        return value


def _value(
    expr: sympy.Expr,
    values: Mapping[sympy.Symbol, Number],
    table: _Arrays | _Digits,
    known: dict[sympy.Expr, Number],
) -> Number:
    """The value of an expression; equal parts are computed once."""
    # Answers repeat their parts; without this, nested ones take a time that doubles with depth.
    if expr in known:
        return known[expr]
    if expr.is_Symbol:
        found = values[expr]
    elif not expr.args:
        found = table.number(expr)
    else:
        parts = [_value(argument, values, table, known) for argument in expr.args]
        found = _combined(expr, parts, table)
    known[expr] = table.checked(found)
    return known[expr]


def _combined(expr: sympy.Expr, parts: list[Number], table: _Arrays | _Digits) -> Number:
    """The value of a sum, product, power or function from those of its parts."""
    if expr.is_Add:
        return sum(parts[1:], parts[0])
    if expr.is_Mul:
        product = parts[0]
        for part in parts[1:]:
            product = product * part
        return product
    if expr.is_Pow:
        return table.power(*parts)
    name = type(expr).__name__
    if name in INVERSE:
        return 1 / table.call(INVERSE[name], parts)
    if name in _TURNED:
        return table.call(_TURNED[name], [1 / parts[0]])
    if name not in _NUMPY:
        raise ExpressionError(f"{name} occurs in {str(expr)[:60]}; write it by smooth functions.")
    if name == "log" and len(parts) == 2:
        return table.call("log", parts[:1]) / table.call("log", parts[1:])
    return table.call(name, parts)
