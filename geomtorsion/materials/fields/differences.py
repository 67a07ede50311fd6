"""Differences: derivatives at the nodes of a grid, from neighbours or from every second node."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from geomtorsion.materials.fields.grid import Grid
from geomtorsion.materials.fields.sides import on_grid
from geomtorsion.materials.fields.stencils import Rule
from geomtorsion.support.caching import cached_property


@dataclass(frozen=True, eq=False)
class Differences:
    """Derivatives at nodes by polynomials through nodes that are a number of steps apart.

    grid: with its holes. order: of the error in the spacing. stride: steps between the nodes.
    """

    grid: Grid
    order: int
    stride: int = 1

    @classmethod
    def of(cls, grid: Grid, order: int, stride: int = 1) -> Differences:
        """Differences on the nodes where derivatives along all axes exist; others become holes."""
        while True:
            made = cls(grid, order, stride)
            holes = grid.holes.copy()
            for axis in range(grid.dimension):
                for nodes, rule in made.rules[axis]:
                    known = on_grid(rule.known, _part(grid.shape, axis, len(nodes)), axis)
                    part = np.take(holes, nodes, axis) | ~known
                    holes[(slice(None),) * axis + (nodes,)] = part
            if (holes == grid.holes).all():
                return made
            grid = replace(grid, holes=holes)

    @cached_property
    def rules(self) -> list[list[tuple[np.ndarray, Rule]]]:
        """For each axis: numbers of nodes that are joined, in order, and their rule."""
        return [
            [(nodes, self._rule(nodes, axis)) for nodes in self._rows(axis)]
            for axis in range(self.grid.dimension)
        ]

    def _rows(self, axis: int) -> list[np.ndarray]:
        points = self.grid.shape[axis]
        if self.grid.periodic[axis] and points % self.stride:
            # Steps go around the period, until all nodes are joined.
            return [np.arange(points) * self.stride % points]
        return [np.arange(first, points, self.stride) for first in range(self.stride)]

    def _rule(self, nodes: np.ndarray, axis: int) -> Rule:
        lines = np.moveaxis(np.take(self.grid.holes, nodes, axis), axis, 0)
        # One line represents all lines without holes.
        lines = lines.reshape(len(nodes), -1)[:, : None if lines.any() else 1]
        return Rule.of(self.order, lines, self.grid.periodic[axis], slopes=True)

    @property
    def centred(self) -> np.ndarray:
        """Whether all stencils of a node have full length, with the node in the middle."""
        result = ~self.grid.holes
        for axis, rules in enumerate(self.rules):
            for nodes, rule in rules:
                place = (slice(None),) * axis + (nodes,)
                full = (rule.used == self.order + 1) & (rule.shift == self.order // 2)
                result[place] &= on_grid(full, _part(self.grid.shape, axis, len(nodes)), axis)
        return result

    def __call__(self, values: np.ndarray, axis: int) -> np.ndarray:
        """The derivative of values of shape (N_1, ..., N_d) along an axis; NaN at holes."""
        holes = self.grid.holes
        known = values[~holes]
        if not known.size:
            return np.full(values.shape, np.nan)
        # A constant then has no derivative, without rounding.
        filled = np.where(holes, 0.0, values - known[0])
        result = np.empty(values.shape)
        for nodes, rule in self.rules[axis]:
            part = rule(np.ascontiguousarray(np.take(filled, nodes, axis))[None], 1 + axis)[0]
            result[(slice(None),) * axis + (nodes,)] = part
        result /= self.grid.steps[axis] * self.stride
        result[holes] = np.nan
        return result


def _part(shape: tuple[int, ...], axis: int, count: int) -> tuple[int, ...]:
    """Shape of a part of the grid with fewer nodes along one axis."""
    return (*shape[:axis], count, *shape[axis + 1 :])
