"""Holes: connected sets of unknown nodes, and circuits around them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geomtorsion.errors import GridError
from geomtorsion.loops import Loop
from geomtorsion.materials.fields.grid import Grid
from geomtorsion.materials.rings import hole_numbers
from geomtorsion.support import checks


@dataclass(frozen=True, eq=False, repr=False)
class Hole:
    """A set of unknown nodes, connected by sides, edges or corners.

    number: in the list of holes. nodes: their numbers along the axes, shape (k, d); on a periodic
    axis the numbers continue beyond the last node if the hole crosses the end.
    """

    number: int
    nodes: np.ndarray

    @property
    def low(self) -> tuple[int, ...]:
        """The smallest node number along each axis."""
        return tuple(self.nodes.min(axis=0).tolist())

    @property
    def high(self) -> tuple[int, ...]:
        """The largest node number along each axis."""
        return tuple(self.nodes.max(axis=0).tolist())

    def __repr__(self) -> str:
        return f"Hole({self.number}: {len(self.nodes)} nodes from {self.low} to {self.high})"


def holes_of(grid: Grid) -> tuple[Hole, ...]:
    """All holes, in the order of their first nodes."""
    if not grid.has_holes:
        return ()
    numbers = hole_numbers(grid.holes, grid.periodic, np.ones((3,) * grid.dimension))
    nodes = np.argwhere(grid.holes)
    names = numbers[grid.holes]
    order = np.argsort(names, kind="stable")
    parts = np.split(nodes[order], np.cumsum(np.bincount(names))[:-1])
    return tuple(Hole(k, _unwrapped(part, grid)) for k, part in enumerate(parts))


def _unwrapped(nodes: np.ndarray, grid: Grid) -> np.ndarray:
    """Nodes of a hole that crosses the end of a periodic axis, with consecutive numbers."""
    indices = nodes.copy()
    for axis, (points, wraps) in enumerate(zip(grid.shape, grid.periodic, strict=True)):
        there = np.unique(nodes[:, axis])
        if wraps and there[0] == 0 and there[-1] == points - 1 and len(there) < points:
            gap = int(np.setdiff1d(np.arange(points), there)[0])
            indices[:, axis] += points * (indices[:, axis] < gap)
    return indices


def chosen_hole(holes: Sequence[Hole], wanted: object) -> Hole:
    """A hole by its number; without a number, the only hole."""
    if isinstance(wanted, Hole):
        return wanted
    if not holes:
        raise GridError("the grid has no holes. Use .burgers(loop) with any loop.")
    if wanted is None:
        if len(holes) > 1:
            raise GridError(
                f"hole: expected the number of one of {len(holes)} holes, got none. Give a number "
                f"from 0 to {len(holes) - 1}, or one of .holes."
            )
        return holes[0]
    return holes[checks.count(wanted, "hole", GridError, 0, len(holes) - 1)]


def loop_around(
    grid: Grid, hole: Hole, margin: int, plane: tuple[int, int], at: Sequence[int]
) -> Loop:
    """The rectangle along lines of nodes that surrounds a hole at a margin in nodes."""
    low, high = list(at), list(at)
    for axis in plane:
        low[axis], high[axis] = hole.low[axis] - margin, hole.high[axis] + margin
        points = grid.shape[axis]
        if not grid.periodic[axis] and (low[axis] < 0 or high[axis] >= points):
            raise GridError(
                f"{hole!r} reaches the edge of the grid: along {grid.names[axis]} a circuit around "
                f"it would need nodes {low[axis]} to {high[axis]}, but the axis has 0 to "
                f"{points - 1}. Give a smaller margin or another hole."
            )
        if high[axis] - low[axis] >= points:
            raise GridError(
                f"{hole!r} extends along the whole periodic axis {grid.names[axis]}: no closed "
                "circuit surrounds it. Give your own loop to .burgers."
            )
    a, b = plane
    rim = []
    for k in range(low[a], high[a] + 1):
        rim += [{a: k, b: low[b]}, {a: k, b: high[b]}]
    for k in range(low[b], high[b] + 1):
        rim += [{a: low[a], b: k}, {a: high[a], b: k}]
    nodes = np.array([[one.get(k, low[k]) for k in range(grid.dimension)] for one in rim])
    nodes %= np.array(grid.shape)
    touched = nodes[grid.holes[tuple(nodes.T)]]
    if len(touched):
        raise GridError(
            f"a circuit {margin} nodes around {hole!r} touches another hole at node "
            f"{grid.pixels(touched)}. Give another margin, or a loop around both holes."
        )
    ends = [
        [
            float(axis[0] + step * k)
            for axis, step, k in zip(grid.axes, grid.steps, row, strict=True)
        ]
        for row in (low, high)
    ]
    corner = [min(x, y) if k in plane else x for k, (x, y) in enumerate(zip(*ends, strict=True))]
    sides = [abs(ends[1][k] - ends[0][k]) for k in plane]
    return Loop.plaquette(corner, sides, plane, f"around {hole!r}")
