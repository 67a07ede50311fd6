"""Linear: dependence of elements over the rationals."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flint import fmpq, fmpq_mat

if TYPE_CHECKING:
    from collections.abc import Sequence

    from geomtorsion.exact.element import Denominator, Element
    from geomtorsion.exact.field import Field


def express(
    field: Field, target: Sequence[Element], basis: Sequence[Sequence[Element]]
) -> list[fmpq] | None:
    """Rational q_j with target = sum q_j basis_j (row by row), or None.

    Each vector is a sequence of elements; all have one length.  Monomials over a common
    denominator are independent, so this is linear algebra on their coefficients.
    """
    columns = [dict[tuple[int, tuple[int, ...]], fmpq]() for _ in range(len(basis) + 1)]
    for row in range(len(target)):
        entries = [vector[row] for vector in basis] + [target[row]]
        common: Denominator = ()
        for entry in entries:
            common = field.lcm(common, entry._den)
        for column, entry in zip(columns, entries, strict=True):
            poly = field.lift(entry) * field.cofactor(common, entry._den)
            for monomial, value in field.reduced(poly).to_dict().items():
                column[row, tuple(monomial)] = value
    keys = sorted({key for column in columns for key in column})
    if not keys:
        return [fmpq(0)] * len(basis)
    matrix = fmpq_mat(
        len(keys), len(columns), [c.get(key, fmpq(0)) for key in keys for c in columns]
    )
    reduced, rank = matrix.rref()
    last = len(basis)
    answer = [fmpq(0)] * last
    for row in range(rank):
        pivot = next(j for j in range(last + 1) if reduced[row, j] != 0)
        if pivot == last:
            return None
        answer[pivot] = reduced[row, last]
    return answer
