"""Linear algebra: rows of exact elements reduced, their kernels, and signs of quadratic forms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import fmpq, fmpq_mat

from geomtorsion.errors import UndecidedError
from geomtorsion.exact.element import Element
from geomtorsion.exact.field import Field

Row = list[Element]


@dataclass(frozen=True)
class Reduced:
    """Independent rows in reduced echelon form.

    rows: each has 1 in its own pivot column and 0 in the pivot columns of the others.
    pivots: the pivot columns, ascending.
    width: the number of entries of a row.
    field: the field of the entries.

    Examples
    --------
    >>> from geomtorsion.exact import Field
    >>> from geomtorsion.exact.linear import reduced
    >>> field = Field([])
    >>> rows = reduced(field, [[field.rational(x) for x in (1, 2, 4)]], 3)
    >>> rows.pivots, [[str(x) for x in row] for row in rows.kernel()]
    ((0,), [['-2', '1', '0'], ['-4', '0', '1']])
    """

    rows: tuple[Row, ...]
    pivots: tuple[int, ...]
    width: int
    field: Field

    @property
    def rank(self) -> int:
        """The number of independent rows."""
        return len(self.rows)

    @property
    def free(self) -> tuple[int, ...]:
        """The columns that are not pivots."""
        return tuple(k for k in range(self.width) if k not in self.pivots)

    def kernel(self) -> list[Row]:
        """Vectors that all rows annihilate, each with 1 in one of the free columns."""
        basis = []
        for column in self.free:
            vector = [self.field.zero] * self.width
            vector[column] = self.field.one
            for row, pivot in zip(self.rows, self.pivots, strict=True):
                vector[pivot] = -row[column]
            basis.append(vector)
        return basis

    def rest(self, vector: Sequence[Element]) -> Row:
        """A vector minus the sum of rows that agrees with it in the pivot columns."""
        weights = [vector[pivot] for pivot in self.pivots]
        return [
            self.field.sum(
                [(1, x), *((-1, w, row[k]) for w, row in zip(weights, self.rows, strict=True))]
            )
            for k, x in enumerate(vector)
        ]


def reduced(field: Field, rows: Sequence[Sequence[Element]], width: int) -> Reduced:
    """Reduced echelon form of rows, by exact elimination; see `Reduced` for an example.

    Raises
    ------
    UndecidedError
        It cannot be decided whether an entry vanishes.
    """
    if all(x.is_rational for row in rows for x in row):
        return _reduced_numbers(field, rows, width)
    left = [list(row) for row in rows]
    chosen: list[Row] = []
    pivots: list[int] = []
    for column in range(width):
        candidates = [row for row in left if not vanishes(row[column])]
        if not candidates:
            continue
        # The shortest pivot makes the shortest quotients.
        pivot = min(candidates, key=lambda row: row[column].length)
        left = [row for row in left if row is not pivot]
        inverse = pivot[column].inverse()
        pivot = [x * inverse for x in pivot]
        left = [_cleared(field, row, pivot, column) for row in left]
        chosen = [_cleared(field, row, pivot, column) for row in chosen]
        chosen.append(pivot)
        pivots.append(column)
    return Reduced(tuple(chosen), tuple(pivots), width, field)


def _cleared(field: Field, row: Row, pivot: Row, column: int) -> Row:
    """A row minus the multiple of the pivot row that has the same entry in a column."""
    factor = row[column]
    if vanishes(factor):
        return row
    return [field.sum([(1, x), (-1, factor, y)]) for x, y in zip(row, pivot, strict=True)]


def _reduced_numbers(field: Field, rows: Sequence[Sequence[Element]], width: int) -> Reduced:
    """The reduced form of rational rows."""
    matrix = fmpq_mat(len(rows), width)
    for i, row in enumerate(rows):
        for k, x in enumerate(row):
            if not x.is_zero:
                value = x.as_fraction()
                matrix[i, k] = fmpq(value.numerator, value.denominator)
    form, rank = matrix.rref()
    chosen, pivots = [], []
    for i in range(rank):
        start = pivots[-1] + 1 if pivots else 0
        pivots.append(next(k for k in range(start, width) if form[i, k] != 0))
        chosen.append([field.rational(form[i, k]) for k in range(width)])
    return Reduced(tuple(chosen), tuple(pivots), width, field)


def vanishes(x: Element) -> bool:
    """Whether an element is zero.

    Raises
    ------
    UndecidedError
        It cannot be decided.
    """
    verdict = x.is_zero
    if verdict is None:
        raise UndecidedError(
            f"whether {x} vanishes cannot be decided exactly: functions occur whose relations are "
            "not known. Give numbers for the parameters in them."
        )
    return verdict


def sign(field: Field, x: Element) -> int:
    """The sign of an element, at the sample values of the symbols."""
    if vanishes(x):
        return 0
    value = x.as_fraction() if x.is_rational else field.sample.value(x)
    return 1 if value > 0 else -1


def signature(field: Field, form: Sequence[Sequence[Element]]) -> tuple[int, int, int]:
    """How many squares of a symmetric form are positive, negative and zero (Sylvester).

    The signs hold at the sample values of the symbols, the number of zeros for generic values.

    Examples
    --------
    >>> from geomtorsion.exact import Field
    >>> from geomtorsion.exact.linear import signature
    >>> field = Field([])
    >>> signature(field, [[field.rational(x) for x in row] for row in ([0, 1], [1, 0])])
    (1, 1, 0)
    """
    signs = [sign(field, x) for x in squares(field, form)]
    positive = signs.count(1)
    return positive, len(signs) - positive, len(form) - len(signs)


def squares(field: Field, form: Sequence[Sequence[Element]]) -> list[Element]:
    """Coefficients of a symmetric form as a sum of squares (Lagrange), without zeros."""
    rows = [list(row) for row in form]
    coefficients: list[Element] = []
    while rows:
        n = len(rows)
        k = next((k for k in range(n) if not vanishes(rows[k][k])), None)
        if k is None:
            pair = next(
                ((i, j) for i in range(n) for j in range(i) if not vanishes(rows[i][j])), None
            )
            if pair is None:
                break
            # The square of x_i + x_j has the coefficient 2 form_ij.
            i, k = pair
            for j in range(n):
                rows[k][j] = rows[k][j] + rows[i][j]
            for j in range(n):
                rows[j][k] = rows[j][k] + rows[j][i]
        pivot = rows[k]
        coefficients.append(pivot[k])
        inverse = pivot[k].inverse()
        others = [j for j in range(n) if j != k]
        rows = [
            [field.sum([(1, rows[i][j]), (-1, pivot[i], pivot[j], inverse)]) for j in others]
            for i in others
        ]
    return coefficients
