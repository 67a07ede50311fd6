"""Hamel: the equations of motion in quasi-velocities, solved for the accelerations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from geomtorsion.action.phase import Phase
from geomtorsion.action.solving import Quotient, quotients
from geomtorsion.errors import KineticMatrixError, LimitError, UndecidedError
from geomtorsion.geometry.matrices import dependence, determinant, inverse

if TYPE_CHECKING:
    from geomtorsion.action.twist import Twist
    from geomtorsion.exact import Element


@dataclass(frozen=True, eq=False)
class Hamel:
    """d/dt p_k = A_kj^i u^j p_i + E_k(L) + F_k over a frame, some velocities held.

    phase: the frame, adapted to the constraints if there are any.
    free: numbers of the quasi-velocities that move.
    lagrangian: L, where the held velocities have their values.
    momenta: p_i = dL/du^i for all i, likewise.
    slopes: E_k(L) at fixed u, for all k, likewise.
    forces: F_k, for all k, likewise.
    twist: A_kj^i of the variation.
    held: values of the other velocities, functions of q and t, mostly zero.
    """

    phase: Phase
    free: tuple[int, ...]
    lagrangian: Element
    momenta: tuple[Element, ...]
    slopes: tuple[Element, ...]
    forces: tuple[Element, ...]
    twist: Twist
    held: Mapping[int, Element] = field(default_factory=dict)

    @cached_property
    def velocities(self) -> tuple[Element, ...]:
        """u^i as elements, with the values of those that are held."""
        every = enumerate(self.phase.velocities)
        return tuple(self.held.get(i, value) for i, value in every)

    @cached_property
    def rates(self) -> tuple[Element, ...]:
        """q'^mu = E_i^mu u^i."""
        return tuple(self.phase.rates(self.velocities))

    @cached_property
    def gyroscopic(self) -> tuple[Element, ...]:
        """A_kj^i u^j p_i for each k."""
        field = self.phase.field
        terms: list[list] = [[] for _ in range(self.phase.dimension)]
        for (k, j, i), value in self.twist.items():
            terms[k].append((1, value, self.velocities[j], self.momenta[i]))
        return tuple(field.sum(row) for row in terms)

    def kinetic(self, rows: Sequence[int]) -> dict[tuple[int, int], Element]:
        """M_kl = dp_k/du^l at (place of k in rows, place of l among the free ones)."""
        symbols = [self.phase.letters.velocities[i] for i in self.free]
        found = {}
        for place, k in enumerate(rows):
            for column, symbol in enumerate(symbols):
                value = self.momenta[k].diff(symbol)
                if not value.is_zero:
                    found[place, column] = value
        return found

    @cached_property
    def rest(self) -> tuple[Element, ...]:
        """The residual without its accelerations, for each k."""
        field, phase = self.phase.field, self.phase
        found = []
        for k in range(phase.dimension):
            change = phase.change(self.momenta[k], self.rates)
            parts = ((1, change), (-1, self.gyroscopic[k]), (-1, self.slopes[k]))
            found.append(field.sum([*parts, (-1, self.forces[k])]))
        return tuple(found)

    @cached_property
    def matrix(self) -> dict[tuple[int, int], Element]:
        """The kinetic matrix of the free velocities, found regular."""
        matrix = self.kinetic(self.free)
        self._check_regular(matrix, len(self.free))
        return matrix

    @cached_property
    def accelerations(self) -> tuple[Element, ...] | None:
        """u'^k of the free velocities, in their order: M u' = - rest.

        None where clearing a denominator full of roots and sines would fill the memory.
        """
        field, n = self.phase.field, len(self.free)
        try:
            inverted = inverse(field, self.matrix, n)
        except LimitError:
            return None
        terms: list[list] = [[] for _ in range(n)]
        for (row, column), value in inverted.items():
            terms[row].append((-1, value, self.rest[self.free[column]]))
        return tuple(field.sum(row) for row in terms)

    @cached_property
    def quotients(self) -> tuple[Quotient, ...]:
        """The same as above / below, never divided."""
        right = [-self.rest[k] for k in self.free]
        return tuple(quotients(self.phase.field, self.matrix, right))

    def _check_regular(self, matrix: dict[tuple[int, int], Element], n: int) -> None:
        field, letters = self.phase.field, self.phase.letters
        size = determinant(field, matrix, n)
        if size.is_zero is None:
            raise UndecidedError(
                f"whether the kinetic matrix is singular cannot be decided: its determinant is "
                f"{size}. Use functions with known relations."
            )
        if not size.is_zero:
            return
        names = [letters.velocities[i].name for i in self.free]
        lost = sorted(set(range(n)) - {column for _, column in matrix})
        relation = "; ".join(f"{names[k]} does not occur quadratically" for k in lost)
        if not lost:
            found = dependence(field, matrix, n) or {}
            weights = [f"({value})*dL/d{names[i]}" for i, value in found.items()]
            relation = f"{' + '.join(weights)} contains no velocity"
        raise KineticMatrixError(
            "the kinetic matrix d2L/du^i du^j is singular, so the accelerations are not "
            f"determined: {relation}. Add the kinetic energy that is missing, or constrain the "
            "velocity that carries none."
        )

    @cached_property
    def whole_matrix(self) -> dict[tuple[int, int], Element]:
        """M_kl at (k, place of l among the free ones), for all k."""
        return self.kinetic(range(self.phase.dimension))

    @cached_property
    def residuals(self) -> tuple[tuple[tuple[tuple[int, Element], ...], Element], ...]:
        """For each k the pairs (l, M_kl) with l counted among all velocities, and the rest."""
        matrix, found = self.whole_matrix, []
        for k in range(self.phase.dimension):
            pairs = [(self.free[c], value) for (row, c), value in matrix.items() if row == k]
            found.append((tuple(pairs), self.rest[k]))
        return tuple(found)

    @cached_property
    def reactions(self) -> dict[int, Element] | None:
        """Forces that hold the held velocities: the residuals along them; None as above."""
        if self.accelerations is None:
            return None
        moving = dict(zip(self.free, self.accelerations, strict=True))
        found = {}
        for k in range(self.phase.dimension):
            if k not in self.free:
                pairs, rest = self.residuals[k]
                terms = [(1, value, moving[i]) for i, value in pairs]
                found[k] = self.phase.field.sum([*terms, (1, rest)])
        return found

    def derivative(self, element: Element) -> Element:
        """d/dt of f(q, u, t) along the motion, where accelerations could not be divided times
        the denominators of all: the same factor for every f.
        """
        letters, field = self.phase.letters, self.phase.field
        change = self.phase.change(element, self.rates)
        slopes = [element.diff(letters.velocities[i]) for i in self.free]
        if self.accelerations is not None:
            pairs = zip(slopes, self.accelerations, strict=True)
            return field.sum([(1, change), *((1, slope, value) for slope, value in pairs)])
        every = list(dict.fromkeys(below for _, below in self.quotients))
        terms: list = [(1, change, *every)]
        for slope, (above, below) in zip(slopes, self.quotients, strict=True):
            terms.append((1, slope, above, *(other for other in every if other != below)))
        return field.sum(terms)
