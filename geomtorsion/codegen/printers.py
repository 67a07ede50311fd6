"""Printers: steps as Python source or heyoka expressions; names of functions in each.

The only module in which text becomes a function.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from fractions import Fraction
from functools import lru_cache, reduce
from importlib import import_module
from typing import Any, Literal, Protocol

import numpy as np
from mpmath.libmp import prec_to_dps

from geomtorsion.codegen.special import of_arrays, of_floats
from geomtorsion.codegen.steps import Signed, Step, is_one, uses
from geomtorsion.errors import ExpressionError
from geomtorsion.exact.special_values import VALUES
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.precision import EXACT_BITS


@dataclass(frozen=True)
class Names:
    """Names of one function; empty where it does not exist.

    math: in generated source; of the math module, but for power, sign and special functions.
    numpy: of numpy, but for special functions.
    mpmath: of mpmath.
    heyoka: of heyoka.
    roundings: to how many of them NumPy and SciPy are right.
    """

    math: str
    numpy: str
    mpmath: str
    heyoka: str = ""
    roundings: int = 4


def _plain(name: str, numpy: str = "") -> Names:
    """A function that everybody has."""
    return Names(name, numpy or name, name, name)


# By the names of sympy's classes.
FUNCTIONS = {
    **{name: _plain(name) for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log")},
    **{name: _plain(name, "arc" + name[1:]) for name in ("asin", "acos", "atan", "asinh", "acosh",
                                                         "atanh", "atan2")},
    "Abs": Names("fabs", "abs", "fabs"),
    "sign": Names("sign", "sign", "sign"),
    "floor": Names("floor", "floor", "floor"),
    "ceiling": Names("ceil", "ceil", "ceil"),
    "Max": Names("max", "maximum", "max"),
    "Min": Names("min", "minimum", "min"),
    # To more than double precision by Arb; SciPy's are right to some roundings.
    **{name: Names(name, name, name, roundings=16) for name in VALUES},
}  # fmt: skip


# Longer pieces become statements: Python's parser has a limit for brackets within brackets.
_LONGEST_PIECE = 500


class Binding(IntEnum):
    """How tightly a piece of code holds together."""

    SUM = 0
    PRODUCT = 1
    WHOLE = 2


# Statements, and the code of each output after them.
Body = tuple[tuple[str, ...], tuple[str, ...]]


def python_body(steps: Sequence[Step], outputs: Sequence[Signed]) -> Body:
    """The code of outputs over a0, a1, ..."""
    writer = _PythonWriter(steps, outputs)
    results = tuple(writer.signed(sign, place) for sign, place in outputs)
    return tuple(writer.lines), results


def python_source(arguments: int, body: Body) -> str:
    """Source of a function `values` of a0, a1, ... that returns the outputs in a tuple."""
    lines, results = body
    header = f"def values({', '.join(f'a{k}' for k in range(arguments))}):"
    ending = f"return ({', '.join(results)}{',' * bool(results)})"
    return "\n    ".join([header, *lines, ending])


class _PythonWriter:
    """Writer of steps: steps needed once are inlined, others are statements before."""

    def __init__(self, steps: Sequence[Step], outputs: Sequence[Signed]) -> None:
        self.lines: list[str] = []
        self._codes: list[tuple[str, Binding]] = []
        for step, count in zip(steps, uses(steps, outputs), strict=True):
            code, kind = self._step(step)
            if len(code) > _LONGEST_PIECE or (count > 1 and (kind != Binding.WHOLE or "(" in code)):
                code, kind = self._stored(code), Binding.WHOLE
            self._codes.append((code, kind))

    def signed(self, sign: int, place: int) -> str:
        """An output."""
        code, kind = self._codes[place]
        if sign > 0:
            return code
        return f"-({code})" if kind == Binding.SUM else f"-{code}"

    def _stored(self, code: str) -> str:
        name = f"t{len(self.lines)}"
        self.lines.append(f"{name} = {code}")
        return name

    def _bracketed(self, place: int, least: Binding) -> str:
        code, kind = self._codes[place]
        return code if kind >= least else f"({code})"

    def _step(self, step: Step) -> tuple[str, Binding]:
        kind, operands, detail = step.kind, step.operands, step.detail
        if kind == "argument":
            return f"a{detail}", Binding.WHOLE
        if kind == "number":
            return _number(detail)
        if kind == "digits":
            return repr(float(detail)), Binding.WHOLE
        if kind == "imaginary":
            return "1j", Binding.WHOLE
        if kind == "sum":
            return self._sum(step), Binding.SUM
        if kind == "square":
            # The base is read twice, so it has a name or is short.
            code = self._bracketed(operands[0], Binding.WHOLE)
            return f"{code}*{code}", Binding.PRODUCT
        if kind in ("product", "quotient"):
            sign = "*" if kind == "product" else "/"
            first = self._bracketed(operands[0], Binding.PRODUCT)
            second = self._bracketed(operands[1], Binding.WHOLE)
            return f"{first}{sign}{second}", Binding.PRODUCT
        inner = [self._codes[place][0] for place in operands]
        if kind == "root":
            name, inner = ("sqrt", inner) if detail == 2 else ("pow", [*inner, f"1/{detail}"])
        else:
            name = "pow" if detail == "power" else FUNCTIONS[detail].math
        return f"{name}({', '.join(inner)})", Binding.WHOLE

    def _sum(self, step: Step) -> str:
        code = ""
        for sign, place in zip(step.signs, step.operands, strict=True):
            if len(code) > _LONGEST_PIECE:
                code = " + " + self._stored(code.removeprefix(" + "))
            code += f" {'+' if sign > 0 else '-'} {self._bracketed(place, Binding.PRODUCT)}"
        return code.removeprefix(" + ")


def _number(value: Fraction) -> tuple[str, Binding]:
    """A rational number as floating-point code."""
    try:
        above, below = float(value.numerator), float(value.denominator)
    except OverflowError:
        return _far_number(value)
    if value.denominator & (value.denominator - 1) == 0:
        return repr(above / below), Binding.WHOLE if value >= 0 else Binding.SUM
    return f"({above!r}/{below!r})", Binding.WHOLE


def _far_number(value: Fraction) -> tuple[str, Binding]:
    """A number whose numerator or denominator is beyond all floats."""
    try:
        return repr(float(value)), Binding.WHOLE if value >= 0 else Binding.SUM
    except OverflowError:
        raise ExpressionError(
            "expected numbers below 1.8e308 in size, got a larger one. Use other units."
        ) from None


def _sign(x: float) -> float:
    """1, -1, 0 or not a number, as numpy has it."""
    return x if x != x else float((x > 0) - (x < 0))


def _largest(*values: np.ndarray) -> np.ndarray:
    return reduce(np.maximum, values)


def _smallest(*values: np.ndarray) -> np.ndarray:
    return reduce(np.minimum, values)


# Special functions, some of which math also has, come from their own file.
_FLOATS: dict[str, Any] = {
    **{x.math: getattr(math, x.math, None) for name, x in FUNCTIONS.items() if name not in VALUES},
    **{name: of_floats(name) for name in VALUES},
    "pow": math.pow,
    "sqrt": math.sqrt,
    "sign": _sign,
    "max": max,
    "min": min,
}
_ARRAYS: dict[str, Any] = {
    **{x.math: getattr(np, x.numpy, None) for name, x in FUNCTIONS.items() if name not in VALUES},
    **{name: of_arrays(name) for name in VALUES},
    "pow": np.power,
    "sqrt": np.sqrt,
    "max": _largest,
    "min": _smallest,
}


@lru_cache(maxsize=1024)
def compiled(
    source: str, numbers: Literal["floats", "arrays"], name: str = "values"
) -> Callable[..., Any]:
    """Compile a function from source text that this package has written, by its name there.

    numbers: type of its arguments; floats go to functions of the math module, not of numpy.

    Examples
    --------
    >>> compiled("def values(a0): return (sqrt(a0),)", "floats")(4.0)
    (2.0,)
    """
    table: dict[str, Any] = dict(_FLOATS if numbers == "floats" else _ARRAYS)
    return function_of(source, table, name)


def function_of(source: str, table: dict[str, Any], name: str = "values") -> Callable[..., Any]:
    """A function of source text that this package has written, over the names of a table.

    Examples
    --------
    >>> function_of("def values(a): return twice(a)", {"twice": lambda x: 2 * x})(4)
    8
    """
    # The source is made of our own names and numbers; no text of a user gets into it.
    exec(compile(source, "<geomtorsion>", "exec"), table)  # noqa: S102
    return table[name]


class Expression(Protocol):
    """An expression of heyoka, which does not declare its types."""

    def __neg__(self) -> Expression:
        """Its opposite."""
        ...

    def __truediv__(self, other: Expression) -> Expression:
        """A quotient."""
        ...

    def __pow__(self, other: Expression | float) -> Expression:
        """A power."""
        ...


# p, q -> p/q, rounded at the precision in use.
Number = Callable[[int, int], Expression]


def heyoka_expressions(
    steps: Sequence[Step],
    outputs: Sequence[Signed],
    arguments: Sequence[Expression | None],
    number: Number,
) -> list[Expression]:
    """Outputs as expressions of the arguments' expressions."""
    writer = _HeyokaWriter(steps, arguments, number)
    return [writer.made[place] if sign > 0 else -writer.made[place] for sign, place in outputs]


class _HeyokaWriter:
    """Writes steps as expressions, in order."""

    def __init__(
        self, steps: Sequence[Step], arguments: Sequence[Expression | None], number: Number
    ) -> None:
        # heyoka is an extra: it is loaded only where it is used.
        self.heyoka = import_module("heyoka")
        self.steps = steps
        self.arguments = arguments
        self.number = number
        self.made: list[Expression] = []
        for step in steps:
            self.made.append(self._step(step))

    @exclusive
    def _step(self, step: Step) -> Expression:
        kind, detail = step.kind, step.detail
        if kind == "argument":
            argument = self.arguments[detail]
            assert argument is not None
            return argument
        if kind == "number":
            return self.number(detail.numerator, detail.denominator)
        if kind == "digits":
            digits = Fraction(str(detail.evalf(prec_to_dps(EXACT_BITS))))
            return self.number(digits.numerator, digits.denominator)
        inner = [self.made[place] for place in step.operands]
        if kind == "sum":
            parts = zip(step.signs, inner, strict=True)
            return self.heyoka.sum([value if sign > 0 else -value for sign, value in parts])
        if kind == "product":
            return self.heyoka.prod(inner)
        if kind == "square":
            return inner[0] ** 2.0
        if kind == "quotient":
            return self._quotient(step, *inner)
        if kind == "root":
            return self.heyoka.sqrt(inner[0]) if detail == 2 else inner[0] ** self.number(1, detail)
        if detail == "power":
            return inner[0] ** inner[1]
        name = FUNCTIONS[detail].heyoka if kind == "call" else ""
        if not name:
            raise ExpressionError(
                f"{detail} has no Taylor series in these equations; replace it by an expression in "
                "other functions, or take another engine"
            )
        return getattr(self.heyoka, name)(*inner)

    def _quotient(self, step: Step, above: Expression, below: Expression) -> Expression:
        first = self.steps[step.operands[0]]
        if is_one(first):
            # heyoka turns 1/x into the power -1, but -1/x into a quotient, which costs two thirds.
            return -self.heyoka.prod([self.number(-1, 1), below**-1.0])
        return above / below
