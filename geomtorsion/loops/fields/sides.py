"""Sides: integrals along straight rows of edges, from every node, with the variance of each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import scipy  # loads its parts when they are asked for

from geomtorsion.loops.fields.circuits import Field
from geomtorsion.loops.fields.grid import Grid
from geomtorsion.loops.fields.stencils import Rule, applied

if TYPE_CHECKING:
    from scipy.sparse import csr_array


@dataclass(frozen=True, eq=False)
class Sides:
    """Integrals along sides of so many edges, one from every node where there is room.

    values, difference (from another order), variance, difference_variance: shape (rows, sides...);
    known: where no edge touches a hole, shape (sides...).
    """

    values: np.ndarray
    difference: np.ndarray
    known: np.ndarray
    variance: np.ndarray
    difference_variance: np.ndarray


def sides(field: Field, axis: int, edges: int) -> Sides:
    """Sides of so many edges along an axis."""
    grid = field.grid
    step, periodic = grid.steps[axis], grid.periodic[axis]
    fine = grid.rule(field.order, axis)
    other = fine.other()
    values = field.values[:, axis]
    here, there = (step * rule(values, 1 + axis) for rule in (fine, other))
    known = on_grid(fine.known, grid.shape, axis)
    spread = [np.zeros(1)] * 2
    if field.variances is not None:
        rules = _Rules(grid, axis, edges, fine, other, field.order)
        variances = field.variances[:, axis] * step**2
        spread = [rules.variance(variances, less_other) for less_other in (False, True)]
    return Sides(
        window_sums(here, edges, 1 + axis, periodic),
        window_sums(here - there, edges, 1 + axis, periodic),
        window_sums((~known).astype(np.int32), edges, axis, periodic) == 0,
        *spread,
    )


def on_grid(table: np.ndarray, shape: tuple[int, ...], axis: int) -> np.ndarray:
    """A table of shape (edges, lines), or (edges, 1) for all lines, on the grid."""
    rest = (*shape[:axis], *shape[axis + 1 :])
    lines = rest if table.shape[1] > 1 else (1,) * len(rest)
    found = np.broadcast_to(table.reshape(len(table), *lines), (len(table), *rest))
    return np.moveaxis(found, 0, axis)


def window_sums(values: np.ndarray, count: int, axis: int, periodic: bool = False) -> np.ndarray:
    """Sums of so many neighbours along an axis, by doubling: the same bits wherever it begins."""
    moved = np.moveaxis(values, axis, -1)
    if periodic:
        moved = np.concatenate([moved, moved[..., : count - 1]], axis=-1)
    room = moved.shape[-1] - count + 1
    block, width, first = moved, 1, 0
    total = np.zeros((*moved.shape[:-1], room), dtype=moved.dtype)
    while True:
        if count & width:
            total += block[..., first : first + room]
            first += width
        if 2 * width > count:
            return np.moveaxis(total, -1, axis)
        block = block[..., :-width] + block[..., width:]
        width *= 2


@dataclass(frozen=True, eq=False)
class _Rules:
    """The rules along an axis, with holes and without, and the sums of edges that are wanted."""

    grid: Grid
    axis: int
    edges: int
    fine: Rule
    other: Rule
    order: int

    def variance(self, variances: np.ndarray, less_other: bool) -> np.ndarray:
        """Variance of sums of edges (less those of the other rule) for independent nodes.

        variances: of what is integrated, shape (rows, grid...), where axes may have length 1. Each
        node counts with the square of all that the sum has of it.
        """
        along = 1 + self.axis
        points, periodic = self.grid.shape[self.axis], self.grid.periodic[self.axis]
        plain = Rule.of(self.order, np.zeros((points, 1), dtype=bool), periodic)
        matrix = plain.matrix - plain.other().matrix if less_other else plain.matrix
        lines = np.arange(len(plain.used) - (0 if periodic else self.edges - 1))
        squares = (_windows(lines, 1, len(plain.used), self.edges, periodic) @ matrix).power(2)
        if variances.shape[along] == 1:
            profile = np.asarray(squares.sum(axis=1))
            found = variances * profile.reshape(-1, *(1,) * (self.grid.dimension - 1 - self.axis))
        else:
            found = self._spread(squares, matrix, variances)
        if not self.grid.has_holes:
            return found
        return self._near_holes(found, variances, plain, less_other)

    def _spread(self, squares: csr_array, matrix: csr_array, variances: np.ndarray) -> np.ndarray:
        """The squares of all weights times variances; the inner ones are one sum over a window."""
        along, margin = 1 + self.axis, self.order + 2
        points, periodic = self.grid.shape[self.axis], self.grid.periodic[self.axis]
        inner = self.edges - 2 * margin + 1
        if inner < 1 or (periodic and self.edges > points - 2 * margin):
            return applied(squares, variances, along)
        ends = squares.tocoo()
        row, column = ends.coords
        depth = (column - row) % points
        kept = (depth < margin) | (depth > self.edges - margin)
        ends = type(ends)((ends.data[kept], (row[kept], column[kept])), shape=ends.shape).tocsr()
        # Nodes within have the whole of their weights in the sum.
        whole = np.asarray(matrix.sum(axis=0)).ravel() ** 2
        weighted = variances * whole.reshape(-1, *(1,) * (self.grid.dimension - 1 - self.axis))
        sums = window_sums(weighted, inner, along, periodic)
        places = np.arange(squares.shape[0]) + margin
        middle = np.take(sums, places % points if periodic else places, axis=along)
        return applied(ends, variances, along) + middle

    def _near_holes(
        self, found: np.ndarray, variances: np.ndarray, plain: Rule, less_other: bool
    ) -> np.ndarray:
        """The variances again, where stencils are others near holes: side by side."""
        grid, along, rule = self.grid, 1 + self.axis, self.fine
        odd = ((rule.used != plain.used) | (rule.shift != plain.shift)).astype(np.int32)
        periodic, lines = rule.periodic, rule.holes.shape[1]
        places = np.flatnonzero(window_sums(odd, self.edges, 0, periodic))
        count = len(rule.used) - (0 if periodic else self.edges - 1)
        shape = (*grid.shape[: self.axis], count, *grid.shape[self.axis + 1 :])
        full = np.broadcast_to(found, (len(found), *shape)).copy()
        matrix = rule.matrix - self.other.matrix if less_other else rule.matrix
        rows = _windows(places, lines, len(rule.used), self.edges, periodic) @ matrix
        every = np.broadcast_to(variances, (len(variances), *grid.shape))
        flat = np.moveaxis(every, along, 1).reshape(len(every), -1)
        inner = np.moveaxis(full, along, 1)
        table = inner.reshape(len(full), -1)
        table[:, places] = (rows.power(2) @ flat.T).T
        return np.moveaxis(table.reshape(inner.shape), 1, along)


def _windows(places: np.ndarray, lines: int, count: int, edges: int, periodic: bool) -> csr_array:
    """Sums of edges that begin at places of a table (edges, lines), as a sparse matrix."""
    first, line = np.divmod(places, lines)
    columns = first[:, None] + np.arange(edges)
    columns = (columns % count if periodic else columns) * lines + line[:, None]
    indptr = np.arange(0, columns.size + 1, edges)
    ones = np.ones(columns.size)
    return scipy.sparse.csr_array(
        (ones, columns.ravel(), indptr), shape=(len(places), count * lines)
    )
