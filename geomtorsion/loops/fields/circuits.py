"""Circuits: integrals of a field on a grid along loops and edges, with the noise along them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from geomtorsion.conventions import Signed
from geomtorsion.errors import GridError
from geomtorsion.loops.arcs import SAME_POINT, Arc, Part
from geomtorsion.loops.fields.grid import ORDERS, Grid
from geomtorsion.loops.fields.stencils import SLACK, Blocks
from geomtorsion.loops.loop import Loop
from geomtorsion.loops.quadrature import ROUNDING

# Gauss points on each stretch: enough for the highest order of interpolation.
GAUSS = max(ORDERS) // 2 + 2


@dataclass(frozen=True, eq=False)
class Field:
    """The values of a coframe on a grid, as integrals use them.

    values: e^i_mu without its mean, zero in holes, shape (rows, d, grid...): constant parts close
    exactly, and need not be rounded. mean: shape (rows, d). variances: of each value, or None.
    """

    grid: Grid
    values: np.ndarray
    mean: np.ndarray
    variances: np.ndarray | None
    order: int
    other_order: int
    scale: float | None = None

    @property
    def rows(self) -> int:
        """Number of frame indices."""
        return len(self.values)

    @property
    def size(self) -> float:
        """The largest value, to which rounding is in proportion."""
        return float(np.abs(self.values).max()) if self.scale is None else self.scale


@dataclass(frozen=True, eq=False)
class SampledBurgers(Signed):
    """Burgers vector of a loop through a sampled frame.

    vector: b^i, shape (rows,), in `unit`.
    interpolation_error: distance from the result with interpolation of another order, without what
    noise explains of that distance. quadrature_error: distance from the result with half as many
    stretches.
    sigmas: standard deviation of each component by the noise of the nodes, shape (rows,); zero
    where no sigma of the grid is known.
    order: order of the interpolation; evaluations: points at which it was taken.
    """

    vector: np.ndarray
    interpolation_error: float
    quadrature_error: float
    order: int
    evaluations: int
    sigmas: np.ndarray
    unit: str = ""

    @property
    def noise(self) -> float:
        """Standard deviation of the noisiest component."""
        return float(self.sigmas.max())

    @property
    def error(self) -> float:
        """Interpolation, quadrature and noise together; the noise as one standard deviation."""
        return math.hypot(self.interpolation_error + self.quadrature_error, self.noise)

    @property
    def significance(self) -> float:
        """|b| against its error: sqrt(sum (b^i / sigma^i)^2), each sigma^i with its other errors.

        Pure noise in n components gives sqrt(n) or so; without any error it is infinite.
        """
        other = self.interpolation_error + self.quadrature_error
        sigmas = np.hypot(self.sigmas, other)
        with np.errstate(divide="ignore", invalid="ignore"):
            shares = np.where(self.vector == 0, 0.0, np.abs(self.vector) / sigmas)
        return float(np.sqrt((shares**2).sum()))

    def __repr__(self) -> str:
        parts = ", ".join(f"{x:.6g}" for x in self.vector.tolist())
        unit = f" {self.unit}" if self.unit else ""
        other = self.interpolation_error + self.quadrature_error
        noise = f", noise {self.noise:.1e}" if self.noise else ""
        return f"SampledBurgers([{parts}]{unit}, error={self.error:.1e}: grid {other:.1e}{noise})"


class _Weights:
    """Weights of nodes in a sum along a loop, shape (d, nodes), collected piece by piece."""

    def __init__(self, grid: Grid):
        self.grid = grid
        self.keys: list[np.ndarray] = []
        self.parts: list[np.ndarray] = []

    def add(self, nodes: tuple[np.ndarray, ...], weights: np.ndarray) -> None:
        """Weights of shape (d, k) at k nodes."""
        self.keys.append(np.ravel_multi_index(nodes, self.grid.shape))
        self.parts.append(weights)

    def spread(self, variances: np.ndarray) -> np.ndarray:
        """Variance of the sum, shape (rows,), for independent values at the nodes."""
        keys, where = np.unique(np.concatenate(self.keys), return_inverse=True)
        parts = np.concatenate(self.parts, axis=1)
        total = np.array([np.bincount(where, row, len(keys)) for row in parts])
        flat = np.broadcast_to(variances, (len(variances), len(parts), *self.grid.shape))
        nodes = np.unravel_index(keys, self.grid.shape)
        return np.einsum("mk,imk->i", total**2, flat[(slice(None), slice(None), *nodes)])


def sampled_burgers(field: Field, loop: Loop, unit: str = "") -> SampledBurgers:
    """The integral of the interpolated coframe along a loop; see SampledFrame.burgers."""
    grid = field.grid
    if loop.dimension != grid.dimension:
        raise GridError(
            f"the loop has {loop.dimension} coordinates, the grid {grid.dimension} axes: give a "
            "loop in the coordinates of the grid."
        )
    found = np.zeros((3, field.rows))
    evaluations = 0
    weights, differences = _Weights(grid), _Weights(grid)
    gap = np.zeros(grid.dimension)
    for part in loop.parts:
        for arc in part.arcs:
            count = _stretches(grid, part, arc)
            # On the coarse points: how the order matters. On the fine ones: the result.
            fine, other = _both(field, part, arc, 2 * count, (weights, differences))
            coarse, _ = _both(field, part, arc, count)
            found += part.times * np.array([fine, other, coarse])
            evaluations += 5 * count * GAUSS
            ends = part.points(arc, np.array([0.0, 1.0]))[0]
            gap += part.times * (ends[:, 1] - ends[:, 0])
    fine, other, coarse = found
    if np.abs(gap).max() > SAME_POINT * loop.size:
        grid.check_periods(gap)
        # Round a period the constant part does not close.
        fine, other, coarse = (x + field.mean @ gap for x in (fine, other, coarse))
    # Order 2 is compared with a better one: its own error is that distance, give or take a little.
    safety = 4 / 3 if field.order < field.other_order else 1.0
    difference = np.abs(fine - other)
    sigmas = np.zeros(field.rows)
    if field.variances is not None:
        sigmas = np.sqrt(weights.spread(field.variances))
        difference = unexplained(difference, differences.spread(field.variances))
    return SampledBurgers(
        fine,
        safety * float(difference.max()),
        float(np.abs(fine - coarse).max()) + ROUNDING * field.size * loop.size,
        field.order,
        evaluations,
        sigmas,
        unit,
    )


def unexplained(difference: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """What is left of the difference of two rules when its share of noise is taken out.

    The mean square of the difference is that of the interpolation and the variance together.
    """
    return np.sqrt(np.maximum(difference**2 - variance, 0.0))


def _stretches(grid: Grid, part: Part, arc: Arc) -> int:
    """How many stretches an arc needs so that each stays within a part of a cell."""
    count = max(65, 16 * arc.waves + 1)
    points, _ = part.points(arc, np.linspace(0, 1, count))
    steps = np.abs(np.diff(points, axis=1)) / np.abs(np.array(grid.steps))[:, None]
    # Two for each cell that it crosses: one alone may hold the kink between two cells.
    return max(4, math.ceil(2 * float(steps.sum(axis=1).max()) - SLACK), 4 * arc.waves)


def _both(
    field: Field,
    part: Part,
    arc: Arc,
    count: int,
    collected: tuple[_Weights, _Weights] | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """The integral along one arc by a composite Gauss rule, and with another order.

    The mean coframe is left out. collected: takes the weights of the nodes in the sum, and those in
    the difference of both orders, where noise is known.
    """
    x, w = np.polynomial.legendre.leggauss(GAUSS)
    s = ((np.arange(count)[:, None] + (x + 1) / 2) / count).ravel()
    weights = np.tile(w / 2, count) / count
    points, slopes = part.points(arc, s)
    known = field.grid.known
    places = field.grid.places(points, "loop")
    blocks = known.blocks(places, field.order)
    field.grid.refuse_holes(blocks.used, places, "loop")
    if collected is None:
        return _sum(field, places, blocks, slopes, weights), np.zeros(field.rows)
    other = known.other(blocks, places, field.other_order)
    if field.variances is not None:
        for sign, chosen in ((1, blocks), (-1, other)):
            for rows, nodes, weight in known.terms(chosen, places):
                each = part.times * slopes[:, rows] * weights[rows] * weight
                collected[1].add(nodes, sign * each)
                if sign == 1:
                    collected[0].add(nodes, each)
    fine = _sum(field, places, blocks, slopes, weights)
    return fine, _sum(field, places, other, slopes, weights)


def _sum(
    field: Field, places: np.ndarray, blocks: Blocks, slopes: np.ndarray, weights: np.ndarray
) -> np.ndarray:
    """The integral along one arc from values of blocks."""
    n = field.grid.dimension
    flat = field.values.reshape(field.rows * n, *field.grid.shape)
    values = field.grid.known.interpolated(flat, blocks, places).reshape(field.rows, n, -1)
    return np.einsum("imk,mk,k->i", values, slopes, weights)
