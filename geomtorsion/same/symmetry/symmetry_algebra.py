"""Symmetry algebra: the brackets of all symmetries, from their values at one point."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

from geomtorsion.errors import UndecidedError
from geomtorsion.exact import Element, Reduced, Specialization, reduced
from geomtorsion.geometry import Brackets, LieAlgebra, Tensor, levi_civita
from geomtorsion.same.symmetry.symmetry_conditions import Conditions

Row = list[Element]


@dataclass(frozen=True, eq=False)
class AtPoint:
    """The conditions on the values of symmetries at one point near the generic point.

    functions: the conditions as functions of the point.
    place: the point.
    conditions: their values there.
    """

    functions: Conditions
    place: Specialization
    conditions: Reduced

    @cached_property
    def algebra(self) -> LieAlgebra:
        """The algebra with the basis that is 1 in one free unknown and 0 in the others."""
        return _algebra(self.functions, self.place, self.conditions)

    def components(self, values: Sequence[Element]) -> list[Element]:
        """Components in this basis of a symmetry with these values."""
        return [self.place(values[k]) for k in self.conditions.free]

    def basis(self, fields: Sequence[Sequence[Element]]) -> list[list[Element]] | None:
        """Components of fields with these values; None where they depend on each other."""
        rows = [self.components(values) for values in fields]
        rank = reduced(self.place.field, rows, self.algebra.dimension).rank
        return rows if rank == len(rows) else None

    def missing(self, fields: Sequence[Sequence[Element]]) -> tuple[int, ...]:
        """Numbers of the basis elements that complete fields with these values."""
        rows = [self.components(values) for values in fields]
        return reduced(self.place.field, rows, self.algebra.dimension).free


def points(conditions: Conditions) -> Iterator[AtPoint]:
    """Points where all is regular and the rank of the conditions is the generic one.

    Raises
    ------
    UndecidedError
        All points have been used.
    """
    frame, (_, echelon) = conditions.frame, conditions.echelons
    region, q = frame.region, frame.coordinates
    for place in Specialization.nearer(frame.field, q, region.point, region.surrounds):
        try:
            rows = [place.all(row) for row in echelon.rows]
            values = reduced(place.field, rows, echelon.width)
            if values.rank == echelon.rank:
                yield AtPoint(conditions, place, values)
        except ZeroDivisionError:
            continue
    raise UndecidedError(
        "expected a point at which the conditions on the symmetries are regular, got none in the "
        f"region {region}. Declare a part of it: domain=[...]."
    )


@dataclass(frozen=True, eq=False)
class Values:
    """The values of one symmetry at a point.

    xi: xi^a. F: F_bc for all b, c. raised: F_b^m. phi: D_a xi^a / n. k: D_a phi.
    """

    xi: Row
    F: list[Row]
    raised: list[Row]
    phi: Element
    k: Row


def _algebra(
    conditions: Conditions, place: Specialization, reduced_conditions: Reduced
) -> LieAlgebra:
    """Brackets of the symmetries with the values that the conditions leave free.

    zeta^a = xi^m D_m xi'^a - xi'^m D_m xi^a,  D_a xi_b = F_ab + phi g_ab
    F''_bc = F_b^m F'_mc - F'_b^m F_mc + (xi^m xi'^d - xi'^m xi^d) R_mcbd
             + xi_c k'_b - xi_b k'_c - xi'_c k_b + xi'_b k_c
    phi'' = xi^m k'_m - xi'^m k_m
    k''_a = D_a xi^m k'_m - xi^m (L_xi' P)_am - D_a xi'^m k_m + xi'^m (L_xi P)_am
    """
    frame, field = conditions.frame, place.field
    n, turns, free = frame.dimension, conditions.turns, reduced_conditions.free
    end = n + len(turns)
    bar = levi_civita(frame)
    inverse = _values(place, frame.inverse_metric)
    g = _values(place, frame.metric)
    riemann = _values(place, bar.curvature.lower) if n > 1 else {}
    schouten, slope = {}, {}
    if conditions.scaling == 2:
        schouten = _values(place, bar.curvature.schouten)
        slope = _values(place, bar.covariant_derivative(bar.curvature.schouten))

    def split(vector: Row) -> Values:
        F = [[field.zero] * n for _ in range(n)]
        for (b, c), x in zip(turns, vector[n:end], strict=True):
            F[b][c], F[c][b] = x, -x
        raised = [
            [
                field.sum([(1, F[b][c], inverse[c, m]) for c in range(n) if (c, m) in inverse])
                for m in range(n)
            ]
            for b in range(n)
        ]
        phi = vector[end] if conditions.scaling else field.zero
        k = vector[end + 1 :] if conditions.scaling == 2 else [field.zero] * n
        return Values(vector[:n], F, raised, phi, k)

    def half(v: Values, w: Values, unknown: int) -> list[tuple]:
        """The terms of one component of the bracket; minus those with v and w exchanged."""
        if unknown < n:
            terms = [(1, v.xi[m], w.raised[m][unknown]) for m in range(n)]
            return [*terms, (1, v.xi[unknown], w.phi)]
        if unknown < end:
            b, c = turns[unknown - n]
            terms = [(1, v.raised[b][m], w.F[m][c]) for m in range(n)]
            terms += [
                (1, v.xi[m], w.xi[d], x) for (m, i, j, d), x in riemann.items() if (i, j) == (c, b)
            ]
            for m in range(n):
                if (c, m) in g:
                    terms.append((1, g[c, m], v.xi[m], w.k[b]))
                if (b, m) in g:
                    terms.append((-1, g[b, m], v.xi[m], w.k[c]))
            return terms
        if unknown == end:
            return [(1, v.xi[m], w.k[m]) for m in range(n)]
        a = unknown - end - 1
        terms = [(1, v.raised[a][m], w.k[m]) for m in range(n)] + [(1, v.phi, w.k[a])]
        terms += [(-1, v.xi[m], w.xi[c], x) for (c, i, m), x in slope.items() if i == a]
        for (i, j), x in schouten.items():
            # xi^m (P_lm D_a xi'^l + P_al D_m xi'^l)
            terms.append((-1, v.xi[j], x, w.raised[a][i]))
            if i == a:
                terms += [(-1, v.xi[m], x, w.raised[m][j]) for m in range(n)]
                terms.append((-2, v.xi[j], x, w.phi))
        return terms

    basis = [split(vector) for vector in reduced_conditions.kernel()]
    table = {}
    for (i, v), (j, w) in combinations(enumerate(basis), 2):
        table[i, j] = [
            field.sum([*half(v, w, u), *((-sign, *rest) for sign, *rest in half(w, v, u))])
            for u in free
        ]
    return LieAlgebra.of(Brackets.of(field, len(basis), table))


def _values(place: Specialization, tensor: Tensor) -> dict[tuple[int, ...], Element]:
    """The components of a tensor at a point, those that do not vanish."""
    return {index: place(x) for index, x in tensor.components.nonzero.items()}
