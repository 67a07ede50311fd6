"""Noise: (co)variances of values at nodes, given or estimated, and of their sums along edges."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import comb, inf, sqrt
from statistics import NormalDist
from typing import TYPE_CHECKING, Protocol

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.errors import GridError
from geomtorsion.materials.fields.grid import ORDERS, REGULAR, Grid, numbers
from geomtorsion.support import checks

if TYPE_CHECKING:
    from scipy.sparse import csr_array

# Two components of a coframe: row and column of the first, row and column of the second.
Pair = tuple[int, int, int, int]
# Differences of sixth order cancel a field that is smooth over seven nodes.
SMOOTH = ORDERS[-2]
# The median of |x| of a normal distribution of standard deviation 1.
MEDIAN = NormalDist().inv_cdf(3 / 4)


@dataclass(frozen=True, eq=False)
class Noise:
    """Covariances of values at nodes that are independent of each other.

    rows: number of frame indices. terms: {(i, mu, j, nu): covariance of e^i_mu and e^j_nu at each
    node}, with length 1 along axes without variation; missing terms are zero.
    """

    rows: int
    terms: Mapping[Pair, np.ndarray]

    @classmethod
    def of_sigma(cls, sigma: np.ndarray) -> Noise:
        """Independent components, from standard deviations (rows or 1, columns or 1, grid...)."""
        return cls(
            len(sigma), {(i, k, i, k): sigma[i, k] ** 2 for i, k in np.ndindex(*sigma.shape[:2])}
        )

    @classmethod
    def of_covariance(cls, given: np.ndarray) -> Noise:
        """From covariances of shape (rows, columns, rows, columns, grid...)."""
        rows, columns = given.shape[:2]
        every = [pair for pair in np.ndindex(rows, columns, rows, columns) if given[pair].any()]
        return cls(rows, {(i, k, j, m): given[i, k, j, m] for i, k, j, m in every})

    def between(self, columns: tuple[int, int]) -> dict[tuple[int, int], np.ndarray]:
        """Covariances of e^i_mu with e^j_nu by (i, j), for two columns mu and nu."""
        return {(i, j): c for (i, k, j, m), c in self.terms.items() if (k, m) == columns}

    @property
    def joins_columns(self) -> bool:
        """Whether different columns are correlated."""
        return any(k != m for _, k, _, m in self.terms)

    def at_nodes(self, row: int, column: int, shape: tuple[int, ...]) -> np.ndarray:
        """Variance of one component at each node, shape of the grid."""
        key = (row, column, row, column)
        return np.broadcast_to(self.terms.get(key, np.zeros((1,) * len(shape))), shape)

    def draw(self, shape: tuple[int, ...], rng: np.random.Generator) -> np.ndarray:
        """Random values with these covariances and mean zero, shape (rows, columns, grid...)."""
        rows, columns = shape[:2]
        terms = {key: c for key, c in self.terms.items() if max(key[1], key[3]) < columns}
        signs = rng.choice([-1.0, 1.0], shape)
        if all((i, k) == (j, m) for i, k, j, m in terms):
            values = np.zeros(shape)
            for (i, k, _, _), variance in terms.items():
                values[i, k] = np.sqrt(variance) * signs[i, k]
            return values
        table = np.zeros(
            (rows, columns) * 2 + np.broadcast_shapes(*(c.shape for c in terms.values()))
        )
        for key, c in terms.items():
            table[key] = c
        n = rows * columns
        squares, axes = np.linalg.eigh(np.moveaxis(table.reshape(n, n, -1), -1, 0))
        root = (axes * np.sqrt(np.maximum(squares, 0))[:, None, :]) @ axes.swapaxes(1, 2)
        return np.einsum(
            "ikjm...,jm...->ik...", np.moveaxis(root, 0, -1).reshape(table.shape), signs
        )

    def in_a_row(self) -> Noise:
        """The same noise for a flat list of nodes."""
        return Noise(self.rows, {pair: c.ravel() for pair, c in self.terms.items()})

    def of_sum(self, weights: np.ndarray) -> np.ndarray:
        """Covariance of a sum over nodes with weights (columns, grid...), shape (rows, rows)."""
        shape = weights.shape[1:]
        nodes = np.flatnonzero(weights.any(axis=0))
        flat = weights.reshape(len(weights), -1)[:, nodes]
        covariance = np.zeros((self.rows, self.rows))
        for (i, k, j, m), c in self.terms.items():
            here = np.broadcast_to(c, shape).ravel()[nodes] if c.size > 1 else c.ravel()
            covariance[i, j] += float((flat[k] * flat[m] * here).sum())
        return covariance

    def of_sums(self, weights: Sequence[csr_array]) -> np.ndarray:
        """Covariances of many sums over nodes in a row, shape (sums, rows, rows).

        weights: of the nodes, one matrix (sums, nodes) for each column.
        """
        count = weights[0].shape[0]
        covariances = np.zeros((count, self.rows, self.rows))
        columns = {(k, m) for _, k, _, m in self.terms}
        shares = {
            (k, m): weights[k].power(2) if k == m else weights[k] * weights[m] for k, m in columns
        }
        for (i, k, j, m), c in self.terms.items():
            covariances[:, i, j] += shares[k, m] @ np.broadcast_to(c, weights[0].shape[1:])
        return covariances


def along(matrix: csr_array, values: np.ndarray, axis: int) -> np.ndarray:
    """Apply a matrix, for one line or for all lines, along an axis of values on a grid."""
    moved = np.moveaxis(values, axis, 0)
    lines = matrix.shape[1] // len(moved)
    flat = moved.ravel() if lines > 1 else moved.reshape(len(moved), -1)
    return np.moveaxis((matrix @ flat).reshape(-1, *moved.shape[1:]), 0, axis)


def covariance_of(given: object, shape: tuple[int, ...], grid: Grid) -> np.ndarray:
    """Covariances of all components, checked, shape (rows, columns, rows, columns, grid or 1...).

    given: without the grid (the same at every node) or with it; in (rows, columns, rows, columns)
    or as square matrices of the components in order.
    """
    matrices = numbers(given, "covariance")
    rows, columns = shape[:2]
    n, inner = rows * columns, (1,) * grid.dimension
    wide = (rows, columns, rows, columns)
    shapes = {(n, n): inner, wide: inner, (n, n, *grid.shape): grid.shape}
    shapes |= {(*wide, *grid.shape): grid.shape, (*wide, *inner): inner}
    if matrices.shape not in shapes:
        raise GridError(
            f"covariance: expected shape {wide} or {(n, n)}, optionally followed by the nodes "
            f"{grid.shape}, got {matrices.shape}."
        )
    places = shapes[matrices.shape]
    table = np.moveaxis(matrices.reshape(n, n, -1), -1, 0)
    if places == grid.shape:
        table = np.where(grid.holes.ravel()[:, None, None], 0.0, table)
    if not np.isfinite(table).all():
        raise GridError("covariance: expected finite numbers, got others. Mask unknown nodes.")
    size = np.abs(table).max(axis=(1, 2), initial=0.0)
    # Tolerance for the rounding of tables.
    away = np.abs(table - table.swapaxes(1, 2)).max(axis=(1, 2), initial=0.0)
    least = np.linalg.eigvalsh(table)[:, 0]
    bad = (away > REGULAR * size) | (least < -REGULAR * size)
    if bad.any():
        k = int(np.argmax(bad))
        where = f" at node {tuple(map(int, np.unravel_index(k, places)))}" if len(bad) > 1 else ""
        fault = f"the eigenvalue {least[k]:.6g}"
        if away[k] > REGULAR * size[k]:
            fault = f"entries that differ from their transpose by {away[k]:.6g}"
        raise GridError(
            "covariance: expected symmetric matrices without negative eigenvalues, got "
            f"{fault}{where}. If these are standard deviations, give them as sigma."
        )
    return np.moveaxis(table, 0, -1).reshape(*wide, *places)


def noise_of(
    sigma: object, covariance: object, values: np.ndarray, grid: Grid
) -> tuple[np.ndarray | None, np.ndarray | Noise | None, Noise | None, str]:
    """Standard deviations, covariances as given, the resulting noise, and its origin in words.

    values: shape (rows, columns, grid...), with columns only along the axes of the grid.
    """
    shape, ones = values.shape, (1,) * grid.dimension
    if covariance is None:
        if sigma is None:
            return None, None, None, ""
        note = "given"
        if isinstance(sigma, str):
            checks.choice(sigma, ["estimate"], "sigma", GridError)
            sigmas, note = estimated(values, grid), "the median of sixth differences along the axes"
        else:
            sigmas = sigma_of(sigma, shape, grid)
        wide = ones if sigmas.shape[2:] == ones else grid.shape
        return sigmas, None, Noise.of_sigma(np.broadcast_to(sigmas, (*shape[:2], *wide))), note
    note = "given"
    covariances: np.ndarray | Noise
    if isinstance(covariance, Noise):
        covariances = noise = covariance
    elif isinstance(covariance, str):
        checks.choice(covariance, ["estimate"], "covariance", GridError)
        covariances = estimated_covariance(values, grid)
        noise = Noise.of_covariance(covariances)
        note = "medians of sums and differences of sixth differences along the axes"
    else:
        covariances = covariance_of(covariance, shape, grid)
        noise = Noise.of_covariance(covariances)
    table = [noise.at_nodes(i, k, grid.shape) for i, k in np.ndindex(*shape[:2])]
    sigmas = np.sqrt(np.array(table)).reshape(shape)
    if sigma is not None and not np.array_equal(np.asarray(sigma, dtype=object), sigmas):
        raise GridError(
            "sigma: expected either sigma or covariance, got both. Omit sigma: the covariance "
            "includes it."
        )
    return sigmas, covariances, noise, note


def sigma_of(given: object, shape: tuple[int, ...], grid: Grid) -> np.ndarray:
    """Standard deviations with all axes of the coframe, of length 1 without variation.

    given: a number, or an array of the shape of the grid, of (rows, columns), or of the coframe.
    """
    sigmas = numbers(given, "sigma")
    inner = (1,) * grid.dimension
    shapes = {(): (1, 1, *inner), grid.shape: (1, 1, *grid.shape), shape: shape}
    shapes.setdefault(shape[:2], (*shape[:2], *inner))
    shapes.setdefault((*shape[:2], *inner), (*shape[:2], *inner))
    shapes.setdefault((1, 1, *inner), (1, 1, *inner))
    shapes.setdefault((1, 1, *grid.shape), (1, 1, *grid.shape))
    if sigmas.shape not in shapes:
        raise GridError(
            f"sigma: expected a number, or shape {grid.shape} (nodes), {shape[:2]} (components) or "
            f"{shape} (both), got {sigmas.shape}."
        )
    sigmas = sigmas.reshape(shapes[sigmas.shape])
    bad = ~(sigmas >= 0) | np.isinf(sigmas)
    if sigmas.shape[2:] == grid.shape:
        # Values in holes are not checked.
        bad &= ~grid.holes
        sigmas = np.where(grid.holes, 0.0, sigmas)
    if bad.any():
        place = tuple(np.argwhere(bad)[0].tolist())
        where = f" at node {place[2:]}" if sigmas.shape[2:] == grid.shape else ""
        raise GridError(
            f"sigma: expected standard deviations of 0 or more, got {sigmas[place]:.6g}{where}. "
            "Mask unknown nodes."
        )
    return sigmas


def estimated(values: np.ndarray, grid: Grid) -> np.ndarray:
    """Standard deviation of each component, from differences of sixth order.

    values: shape (rows, columns, grid...). Returns shape (rows, columns, 1, ...).
    """
    return estimated_from_parts([(values, grid)])


def estimated_from_parts(parts: Sequence[tuple[np.ndarray, Grid]]) -> np.ndarray:
    """Standard deviation of each component, from differences of sixth order in parts of one field.

    sigma = median |difference| / (0.6745 sqrt(sum of squared binomials)), the least along the axes.
    The differences cancel a field that is smooth over seven nodes, and the median ignores cores and
    cuts.

    parts: values of shape (rows, columns, grid...) with their grids. Returns shape
    (rows, columns, 1, ...).
    """
    dimension = parts[0][1].dimension
    best = np.full(parts[0][0].shape[:2], np.inf)
    picks = [(values, _differences(grid)) for values, grid in parts]
    for axis in range(dimension):
        for i, k in np.ndindex(*best.shape):
            numbers = np.concatenate([pick[axis](values[i, k]) for values, pick in picks])
            best[i, k] = min(best[i, k], spread(numbers))
    _check_estimate(best)
    return best.reshape(*best.shape, *(1,) * dimension)


def estimated_covariance(values: np.ndarray, grid: Grid) -> np.ndarray:
    """Covariance of the components at a node, from differences of sixth order as in `estimated`.

    values: shape (rows, columns, grid...). Returns shape (rows, columns, rows, columns, 1, ...).
    """
    flat = values.reshape(-1, *grid.shape)
    numbers = [[pick(one) for one in flat] for pick in _differences(grid)]
    candidates = [robust_covariance(rows) for rows in numbers if rows[0].size]
    best = min(candidates, key=np.trace, default=np.full((len(flat),) * 2, np.inf))
    _check_estimate(best)
    return best.reshape(*values.shape[:2] * 2, *(1,) * grid.dimension)


def spread(numbers: np.ndarray) -> float:
    """Standard deviation of numbers about 0, from the median of |x|; infinite without numbers."""
    if not numbers.size:
        return inf
    return float(np.median(np.abs(numbers))) / MEDIAN


def robust_covariance(rows: list[np.ndarray]) -> np.ndarray:
    """Covariance of normal numbers about 0, one variable per row, by medians of sums, differences.

    C_xy = (s(x + y)^2 - s(x - y)^2) / 4 (Gnanadesikan and Kettenring 1972), after scaling x and y
    by their spreads. The medians ignore walls and cores, because these are few.
    """
    sizes = np.array([spread(row) for row in rows])
    correlations = np.eye(len(rows))
    for a, b in combinations(range(len(rows)), 2):
        if sizes[a] and sizes[b]:
            one, two = rows[a] / sizes[a], rows[b] / sizes[b]
            more, less = spread(one + two) ** 2, spread(one - two) ** 2
            correlations[a, b] = correlations[b, a] = (more - less) / (more + less)
    # Medians do not guarantee a nonnegative variance in all directions.
    values, vectors = np.linalg.eigh(correlations * np.outer(sizes, sizes))
    return (vectors * np.maximum(values, 0)) @ vectors.T


class EdgeNoise(Protocol):
    """Noise of integrals along edges; chains: multiplicity of each edge, shape (k, edges)."""

    def covariance(self, chains: csr_array) -> np.ndarray:
        """Covariance of the sum along each chain, shape (k, rows, rows)."""
        ...

    def difference(self, chains: csr_array) -> np.ndarray:
        """Variance of the difference from another rule along each chain, shape (k, rows)."""
        ...


@dataclass(frozen=True, eq=False)
class NodeNoise:
    """Noise of values at points.

    noise: of the values. steps: along each edge, shape (edges, d). rule: matrix from values at
    points to their mean along each edge, (edges, points). less_other: `rule` minus the matrix of
    another rule.
    """

    noise: Noise
    steps: np.ndarray
    rule: csr_array
    less_other: csr_array

    def covariance(self, chains: csr_array) -> np.ndarray:
        """Covariance from the square of the total weight of each point in a chain."""
        return self._of(chains, self.rule)

    def difference(self, chains: csr_array) -> np.ndarray:
        """Variance of the difference from the other rule, from the weights `less_other`."""
        return np.diagonal(self._of(chains, self.less_other), axis1=1, axis2=2)

    def _of(self, chains: csr_array, rule: csr_array) -> np.ndarray:
        weights = [chains @ scipy.sparse.diags_array(step) @ rule for step in self.steps.T]
        return self.noise.of_sums([w.tocsr() for w in weights])


@dataclass(frozen=True, eq=False)
class JumpNoise:
    """Chances that noise has changed the jumps of a displacement.

    chances: of each edge and vector, shape (edges, k). vectors: shape (k, rows).
    """

    chances: np.ndarray
    vectors: np.ndarray

    def covariance(self, chains: csr_array) -> np.ndarray:
        """Covariance from wrong jumps, each of which changes the sum by a lattice vector."""
        total = abs(chains) @ self.chances
        return np.einsum("ck,ki,kj->cij", total, self.vectors, self.vectors)

    def difference(self, chains: csr_array) -> np.ndarray:
        """Zero, because there is no other rule."""
        return np.zeros((chains.shape[0], self.vectors.shape[1]))


def chances_of(rest: np.ndarray, sigma: np.ndarray) -> np.ndarray:
    """Chances that noise has changed a whole number by one, shape of the rests.

    The rest of a difference is noise around 0, or noise around the next whole number.
    """
    away = 1 - 2 * np.abs(rest)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(sigma > 0, away / (2 * sigma**2), np.where(away > 0, np.inf, 0.0))
    return scipy.special.expit(-share)


def _check_estimate(found: np.ndarray) -> None:
    """Refuse an estimate without any differences."""
    if not np.isfinite(found).all():
        raise GridError(
            "sigma: expected rows of seven known nodes (or of a whole axis), from which to "
            "estimate noise, got none. Give sigma as a number or an array."
        )


def _differences(grid: Grid) -> list[Callable[[np.ndarray], np.ndarray]]:
    """For each axis, the known differences of sixth order, scaled to the variance of one node."""
    picks = []
    for axis, points in enumerate(grid.shape):
        order = min(SMOOTH, points - 1)
        scale = sqrt(sum(comb(order, k) ** 2 for k in range(order + 1)))
        holes = np.moveaxis(grid.holes, axis, -1)
        known = np.ones((*holes.shape[:-1], points - order), dtype=bool)
        for k in range(order + 1):
            known &= ~holes[..., k : k + points - order]

        def pick(
            one: np.ndarray, axis: int = axis, order: int = order, scale: float = scale,
            known: np.ndarray = known,
        ) -> np.ndarray:  # fmt: skip
            return np.diff(np.moveaxis(one, axis, -1), order, axis=-1)[known] / scale

        picks.append(pick)
    return picks
