"""Tape: sympy expressions as straight-line code that runs on any kind of number."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import sympy as sp

from geomtorsion.checks import expression as expression_of
from geomtorsion.errors import ExpressionError
from geomtorsion.exact.compile import python_function

# numpy's names of functions that sympy calls otherwise.
_NAMES = {
    "Abs": "abs", "asin": "arcsin", "acos": "arccos", "atan": "arctan", "atan2": "arctan2",
    "asinh": "arcsinh", "acosh": "arccosh", "atanh": "arctanh",
}  # fmt: skip
_PLAIN = frozenset("sin cos tan exp log sinh cosh tanh sqrt sign floor ceiling".split())
_INVERSES = {
    "cot": "tan", "sec": "cos", "csc": "sin", "coth": "tanh", "sech": "cosh", "csch": "sinh",
}  # fmt: skip
# Bits with which numbers that are no fractions are worked out.
BITS = 400


@dataclass(frozen=True)
class Tape:
    """Expressions over named arguments; equal parts are computed once.

    Cheaper to make than a compiled function, and as fast on arrays.

    arguments: names of the symbols, in order.
    outputs: sympy expressions over them.

    Examples
    --------
    >>> x = sp.Symbol("x")
    >>> Tape(("x",), (x**2 + 1, sp.Abs(x))).floats([-3.0])
    [10.0, 3.0]
    >>> Tape(("x",), (x / 3,)).exactly([2])
    [Fraction(2, 3)]
    """

    arguments: tuple[str, ...]
    outputs: tuple[Any, ...]

    @cached_property
    def _plain(self) -> tuple[str, list[Any]]:
        return Writer(self.arguments, sizes=False).source(self.outputs)

    @cached_property
    def _sizes(self) -> tuple[str, list[Any]]:
        return Writer(self.arguments, sizes=True).source(self.outputs)

    @cached_property
    def _array_function(self) -> Callable[..., tuple[Any, ...]]:
        return _made(self._plain, "numpy")

    @cached_property
    def _fraction_function(self) -> Callable[..., tuple[Any, ...]]:
        return _made(self._plain, "fractions")

    @cached_property
    def _long_function(self) -> Callable[..., tuple[Any, ...]]:
        return _made(self._plain, "mpmath")

    @cached_property
    def _size_function(self) -> Callable[..., tuple[Any, ...]]:
        return _made(self._sizes, "numpy")

    def arrays(self, values: Sequence[Any]) -> list[Any]:
        """Values on arrays (or floats) of one shape; what has no value is not a number."""
        import numpy as np

        with np.errstate(all="ignore"):
            return list(self._array_function(*values))

    def sizes(self, values: Sequence[Any]) -> list[Any]:
        """Sums of the sizes of all terms, the scale against which rounding is measured."""
        import numpy as np

        with np.errstate(all="ignore"):
            return list(self._size_function(*values))

    def floats(self, values: Sequence[Any]) -> list[float]:
        """Values at one point."""
        import numpy as np

        return [float(x) for x in self.arrays([np.float64(value) for value in values])]

    def exactly(self, values: Sequence[Any]) -> list[Any]:
        """Values at one point: fractions where they are rational, else mpmath numbers."""
        from geomtorsion.motion.system import exact, mpf

        fractions = [exact(value) for value in values]
        if all(value is not None for value in fractions):
            try:
                return list(self._fraction_function(*fractions))
            except _NoFraction:
                pass
        import mpmath

        with mpmath.workprec(BITS):
            return list(self._long_function(*(mpf(value, BITS) for value in values)))


class _NoFraction(Exception):
    """The value is not rational."""


class Writer:
    """Writes one statement for each part."""

    def __init__(self, arguments: Sequence[str], *, sizes: bool, literal: bool = False) -> None:
        self.place = {name: f"a{k}" for k, name in enumerate(arguments)}
        self.arguments = arguments
        self.literal = literal
        self.with_sizes = sizes
        self.lines: list[str] = []
        self.numbers: list[Any] = []
        self.functions: set[str] = set()
        self.known: dict[tuple[Any, bool], str] = {}

    def source(self, outputs: Sequence[Any]) -> tuple[str, list[Any]]:
        """The source of a function of the arguments, and the numbers that it names."""
        results = [self.part(expression_of(entry), self.with_sizes) for entry in outputs]
        header = f"def values({', '.join(self.place.values())}):"
        ending = f"return ({', '.join(results)}{',' * bool(results)})"
        return "\n    ".join([header, *self.lines, ending]), self.numbers

    def part(self, expr: Any, size: bool = False) -> str:
        """The name of a part; size: of the sum of the sizes of its terms."""
        found = self.known.get((expr, size))
        if found is None:
            code = self.code(expr, size)
            if code.isidentifier():
                found = code
            else:
                found = f"t{len(self.lines)}"
                self.lines.append(f"{found} = {code}")
            self.known[expr, size] = found
        return found

    def code(self, expr: Any, size: bool) -> str:
        """The code of a part."""
        if expr.is_Add:
            return " + ".join(self.part(term, size) for term in expr.args)
        if expr.is_Mul:
            return "*".join(self.part(factor, size) for factor in expr.args)
        if size and not (expr.is_Pow and expr.exp.is_Integer and expr.exp.is_positive):
            return f"absolute({self.part(expr)})"
        if expr.is_Symbol:
            if expr.name not in self.place:
                raise ExpressionError(f"{expr.name} has no value in {', '.join(self.arguments)}")
            return self.place[expr.name]
        if expr.is_Number or expr.is_NumberSymbol:
            if self.literal:
                return repr(float(expr))
            self.numbers.append(expr)
            return f"n{len(self.numbers) - 1}"
        if expr.is_Pow:
            return self.power(expr, size)
        name = type(expr).__name__
        if name in _INVERSES:
            self.functions.add(_INVERSES[name])
            return f"1/{_INVERSES[name]}({self.part(expr.args[0])})"
        if name in ("Max", "Min"):
            return self.extreme("maximum" if name == "Max" else "minimum", expr.args)
        if name in _PLAIN or name in _NAMES:
            self.functions.add(_NAMES.get(name, name))
            inner = ", ".join(self.part(argument) for argument in expr.args)
            return f"{_NAMES.get(name, name)}({inner})"
        raise ExpressionError(f"{expr} has no numerical form here; write it in other functions")

    def power(self, expr: Any, size: bool) -> str:
        """The code of a power."""
        base, exponent = expr.base, expr.exp
        if exponent.is_Integer:
            n = int(exponent)
            if n < 0:
                return f"1/{self.part(base ** (-exponent))}"
            return f"{self.part(base, size)}**{n}"
        if exponent == sp.Rational(1, 2):
            self.functions.add("sqrt")
            return f"sqrt({self.part(base)})"
        if exponent == sp.Rational(-1, 2):
            return f"1/{self.part(sp.sqrt(base))}"
        if base is sp.E:
            self.functions.add("exp")
            return f"exp({self.part(exponent)})"
        return f"{self.part(base)}**{self.part(exponent)}"

    def extreme(self, name: str, args: Sequence[Any]) -> str:
        """The code of the largest or smallest of several."""
        code = self.part(args[0])
        for other in args[1:]:
            code = f"{name}({code}, {self.part(other)})"
        return code


def _made(written: tuple[str, list[Any]], kind: str) -> Callable[..., tuple[Any, ...]]:
    """The function of a tape for one kind of number."""
    source, numbers = written
    return python_function(source, _names(kind, numbers))


def _names(kind: str, numbers: list[Any]) -> dict[str, Any]:
    functions = [*_PLAIN, *_NAMES.values(), "maximum", "minimum", "absolute"]
    if kind == "numpy":
        import numpy as np

        table = {name: getattr(np, name) for name in functions if name != "ceiling"}
        table["ceiling"] = np.ceil
        values: list[Any] = [float(number) for number in numbers]
    elif kind == "fractions":

        def refused(*_: Any) -> Any:
            raise _NoFraction

        table = dict.fromkeys(functions, refused)
        if not all(number.is_Rational or number.is_Float for number in numbers):
            raise _NoFraction
        exact = [sp.Rational(number) for number in numbers]
        values = [Fraction(int(number.p), int(number.q)) for number in exact]
    else:
        import mpmath

        names = {value: key.lower() for key, value in _NAMES.items()}
        other = {"abs": "fabs", "absolute": "fabs", "ceiling": "ceil"}
        table = {}
        for name in functions:
            found = other.get(name, names.get(name, name))
            table[name] = getattr(mpmath, found, None)
        table |= {"maximum": max, "minimum": min}
        values = [mpmath.mpmathify(sp.Rational(n) if n.is_Float else n.evalf(125)) if not
                  n.is_Rational else mpmath.mpf(int(n.p)) / int(n.q) for n in numbers]  # fmt: skip
    return table | {f"n{k}": value for k, value in enumerate(values)}
