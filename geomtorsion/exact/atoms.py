"""Atoms: the rational basis in which angles and exponents are written."""

from __future__ import annotations

from math import gcd
from typing import TYPE_CHECKING

from flint import fmpq

from geomtorsion.exact.element import Element
from geomtorsion.exact.linear import express

if TYPE_CHECKING:
    from geomtorsion.exact.field import Field


class Atoms:
    """Elements independent over the rationals, each with the unit in which it is counted."""

    def __init__(self, field: Field) -> None:
        self._field = field
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
            return [(value, self._index[monomial]) for value, monomial in parts]
        found = self._express(element)
        if found is None:
            for _, part in parts:
                if self._express(part) is None:
                    self._add(part)
            found = self._express(element)
            assert found is not None
        return [(value, index) for index, value in enumerate(found) if value]

    def _express(self, element: Element) -> list[fmpq] | None:
        return express(self._field, [element], [[atom] for atom in self.elements])

    def _add(self, atom: Element) -> None:
        self._index[atom] = len(self.elements)
        self.elements.append(atom)
        self.units.append(fmpq(0))
        self._all_monomials = self._all_monomials and not atom._den

    def refine_unit(self, index: int, coefficient: fmpq) -> None:
        """Makes the unit of an atom divide a coefficient; only before the unit is in use."""
        self.units[index] = rational_gcd(self.units[index], coefficient)


def rational_gcd(a: fmpq, b: fmpq) -> fmpq:
    """The largest rational of which both are integer multiples."""
    q = int(a.q) * int(b.q) // gcd(int(a.q), int(b.q))
    return fmpq(gcd(int(a.p) * (q // int(a.q)), int(b.p) * (q // int(b.q))), q)


def terms(element: Element) -> list[tuple[fmpq, Element]]:
    """The element as (rational, monomial over the common denominator)."""
    field = element.field
    num = field.lift(element)
    return [
        (value, Element(field, field.ctx.from_dict({tuple(m): fmpq(1)}), element._den, field.level))
        for m, value in num.to_dict().items()
    ]
