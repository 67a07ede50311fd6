"""Emitting: sums over literals as steps of a straight line."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from geomtorsion.exact.factoring import shorten
from geomtorsion.exact.literals import Literals
from geomtorsion.exact.straight_line import Lines, StraightLine
from geomtorsion.exact.sums import Term, content, shared, without


def short_line(literals: Literals, numbers: Sequence[int]) -> StraightLine:
    """The straight line of some sums, with everything pulled out of them that saves work.

    Raises
    ------
    TooLong
        there is more to compare than is worth the time.
    """
    literals.sums.inline()
    shorten(literals.sums)
    literals.sums.inline()
    return _Emitter(literals).line(numbers)


class _Emitter:
    """Writes sums as steps."""

    def __init__(self, literals: Literals) -> None:
        self.literals = literals
        self.sums = literals.sums
        self.lines = Lines()
        self.done: dict[int, tuple[int, int]] = {}

    def line(self, numbers: Sequence[int]) -> StraightLine:
        """The steps of some of the sums."""
        for name in self.literals.symbols:
            self.lines.symbol(name, constant=name in self.literals.constants)
        return self.lines.line(tuple(self.sum(number) for number in numbers))

    def literal(self, literal: int) -> tuple[int, int]:
        """Sign and place of a literal."""
        if literal not in self.done:
            self.done[literal] = self._literal(literal)
        return self.done[literal]

    def _literal(self, literal: int) -> tuple[int, int]:
        if literal in self.sums.named:
            return self.sum(self.sums.named[literal])
        if literal in self.sums.pairs:
            return self.term((Fraction(1), (), self.sums.pairs[literal]))
        kind, *rest = self.literals.meaning[literal]
        if kind == "symbol":
            return 1, self.lines.symbol(rest[0], constant=literal in self.sums.constant)
        if kind == "digits":
            return 1, self.lines.digits(rest[0])
        if kind == "root":
            return 1, self.lines.root(self._whole(rest[1]), rest[0])
        return 1, self.lines.call(rest[0], tuple(self._whole(number) for number in rest[1]))

    def _whole(self, number: int) -> int:
        """A sum without a sign of its own."""
        sign, place = self.sum(number)
        return place if sign > 0 else self.lines.product(self._number(Fraction(-1)), place)

    def _number(self, value: Fraction) -> int:
        return self.lines.number(value)

    def sum(self, number: int) -> tuple[int, int]:
        """Sign and place of a sum."""
        terms = self.sums.sums[number]
        if not terms:
            return 1, self._number(Fraction(0))
        value, parameters = terms[0][0], terms[0][1]
        for other, some, _ in terms:
            value, parameters = content(value, other), shared(parameters, some)
        bare = [(n / value, without(some, parameters), rest) for n, some, rest in terms]
        front = _scaled([(value, parameters, ())])
        if len(terms) > 1 and front and _scaled(bare) + front <= _scaled(terms):
            sign, place = self.lines.total(tuple(map(self.term, bare)))
            turn, scale = self._scale(value, parameters)
            return sign * turn, self.lines.product(scale, place)
        return self.lines.total(tuple(map(self.term, terms)))

    def term(self, term: Term) -> tuple[int, int]:
        """Sign and place of a term."""
        number, parameters, rest = term
        sign, above, below = self._split(rest)
        scaled = bool(parameters) or abs(number) != 1
        turn, scale = self._scale(number, parameters) if scaled else (1 if number > 0 else -1, -1)
        sign *= turn
        if above < 0:
            above, scaled = scale if scaled else self._number(Fraction(1)), False
        if below >= 0:
            above = self.lines.quotient(above, below)
        return sign, self.lines.product(scale, above) if scaled else above

    def _scale(self, number: Fraction, parameters: tuple[int, ...]) -> tuple[int, int]:
        """Sign and place of a number times parameters."""
        sign, above, below = self._split(parameters)
        if number < 0:
            sign, number = -sign, -number
        if above < 0:
            above = self._number(number)
        elif number != 1:
            above = self.lines.product(self._number(number), above)
        return sign, self.lines.quotient(above, below) if below >= 0 else above

    def _split(self, literals: tuple[int, ...]) -> tuple[int, int, int]:
        """Sign, and places of what stands above and below the line (-1: nothing)."""
        sign, found = 1, {1: list[int](), -1: list[int]()}
        for literal in literals:
            turn, place = self.literal(abs(literal))
            sign *= turn
            found[1 if literal > 0 else -1].append(place)
        return sign, self._chain(found[1]), self._chain(found[-1])

    def _chain(self, all_places: list[int]) -> int:
        """The product of places, squares first."""
        count: dict[int, int] = {}
        for place in sorted(all_places):
            count[place] = count.get(place, 0) + 1
        result = -1
        for place, times in count.items():
            power = self._power(place, times)
            result = power if result < 0 else self.lines.product(result, power)
        return result

    def _power(self, place: int, times: int) -> int:
        if times == 1:
            return place
        half = self._power(place, times // 2)
        square = self.lines.product(half, half)
        return self.lines.product(square, place) if times % 2 else square


def _scaled(terms: Sequence[Term]) -> int:
    """How many numbers and parameters stand in front of terms."""
    return sum(len(some) + (abs(number) != 1) for number, some, _ in terms)
