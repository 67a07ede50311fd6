"""Stencils: local polynomial interpolation, integration and differentiation on regular grids."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from scipy.sparse import csr_array


def lagrange(count: int, t: np.ndarray) -> np.ndarray:
    """Values at t of the polynomials that are 1 at one node of 0..count-1, shape (count, k)."""
    nodes = np.arange(count)
    factors = [
        [(t - nodes[m]) / (nodes[j] - nodes[m]) for m in nodes if m != j] for j in nodes.tolist()
    ]
    return np.array([np.prod(row, axis=0) if row else np.ones_like(t) for row in factors])


def starts(order: int, cells: np.ndarray, points: int) -> np.ndarray:
    """First node of the stencil of each cell: centred, one-sided at the edge of the grid."""
    return np.clip(cells - order // 2 + 1, 0, points - order)


@cache
def integration(order: int, points: int) -> csr_array:
    """Integrals over each cell (spacing 1) from values at nodes, shape (points - 1, points)."""
    from scipy.sparse import csr_array  # 0.15 s, and grids alone need it

    cells = np.arange(points - 1)
    first = starts(order, cells, points)
    x, w = np.polynomial.legendre.leggauss(order // 2 + 1)
    weights = np.zeros((len(cells), order))
    for node, weight in zip((x + 1) / 2, w / 2, strict=True):
        weights += weight * lagrange(order, cells - first + node).T
    return _banded(csr_array, weights, first, points)


@cache
def differentiation(order: int, points: int) -> csr_array:
    """Derivatives at the nodes (spacing 1) to an order of accuracy, shape (points, points)."""
    from scipy.sparse import csr_array  # as above

    count = order + 1
    nodes = np.arange(points)
    first = np.clip(nodes - order // 2, 0, points - count)
    # Derivatives of the node polynomials at each node of one stencil.
    k = np.arange(count)
    powers = np.linalg.inv(np.vander(k.astype(float), increasing=True))
    slopes = np.array(
        [sum(m * powers[m] * t ** (m - 1) for m in range(1, count)) for t in k.astype(float)]
    )
    return _banded(csr_array, slopes[nodes - first], first, points)


def _banded(kind: type, weights: np.ndarray, first: np.ndarray, points: int) -> csr_array:
    """Rows of weights that begin at a column each, as a sparse matrix."""
    rows, width = weights.shape
    columns = (first[:, None] + np.arange(width)).ravel()
    indptr = np.arange(0, rows * width + 1, width)
    return kind((weights.ravel(), columns, indptr), shape=(rows, points))


def applied(matrix: csr_array, values: np.ndarray, axis: int) -> np.ndarray:
    """A sparse matrix along one axis of an array."""
    moved = np.moveaxis(values, axis, 0)
    result = matrix @ moved.reshape(len(moved), -1)
    return np.moveaxis(result.reshape(-1, *moved.shape[1:]), 0, axis)


def interpolated(values: np.ndarray, places: np.ndarray, order: int) -> np.ndarray:
    """Values between the nodes: tensor product of local polynomials.

    Parameters
    ----------
    values
        Shape (entries, N_1, ..., N_d).
    places
        Positions in units of the spacing, from 0 to N - 1 on each axis, shape (d, k).
    order
        Nodes of each stencil; the error is of this order in the spacing.
    """
    shape = values.shape[1:]
    index, weights = [], []
    for axis, points in enumerate(shape):
        cells = np.clip(np.floor(places[axis]).astype(int), 0, points - 2)
        first = starts(order, cells, points)
        index.append(first)
        weights.append(lagrange(order, places[axis] - first))
    total = np.zeros((len(values), places.shape[1]))
    for shift in np.ndindex(*(order,) * len(shape)):
        weight = np.prod([w[s] for w, s in zip(weights, shift, strict=True)], axis=0)
        where = tuple(first + s for first, s in zip(index, shift, strict=True))
        total += weight * values[(slice(None), *where)]
    return total
