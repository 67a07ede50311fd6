"""Solving: linear equations by cofactors, kept as quotients so that nothing must be inverted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from geomtorsion.geometry.matrices import blocks, determinant

if TYPE_CHECKING:
    from geomtorsion.exact import Element, Field

Matrix = Mapping[tuple[int, int], "Element"]
Quotient = tuple["Element", "Element"]


def quotients(field: Field, matrix: Matrix, right: Sequence[Element]) -> list[Quotient]:
    """x_i = above_i / below_i with M x = right, for a symmetric regular matrix, block by block.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.exact import Field
    >>> a, b = sp.symbols("a b")
    >>> field = Field([a, b])
    >>> matrix = {(0, 0): field.read(a), (0, 1): field.one}
    >>> matrix |= {(1, 0): field.one, (1, 1): field.read(b)}
    >>> quotients(field, matrix, [field.one, field.zero])
    [(Element(b), Element(a*b - 1)), (Element(-1), Element(a*b - 1))]
    """
    n = len(right)
    found: dict[int, Quotient] = {}
    for rows, columns in blocks(matrix, n):
        if len(rows) == 1:
            found[columns[0]] = (right[rows[0]], matrix[rows[0], columns[0]])
            continue
        size = len(rows)
        terms: list[list] = [[] for _ in rows]
        whole: list = []
        for r, row in enumerate(rows):
            for c, column in enumerate(columns):
                others = _part(matrix, rows[:r] + rows[r + 1 :], columns[:c] + columns[c + 1 :])
                cofactor = determinant(field, others, size - 1)
                sign = -1 if (r + c) % 2 else 1
                terms[c].append((sign, cofactor, right[row]))
                if r == 0 and (row, column) in matrix:
                    whole.append((sign, cofactor, matrix[row, column]))
        below = field.sum(whole)
        for c, column in enumerate(columns):
            found[column] = (field.sum(terms[c]), below)
    return [found[i] for i in range(n)]


def _part(
    matrix: Matrix, rows: Sequence[int], columns: Sequence[int]
) -> dict[tuple[int, int], Element]:
    """The matrix of some rows and columns, numbered anew."""
    return {
        (r, c): matrix[row, column]
        for r, row in enumerate(rows)
        for c, column in enumerate(columns)
        if (row, column) in matrix
    }
