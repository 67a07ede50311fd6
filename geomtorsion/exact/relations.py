"""Relations: rows of exact elements that depend on others, and sums of elements that vanish."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from flint import fmpq_mat

from geomtorsion.exact.element import Element
from geomtorsion.exact.points import roomy_point_of

if TYPE_CHECKING:
    from geomtorsion.exact.field import Field

# One linear equation with rational coefficients: pairs (unknown, coefficient).
Condition = tuple[tuple[int, Any], ...]


class Echelon:
    """Independent rows of elements, found by their values at a random point modulo a prime.

    Rows that are independent at the point are independent; dependent ones are so up to a chance
    below 1e-70, as for a zero found modulo a prime (see `Certainty`).

    field: the exact field of the rows. width: the number of entries of a row.

    Examples
    --------
    >>> import sympy
    >>> from geomtorsion.exact import Echelon, Field
    >>> x, y = sympy.symbols("x y")
    >>> field = Field([x, y])
    >>> rows = [[field.read(e) for e in row] for row in ([x, y], [x**2, x * y], [1, 1])]
    >>> echelon = Echelon(field, 2)
    >>> [echelon.add(row) for row in rows], echelon.rank
    ([True, False, True], 2)
    """

    def __init__(self, field: Field, width: int) -> None:
        self.field = field
        self.width = width
        self.rows: list[list[Element]] = []

    @property
    def rank(self) -> int:
        """The number of independent rows."""
        return len(self.rows)

    def add(self, row: Sequence[Element]) -> bool:
        """Add a row if it is independent of the rows so far; whether it was added."""
        return bool(self.extend([row]))

    def extend(self, rows: Iterable[Sequence[Element]]) -> list[list[Element]]:
        """Add the rows that are independent of the rows so far and of each other; return them."""
        zero = self.field.zero
        new = [list(row) for row in rows if any(x is not zero for x in row)]
        if not new or self.rank == self.width:
            return []
        every = self.rows + new
        # One place for all: rows from two places cannot be compared.
        images = roomy_point_of(self.field).images([x for row in every for x in row])
        table = [images[k : k + self.width] for k in range(0, len(images), self.width)]
        chosen = [every[k] for k in _independent(table)]
        added = chosen[self.rank :]
        self.rows = chosen
        return added

    def rank_of_columns(self, columns: Sequence[int]) -> int:
        """Rank of some columns of the rows."""
        if not self.rows:
            return 0
        images = roomy_point_of(self.field).images([row[k] for row in self.rows for k in columns])
        n = len(columns)
        return len(_independent([images[k : k + n] for k in range(0, len(images), n)]))


def _independent(table: Sequence[Sequence[Any]]) -> list[int]:
    """Numbers of the rows that do not depend on earlier ones, by elimination."""
    pivots: list[tuple[int, list[Any]]] = []
    numbers = []
    for number, original in enumerate(table):
        row = list(original)
        for column, pivot in pivots:
            if row[column] != 0:
                factor = row[column]
                row = [x - factor * y for x, y in zip(row, pivot, strict=True)]
        column = next((k for k, x in enumerate(row) if x != 0), None)
        if column is not None:
            inverse = row[column] ** -1
            pivots.append((column, [x * inverse for x in row]))
            numbers.append(number)
    return numbers


def vanishing_sums(equations: Iterable[Sequence[Element]], width: int) -> list[list[Fraction]]:
    """Rational c with sum_k c_k equation[k] = 0 for all equations: a basis of these c.

    Each equation is brought over one denominator, and every monomial of its numerator gives one
    linear equation. Lazy elements are multiplied out first (see `Field.whole`).

    Examples
    --------
    >>> import sympy
    >>> from geomtorsion.exact import Field, vanishing_sums
    >>> x, y = sympy.symbols("x y")
    >>> field = Field([x, y])
    >>> one = [field.read(e) for e in (sympy.sin(x) ** 2, sympy.cos(x) ** 2, x / y, 2 + 0 * x)]
    >>> [[str(c) for c in found] for found in vanishing_sums([one], 4)]
    [['-2', '-2', '0', '1']]
    """
    rows: dict[Condition, None] = {}
    for equation in equations:
        for row in _by_monomials(equation):
            # Scaled so that equal conditions are met once.
            first = row[0][1]
            rows[tuple((k, x / first) for k, x in row)] = None
    basis: dict[int, list[Fraction]] = {}
    for unknowns, conditions in _blocks(list(rows), width):
        basis |= _kernel(unknowns, conditions, width)
    return [basis[free] for free in sorted(basis)]


def _blocks(rows: Sequence[Condition], width: int) -> list[tuple[list[int], list[Condition]]]:
    """Unknowns that share conditions, directly or through others, with these conditions."""
    block = list(range(width))

    def root(k: int) -> int:
        while block[k] != k:
            k = block[k]
        return k

    for row in rows:
        for k, _ in row:
            one, two = root(row[0][0]), root(k)
            block[max(one, two)] = min(one, two)
    every: dict[int, tuple[list[int], list[Condition]]] = {}
    for k in range(width):
        every.setdefault(root(k), ([], []))[0].append(k)
    for row in rows:
        every[root(row[0][0])][1].append(row)
    return list(every.values())


def _kernel(
    unknowns: Sequence[int], conditions: Sequence[Condition], width: int
) -> dict[int, list[Fraction]]:
    """Solutions in some of the unknowns, each by the number of the unknown that is free in it."""
    places = {k: place for place, k in enumerate(unknowns)}
    matrix = fmpq_mat(len(conditions), len(unknowns))
    for i, row in enumerate(conditions):
        for k, value in row:
            matrix[i, places[k]] = value
    reduced, rank = matrix.rref()
    pivots: list[int] = []
    for i in range(rank):
        start = pivots[-1] + 1 if pivots else 0
        pivots.append(next(k for k in range(start, len(unknowns)) if reduced[i, k] != 0))
    solutions = {}
    for place in sorted(set(range(len(unknowns))) - set(pivots)):
        solution = [Fraction(0)] * width
        solution[unknowns[place]] = Fraction(1)
        for i, pivot in enumerate(pivots):
            value = -reduced[i, place]
            solution[unknowns[pivot]] = Fraction(int(value.p), int(value.q))
        solutions[unknowns[place]] = solution
    return solutions


def _by_monomials(equation: Sequence[Element]) -> list[list[tuple[int, Any]]]:
    """The linear equations that one equation consists of: pairs (unknown, coefficient)."""
    filled: list[tuple[int, Any]] = []
    for k, value in enumerate(equation):
        whole: Any = value.field.whole(value) if value.is_kept else value
        if whole._num:
            filled.append((k, whole))
    if not filled:
        return []
    field = filled[0][1].field
    common: Any = ()
    for _, value in filled:
        common = field.lcm(common, value._den)
    equations: dict[Any, list[tuple[int, Any]]] = {}
    for k, value in filled:
        numerator = field.lift(value)
        if value._den != common:
            numerator = field.reduced(numerator * field.cofactor(common, value._den))
        for monomial, coefficient in numerator.to_dict().items():
            equations.setdefault(monomial, []).append((k, coefficient))
    return list(equations.values())
