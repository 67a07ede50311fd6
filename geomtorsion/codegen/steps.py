"""Steps: values computed one after another, each once, ready to be printed for any engine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

# So many quotients by one value make its inverse pay: a product costs less than a quotient.
MANY_QUOTIENTS = 6

# Sign and place of a step.
Signed = tuple[int, int]


@dataclass(frozen=True)
class Step:
    """One value.

    kind: argument, number (rational), digits (pi and its kind), imaginary (the unit), sum,
        product, square, quotient, root or call.
    operands: places of earlier steps.
    signs: of each operand of a sum; nothing elsewhere.
    detail: the position of an argument, the number, the degree of a root, the name of a function
        (sympy's, or power).
    constant: whether the step changes with constant arguments alone.
    """

    kind: str
    operands: tuple[int, ...] = ()
    signs: tuple[int, ...] = ()
    detail: Any = None
    constant: bool = False


class Builder:
    """Collects steps; equal ones are made once."""

    def __init__(self) -> None:
        self.steps: list[Step] = []
        self._known: dict[tuple[object, ...], int] = {}

    def add(
        self,
        kind: str,
        operands: tuple[int, ...] = (),
        detail: Any = None,
        *,
        signs: tuple[int, ...] = (),
        constant: bool | None = None,
    ) -> int:
        """The place of a step; constant: None where its operands tell."""
        key = (kind, operands, signs, detail)
        found = self._known.get(key)
        if found is None:
            if constant is None:
                constant = all(self.steps[place].constant for place in operands)
            found = self._known[key] = len(self.steps)
            self.steps.append(Step(kind, operands, signs, detail, constant))
        return found

    def argument(self, position: int, *, constant: bool) -> int:
        """An argument of the graph."""
        return self.add("argument", detail=position, constant=constant)

    def number(self, value: Fraction) -> int:
        """A rational number."""
        return self.add("number", detail=value, constant=True)

    def root(self, place: int, degree: int) -> int:
        """A root."""
        return self.add("root", (place,), degree)

    def total(self, parts: Sequence[Signed]) -> Signed:
        """A sum of signed steps, with its own sign: minus where all are minus."""
        if len(parts) == 1:
            return parts[0]
        sign = -1 if all(s < 0 for s, _ in parts) else 1
        ordered = sorted(((sign * s, p) for s, p in parts), key=lambda part: -part[0])
        signs, operands = zip(*ordered, strict=True)
        return sign, self.add("sum", operands, signs=signs)

    def product(self, first: int, second: int) -> int:
        """A product, constants in front; of equal factors a square."""
        if first == second:
            return self.add("square", (first,))
        one, two = self.steps[first], self.steps[second]
        if (two.constant, first) > (one.constant, second):
            first, second = second, first
        return self.add("product", (first, second))

    def quotient(self, above: int, below: int) -> int:
        """A quotient."""
        return self.add("quotient", (above, below))

    def power(self, place: int, exponent: int) -> int:
        """A whole power by squares and products.

        heyoka's series of x**n divides by x where n > 2, and has no value on x = 0; squares and
        products have.
        """
        if exponent == 1:
            return place
        half = self.power(place, exponent // 2)
        square = self.product(half, half)
        return self.product(square, place) if exponent % 2 else square

    def needed(self, outputs: Sequence[Signed]) -> tuple[tuple[Step, ...], tuple[Signed, ...]]:
        """The steps that outputs need; inverses where many quotients share what is below."""
        count: dict[int, int] = {}
        for step in self.steps:
            if step.kind == "quotient" and not step.constant:
                count[step.operands[1]] = count.get(step.operands[1], 0) + 1
        many = {place for place, times in count.items() if times >= MANY_QUOTIENTS}
        wanted = [False] * len(self.steps)
        for _, place in outputs:
            wanted[place] = True
        for place in range(len(self.steps) - 1, -1, -1):
            if wanted[place]:
                for other in self.steps[place].operands:
                    wanted[other] = True
        fresh = Builder()
        moved: dict[int, int] = {}
        for place, step in enumerate(self.steps):
            if not wanted[place]:
                continue
            operands = tuple(moved[p] for p in step.operands)
            quotient = step.kind == "quotient"
            if quotient and step.operands[1] in many and not is_one(self.steps[step.operands[0]]):
                inverse = fresh.quotient(fresh.number(Fraction(1)), operands[1])
                moved[place] = fresh.product(operands[0], inverse)
            else:
                moved[place] = fresh.add(
                    step.kind, operands, step.detail, signs=step.signs, constant=step.constant
                )
        return tuple(fresh.steps), tuple((s, moved[p]) for s, p in outputs)


def is_one(step: Step) -> bool:
    """Whether a step is the number one."""
    return step.kind == "number" and step.detail == 1


def uses(steps: Sequence[Step], outputs: Sequence[Signed]) -> list[int]:
    """How often each step is read; a square reads its base twice."""
    count = [0] * len(steps)
    for step in steps:
        for place in step.operands:
            count[place] += 2 if step.kind == "square" else 1
    for _, place in outputs:
        count[place] += 1
    return count
