"""Line code: a straight line as plain Python code, or as expressions of heyoka."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from importlib import import_module
from typing import Any

from geomtorsion.exact.straight_line import Step, StraightLine

_NUMPY_NAMES = {
    "atan": "arctan", "asin": "arcsin", "acos": "arccos", "asinh": "arcsinh",
    "acosh": "arccosh", "atanh": "arctanh", "atan2": "arctan2",
}  # fmt: skip
# How tightly a piece of code holds together: sums, products, and what needs no brackets.
_SUM, _PRODUCT, _WHOLE = 0, 1, 2
_ONE = Step("number", (), Fraction(1), True)


def line_source(arguments: Sequence[str], line: StraightLine) -> tuple[str, set[str]]:
    """Source of `values(arguments...)`, and the functions (NumPy's names) that it calls."""
    places = {name: f"a{k}" for k, name in enumerate(arguments)}
    writer = _Python(line, places)
    results = [writer.signed(sign, place) for sign, place in line.outputs]
    header = f"def values({', '.join(places.values())}):"
    ending = f"return ({', '.join(results)}{',' * bool(results)})"
    return "\n    ".join([header, *writer.lines, ending]), writer.functions


class _Python:
    """Writes steps: those needed once in place, others as statements before."""

    def __init__(self, line: StraightLine, places: Mapping[str, str]) -> None:
        self.line = line
        self.places = places
        self.lines: list[str] = []
        self.functions: set[str] = set()
        self.codes: list[tuple[str, int]] = []
        for step, uses in zip(line.steps, line.uses, strict=True):
            code, kind = self._step(step)
            if uses > 1 and (kind != _WHOLE or "(" in code):
                name = f"t{len(self.lines)}"
                self.lines.append(f"{name} = {code}")
                code, kind = name, _WHOLE
            self.codes.append((code, kind))

    def signed(self, sign: int, place: int) -> str:
        """An output."""
        code, kind = self.codes[place]
        if sign > 0:
            return code
        return f"-({code})" if kind == _SUM else f"-{code}"

    def _held(self, place: int, least: int) -> str:
        code, kind = self.codes[place]
        return code if kind >= least else f"({code})"

    def _step(self, step: Step) -> tuple[str, int]:
        kind, operands = step.kind, step.operands
        if kind == "symbol":
            return self.places[step.detail], _WHOLE
        if kind == "number":
            return _number(step.detail)
        if kind == "digits":
            return repr(float(step.detail)), _WHOLE
        if kind == "sum":
            parts = [f" {'+' if s > 0 else '-'} {self._held(p, _PRODUCT)}" for s, p in operands]
            return "".join(parts).removeprefix(" + "), _SUM
        if kind == "product":
            return (
                f"{self._held(operands[0], _PRODUCT)}*{self._held(operands[1], _WHOLE)}",
                _PRODUCT,
            )
        if kind == "square":
            code = self._held(operands[0], _WHOLE)
            return (f"{code}*{code}" if code.isidentifier() else f"{code}**2"), _PRODUCT
        if kind == "quotient":
            return (
                f"{self._held(operands[0], _PRODUCT)}/{self._held(operands[1], _WHOLE)}",
                _PRODUCT,
            )
        if kind == "root":
            if step.detail == 2:
                return self._called("sqrt", operands), _WHOLE
            return f"{self._held(operands[0], _WHOLE)}**(1/{step.detail})", _PRODUCT
        if step.detail == "power":
            base, exponent = (self._held(place, _WHOLE) for place in operands)
            return f"{base}**{exponent}", _PRODUCT
        name = str(step.detail)
        return self._called(_NUMPY_NAMES.get(name, name), operands), _WHOLE

    def _called(self, name: str, operands: Sequence[int]) -> str:
        self.functions.add(name)
        return f"{name}({', '.join(self.codes[place][0] for place in operands)})"


def _number(value: Fraction) -> tuple[str, int]:
    """A rational number as floating-point code."""
    p, q = float(value.numerator), float(value.denominator)
    if value.denominator & (value.denominator - 1) == 0:
        return repr(p / q), _WHOLE if value >= 0 else _SUM
    return f"({p!r}/{q!r})", _WHOLE


def line_expressions(
    line: StraightLine, known: Mapping[str, Any], number: Callable[[int, int], Any]
) -> list[Any]:
    """Outputs as heyoka expressions.

    known: name of a symbol -> its expression; number: p, q -> p/q at the precision in use.

    Powers above squares are spelt out as squares and products: heyoka's series of x**n, n > 2,
    divides by x and has no value on x = 0.
    """
    writer = _Heyoka(line, known, number)
    return [writer.made[place] if sign > 0 else -writer.made[place] for sign, place in line.outputs]


class _Heyoka:
    """Writes steps as expressions, in order."""

    def __init__(
        self, line: StraightLine, known: Mapping[str, Any], number: Callable[[int, int], Any]
    ) -> None:
        self.heyoka: Any = import_module("heyoka")
        self.steps = line.steps
        self.known = known
        self.number = number
        self.made: list[Any] = []
        for step in line.steps:
            self.made.append(self._step(step))

    def _step(self, step: Step) -> Any:
        hy, kind, detail = self.heyoka, step.kind, step.detail
        if kind == "symbol":
            return self.known[detail]
        if kind == "number":
            return self.number(detail.numerator, detail.denominator)
        if kind == "digits":
            digits = Fraction(str(detail.evalf(120)))
            return self.number(digits.numerator, digits.denominator)
        if kind == "sum":
            return hy.sum([self.made[p] if s > 0 else -self.made[p] for s, p in step.operands])
        inner = [self.made[place] for place in step.operands]
        if kind == "product":
            return hy.prod(inner) if step.constant else self._product(step.operands[0], inner[1])
        if kind == "square":
            return inner[0] ** 2.0
        if kind == "quotient":
            return self._quotient(step, *inner)
        if kind == "root":
            return hy.sqrt(inner[0]) if detail == 2 else inner[0] ** self.number(1, detail)
        return inner[0] ** inner[1] if detail == "power" else getattr(hy, detail)(*inner)

    def _product(self, place: int, value: Any) -> Any:
        """A product; with a product of parameters one parameter after another.

        Each of them costs one multiplication at each order, while heyoka takes their product for
        a series in compact mode.
        """
        first = self.steps[place]
        if first.constant and first.kind in ("product", "square"):
            for factor in (first.operands * 2)[:2]:
                value = self._product(factor, value)
            return value
        return self.heyoka.prod([self.made[place], value])

    def _quotient(self, step: Step, above: Any, below: Any) -> Any:
        """A quotient."""
        if self.steps[step.operands[1]].constant and not step.constant:
            # A product costs less than a quotient at each order, and the inverse nothing.
            return self.heyoka.prod([self.number(1, 1) / below, above])
        if self.steps[step.operands[0]] == _ONE:
            # Of 1/x heyoka makes the power -1, of -1/x a quotient, which costs two thirds.
            return -self.heyoka.prod([self.number(-1, 1), below**-1.0])
        return above / below
