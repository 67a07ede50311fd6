"""Relations: rational combinations of elements that vanish, by exact linear algebra."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import lcm
from typing import TYPE_CHECKING

from geomtorsion.exact import vanishing_sums

if TYPE_CHECKING:
    from geomtorsion.exact import Element

Row = dict[int, Fraction]


def relations(vectors: Sequence[Sequence[Element]]) -> list[Row]:
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
    >>> relations([[field.read(value)] for value in values])
    [{0: Fraction(2, 1), 1: Fraction(2, 1), 3: Fraction(-1, 1)}]
    """
    equations = list(zip(*vectors, strict=True))
    return [
        _whole({j: q for j, q in enumerate(row) if q})
        for row in vanishing_sums(equations, len(vectors))
    ]


def depends(element: Element, known: Sequence[Element]) -> bool:
    """Whether an element is a rational combination of others."""
    every = relations([[value] for value in (*known, element)])
    return any(len(known) in row for row in every)


def _whole(row: Row) -> Row:
    """The same relation in whole numbers, the first one positive."""
    scale = lcm(*(value.denominator for value in row.values()))
    sign = 1 if row[min(row)] > 0 else -1
    return {j: row[j] * scale * sign for j in sorted(row)}
