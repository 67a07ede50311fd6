"""Sampled loop: the line integral of a sampled coframe, with two errors told apart."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.errors import GridError
from geomtorsion.loops.loop import Loop, Part, shown
from geomtorsion.loops.sides import Side
from geomtorsion.loops.stencils import interpolated

if TYPE_CHECKING:
    from geomtorsion.loops.sampled import SampledFrame

# Gauss points on each stretch, and stretches per cell that a loop crosses.
GAUSS = 6
PER_CELL = 2
# A loop may leave the grid by this share of a step: rounding of its own coordinates.
SLACK = 1e-9


@dataclass(frozen=True, eq=False)
class SampledBurgers:
    """Burgers vector of a loop through a sampled frame.

    vector: b^i, shape (rows,).
    interpolation_error: distance from the result with interpolation of another order.
    quadrature_error: distance from the result with half as many stretches.
    order: order of the interpolation; evaluations: points at which it was taken.
    """

    vector: np.ndarray
    interpolation_error: float
    quadrature_error: float
    order: int
    evaluations: int

    @property
    def error(self) -> float:
        """Both errors together."""
        return self.interpolation_error + self.quadrature_error


def sampled_burgers(grid: SampledFrame, loop: Loop) -> SampledBurgers:
    """The integral of the interpolated coframe along a loop; see SampledFrame.burgers."""

    if loop.dimension != grid.dimension:
        raise GridError(
            f"the loop has {loop.dimension} coordinates, the grid {grid.dimension} axes: give a "
            "loop in the coordinates of the grid."
        )
    found = np.zeros((3, grid.rows))
    evaluations = 0
    for part in loop.parts:
        for side in part.sides:
            count = _stretches(grid, part, side)
            # On the coarse points: how the order matters. On the fine ones: the result.
            places, slopes, weights = _points(grid, part, side, 2 * count)
            fine = _sum(grid, places, slopes, weights, grid.order)
            other = _sum(grid, places, slopes, weights, grid.other_order)
            coarse = _sum(grid, *_points(grid, part, side, count), grid.order)
            found += part.times * np.array([fine, other, coarse])
            evaluations += 5 * count * GAUSS
    fine, other, coarse = found
    # Order 2 is compared with a better one: its own error is that distance, give or take a little.
    safety = 4 / 3 if grid.order < grid.other_order else 1.0
    return SampledBurgers(
        fine,
        safety * float(np.abs(fine - other).max()),
        float(np.abs(fine - coarse).max()) + 2.0**-50 * float(np.abs(grid._bent).max()) * loop.size,
        grid.order,
        evaluations,
    )


def _stretches(grid: SampledFrame, part: Part, side: Side) -> int:
    """How many stretches a side needs so that each stays within a part of a cell."""

    count = max(65, 16 * side.waves + 1)
    points, _ = part.points(side, np.linspace(0, 1, count))
    steps = np.abs(np.diff(points, axis=1)) / np.abs(np.array(grid.steps))[:, None]
    return max(4, math.ceil(PER_CELL * float(steps.sum(axis=1).max())), 4 * side.waves)


def _points(
    grid: SampledFrame, part: Part, side: Side, count: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places in units of the grid, slopes and weights of a composite Gauss rule."""

    x, w = np.polynomial.legendre.leggauss(GAUSS)
    s = ((np.arange(count)[:, None] + (x + 1) / 2) / count).ravel()
    weights = np.tile(w / 2, count) / count
    points, slopes = part.points(side, s)
    places = np.array(
        [
            (row - axis[0]) / step
            for row, axis, step in zip(points, grid.axes, grid.steps, strict=True)
        ]
    )
    last = np.array([len(axis) - 1 for axis in grid.axes])[:, None]
    outside = (places < -SLACK) | (places > last + SLACK) | ~np.isfinite(places)
    if outside.any():
        axis, k = (int(i) for i in np.argwhere(outside)[0])
        low, high = sorted((float(grid.axes[axis][0]), float(grid.axes[axis][-1])))
        raise GridError(
            f"the loop leaves the grid at {shown(points[:, k])}: axis {grid.names[axis]} runs from "
            f"{low:.6g} to {high:.6g}. Choose a smaller loop; nothing is extrapolated."
        )
    return np.clip(places, 0, last), slopes, weights


def _sum(
    grid: SampledFrame, places: np.ndarray, slopes: np.ndarray, weights: np.ndarray, order: int
) -> np.ndarray:
    """The integral along one side; the mean coframe is left out, it closes exactly."""

    n = grid.dimension
    flat = grid._bent.reshape(grid.rows * n, *grid._bent.shape[2:])
    values = interpolated(flat, places, order).reshape(grid.rows, n, -1)
    return np.einsum("imk,mk,k->i", values, slopes, weights)
