"""Circuits: integrals of a field on a grid along loops and edges, with the noise along them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.loops import Arc, Cochain, Complex, EdgeIntegrals, Loop, Part
from geomtorsion.loops.quadrature import ROUNDING
from geomtorsion.materials.fields.grid import ORDERS, Grid
from geomtorsion.materials.fields.noise import Noise, along
from geomtorsion.materials.fields.pieces import halved, pieces_of_arc, pieces_of_edges
from geomtorsion.materials.fields.stencils import SLACK, Blocks
from geomtorsion.support.precision import CALCULATED

if TYPE_CHECKING:
    from scipy.sparse import csr_array


# Gauss points on each piece of an arc, enough for the highest order of interpolation.
GAUSS = max(ORDERS) // 2 + 2


@dataclass(frozen=True, eq=False)
class Field:
    """The values of a coframe on a grid, prepared for integrals.

    values: e^i_mu without its mean, zero in holes, shape (rows, d, grid...). The mean is separate,
    because its closed integrals vanish exactly, without rounding. mean: shape (rows, d). noise: of
    the values, or None.
    """

    grid: Grid
    values: np.ndarray
    mean: np.ndarray
    noise: Noise | None
    order: int
    other_order: int
    scale: float | None = None

    @property
    def rows(self) -> int:
        """Number of frame indices."""
        return len(self.values)

    @property
    def size(self) -> float:
        """The largest value; rounding errors are proportional to it."""
        return float(np.abs(self.values).max()) if self.scale is None else self.scale


@cache
def _gauss() -> tuple[np.ndarray, np.ndarray]:
    """Points and weights of Gauss's rule on [-1, 1]."""
    return np.polynomial.legendre.leggauss(GAUSS)


class _Weights:
    """Weights of nodes in a sum along a loop, shape (d, nodes), collected piece by piece."""

    def __init__(self, grid: Grid):
        self.grid = grid
        self.keys: list[np.ndarray] = []
        self.parts: list[np.ndarray] = []

    def add(self, nodes: tuple[np.ndarray, ...], weights: np.ndarray) -> None:
        """Add weights of shape (d, k) at k nodes."""
        self.keys.append(np.ravel_multi_index(nodes, self.grid.shape))
        self.parts.append(weights)

    @property
    def total(self) -> np.ndarray:
        """The weight of each node, shape (d, grid...)."""
        keys, parts = np.concatenate(self.keys), np.concatenate(self.parts, axis=1)
        count = self.grid.holes.size
        totals = np.array([np.bincount(keys, row, count) for row in parts])
        return totals.reshape(-1, *self.grid.shape)


# A Burgers vector, its covariance from noise, and its systematic errors by name.
Measured = tuple[np.ndarray, np.ndarray, dict[str, float]]


def sampled_burgers(field: Field, loop: Loop) -> Measured:
    """The integral of the interpolated coframe along a loop; see SampledFrame.burgers."""
    grid = field.grid
    # The fine points give the result, the coarse points the error of the quadrature.
    whole, halves, gap = [], [], np.zeros(grid.dimension)
    for part in loop.parts:
        for arc in part.arcs:
            pieces = pieces_of_arc(grid, part, arc, _stretches(grid, part, arc))
            whole.append(_gauss_points(part, arc, *pieces))
            halves.append(_gauss_points(part, arc, *halved(*pieces)))
            ends = part.points(arc, np.array([0.0, 1.0]))[0]
            gap += part.times * (ends[:, 1] - ends[:, 0])
    weights, differences = _Weights(grid), _Weights(grid)
    fine, other = _both(field, *_joined(halves), (weights, differences))
    coarse, _ = _both(field, *_joined(whole))
    if np.abs(gap).max() > CALCULATED * loop.size:
        grid.check_periods(gap)
        # The integral of the constant part around a period is not zero.
        fine, other, coarse = (x + field.mean @ gap for x in (fine, other, coarse))
    # Order 2 is compared with a better order, so that its error is only about the difference.
    safety = 4 / 3 if field.order < field.other_order else 1.0
    difference = np.abs(fine - other)
    covariance = np.zeros((field.rows, field.rows))
    if field.noise is not None:
        covariance = field.noise.of_sum(weights.total)
        difference = unexplained(difference, np.diag(field.noise.of_sum(differences.total)))
    quadrature = float(np.abs(fine - coarse).max()) + ROUNDING * field.size * loop.size
    interpolation = safety * float(difference.max())
    return fine, covariance, {"interpolation": interpolation, "quadrature": quadrature}


def unexplained(difference: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """The difference of two rules without the share of noise.

    The mean square of the difference is the mean square of the interpolation plus the variance.
    """
    return np.sqrt(np.maximum(difference**2 - variance, 0.0))


def _stretches(grid: Grid, part: Part, arc: Arc) -> int:
    """Number of equal pieces of an arc, so that none is much longer than a cell; 1 if straight."""
    count = max(65, 16 * arc.waves + 1)
    points, slopes = part.points(arc, np.linspace(0, 1, count))
    if not np.ptp(slopes, axis=1).any():
        return 1
    steps = np.abs(np.diff(points, axis=1)) / np.abs(np.array(grid.steps))[:, None]
    return max(4, math.ceil(float(steps.sum(axis=1).max()) - SLACK), 4 * arc.waves)


# Points, shape (d, k), and their weights in an integral of a one-form, shape (d, k).
Points = tuple[np.ndarray, np.ndarray]


def _gauss_points(part: Part, arc: Arc, starts: np.ndarray, lengths: np.ndarray) -> Points:
    """Points and weights of a composite Gauss rule on pieces of an arc."""
    x, w = _gauss()
    s = (starts[:, None] + lengths[:, None] * (x + 1) / 2).ravel()
    points, slopes = part.points(arc, s)
    return points, part.times * slopes * (lengths[:, None] * w / 2).ravel()


def _joined(every: Sequence[Points]) -> Points:
    """The points and weights of several arcs."""
    points, weights = (np.concatenate(x, axis=1) for x in zip(*every, strict=True))
    return points, weights


def _both(
    field: Field,
    points: np.ndarray,
    weights: np.ndarray,
    collected: tuple[_Weights, _Weights] | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """The integral as a sum over points, for the order and another order, without the mean.

    collected: receives the weights of the nodes in the sum, and in the difference of both orders,
    if noise is known.
    """
    known_nodes = field.grid.known
    places = field.grid.places(points, "loop")
    blocks = known_nodes.blocks(places, field.order)
    field.grid.refuse_holes(blocks.used, places, "loop")
    if collected is None:
        return _sum(field, places, blocks, weights), np.zeros(field.rows)
    other = known_nodes.other(blocks, places, field.other_order)
    if field.noise is not None:
        for sign, chosen in ((1, blocks), (-1, other)):
            for rows, nodes, weight in known_nodes.terms(chosen, places):
                each = weights[:, rows] * weight
                collected[1].add(nodes, sign * each)
                if sign == 1:
                    collected[0].add(nodes, each)
    fine = _sum(field, places, blocks, weights)
    return fine, _sum(field, places, other, weights)


def _sum(field: Field, places: np.ndarray, blocks: Blocks, weights: np.ndarray) -> np.ndarray:
    """The integral as a weighted sum of values that are interpolated in blocks."""
    n = field.grid.dimension
    flat = field.values.reshape(field.rows * n, *field.grid.shape)
    values = field.grid.known.interpolated(flat, blocks, places).reshape(field.rows, n, -1)
    return np.einsum("imk,mk->i", values, weights)


def edge_cochain(field: Field) -> Cochain:
    """The integral along each edge of the grid; see SampledFrame.cochain."""
    grid = field.grid
    integrals, errors = [], []
    for k, step in enumerate(grid.steps):
        rule = grid.rule(field.order, k)
        fine, other = (step * one(field.values[:, k], 1 + k) for one in (rule, rule.other))
        constant = step * field.mean[:, k].reshape(-1, *(1,) * grid.dimension)
        integrals.append((fine + constant).reshape(field.rows, -1).T)
        difference = np.abs(fine - other).max(axis=0)
        errors.append(np.hypot(difference, _sigma(field, k, step * rule.matrix)).ravel())
    values = np.concatenate(integrals)
    rounding = ROUNDING * np.abs(values).max(axis=1)
    edges = Complex.grid(grid.shape, periodic=grid.periodic)
    return Cochain(edges, values, np.concatenate(errors) + rounding)


def _sigma(field: Field, axis: int, matrix: csr_array) -> np.ndarray:
    """Standard deviation from noise of the noisiest component of edges along an axis, no holes.

    matrix: values at the nodes of a line to integrals over its edges.
    """
    noise, shape = field.noise, field.grid.shape
    if noise is None:
        return np.zeros((1,) * len(shape))
    squares = matrix.power(2)
    every = [c for (i, j), c in noise.between((axis, axis)).items() if i == j]
    variances = [along(squares, np.broadcast_to(c, shape), axis) for c in every]
    return np.sqrt(np.max(variances, axis=0)) if variances else np.zeros((1,) * len(shape))


def sampled_edges(field: Field, starts: np.ndarray, ends: np.ndarray) -> EdgeIntegrals:
    """The integrals of the interpolated coframe along edges; see SampledFrame.along_edges."""
    fine, other, coarse, sums, evaluations = _edge_sums(field, starts, ends)
    errors = np.abs(fine - other).max(axis=1) + np.abs(fine - coarse).max(axis=1)
    if field.noise is not None:
        covariance = field.noise.in_a_row().of_sums(sums)
        variances = np.diagonal(covariance, axis1=1, axis2=2).max(axis=1)
        errors = np.hypot(errors, np.sqrt(variances))
    rounding = ROUNDING * np.abs(fine).max(axis=1)
    return EdgeIntegrals(fine, errors + rounding, evaluations)


def sampled_polygons(field: Field, polygons: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Integrals along many closed polygons at once, (k, rows), and their variances from noise.

    polygons: points of each, the first one also at the end, shape (points, d).
    """
    starts = np.concatenate([points[:-1] for points in polygons])
    ends = np.concatenate([points[1:] for points in polygons])
    owner = np.repeat(np.arange(len(polygons)), [len(points) - 1 for points in polygons])
    shape = len(polygons), len(starts)
    chains = scipy.sparse.csr_array((np.ones(len(owner)), (owner, np.arange(len(owner)))), shape)
    fine, _, _, sums, _ = _edge_sums(field, starts, ends)
    vectors = chains @ fine
    if field.noise is None:
        return vectors, np.zeros_like(vectors)
    covariance = field.noise.in_a_row().of_sums([(chains @ weights).tocsr() for weights in sums])
    return vectors, np.diagonal(covariance, axis1=1, axis2=2)


def _edge_sums(
    field: Field, starts: np.ndarray, ends: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[csr_array], int]:
    """Integrals along edges, by another order, and with half of the pieces, (edges, rows) each.

    Then the weights of the nodes in the first integrals, (edges, nodes) for each column, which are
    zero without noise; and the number of points.
    """
    grid = field.grid
    steps = ends - starts
    pieces = pieces_of_edges(grid, starts, ends)
    nodes, weights = _gauss()
    nodes, weights = (nodes + 1) / 2, weights / 2
    flat = field.values.reshape(-1, *grid.shape)

    sums = [scipy.sparse.csr_array((len(starts), grid.holes.size)) for _ in grid.shape]

    def weighted(blocks: Blocks, places: np.ndarray, edge: np.ndarray, weight: np.ndarray) -> None:
        """Collect the weight of each node in each edge."""
        for rows, nodes, share in grid.known.terms(blocks, places):
            keys = np.ravel_multi_index(nodes, grid.shape)
            for mu in range(grid.dimension):
                each = share * weight[rows] * steps[edge[rows], mu]
                sums[mu] = sums[mu] + scipy.sparse.csr_array(
                    (each, (edge[rows], keys)), shape=sums[mu].shape
                )

    def summed(
        owner: np.ndarray, first: np.ndarray, length: np.ndarray, both: bool
    ) -> list[np.ndarray]:
        s = (first[:, None] + length[:, None] * nodes).ravel()
        edge = np.repeat(owner, GAUSS)
        weight = (length[:, None] * weights).ravel()
        places = grid.places((starts[edge] + s[:, None] * steps[edge]).T, "edge")
        blocks = grid.known.blocks(places, field.order)
        grid.refuse_holes(blocks.used, places, "edge")
        chosen = [blocks]
        if both and field.noise is not None:
            weighted(blocks, places, edge, weight)
        if both:
            chosen.append(grid.known.other(blocks, places, field.other_order))
        parts = []
        for one in chosen:
            values = grid.known.interpolated(flat, one, places)
            values = values.reshape(field.rows, grid.dimension, -1) + field.mean[:, :, None]
            each = np.einsum("imk,km,k->ik", values, steps[edge], weight)
            parts.append(np.stack([np.bincount(edge, row, len(starts)) for row in each], axis=1))
        return parts

    owner, first, length = pieces
    halves = np.repeat(owner, 2), *halved(first, length)
    (fine, other), (coarse,) = summed(*halves, True), summed(*pieces, False)
    return fine, other, coarse, sums, 5 * len(owner) * GAUSS
