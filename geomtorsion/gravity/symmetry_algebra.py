"""Symmetry algebra: the brackets of all symmetries, from their values at one point."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

from geomtorsion.errors import UndecidedError
from geomtorsion.exact import Echelon, Element, Reduced, Specialization, reduced
from geomtorsion.geometry import Brackets, Frame, LieAlgebra, levi_civita

# Largest denominators of the values at the point; the first where all is regular is taken.
LARGEST = (4, 16, 64, 256)

Row = list[Element]


@dataclass(frozen=True, eq=False)
class AtPoint:
    """The conditions on (xi^a, F_bc = D_b xi_c), b < c, at one point near the generic point.

    frame: the frame of the metric.
    place: the point.
    conditions: their values there.
    """

    frame: Frame
    place: Specialization
    conditions: Reduced

    @cached_property
    def algebra(self) -> LieAlgebra:
        """The algebra with the basis that is 1 in one free unknown and 0 in the others."""
        return _algebra(self.frame, self.place, self.conditions)

    def components(self, values: Sequence[Element]) -> list[Element]:
        """Components in this basis of a symmetry with values (xi^a, F_bc)."""
        return [self.place(values[k]) for k in self.conditions.free]

    def basis(self, fields: Sequence[Sequence[Element]]) -> list[list[Element]] | None:
        """Components of fields with values (xi^a, F_bc); None where they depend on each other."""
        rows = [self.components(values) for values in fields]
        rank = reduced(self.place.field, rows, self.algebra.dimension).rank
        return rows if rank == len(rows) else None

    def missing(self, fields: Sequence[Sequence[Element]]) -> tuple[int, ...]:
        """Numbers of the basis elements that complete fields with values (xi^a, F_bc)."""
        rows = [self.components(values) for values in fields]
        return reduced(self.place.field, rows, self.algebra.dimension).free


def points(frame: Frame, conditions: Echelon) -> Iterator[AtPoint]:
    """Points where all is regular and the rank of the conditions is the generic one.

    Raises
    ------
    UndecidedError
        All points have been used.
    """
    for largest in LARGEST:
        place = Specialization(frame.field, frame.coordinates, largest)
        try:
            rows = [place.all(row) for row in conditions.rows]
            values = reduced(place.field, rows, conditions.width)
            if values.rank == conditions.rank:
                yield AtPoint(frame, place, values)
        except ZeroDivisionError:
            continue
    raise UndecidedError(
        "expected a point at which the conditions on the symmetries are regular, got none. State "
        "the domain of the frame, as numerical bounds of each coordinate."
    )


def _algebra(frame: Frame, place: Specialization, conditions: Reduced) -> LieAlgebra:
    """Brackets of the symmetries with the values that the conditions leave free.

    zeta^a = xi^m F'_m^a - xi'^m F_m^a
    D_b zeta_c = F_b^m F'_mc - F'_b^m F_mc + (xi^m xi'^d - xi'^m xi^d) R_mcbd
    """
    n, field = frame.dimension, place.field
    basis, free = conditions.kernel(), conditions.free
    inverse = _values(place, frame.inverse_metric.components.nonzero)
    riemann = {}
    if n > 1:
        curvature = levi_civita(frame).curvature.lower.components
        riemann = _values(place, curvature.nonzero)
    turns = list(combinations(range(n), 2))
    forms = [_turns(field, vector[n:], turns, n) for vector in basis]
    raised = [
        [
            [
                field.sum([(1, F[b][c], inverse[c, m]) for c in range(n) if (c, m) in inverse])
                for m in range(n)
            ]
            for b in range(n)
        ]
        for F in forms
    ]
    table = {}
    for i, j in combinations(range(len(basis)), 2):
        x, y, F, G, U, V = basis[i], basis[j], forms[i], forms[j], raised[i], raised[j]
        wanted = {}
        for place_of_unknown in free:
            if place_of_unknown < n:
                a = place_of_unknown
                terms = [t for m in range(n) for t in ((1, x[m], V[m][a]), (-1, y[m], U[m][a]))]
            else:
                b, c = turns[place_of_unknown - n]
                terms = [
                    t for m in range(n) for t in ((1, U[b][m], G[m][c]), (-1, V[b][m], F[m][c]))
                ]
                for m in range(n):
                    for d in range(n):
                        curved = riemann.get((m, c, b, d))
                        if curved is not None:
                            terms += [(1, x[m], y[d], curved), (-1, y[m], x[d], curved)]
            wanted[place_of_unknown] = field.sum(terms)
        table[i, j] = [wanted[k] for k in free]
    return LieAlgebra.of(Brackets.of(field, len(basis), table))


def _values(
    place: Specialization, components: Mapping[tuple[int, ...], Element]
) -> dict[tuple[int, ...], Element]:
    return {index: place(x) for index, x in components.items()}


def _turns(
    field, entries: Sequence[Element], turns: Sequence[tuple[int, int]], n: int
) -> list[Row]:
    """F_bc from its entries with b < c."""
    rows = [[field.zero] * n for _ in range(n)]
    for (b, c), x in zip(turns, entries, strict=True):
        rows[b][c], rows[c][b] = x, -x
    return rows
