"""Rational basis: elements independent over Q, in which angles and exponents are counted."""

from __future__ import annotations

from math import gcd
from typing import TYPE_CHECKING

import sympy
from flint import fmpq, fmpq_mat

from geomtorsion.exact.element import Denominator, Element

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from flint import fmpq_mpoly

    from geomtorsion.exact.generators import Generator
    from geomtorsion.exact.tower import Tower


class RationalBasis:
    """Elements independent over the rationals, each with the unit in which it is counted.

    stands_alone: which terms are atoms wherever they occur, as the function undoes them.
    """

    def __init__(self, field: Tower, stands_alone: Callable[[Tower, Element], bool]) -> None:
        self._field = field
        self._stands_alone = stands_alone
        self.elements: list[Element] = []
        self.units: list[fmpq] = []
        self._index: dict[Element, int] = {}
        self._all_monomials = True

    def decompose(self, element: Element) -> list[tuple[fmpq, int]]:
        """The element as sum of coefficient * atom; new atoms are added where needed."""
        parts = terms(element)
        if self._all_monomials and not element._den:
            for _, monomial in parts:
                if monomial not in self._index:
                    self._add(monomial)
            # Different monomials are independent: no linear algebra is needed.
            return [(value, self._index[monomial]) for value, monomial in parts]
        # Sums that are atoms themselves may span this one; only if not, its terms become atoms.
        found = self._express(element)
        if found is None:
            for _, part in parts:
                if self._express(part) is None:
                    self._add(part)
            found = self._express(element)
            assert found is not None
        return [(value, index) for index, value in enumerate(found) if value]

    def choose(self, elements: list[Element]) -> None:
        """Adds atoms for all these at once: whole sums where these are fewer than their terms.

        cos(k*x - w*t) alone keeps its angle; cos(x), cos(y) and cos(x + y) are split.  exp of
        a logarithm is undone, cos of one is not: there its sums stay whole, too.
        """
        if self._all_monomials and all(_is_monomial(element) for element in elements):
            # Different monomials are independent: no linear algebra is needed.
            parts = [part for element in elements for _, part in terms(element)]
            for part in sorted(parts, key=lambda x: not self._stands_alone(self._field, x)):
                if part not in self._index:
                    self._add(part)
            return
        whole: list[Element] = []
        monomials: list[Element] = []
        for element in elements:
            rest = element
            for value, part in terms(element):
                if self._stands_alone(self._field, part):
                    self._add_new(part)
                    rest = rest - part * value
            if rest._num and self._express(rest) is None:
                trial = [*self.elements, *whole]
                if express(self._field, [rest], [[atom] for atom in trial]) is None:
                    whole.append(rest)
                for _, part in terms(rest):
                    trial = [*self.elements, *monomials]
                    if express(self._field, [part], [[atom] for atom in trial]) is None:
                        monomials.append(part)
        for atom in whole if len(whole) < len(monomials) else monomials:
            self._add_new(atom)

    def _add_new(self, atom: Element) -> None:
        """Adds an atom that the present ones do not span."""
        if self._express(atom) is None:
            self._add(atom)

    def _express(self, element: Element) -> list[fmpq] | None:
        return express(self._field, [element], [[atom] for atom in self.elements])

    def _add(self, atom: Element) -> None:
        single = len(self._field.lift(atom)) == 1 and not atom._den
        index = {**self._index, atom: len(self.elements)}
        elements, units = [*self.elements, atom], [*self.units, fmpq(0)]
        # All at once: whoever interrupts finds all of it or nothing.
        self._index, self.elements, self.units = index, elements, units
        self._all_monomials = self._all_monomials and single

    def refine_unit(self, index: int, coefficient: fmpq) -> None:
        """Makes the unit of an atom divide a coefficient; only before the unit is in use."""
        self.units[index] = rational_gcd(self.units[index], coefficient)


def _is_monomial(element: Element) -> bool:
    """Whether an element has at most one term, and nothing below the line."""
    return not element.is_kept and not element._den and len(element._num) < 2


def undone_by_exp(field: Tower, atom: Element) -> bool:
    """Whether the atom is a single logarithm or inverse function."""
    generator = single_generator(field, atom)
    if generator is None:
        return False
    return generator.kind in ("log", "primitive") or isinstance(generator.shown, sympy.log)


def undone_by_cos(field: Tower, atom: Element) -> bool:
    """Whether the atom is a single inverse function."""
    generator = single_generator(field, atom)
    return generator is not None and generator.kind == "primitive"


def single_generator(field: Tower, atom: Element) -> Generator | None:
    """The generator that the element is, or None."""
    num = field.lift(atom)
    if atom._den or len(num) != 1 or num.total_degree() != 1 or num.leading_coefficient() != 1:
        return None
    return next(g for g, degree in zip(field.generators, num.degrees(), strict=True) if degree)


def rational_gcd(a: fmpq, b: fmpq) -> fmpq:
    """The largest rational of which both are integer multiples."""
    q = int(a.q) * int(b.q) // gcd(int(a.q), int(b.q))
    return fmpq(gcd(int(a.p) * (q // int(a.q)), int(b.p) * (q // int(b.q))), q)


def terms(element: Element) -> list[tuple[fmpq, Element]]:
    """The element as sum of rational * monomial: its polynomial part, then what is over den.

    u/R + pi/3 is kept as (3 u + pi R)/(3 R); division with remainder takes pi/3 out again.
    """
    field = element.field
    rest = field.lift(element)
    if len(rest) == 1 and not element._den:
        value = rest.leading_coefficient()
        return [(value, Element(field, rest / value, (), field.level))]
    parts: list[tuple[fmpq_mpoly, Denominator]] = [(rest, element._den)]
    if element._den:
        whole, rest = divmod(rest, field.cofactor(element._den, ()))
        parts = [(whole, ()), (rest, element._den)]
    return [
        (value, Element(field, field.ctx.from_dict({tuple(m): fmpq(1)}), den, field.level))
        for poly, den in parts
        for m, value in poly.to_dict().items()
    ]


def express(
    field: Tower, target: Sequence[Element], basis: Sequence[Sequence[Element]]
) -> list[fmpq] | None:
    """Rational q_j with target = sum q_j basis_j (row by row), or None.

    Each vector is a sequence of elements; all have one length.  Monomials over a common
    denominator are independent, so this is linear algebra on their coefficients.
    """
    answer = [fmpq(0)] * len(basis)
    places = _without_own_poles(target, basis)
    if places is None:
        return None
    chosen = [basis[place] for place in places]
    columns = [dict[tuple[int, tuple[int, ...]], fmpq]() for _ in range(len(chosen) + 1)]
    for row in range(len(target)):
        entries = [vector[row] for vector in chosen] + [target[row]]
        common: Denominator = ()
        for entry in entries:
            common = field.lcm(common, entry._den)
        for column, entry in zip(columns, entries, strict=True):
            poly = field.lift(entry) * field.cofactor(common, entry._den)
            for monomial, value in field.reduced(poly).to_dict().items():
                column[row, tuple(monomial)] = value
    keys = sorted({key for column in columns for key in column})
    if not keys:
        return answer
    matrix = fmpq_mat(
        len(keys), len(columns), [c.get(key, fmpq(0)) for key in keys for c in columns]
    )
    reduced, rank = matrix.rref()
    last = len(chosen)
    for row in range(rank):
        pivot = next(j for j in range(last + 1) if reduced[row, j] != 0)
        if pivot == last:
            return None
        answer[places[pivot]] = reduced[row, last]
    return answer


def _without_own_poles(
    target: Sequence[Element], basis: Sequence[Sequence[Element]]
) -> list[int] | None:
    """The places of the vectors that may have a share in the target; None if it is in no span.

    What has a factor below the line to a higher power than all others has no share in a sum
    without it.  To see this is cheap; a common denominator has 2**n terms for n nested logarithms.
    """
    # The target comes last.
    vectors, left = [*basis, target], list(range(len(basis) + 1))
    while True:
        own: set[int] = set()
        for row in range(len(target)):
            highest: dict[int, int] = {}
            holders: dict[int, list[int]] = {}
            for place in left:
                for factor, exponent in vectors[place][row]._den:
                    if exponent > highest.get(factor, 0):
                        highest[factor], holders[factor] = exponent, []
                    if exponent == highest[factor]:
                        holders[factor].append(place)
            own.update(places[0] for places in holders.values() if len(places) == 1)
        if len(basis) in own:
            return None
        if not own:
            return left[:-1]
        left = [place for place in left if place not in own]
