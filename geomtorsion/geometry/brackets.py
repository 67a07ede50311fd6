"""Brackets: the exact linear algebra of structure constants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

from geomtorsion.exact import Element, Field, Reduced, reduced, signature, vanishes
from geomtorsion.support.caching import cached_property

Vector = list[Element]
# [X_i, X_j] for i < j, as components.
Table = Mapping[tuple[int, int], Vector]


@dataclass(frozen=True, eq=False)
class Brackets:
    """Brackets of basis elements X_0, X_1, ... that satisfy the Jacobi identity.

    field: the field of the structure constants.
    dimension: the number of basis elements.
    table: (i, j) -> components of [X_i, X_j] for i < j; pairs that commute are omitted.
    """

    field: Field
    dimension: int
    table: Table

    @classmethod
    def of(cls, field: Field, dimension: int, table: Table) -> Brackets:
        """Brackets, without vanishing ones."""
        rows = {pair: row for pair, row in table.items() if not all(vanishes(x) for x in row)}
        return cls(field, dimension, rows)

    def constant(self, i: int, j: int) -> Vector:
        """[X_i, X_j], all components."""
        if (i, j) in self.table:
            return self.table[i, j]
        if (j, i) in self.table:
            return [-x for x in self.table[j, i]]
        return [self.field.zero] * self.dimension

    def bracket(self, first: Vector, second: Vector) -> Vector:
        """Components of [first, second]."""
        zero = self.field.zero
        terms: list[list] = [[] for _ in range(self.dimension)]
        for (i, j), row in self.table.items():
            for sign, a, b in ((1, first[i], second[j]), (-1, first[j], second[i])):
                if a is zero or b is zero:
                    continue
                for k, x in enumerate(row):
                    if x is not zero:
                        terms[k].append((sign, a, b, x))
        return [self.field.sum(own) if own else zero for own in terms]

    def span(self, rows: Sequence[Vector]) -> Reduced:
        """The span of vectors."""
        return reduced(self.field, rows, self.dimension)

    def unit(self, k: int) -> Vector:
        """X_k, as components."""
        zero, one = self.field.zero, self.field.one
        return [one if k == j else zero for j in range(self.dimension)]

    @cached_property
    def derived(self) -> tuple[Reduced, ...]:
        """The derived series, without the algebra itself."""
        series = [self.span(list(self.table.values()))]
        rank = self.dimension
        while 0 < series[-1].rank < rank:
            rank = series[-1].rank
            pairs = combinations(series[-1].rows, 2)
            series.append(self.span([self.bracket(a, b) for a, b in pairs]))
        return tuple(series)

    @cached_property
    def center(self) -> list[Vector]:
        """A basis of the centre."""
        n = range(self.dimension)
        rows = []
        for j in n:
            columns = [self.constant(i, j) for i in n]
            rows += [[column[k] for column in columns] for k in n]
        return self.span(rows).kernel()

    @cached_property
    def killing(self) -> list[Vector]:
        """K_ij = C_im^k C_jk^m."""
        n = range(self.dimension)
        # ad[i] has the entries C_im^k that do not vanish.
        ad = [
            {(m, k): x for m in n for k, x in enumerate(self.constant(i, m)) if not vanishes(x)}
            for i in n
        ]
        rows = [[self.field.zero] * self.dimension for _ in n]
        for i in n:
            for j in range(i, self.dimension):
                terms = [(1, x, ad[j][k, m]) for (m, k), x in ad[i].items() if (k, m) in ad[j]]
                rows[i][j] = rows[j][i] = self.field.sum(terms) if terms else self.field.zero
        return rows

    @cached_property
    def radical(self) -> Reduced:
        """The largest solvable ideal, orthogonal to [g, g] by the Killing form."""
        zero = self.field.zero
        rows = [
            [
                self.field.sum(
                    [(1, x, self.killing[k][i]) for k, x in enumerate(row) if x is not zero]
                )
                for i in range(self.dimension)
            ]
            for row in self.derived[0].rows
        ]
        return self.span(self.span(rows).kernel())

    def quotient(self, ideal: Reduced) -> Brackets:
        """Quotient by an ideal, with the basis elements without a pivot of the ideal."""
        places = ideal.free
        table = {
            (a, b): [ideal.rest(self.constant(i, j))[k] for k in places]
            for (a, i), (b, j) in combinations(enumerate(places), 2)
        }
        return Brackets.of(self.field, len(places), table)

    def in_basis(self, basis: Sequence[Vector]) -> Brackets:
        """The brackets of other basis elements, from their components, one row each."""
        n = range(self.dimension)
        rows = [[*row, *self.unit(i)] for i, row in enumerate(basis)]
        inverse = [row[self.dimension :] for row in reduced(self.field, rows, 2 * len(n)).rows]
        table = {}
        for i, j in combinations(n, 2):
            value = self.bracket(basis[i], basis[j])
            table[i, j] = [self.field.sum([(1, value[m], inverse[m][k]) for m in n]) for k in n]
        return Brackets.of(self.field, self.dimension, table)

    def subalgebra(self, span: Reduced) -> Brackets:
        """The brackets of the rows of a subalgebra."""
        table = {
            (i, j): [self.bracket(a, b)[k] for k in span.pivots]
            for (i, a), (j, b) in combinations(enumerate(span.rows), 2)
        }
        return Brackets.of(self.field, span.rank, table)

    @cached_property
    def signature(self) -> tuple[int, int, int]:
        """How many squares of the Killing form are positive, negative and zero."""
        return signature(self.field, self.killing)

    @cached_property
    def lower_central(self) -> tuple[int, ...]:
        """Dimensions of g, [g, g], [g, [g, g]], ... until they no longer fall."""
        dims, ideal = [self.dimension], self.derived[0]
        units = [self.unit(k) for k in range(self.dimension)]
        while 0 < ideal.rank < dims[-1]:
            dims.append(ideal.rank)
            ideal = self.span([self.bracket(x, y) for x in units for y in ideal.rows])
        return falling([*dims, ideal.rank])

    @cached_property
    def derived_dimensions(self) -> tuple[int, ...]:
        """Dimensions of g, [g, g], [[g, g], [g, g]], ... until they no longer fall."""
        return falling([self.dimension, *(one.rank for one in self.derived)])


def falling(dims: Sequence[int]) -> tuple[int, ...]:
    """Dimensions without a repeated last one."""
    return tuple(d for k, d in enumerate(dims) if k == 0 or d < dims[k - 1])
