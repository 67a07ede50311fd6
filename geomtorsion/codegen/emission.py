"""Emission: sums over literals as steps."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction

from geomtorsion.codegen.reading import Meaning, Reader
from geomtorsion.codegen.steps import Builder, Signed
from geomtorsion.codegen.sums import Sums, Term, content, shared, without


class Emitter:
    """Writes sums as steps, literals in the order in which they need each other."""

    def __init__(self, reader: Reader) -> None:
        self.meaning: dict[int, Meaning] = reader.meaning
        self.sums: Sums = reader.sums
        self.builder: Builder = Builder()
        self._done: dict[int, Signed] = {}

    def outputs(self, numbers: Sequence[int]) -> list[Signed]:
        """Sign and place of some of the sums."""
        found = []
        for number in numbers:
            for literal in self._inside_out(number):
                self._done[literal] = self._literal(literal)
            found.append(self._sum(number))
        return found

    def _inside_out(self, number: int) -> Iterable[int]:
        """Literals that a sum needs, each after those that it needs itself; no recursion."""
        waiting = [(literal, False) for literal in reversed(self._of_sum(number))]
        while waiting:
            literal, ready = waiting.pop()
            if literal in self._done:
                continue
            if ready:
                yield literal
            else:
                waiting.append((literal, True))
                waiting += [(inner, False) for inner in reversed(self._of_literal(literal))]

    def _of_sum(self, number: int) -> list[int]:
        terms = self.sums.sums[number]
        return [abs(inner) for _, constants, rest in terms for inner in (*constants, *rest)]

    def _of_literal(self, literal: int) -> list[int]:
        if literal in self.sums.named:
            return self._of_sum(self.sums.named[literal])
        if literal in self.sums.pairs:
            return [abs(inner) for inner in self.sums.pairs[literal]]
        return [x for number in self.meaning[literal].sums for x in self._of_sum(number)]

    def _literal(self, literal: int) -> Signed:
        if literal in self.sums.named:
            return self._sum(self.sums.named[literal])
        if literal in self.sums.pairs:
            return self._term((Fraction(1), (), self.sums.pairs[literal]))
        meaning, builder = self.meaning[literal], self.builder
        if meaning.kind == "argument":
            constant = literal in self.sums.constant
            return 1, builder.argument(int(meaning.detail), constant=constant)
        if meaning.kind in ("digits", "imaginary"):
            return 1, builder.add(meaning.kind, detail=meaning.detail, constant=True)
        inner = tuple(self._unsigned(number) for number in meaning.sums)
        if meaning.kind == "power":
            return 1, builder.power(inner[0], int(meaning.detail))
        return 1, builder.add(meaning.kind, inner, meaning.detail)

    def _unsigned(self, number: int) -> int:
        """A sum without a sign of its own."""
        sign, place = self._sum(number)
        if sign > 0:
            return place
        step = self.builder.steps[place]
        if step.kind == "number":
            return self.builder.number(-step.detail)
        return self.builder.product(self.builder.number(Fraction(-1)), place)

    def _sum(self, number: int) -> Signed:
        terms = self.sums.sums[number]
        if not terms:
            return 1, self.builder.number(Fraction(0))
        value, constants = terms[0][0], terms[0][1]
        for other, some, _ in terms:
            value, constants = content(value, other), shared(constants, some)
        front = _in_front([(value, constants, ())])
        if len(terms) > 1 and front:
            bare = [(n / value, without(some, constants), rest) for n, some, rest in terms]
            if _in_front(bare) + front <= _in_front(terms):
                sign, place = self.builder.total([self._term(term) for term in bare])
                turn, scale = self._scale(value, constants)
                return sign * turn, self.builder.product(scale, place)
        return self.builder.total([self._term(term) for term in terms])

    def _term(self, term: Term) -> Signed:
        number, constants, rest = term
        sign, above, below = self._split(rest)
        scale = None
        if constants or abs(number) != 1:
            turn, scale = self._scale(number, constants)
        else:
            turn = 1 if number > 0 else -1
        if above is None:
            above, scale = scale, None
        if above is None:
            above = self.builder.number(Fraction(1))
        if below is not None:
            above = self.builder.quotient(above, below)
        return sign * turn, above if scale is None else self.builder.product(scale, above)

    def _scale(self, number: Fraction, constants: tuple[int, ...]) -> Signed:
        """A number times constants."""
        sign, above, below = self._split(constants)
        if number < 0:
            sign, number = -sign, -number
        if above is None:
            above = self.builder.number(number)
        elif number != 1:
            above = self.builder.product(self.builder.number(number), above)
        return sign, above if below is None else self.builder.quotient(above, below)

    def _split(self, literals: tuple[int, ...]) -> tuple[int, int | None, int | None]:
        """Sign, and places of what stands above and below the line, None for nothing."""
        sign, above, below = 1, list[int](), list[int]()
        for literal in literals:
            turn, place = self._done[abs(literal)]
            sign *= turn
            (above if literal > 0 else below).append(place)
        return sign, self._chain(above), self._chain(below)

    def _chain(self, places: Sequence[int]) -> int | None:
        """The product of places, equal ones as powers."""
        if len(places) < 2:
            return places[0] if places else None
        count: dict[int, int] = {}
        for place in sorted(places):
            count[place] = count.get(place, 0) + 1
        result = None
        for place, times in count.items():
            power = self.builder.power(place, times)
            result = power if result is None else self.builder.product(result, power)
        return result


def _in_front(terms: Iterable[Term]) -> int:
    """How many numbers and constants stand in front of terms."""
    return sum(len(some) + (abs(number) != 1) for number, some, _ in terms)
