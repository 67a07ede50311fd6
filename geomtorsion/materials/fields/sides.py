"""Sides: integrals along straight rows of edges, from each node, with their variances."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.materials.fields.grid import Grid
from geomtorsion.materials.fields.grid_circuits import Field
from geomtorsion.materials.fields.noise import Noise, along
from geomtorsion.materials.fields.stencils import Rule, applied, plain_rule
from geomtorsion.materials.windows import window_sums
from geomtorsion.support.caching import cached_property

if TYPE_CHECKING:
    from scipy.sparse import csr_array


@dataclass(frozen=True, eq=False)
class Spread:
    """Noise of integrals along sides.

    covariance: {(i, j): of components i and j, shape (sides...)}. starts, ends: weights of the
    first and the last node of a side, shape (sides...), with length 1 along axes without variation.
    They give the covariance of two sides that share this node.
    """

    covariance: dict[tuple[int, int], np.ndarray]
    starts: np.ndarray
    ends: np.ndarray


@dataclass(frozen=True, eq=False)
class Sides:
    """Integrals along the edges of an axis, which all sizes of circuits share.

    Errors are computed at first use.
    """

    field: Field
    axis: int

    @cached_property
    def _rule(self) -> Rule:
        return self.field.grid.rule(self.field.order, self.axis)

    @cached_property
    def values(self) -> np.ndarray:
        """Integrals along single edges, shape (rows, edges...)."""
        return self._by(self._rule)

    def _by(self, rule: Rule) -> np.ndarray:
        step = self.field.grid.steps[self.axis]
        return step * rule(self.field.values[:, self.axis], 1 + self.axis)

    @property
    def difference(self) -> np.ndarray:
        """Differences from integrals of another order, shape (rows, edges...)."""
        return self.values - self._by(self._rule.other)

    def variances(self) -> np.ndarray:
        """Variances of single edges from noise, shape (rows, edges...)."""
        field, axis = self.field, self.axis
        assert field.noise is not None
        squares = (field.grid.steps[axis] * self._rule.matrix).power(2)
        return np.stack(
            [along(squares, field.noise.at_nodes(i, axis, field.grid.shape), axis)
             for i in range(field.rows)]
        )  # fmt: skip

    def spread(self, edges: int, less_other: bool) -> Spread:
        """Noise of sides of so many edges, or of their differences from another order."""
        field = self.field
        assert field.noise is not None
        rules = _Rules(
            field.grid, self.axis, edges, self._rule, self._rule.other, field.order,
            field.noise,
        )  # fmt: skip
        return rules.spread(less_other)


def on_grid(table: np.ndarray, shape: tuple[int, ...], axis: int) -> np.ndarray:
    """A table of shape (edges, lines), or (edges, 1) for all lines, as an array on the grid."""
    rest = (*shape[:axis], *shape[axis + 1 :])
    lines = rest if table.shape[1] > 1 else (1,) * len(rest)
    values = np.broadcast_to(table.reshape(len(table), *lines), (len(table), *rest))
    return np.moveaxis(values, 0, axis)


@dataclass(frozen=True, eq=False)
class _Rules:
    """The rules along an axis, with holes and without, for sums of consecutive edges."""

    grid: Grid
    axis: int
    edges: int
    fine: Rule
    other: Rule
    order: int
    noise: Noise

    def spread(self, less_other: bool) -> Spread:
        """Covariance of sums of edges (or of their difference from the other rule).

        Nodes are independent, and each contributes with the square of its total weight in the sum.
        """
        points, periodic = self.grid.shape[self.axis], self.grid.periodic[self.axis]
        plain = plain_rule(self.order, points, periodic)
        matrix = plain.matrix - plain.other.matrix if less_other else plain.matrix
        matrix = self.grid.steps[self.axis] * matrix
        count = len(plain.used) - (0 if periodic else self.edges - 1)
        rows = _windows(np.arange(count), 1, len(plain.used), self.edges, periodic) @ matrix
        special = self._beside_holes(plain, less_other) if self.grid.has_holes else None
        squares = rows.power(2)
        covariance = {}
        for pair, c in self.noise.between((self.axis, self.axis)).items():
            if c.shape[self.axis] == 1:
                profile = np.asarray(squares.sum(axis=1))
                values = c * profile.reshape(-1, *(1,) * (self.grid.dimension - 1 - self.axis))
            else:
                values = self._summed(squares, matrix, c)
            if special is not None:
                places, table = special
                every = np.broadcast_to(c, self.grid.shape)
                flat = np.moveaxis(every, self.axis, 0).ravel()
                values = self._with(values, places, table.power(2) @ flat)
            covariance[pair] = values
        if not self.noise.joins_columns:
            return Spread(covariance, np.zeros(1), np.zeros(1))
        place = np.arange(count)
        ends = []
        for shift in (0, self.edges):
            values = np.asarray(rows[place, (place + shift) % points]).ravel()
            values = values.reshape(-1, *(1,) * (self.grid.dimension - 1 - self.axis))
            values = values.reshape(*(1,) * self.axis, *values.shape)
            if special is not None:
                places, table = special
                lines = self.fine.holes.shape[1]
                first, line = np.divmod(places, lines)
                node = (first + shift) % points * lines + line
                own = np.asarray(table[np.arange(len(places)), node]).ravel()
                values = self._with(values, places, own)
            ends.append(values)
        return Spread(covariance, *ends)

    def _summed(self, squares: csr_array, matrix: csr_array, variances: np.ndarray) -> np.ndarray:
        """Sums of squared weights times variances; inner nodes are summed over a window."""
        along = self.axis
        # Nodes that an edge beyond the end of a sum reaches, and where rules are one-sided.
        margin = self.order + 2
        points, periodic = self.grid.shape[self.axis], self.grid.periodic[self.axis]
        inner = self.edges - 2 * margin + 1
        if inner < 1 or (periodic and self.edges > points - 2 * margin):
            return applied(squares, variances[None], 1 + along)[0]
        ends = squares.tocoo()
        row, column = ends.coords
        depth = (column - row) % points
        rim = (depth < margin) | (depth > self.edges - margin)
        ends = type(ends)((ends.data[rim], (row[rim], column[rim])), shape=ends.shape).tocsr()
        # The sum contains the full weight of each inner node.
        whole = np.asarray(matrix.sum(axis=0)).ravel() ** 2
        weighted = variances * whole.reshape(-1, *(1,) * (self.grid.dimension - 1 - self.axis))
        sums = window_sums(weighted, inner, along, periodic)
        places = np.arange(squares.shape[0]) + margin
        middle = np.take(sums, places % points if periodic else places, axis=along)
        return applied(ends, variances[None], 1 + along)[0] + middle

    def _beside_holes(self, plain: Rule, less_other: bool) -> tuple[np.ndarray, csr_array]:
        """Sides with modified stencils near holes, and the weights of their nodes.

        Returns numbers in a table (sides, lines), and a matrix (numbers, nodes of all lines).
        """
        rule = self.fine
        odd = (rule.used != plain.used) | (rule.shift != plain.shift)
        matrix = rule.matrix - self.other.matrix if less_other else rule.matrix
        step = self.grid.steps[self.axis]
        periodic, lines = rule.periodic, rule.holes.shape[1]
        places = np.flatnonzero(window_sums(odd.astype(np.int32), self.edges, 0, periodic))
        weights = _windows(places, lines, len(rule.used), self.edges, periodic) @ (step * matrix)
        return places, weights.tocsr()

    def _with(self, found: np.ndarray, places: np.ndarray, own: np.ndarray) -> np.ndarray:
        """Values common to all lines, on all sides, with separate values at some places."""
        grid = self.grid
        count = len(self.fine.used) - (0 if self.fine.periodic else self.edges - 1)
        shape = (*grid.shape[: self.axis], count, *grid.shape[self.axis + 1 :])
        inner = np.moveaxis(np.broadcast_to(found, shape), self.axis, 0).copy()
        inner.reshape(-1)[places] = own
        return np.moveaxis(inner, 0, self.axis)


def _windows(places: np.ndarray, lines: int, count: int, edges: int, periodic: bool) -> csr_array:
    """Sums of edges starting at places of a table (edges, lines), as a sparse matrix."""
    first, line = np.divmod(places, lines)
    columns = first[:, None] + np.arange(edges)
    columns = (columns % count if periodic else columns) * lines + line[:, None]
    indptr = np.arange(0, columns.size + 1, edges)
    ones = np.ones(columns.size)
    return scipy.sparse.csr_array(
        (ones, columns.ravel(), indptr), shape=(len(places), count * lines)
    )
