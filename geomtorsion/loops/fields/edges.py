"""Edges: integrals of a field on a grid along straight edges, of networks or of the grid."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import scipy  # loads its parts when they are asked for

from geomtorsion.loops.cochain import Cochain
from geomtorsion.loops.complexes import Complex
from geomtorsion.loops.edges import EdgeIntegrals
from geomtorsion.loops.fields.circuits import GAUSS, Field
from geomtorsion.loops.fields.noise import along
from geomtorsion.loops.fields.stencils import SLACK, Blocks
from geomtorsion.loops.quadrature import ROUNDING

if TYPE_CHECKING:
    from scipy.sparse import csr_array


def edge_cochain(field: Field) -> Cochain:
    """The integral along every edge of the grid; see SampledFrame.cochain."""
    grid = field.grid
    found, errors = [], []
    for k, step in enumerate(grid.steps):
        rule = grid.rule(field.order, k)
        fine, other = (step * one(field.values[:, k], 1 + k) for one in (rule, rule.other()))
        constant = step * field.mean[:, k].reshape(-1, *(1,) * grid.dimension)
        found.append((fine + constant).reshape(field.rows, -1).T)
        difference = np.abs(fine - other).max(axis=0)
        errors.append(np.hypot(difference, _sigma(field, k, step * rule.matrix)).ravel())
    values = np.concatenate(found)
    rounding = ROUNDING * np.abs(values).max(axis=1)
    made = Complex.grid(grid.shape, periodic=grid.periodic)
    return Cochain(made, values, np.concatenate(errors) + rounding)


def _sigma(field: Field, axis: int, matrix: csr_array) -> np.ndarray:
    """Standard deviation by noise of the noisiest component of edges along an axis, without holes.

    matrix: values at the nodes of a line to integrals over its edges.
    """
    noise, shape = field.noise, field.grid.shape
    if noise is None:
        return np.zeros((1,) * len(shape))
    if noise.origins:
        matrix = matrix @ noise.origins[axis]
    squares = matrix.power(2)
    every = [c for (i, j), c in noise.between((axis, axis)).items() if i == j]
    variances = [along(squares, np.broadcast_to(c, shape), axis) for c in every]
    return np.sqrt(np.max(variances, axis=0)) if variances else np.zeros((1,) * len(shape))


def sampled_edges(field: Field, starts: np.ndarray, ends: np.ndarray) -> EdgeIntegrals:
    """The integrals of the interpolated coframe along edges; see SampledFrame.along_edges."""
    grid = field.grid
    steps = ends - starts
    crossed = (np.abs(steps) / np.abs(np.array(grid.steps))).sum(axis=1)
    # Two stretches for each cell that is crossed, as along a loop.
    counts = np.maximum(1, np.ceil(2 * crossed - SLACK).astype(int))
    nodes, weights = np.polynomial.legendre.leggauss(GAUSS)
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

    def summed(share: int, both: bool) -> list[np.ndarray]:
        stretches = share * counts
        owner = np.repeat(np.arange(len(starts)), stretches)
        number = np.arange(len(owner)) - np.repeat(np.cumsum(stretches) - stretches, stretches)
        s = ((number[:, None] + nodes) / stretches[owner][:, None]).ravel()
        edge = np.repeat(owner, GAUSS)
        weight = np.tile(weights, len(owner)) / stretches[edge]
        places = grid.places((starts[edge] + s[:, None] * steps[edge]).T, "edge")
        blocks = grid.known.blocks(places, field.order)
        grid.refuse_holes(blocks.used, places, "edge")
        chosen = [blocks]
        if both and field.noise is not None:
            weighted(blocks, places, edge, weight)
        if both:
            chosen.append(grid.known.other(blocks, places, field.other_order))
        found = []
        for one in chosen:
            values = grid.known.interpolated(flat, one, places)
            values = values.reshape(field.rows, grid.dimension, -1) + field.mean[:, :, None]
            each = np.einsum("imk,km,k->ik", values, steps[edge], weight)
            found.append(np.stack([np.bincount(edge, row, len(starts)) for row in each], axis=1))
        return found

    (fine, other), (coarse,) = summed(2, True), summed(1, False)
    errors = np.abs(fine - other).max(axis=1) + np.abs(fine - coarse).max(axis=1)
    if field.noise is not None:
        covariance = field.noise.in_a_row(grid.shape).of_sums(sums)
        variances = np.diagonal(covariance, axis1=1, axis2=2).max(axis=1)
        errors = np.hypot(errors, np.sqrt(variances))
    rounding = ROUNDING * np.abs(fine).max(axis=1)
    return EdgeIntegrals(fine, errors + rounding, 5 * int(counts.sum()) * GAUSS)
