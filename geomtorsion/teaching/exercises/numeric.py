"""Numeric: values of expressions at points, in floats for all points or in many digits at one."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import mpmath
import sympy

from geomtorsion.errors import ExpressionError
from geomtorsion.precision import working_digits

# A row of complex numbers or a number of mpmath: one code computes with both.
Number = Any
Columns = Mapping[sympy.Symbol, Sequence[float]]
# Enough for answers in which a hundred digits cancel.
DIGITS = 200
# Larger binary exponents are refused: exp(exp(exp(9))) would take minutes.
LARGEST_EXPONENT = 4000
# Functions that floats and mpmath have by the names of sympy.
_NAMES = frozenset(
    "sin cos tan sinh cosh tanh exp log asin acos atan asinh acosh atanh atan2 Abs".split()
)
INVERSE = {"cot": "tan", "sec": "cos", "csc": "sin", "coth": "tanh", "sech": "cosh",
            "csch": "sinh"}  # fmt: skip
_TURNED = {"acot": "atan", "acoth": "atanh", "asec": "acos", "acsc": "asin", "asech": "acosh",
           "acsch": "asinh"}  # fmt: skip


def at_points(expr: sympy.Expr, points: Columns) -> tuple[complex, ...]:
    """Values at many points at once; nan or infinite where the expression has no value.

    Examples
    --------
    >>> x = sympy.Symbol("x")
    >>> at_points(sympy.sqrt(x), {x: [4.0, -1.0]})
    ((2+0j), 1j)
    """
    return at_points_with_size(expr, points)[0]


def at_points_with_size(
    expr: sympy.Expr, points: Columns
) -> tuple[tuple[complex, ...], tuple[float, ...]]:
    """Values at many points, and the largest intermediate number at each.

    A value far below that size has lost digits by cancellation.
    """
    count = len(next(iter(points.values()))) if points else 1
    table = _Floats(count)
    values = {symbol: _Row([complex(x) for x in column]) for symbol, column in points.items()}
    found = _value(expr, values, table, {})
    return tuple(found.values), tuple(table.largest)


def at_point(
    expr: sympy.Expr, point: Mapping[sympy.Symbol, sympy.Rational], digits: int = DIGITS
) -> mpmath.mpc | None:
    """Value at one point to many digits; None if it does not exist or is too large.

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


def _each(function: Callable[..., Any], *rows: Sequence[complex]) -> list[Any]:
    """A function of the numbers of rows; nan or infinity where it has no value."""
    try:
        return list(map(function, *rows))
    except (ArithmeticError, ValueError):
        return [_one(function, *numbers) for numbers in zip(*rows, strict=True)]


def _one(function: Callable[..., Any], *numbers: complex) -> Any:
    """`_each` for single numbers: nan at a division by zero, infinity at other poles."""
    try:
        return function(*numbers)
    except ZeroDivisionError:
        return math.nan
    except (OverflowError, ValueError):
        return math.inf if all(map(cmath.isfinite, numbers)) else math.nan


class _Row:
    """Complex numbers, one a point, with the arithmetic that an expression needs."""

    __slots__ = ("values",)

    def __init__(self, values: list[complex]) -> None:
        self.values = values

    def __add__(self, other: _Row) -> _Row:
        return _Row([a + b for a, b in zip(self.values, other.values, strict=True)])

    def __mul__(self, other: _Row) -> _Row:
        return _Row([a * b for a, b in zip(self.values, other.values, strict=True)])

    def __truediv__(self, other: _Row) -> _Row:
        return _Row(_each(complex.__truediv__, self.values, other.values))

    def __rtruediv__(self, one: int) -> _Row:
        return _Row(_each(lambda x: one / x, self.values))

    def __pow__(self, other: _Row) -> _Row:
        if all(exponent == 0.5 for exponent in other.values):
            return _Row(_each(cmath.sqrt, self.values))
        return _Row(_each(pow, self.values, other.values))


class _Floats:
    """Arithmetic of rows of floats that notes the largest size at each point."""

    def __init__(self, count: int) -> None:
        self.count = count
        self.largest = [0.0] * count

    def number(self, expr: sympy.Expr) -> Number:
        found = complex(int(expr.p) / int(expr.q)) if expr.is_Rational else complex(expr)
        return _Row([found] * self.count)

    def power(self, base: Number, exponent: Number) -> Number:
        return base**exponent

    def call(self, name: str, arguments: list[Number]) -> Number:
        rows = [argument.values for argument in arguments]
        if name == "atan2":
            return _Row([complex(math.atan2(a.real, b.real)) for a, b in zip(*rows, strict=True)])
        function = abs if name == "Abs" else getattr(cmath, name)
        return _Row([complex(x) for x in _each(function, *rows)])

    def checked(self, value: Number) -> Number:
        # max(size, nan) is size: a value that is nan does not change the largest size.
        self.largest = [
            max(before, size)
            for before, size in zip(self.largest, _each(abs, value.values), strict=True)
        ]
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
        # A periodic function of a larger argument has no significant digit.
        if value and mpmath.mag(value) > DIGITS:
            raise OverflowError("an argument beyond all size")

    def checked(self, value: Number) -> Number:
        if value and mpmath.mag(value) > LARGEST_EXPONENT:
            raise OverflowError("beyond all size")
        return value


def _value(
    expr: sympy.Expr,
    values: Mapping[sympy.Symbol, Number],
    table: _Floats | _Digits,
    known: dict[sympy.Expr, Number],
) -> Number:
    """The value of an expression; equal parts are computed once."""
    # Answers repeat their parts; otherwise the time doubles with each level of nesting.
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


def _combined(expr: sympy.Expr, parts: list[Number], table: _Floats | _Digits) -> Number:
    """The value of a sum, product, power or function from the values of its parts."""
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
    if name not in _NAMES:
        raise ExpressionError(f"{name} occurs in {str(expr)[:60]}; write it by smooth functions.")
    if name == "log" and len(parts) == 2:
        return table.call("log", parts[:1]) / table.call("log", parts[1:])
    return table.call(name, parts)
