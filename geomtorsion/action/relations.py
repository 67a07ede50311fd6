"""Relations: rational combinations of exact elements that vanish."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import lcm
from typing import TYPE_CHECKING, Any

from flint import fmpq, fmpq_mat

if TYPE_CHECKING:
    from geomtorsion.exact import Element, Field

Row = dict[int, Fraction]


def relations(field: Field, vectors: Sequence[Sequence[Element]]) -> list[Row]:
    """All independent {j: q_j} with sum_j q_j vectors[j] = 0, each with one q_j = 1 of its own.

    Over a common denominator the monomials of a field are independent, so this is linear
    algebra over the rationals; parameters count as unknowns, not as numbers.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.exact import Field
    >>> x = sp.Symbol("x")
    >>> field = Field([x])
    >>> values = [sp.sin(x) ** 2, sp.cos(x) ** 2, x, sp.Integer(2)]
    >>> relations(field, [[field.read(value)] for value in values])
    [{0: Fraction(2, 1), 1: Fraction(2, 1), 3: Fraction(-1, 1)}]
    """
    columns = _coordinates(field, vectors)
    keys = sorted({key for column in columns for key in column})
    if not keys:
        return [{j: Fraction(1)} for j in range(len(vectors))]
    zero = fmpq(0)
    entries = [column.get(key, zero) for key in keys for column in columns]
    reduced, rank = fmpq_mat(len(keys), len(columns), entries).rref()
    pivots = [next(j for j in range(len(columns)) if reduced[r, j] != 0) for r in range(rank)]
    found = []
    for free in sorted(set(range(len(columns))) - set(pivots)):
        row: Row = {free: Fraction(1)}
        for r, pivot in enumerate(pivots):
            if reduced[r, free] != 0:
                row[pivot] = -_fraction(reduced[r, free])
        found.append(_whole(row))
    return found


def depends(field: Field, element: Element, known: Sequence[Element]) -> bool:
    """Whether an element is a rational combination of others."""
    every = relations(field, [[value] for value in (*known, element)])
    return any(len(known) in row for row in every)


def _coordinates(field: Field, vectors: Sequence[Sequence[Element]]) -> list[dict[Any, fmpq]]:
    """For each vector its coefficients, by row and monomial."""
    columns: list[dict[Any, fmpq]] = [{} for _ in vectors]
    for row in range(len(vectors[0]) if vectors else 0):
        common: Any = ()
        for vector in vectors:
            common = field.lcm(common, vector[row]._den)
        for column, vector in zip(columns, vectors, strict=True):
            entry = vector[row]
            poly = field.reduced(field.lift(entry) * field.cofactor(common, entry._den))
            for monomial, value in poly.to_dict().items():
                column[row, tuple(monomial)] = value
    return columns


def _fraction(value: fmpq) -> Fraction:
    return Fraction(int(value.p), int(value.q))


def _whole(row: Row) -> Row:
    """The same relation in whole numbers, the first one positive."""
    scale = lcm(*(value.denominator for value in row.values()))
    sign = 1 if row[min(row)] > 0 else -1
    return {j: row[j] * scale * sign for j in sorted(row)}
