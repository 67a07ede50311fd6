"""Sums: polynomials over literals; a literal is an argument, a function or another sum."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from math import gcd, lcm

# Number, constants, literals.  A literal is an integer k > 0, and -k stands for its inverse; the
# two tuples are sorted, with repetition.
Term = tuple[Fraction, tuple[int, ...], tuple[int, ...]]
ONE = Fraction(1)


class Sums:
    """All sums of a graph.

    sums: the terms of each sum, by its number.
    named: literal -> the number of the sum that it stands for.
    pairs: literal -> the two literals whose product (or quotient) it is.
    constant: literals that do not change while the variable arguments do.
    known: terms of a sum -> the literal that stands for it.
    """

    def __init__(self) -> None:
        self.sums: list[list[Term]] = []
        self.named: dict[int, int] = {}
        self.pairs: dict[int, tuple[int, int]] = {}
        self.constant: set[int] = set()
        self.known: dict[tuple[Term, ...], int] = {}
        self.count: int = 0

    def fresh(self, *, constant: bool) -> int:
        """A new literal."""
        self.count += 1
        if constant:
            self.constant.add(self.count)
        return self.count

    def entered(self, terms: Iterable[Term]) -> int:
        """The number of a new sum."""
        self.sums.append(collected(terms))
        return len(self.sums) - 1

    def literal(self, terms: Iterable[Term]) -> Term:
        """A sum as one term: itself if it has one, else a literal times a number."""
        found = collected(terms)
        if len(found) == 1:
            return found[0]
        if not found:
            return (Fraction(0), (), ())
        # Sums that differ by a number in front, or by their sign, share one literal.
        number = found[0][0]
        for value, _, _ in found:
            number = content(number, value)
        number = number if found[0][0] > 0 else -number
        if number == 1:
            number = ONE
            key = tuple(found)
        else:
            key = tuple((value / number, constants, rest) for value, constants, rest in found)
        if key not in self.known:
            constant = not any(rest for _, _, rest in key)
            literal = self.known[key] = self.fresh(constant=constant)
            self.named[literal] = self.entered(key)
        literal = self.known[key]
        if literal in self.constant:
            return (number, (literal,), ())
        return (number, (), (literal,))

    def inline(self) -> None:
        """Put sums that are needed once, as a term of another sum, into that sum."""
        inside = [(c, r) for terms in self.sums for _, c, r in terms]
        inside += [((), pair) for pair in self.pairs.values()]
        uses: dict[int, int] = {}
        for constants, rest in inside:
            for literal in (*constants, *rest):
                uses[abs(literal)] = uses.get(abs(literal), 0) + 1
        for number in range(len(self.sums)):
            found: list[Term] = []
            waiting = list(self.sums[number])
            while waiting:
                value, constants, rest = waiting.pop()
                alone = not constants and len(rest) == 1 and rest[0] in self.named
                if alone and uses[rest[0]] == 1:
                    inner = self.named.pop(rest[0])
                    waiting += [(value * n, some, more) for n, some, more in self.sums[inner]]
                    self.known.pop(tuple(self.sums[inner]), None)
                    self.sums[inner] = []
                else:
                    found.append((value, constants, rest))
            self.sums[number] = collected(found)


def order(term: Term) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Where a term stands in its sum."""
    return (term[2], term[1])


def collected(terms: Iterable[Term]) -> list[Term]:
    """Terms in order, those that differ in their number alone added up."""
    found: dict[tuple[tuple[int, ...], tuple[int, ...]], Fraction] = {}
    for number, constants, rest in terms:
        key = (rest, constants)
        found[key] = found[key] + number if key in found else number
    return [(found[key], key[1], key[0]) for key in sorted(found) if found[key]]


def content(one: Fraction, two: Fraction) -> Fraction:
    """The positive number that leaves whole numbers without common divisor."""
    if one is ONE and two.denominator == 1:
        return ONE
    above = gcd(one.numerator, two.numerator)
    below = lcm(one.denominator, two.denominator)
    return ONE if above == below == 1 else Fraction(above, below)


def shared(one: tuple[int, ...], two: tuple[int, ...]) -> tuple[int, ...]:
    """What two sorted tuples have in common, with repetition."""
    found, i, j = list[int](), 0, 0
    while i < len(one) and j < len(two):
        if one[i] == two[j]:
            found.append(one[i])
            i += 1
            j += 1
        elif one[i] < two[j]:
            i += 1
        else:
            j += 1
    return tuple(found)


def without(whole: tuple[int, ...], part: tuple[int, ...]) -> tuple[int, ...]:
    """A sorted tuple without another one that it contains."""
    if not part:
        return whole
    rest = list(whole)
    for entry in part:
        rest.remove(entry)
    return tuple(rest)
