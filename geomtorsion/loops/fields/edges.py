"""Edges: integrals of a field on a grid along straight edges, of networks or of the grid."""

from __future__ import annotations

import numpy as np

from geomtorsion.loops.cochain import Cochain
from geomtorsion.loops.complexes import Complex
from geomtorsion.loops.edges import EdgeIntegrals
from geomtorsion.loops.fields.circuits import GAUSS, Field
from geomtorsion.loops.fields.stencils import SLACK
from geomtorsion.loops.quadrature import ROUNDING


def edge_cochain(field: Field) -> Cochain:
    """The integral along every edge of the grid; see SampledFrame.cochain."""
    grid = field.grid
    found, errors = [], []
    for k, step in enumerate(grid.steps):
        rule = grid.rule(field.order, k)
        fine, other = (step * one(field.values[:, k], 1 + k) for one in (rule, rule.other()))
        constant = step * field.mean[:, k].reshape(-1, *(1,) * grid.dimension)
        found.append((fine + constant).reshape(field.rows, -1).T)
        errors.append(np.abs(fine - other).max(axis=0).ravel())
    values = np.concatenate(found)
    rounding = ROUNDING * np.abs(values).max(axis=1)
    made = Complex.grid(grid.shape, periodic=grid.periodic)
    return Cochain(made, values, np.concatenate(errors) + rounding)


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
    rounding = ROUNDING * np.abs(fine).max(axis=1)
    return EdgeIntegrals(fine, errors + rounding, 5 * int(counts.sum()) * GAUSS)
