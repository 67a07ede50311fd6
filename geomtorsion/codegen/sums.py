"""Sums: polynomials over literals, shortened by pulling out common factors.

A literal is an argument, a function or another sum.  Only the distributive law is used, and only
from the sum to the product: nothing is expanded, and no new divisors appear.  The method is greedy.
Among all pairs of terms (their common factor comes out in front, the rest becomes a literal) and of
all pairs of factors (their product becomes a literal), over all sums together, the one that saves
most is taken, again and again.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from heapq import heappop, heappush
from itertools import combinations, pairwise
from math import gcd, lcm
from typing import Any

# Number, constants, literals.  A literal is an integer k > 0, and -k is its inverse; the
# two tuples are sorted, with repetition.
Term = tuple[Fraction, tuple[int, ...], tuple[int, ...]]
ONE = Fraction(1)


class Sums:
    """All sums of a graph.

    sums: the terms of each sum, by its number.
    named: literal -> the number of the sum that it represents.
    pairs: literal -> the two literals whose product (or quotient) it is.
    constant: literals that do not change while the variable arguments do.
    known: terms of a sum -> the literal that represents it.
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
        ordered = collected(terms)
        if len(ordered) == 1:
            return ordered[0]
        if not ordered:
            return (Fraction(0), (), ())
        # Sums that differ by a number in front, or by their sign, share one literal.
        number = ordered[0][0]
        for value, _, _ in ordered:
            number = content(number, value)
        number = number if ordered[0][0] > 0 else -number
        if number == 1:
            number = ONE
            key = tuple(ordered)
        else:
            key = tuple((value / number, constants, rest) for value, constants, rest in ordered)
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
            remaining: list[Term] = []
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
                    remaining.append((value, constants, rest))
            self.sums[number] = collected(remaining)


def order(term: Term) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Sort key of a term in its sum."""
    return (term[2], term[1])


def collected(terms: Iterable[Term]) -> list[Term]:
    """Terms in order; terms that differ only in their number are added."""
    totals: dict[tuple[tuple[int, ...], tuple[int, ...]], Fraction] = {}
    for number, constants, rest in terms:
        key = (rest, constants)
        totals[key] = totals[key] + number if key in totals else number
    return [(totals[key], key[1], key[0]) for key in sorted(totals) if totals[key]]


def content(one: Fraction, two: Fraction) -> Fraction:
    """The positive number that leaves whole numbers without common divisor."""
    if one is ONE and two.denominator == 1:
        return ONE
    above = gcd(one.numerator, two.numerator)
    below = lcm(one.denominator, two.denominator)
    return ONE if above == below == 1 else Fraction(above, below)


def shared(one: tuple[int, ...], two: tuple[int, ...]) -> tuple[int, ...]:
    """Common elements of two sorted tuples, with repetition."""
    common, i, j = list[int](), 0, 0
    while i < len(one) and j < len(two):
        if one[i] == two[j]:
            common.append(one[i])
            i += 1
            j += 1
        elif one[i] < two[j]:
            i += 1
        else:
            j += 1
    return tuple(common)


def without(whole: tuple[int, ...], part: tuple[int, ...]) -> tuple[int, ...]:
    """A sorted tuple without another one that it contains."""
    if not part:
        return whole
    rest = list(whole)
    for entry in part:
        rest.remove(entry)
    return tuple(rest)


# Cost of an operation on Taylor series, measured with heyoka at order 20: a product of two
# series convolves them; its square needs half the convolution, a product with a constant none.
# On plain numbers all this costs the same, and fewer products are still better.
PRODUCT, SQUARE, QUOTIENT, SCALE = 100, 40, 130, 10
# More comparisons than this take tens of milliseconds: the best result by then is used.
MOST_COMPARED = 12_000

# A pair of terms without common factor, or a pair of factors (integers).
Divisor = tuple[Any, Any]


def factor(sums: Sums) -> None:
    """Pull out the divisor that saves most, as long as one saves anything.

    Where there is more to compare than is worth the time, the sums stay as they are.
    """
    work = 0
    for terms in sums.sums:
        work += len(terms) ** 2 // 2 + sum(len(rest) ** 2 // 2 for _, _, rest in terms)
    # Below a third, some rounds are sure to be possible.
    if work <= MOST_COMPARED // 3:
        _Search(sums).run()


class _Search:
    """Divisors of all sums, with the saving of each; terms and divisors go by numbers.

    divided: two terms -> divisor, front, and the saving of the two.
    factors: a term -> its pairs of factors, and how often each could be taken.
    literal: divisor -> the literal that it has become; own: sum -> the divisor that it is.
    where: divisor -> sum -> pairs of terms, or how often a pair of factors is there; of: the
        same by sums.
    heap: gains with their divisors; outdated gains are skipped.
    """

    def __init__(self, sums: Sums) -> None:
        self.pool = sums
        self.compared = 0
        self.terms: list[Term] = []
        self.costs: list[int] = []
        self.term_number: dict[Term, int] = {}
        self.divisors: list[Divisor] = []
        self.divisor_number: dict[Divisor, int] = {}
        self.divided: dict[tuple[int, int], tuple[int, int, int]] = {}
        self.factors: dict[int, list[tuple[int, int]]] = {}
        self.sums = [[self._term(term) for term in terms] for terms in sums.sums]
        self.literal: dict[int, int] = {}
        self.own: dict[int, int] = {}
        for key, literal in sums.known.items():
            # A sum of two terms that is there already costs nothing to pull out.
            if len(key) == 2 and literal not in sums.constant:
                divisor = self._divisor((key[0], key[1]))
                self.literal[divisor] = literal
                self.own[sums.named[literal]] = divisor
        self.where: dict[int, dict[int, Any]] = {}
        self.of: dict[int, dict[int, Any]] = {}
        self.gain: dict[int, int] = {}
        self.heap: list[tuple[int, bool, int]] = []

    def run(self) -> None:
        """Pull out the best divisor until none saves anything."""
        changed = list(range(len(self.sums)))
        while changed and self.compared < MOST_COMPARED:
            self._update(changed)
            changed = []
            while self.heap and not changed:
                saved, _, divisor = heappop(self.heap)
                if self.gain.get(divisor) == -saved:
                    changed = self._pulled(divisor)
        self.pool.sums = [collected(self.terms[t] for t in terms) for terms in self.sums]

    def _term(self, term: Term) -> int:
        number = self.term_number.get(term)
        if number is None:
            number = self.term_number[term] = len(self.terms)
            self.terms.append(term)
            self.costs.append(cost(term))
        return number

    def _divisor(self, divisor: Divisor) -> int:
        number = self.divisor_number.get(divisor)
        if number is None:
            number = self.divisor_number[divisor] = len(self.divisors)
            self.divisors.append(divisor)
        return number

    def _update(self, changed: list[int]) -> None:
        """Find divisors and gains again for the sums that changed."""
        touched: dict[int, None] = {}
        for number in changed:
            before, after = self.of.get(number, {}), self._found(number)
            self.of[number] = after
            for divisor, where in before.items():
                if divisor not in after:
                    del self.where[divisor][number]
                    touched[divisor] = None
                elif after[divisor] != where:
                    touched[divisor] = None
            for divisor, where in after.items():
                # The same pairs save more once their divisor has a literal.
                self.where.setdefault(divisor, {})[number] = where
                touched[divisor] = None
        for divisor in touched:
            gain = self._gained(divisor)
            if gain <= 0:
                self.gain.pop(divisor, None)
            elif gain != self.gain.get(divisor):
                self.gain[divisor] = gain
                # Among equal gains sums come first: a common factor may go with more terms later.
                heappush(self.heap, (-gain, self._is_pair(divisor), divisor))

    def _is_pair(self, divisor: int) -> bool:
        """Whether a divisor is a pair of factors."""
        return isinstance(self.divisors[divisor][0], int)

    def _found(self, number: int) -> dict[int, Any]:
        """All divisors of a sum, with their positions."""
        divisors: dict[int, Any] = {}
        terms, own = self.sums[number], self.own.get(number)
        self.compared += len(terms) * (len(terms) + 1) // 2
        for two in terms:
            for one in terms:
                if one == two:
                    break
                divisor = self._compared(one, two)[0]
                if divisor >= 0 and divisor != own:
                    divisors.setdefault(divisor, []).append((one, two))
            for pair, times in self._pairs(two):
                divisors[pair] = divisors.get(pair, 0) + times
        return divisors

    def _compared(self, one: int, two: int) -> tuple[int, int, int]:
        """Divisor (-1 where no state occurs) and front of two terms, and their saving."""
        key = (one, two)
        if key not in self.divided:
            divisor, front = divided(self.terms[one], self.terms[two])
            number, constants, rest = front
            some = self.pool.count + 1  # any literal that is not there: only how many matters
            if divisor[0][2] or divisor[1][2]:
                after = (number, constants, (*rest, some))
            else:
                after = (number, (some,), rest)
            # Constants are computed once: factoring terms without states gains nothing.
            states = divisor[0][2] or divisor[1][2] or rest
            saved = self.costs[one] + self.costs[two] - cost(after)
            place = self._divisor(divisor) if states else -1
            self.divided[key] = (place, self._term(front), saved)
        return self.divided[key]

    def _pairs(self, number: int) -> list[tuple[int, int]]:
        """Pairs of factors of a term, and how often each could be taken."""
        if number not in self.factors:
            literals = self.terms[number][2]
            count = {literal: literals.count(literal) for literal in literals}
            pairs = [((a, a), n // 2) for a, n in count.items() if n > 1]
            pairs += [((a, b), min(count[a], count[b])) for a, b in combinations(count, 2)]
            self.factors[number] = [(self._divisor(pair), n) for pair, n in pairs]
        return self.factors[number]

    def _known(self, divisor: int) -> int:
        """The divisor that represents a literal: inverse factors as factors of a denominator."""
        pair = self.divisors[divisor]
        if isinstance(pair[0], int) and pair[1] < 0:
            return self._divisor((-pair[1], -pair[0]))
        return divisor

    def _gained(self, divisor: int) -> int:
        """Saving of pulling out a divisor."""
        where, is_known = self.where[divisor], self._known(divisor) in self.literal
        one, two = self.divisors[divisor]
        if isinstance(one, int):
            each = SQUARE if one == two else QUOTIENT if one < 0 < two else PRODUCT
            return (sum(where.values()) - (not is_known)) * each
        total = 0 if is_known else -cost(one) - cost(two)
        for pairs in where.values():
            for pair in disjoint(pairs):
                total += self.divided[pair][2]
        return total

    def _pulled(self, divisor: int) -> list[int]:
        """Replace a divisor by one literal everywhere; return the sums that changed."""
        one, two = self.divisors[divisor]
        base_literal = self.literal.get(self._known(divisor))
        changed = sorted(self.where[divisor])
        if isinstance(one, int):
            if base_literal is None:
                base_literal = self.literal[self._known(divisor)] = self.pool.fresh(constant=False)
                pair = self.divisors[self._known(divisor)]
                self.pool.pairs[base_literal] = pair
            literal = base_literal if two > 0 else -base_literal
            for number in changed:
                self.sums[number] = [
                    self._term((value, some, paired(rest, one, two, literal)))
                    for value, some, rest in (self.terms[t] for t in self.sums[number])
                ]
            return changed
        free = not (one[2] or two[2])
        if base_literal is None:
            base_literal = self.literal[divisor] = self.pool.fresh(constant=free)
            self.pool.named[base_literal] = len(self.sums)
            self.own[len(self.sums)] = divisor
            changed.append(len(self.sums))
            self.sums.append([self._term(one), self._term(two)])
        for number, pairs in list(self.where[divisor].items()):
            gone, more = set(), []
            for i, j in disjoint(pairs):
                gone |= {i, j}
                value, some, rest = self.terms[self.divided[i, j][1]]
                if free:
                    more.append((value, tuple(sorted((*some, base_literal))), rest))
                else:
                    more.append((value, some, tuple(sorted((*rest, base_literal)))))
            remaining = [self.terms[t] for t in self.sums[number] if t not in gone]
            self.sums[number] = [self._term(term) for term in collected([*remaining, *more])]
        return changed


def cost(term: Term) -> int:
    """Cost of one term."""
    number, constants, literals = term
    if not literals:
        return 0
    bare = not constants and number.denominator == 1 and number.numerator in (1, -1)
    repeated = sum(1 for a, b in pairwise(literals) if a == b)
    total = (0 if bare else SCALE) + (len(literals) - 1) * PRODUCT - repeated * (PRODUCT - SQUARE)
    if literals[0] > 0:
        return total
    # All are divisors: 1/x. Otherwise one of the products is a quotient.
    return total + (QUOTIENT if literals[-1] < 0 else QUOTIENT - PRODUCT)


def divided(one: Term, two: Term) -> tuple[tuple[Term, Term], Term]:
    """Two terms as front * (first + second): the sum without common parts, and the front."""
    literals, constants = shared(one[2], two[2]), shared(one[1], two[1])
    number = content(one[0], two[0])
    values = one[0], two[0]
    if number != 1:
        values = one[0] / number, two[0] / number
    first = (values[0], without(one[1], constants), without(one[2], literals))
    second = (values[1], without(two[1], constants), without(two[2], literals))
    if order(second) < order(first):
        first, second = second, first
    if first[0].numerator < 0:
        number = -number
        first, second = (-first[0], *first[1:]), (-second[0], *second[1:])
    return (first, second), (number, constants, literals)


def paired(literals: tuple[int, ...], a: int, b: int, literal: int) -> tuple[int, ...]:
    """A product in which one literal replaces each occurrence of the pair a, b."""
    times = literals.count(a) // 2 if a == b else min(literals.count(a), literals.count(b))
    if not times:
        return literals
    return tuple(sorted((*without(literals, tuple(sorted((a, b) * times))), *([literal] * times))))


def disjoint(pairs: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Pairs of terms that have no term in common."""
    if len(pairs) == 1:
        return pairs
    taken: set[int] = set()
    chosen = []
    for i, j in pairs:
        if i not in taken and j not in taken:
            taken |= {i, j}
            chosen.append((i, j))
    return chosen
