"""Relations: rational combinations of elements that vanish, by exact linear algebra."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from math import lcm
from typing import TYPE_CHECKING, Any

from flint import fmpq, fmpq_mat

if TYPE_CHECKING:
    from geomtorsion.exact import Element, Field

Row = dict[int, Fraction]
# The row of a vector, and a monomial in it.
Key = tuple[int, tuple[int, ...]]
Column = dict[Key, fmpq]


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
    found = [row for block in _blocks(columns) for row in _kernel(columns, block)]
    return sorted(found, key=max)


def _blocks(columns: Sequence[Column]) -> list[list[int]]:
    """Numbers of the columns, those together that share a row, directly or through others."""
    owner: dict[Key, int] = {}
    block = list(range(len(columns)))

    def root(j: int) -> int:
        while block[j] != j:
            j = block[j]
        return j

    for j, column in enumerate(columns):
        for key in column:
            one, two = root(owner.setdefault(key, j)), root(j)
            block[max(one, two)] = min(one, two)
    every: dict[int, list[int]] = {}
    for j in range(len(columns)):
        every.setdefault(root(j), []).append(j)
    return list(every.values())


def _kernel(columns: Sequence[Column], block: Sequence[int]) -> Iterator[Row]:
    """The relations between some columns, as {number: whole number}."""
    rows: dict[Key, dict[int, fmpq]] = {}
    for place, j in enumerate(block):
        for key, value in columns[j].items():
            rows.setdefault(key, {})[place] = value
    # Most rows are multiples of a few: each is taken once, divided by its first entry.
    scaled = dict.fromkeys(
        tuple((place, value / next(iter(row.values()))) for place, value in row.items())
        for row in rows.values()
    )
    entries = [fmpq(0)] * (len(scaled) * len(block))
    for r, row in enumerate(scaled):
        for place, value in row:
            entries[r * len(block) + place] = value
    reduced, rank = fmpq_mat(len(scaled), len(block), entries).rref()
    pivots = [next(j for j in range(len(block)) if reduced[r, j] != 0) for r in range(rank)]
    for free in sorted(set(range(len(block))) - set(pivots)):
        found: Row = {block[free]: Fraction(1)}
        for r, pivot in enumerate(pivots):
            if reduced[r, free] != 0:
                found[block[pivot]] = -_fraction(reduced[r, free])
        yield _whole(found)


def depends(field: Field, element: Element, known: Sequence[Element]) -> bool:
    """Whether an element is a rational combination of others."""
    every = relations(field, [[value] for value in (*known, element)])
    return any(len(known) in row for row in every)


def _coordinates(field: Field, vectors: Sequence[Sequence[Element]]) -> list[Column]:
    """For each vector its coefficients, by row and monomial."""
    columns: list[Column] = [{} for _ in vectors]
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
