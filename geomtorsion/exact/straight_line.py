"""Straight line: values computed one after another, each once, ready to be written anywhere."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

# So many quotients by one value make its inverse pay: a product costs less than a quotient.
MANY_QUOTIENTS = 6


@dataclass(frozen=True)
class Step:
    """One value.

    kind: symbol, number, digits, sum, product, square, quotient, root or call.
    operands: places of steps before this one; in a sum with a sign each, (sign, place).
    detail: the name of a symbol or function, the number, the degree of a root.
    constant: whether no state occurs in it.
    """

    kind: str
    operands: tuple[Any, ...] = ()
    detail: Any = None
    constant: bool = False


@dataclass(frozen=True)
class StraightLine:
    """Steps in order, and for each output its sign and place."""

    steps: tuple[Step, ...]
    outputs: tuple[tuple[int, int], ...]

    @property
    def uses(self) -> list[int]:
        """How often each step is needed."""
        count = [0] * len(self.steps)
        for step in self.steps:
            for place in places(step):
                count[place] += 1
        for _, place in self.outputs:
            count[place] += 1
        return count


def places(step: Step) -> tuple[int, ...]:
    """The steps that a step needs."""
    if step.kind == "sum":
        return tuple(place for _, place in step.operands)
    return step.operands


class Lines:
    """Collects steps; equal ones are made once."""

    def __init__(self) -> None:
        self.steps: list[Step] = []
        self._known: dict[tuple[Any, ...], int] = {}

    def _add(
        self, kind: str, operands: tuple[Any, ...], detail: Any = None, *, free: Any = None
    ) -> int:
        key = (kind, operands, detail)
        if key not in self._known:
            if free is None:
                inner = (p for _, p in operands) if kind == "sum" else operands
                free = all(self.steps[place].constant for place in inner)
            self._known[key] = len(self.steps)
            self.steps.append(Step(kind, operands, detail, free))
        return self._known[key]

    def symbol(self, name: str, *, constant: bool) -> int:
        """A state or parameter."""
        return self._add("symbol", (), name, free=constant)

    def number(self, value: Fraction) -> int:
        """A rational number."""
        return self._add("number", (), value, free=True)

    def digits(self, value: Any) -> int:
        """A number that is not rational, as sympy expression."""
        return self._add("digits", (), value, free=True)

    def call(self, name: str, operands: tuple[int, ...]) -> int:
        """A function."""
        return self._add("call", operands, name)

    def root(self, place: int, degree: int) -> int:
        """A root."""
        return self._add("root", (place,), degree)

    def total(self, parts: tuple[tuple[int, int], ...]) -> tuple[int, int]:
        """A sum of signed steps, with its own sign: minus where all are minus."""
        if len(parts) == 1:
            return parts[0]
        sign = -1 if all(s < 0 for s, _ in parts) else 1
        ordered = sorted(((sign * s, p) for s, p in parts), key=lambda part: -part[0])
        return sign, self._add("sum", tuple(ordered))

    def product(self, first: int, second: int) -> int:
        """A product; of equal factors a square."""
        if first == second:
            return self._add("square", (first,))
        one, two = self.steps[first], self.steps[second]
        if (two.constant, first) > (one.constant, second):
            first, second = second, first
        return self._add("product", (first, second))

    def quotient(self, above: int, below: int) -> int:
        """A quotient."""
        return self._add("quotient", (above, below))

    def line(self, outputs: tuple[tuple[int, int], ...]) -> StraightLine:
        """What the outputs need, with inverses where many quotients share what is below."""
        count: dict[int, int] = {}
        for step in self.steps:
            if step.kind == "quotient" and not step.constant:
                count[step.operands[1]] = count.get(step.operands[1], 0) + 1
        many = {place for place, times in count.items() if times >= MANY_QUOTIENTS}
        needed = [False] * len(self.steps)
        for _, place in outputs:
            needed[place] = True
        for place in range(len(self.steps) - 1, -1, -1):
            if needed[place]:
                for other in places(self.steps[place]):
                    needed[other] = True
        fresh = Lines()
        moved: dict[int, int] = {}
        for place, step in enumerate(self.steps):
            if not needed[place]:
                continue
            if step.kind == "sum":
                operands: tuple[Any, ...] = tuple((s, moved[p]) for s, p in step.operands)
            else:
                operands = tuple(moved[p] for p in step.operands)
            above = step.operands[0] if step.kind == "quotient" else None
            if above is not None and step.operands[1] in many and not self._is_one(above):
                inverse = fresh.quotient(fresh.number(Fraction(1)), operands[1])
                moved[place] = fresh.product(operands[0], inverse)
            else:
                moved[place] = fresh._add(step.kind, operands, step.detail, free=step.constant)
        return StraightLine(tuple(fresh.steps), tuple((s, moved[p]) for s, p in outputs))

    def _is_one(self, place: int) -> bool:
        step = self.steps[place]
        return step.kind == "number" and step.detail == 1
