"""Stencils: local polynomials on a grid, each on the most centred known nodes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from itertools import pairwise, product
from typing import TYPE_CHECKING

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.support.caching import cached_property, read_only
from geomtorsion.support.precision import HALF

if TYPE_CHECKING:
    from scipy.sparse import csr_array

# A place within this distance of a node, in steps, is at the node, because coordinates of a loop
# are rounded, and steps are small compared with the coordinates far from the origin.
SLACK = HALF
# Number of values that are combined at a time, because they fit in the cache of a processor.
CACHED = 16384


def lagrange(count: int, t: np.ndarray) -> np.ndarray:
    """Values at t of the polynomials that are 1 at one node of 0..count-1, shape (count, k)."""
    nodes = np.arange(count)
    factors = [
        [(t - nodes[m]) / (nodes[j] - nodes[m]) for m in nodes if m != j] for j in nodes.tolist()
    ]
    return np.array([np.prod(row, axis=0) if row else np.ones_like(t) for row in factors])


@cache
def edge_weights(count: int) -> np.ndarray:
    """Integrals of polynomials through count nodes over the edge from node s to s + 1, row s."""
    if count == 1:
        return read_only(np.ones((1, 1)))
    x, w = np.polynomial.legendre.leggauss(count // 2 + 1)
    first = np.arange(count - 1)
    parts = zip(((x + 1) / 2).tolist(), (w / 2).tolist(), strict=True)
    weights = np.zeros((count - 1, count))
    for node, weight in parts:
        weights += weight * lagrange(count, first + node).T
    return read_only(weights)


@cache
def slope_weights(count: int) -> np.ndarray:
    """Derivatives at node s, row s, of the polynomials through count nodes (spacing 1).

    Barycentric formula (Berrut and Trefethen 2004, section 9.3).
    """
    k = np.arange(count)
    # Binomials are exact, unlike the weights of scipy, whose last digits are random.
    weights = (-1.0) ** k * scipy.special.binom(count - 1, k)
    slopes = weights / weights[:, None] / (k[:, None] - k + np.eye(count))
    np.fill_diagonal(slopes, 0.0)
    np.fill_diagonal(slopes, -slopes.sum(axis=1))
    return read_only(slopes)


@cache
def step_weights(count: int) -> np.ndarray:
    """As `slope_weights`, for differences between neighbours, shape (count, count - 1)."""
    return read_only(np.cumsum(slope_weights(count)[:, :0:-1], axis=1)[:, ::-1])


@dataclass(frozen=True, eq=False)
class Rule:
    """The stencils of all edges (or nodes) along an axis.

    The axis has N nodes; L is the number of lines of nodes, or 1 if all lines are equal.

    slopes: True for derivatives at nodes, False for integrals over edges.
    holes: whether each node is unknown, shape (N, L).
    periodic: whether the last node is joined to the first.
    used: number of nodes of each stencil, 0 without enough known nodes, shape (edges, L).
    shift: number of the edge or node in its stencil, shape (edges, L).
    """

    slopes: bool
    holes: np.ndarray
    periodic: bool
    used: np.ndarray
    shift: np.ndarray

    @classmethod
    def of(cls, order: int, holes: np.ndarray, periodic: bool, slopes: bool = False) -> Rule:
        """The rule of an order, or of a lower order where rows of known nodes are too short."""
        count = len(holes) if periodic or slopes else len(holes) - 1
        used = np.zeros((count, holes.shape[1]), dtype=np.int8)
        shift = np.zeros_like(used)
        for nodes in range(order + slopes, 1, -2):
            _choose(used, shift, used == 0, nodes, holes, periodic, slopes)
        return cls(slopes, holes, periodic, used, shift)

    @cached_property
    def other(self) -> Rule:
        """The rule to compare with, which gives the errors: two nodes fewer in each stencil.

        The smallest stencil gets two nodes more, or one node fewer where these are unknown.
        """
        least = 2 + self.slopes
        used, shift = np.zeros_like(self.used), np.zeros_like(self.shift)
        for nodes in np.unique(self.used).tolist():
            if nodes:
                here = self.used == nodes
                count = nodes - 2 if nodes > least else nodes + 2
                _choose(used, shift, here, count, self.holes, self.periodic, self.slopes)
        rest = (self.used > 0) & (used == 0)
        if rest.any():
            _choose(used, shift, rest, least - 1, self.holes, self.periodic, self.slopes)
        return Rule(self.slopes, self.holes, self.periodic, used, shift)

    @property
    def known(self) -> np.ndarray:
        """Whether there is a value, shape (edges, L)."""
        return self.used > 0

    @cached_property
    def matrix(self) -> csr_array:
        """Matrix from values at nodes to values on edges (or at nodes), (edges * L, N * L)."""
        return self._sparse(slope_weights if self.slopes else edge_weights, len(self.holes))

    @cached_property
    def matrix_of_steps(self) -> csr_array:
        """Matrix from differences along edges to slopes at nodes, (N * L, edges * L)."""
        points = len(self.holes)
        return self._sparse(step_weights, points if self.periodic else points - 1)

    def _sparse(self, weights_of: Callable[[int], np.ndarray], points: int) -> csr_array:
        """The rule as a matrix whose columns are nodes, or edges between nodes."""
        lines = self.holes.shape[1]
        tables = {n: weights_of(n) for n in np.unique(self.used).tolist() if n}
        width = max((table.shape[1] for table in tables.values()), default=1)
        longest = max((len(table) for table in tables.values()), default=1)
        table = np.zeros((int(self.used.max(initial=0)) + 1, longest, width))
        for nodes, rows in tables.items():
            table[nodes, : len(rows), : rows.shape[1]] = rows
        weights = table[self.used, self.shift]
        first = np.arange(len(self.used))[:, None] - self.shift
        columns = first[:, :, None] + np.arange(width)
        columns = columns % points if self.periodic else np.clip(columns, 0, points - 1)
        columns = columns * lines + np.arange(lines)[:, None]
        indptr = np.arange(0, weights.size + 1, width)
        shape = (self.used.size, points * lines)
        return scipy.sparse.csr_array((weights.ravel(), columns.ravel(), indptr), shape=shape)

    def __call__(self, values: np.ndarray, axis: int, out: np.ndarray | None = None) -> np.ndarray:
        """Apply the rule along one axis of an array of shape (rows, grid...).

        out: array for the result.
        """
        if self._stretches is None:
            result = applied(self.matrix, values, axis, self.holes.shape[1])
            if out is None:
                return result
            out[...] = result
            return out
        shape = list(values.shape)
        shape[axis] = len(self.used)
        total = np.empty(shape) if out is None else out
        wide = max(1, CACHED // max(1, math.prod(shape[2:])))
        for result, row in zip(total, values, strict=True):
            if axis == 1:
                for first, last, weights in self._stretches:
                    for start in range(first, last, wide):
                        _add_terms(result, row, start, min(start + wide, last), weights)
                continue
            for start in range(0, shape[1], wide):
                parts = (np.moveaxis(x[start : start + wide], axis - 1, 0) for x in (result, row))
                inner, nodes = parts
                for first, last, weights in self._stretches:
                    _add_terms(inner, nodes, first, last, weights)
        return total

    @cached_property
    def _stretches(self) -> list[tuple[int, int, list[tuple[int, float]]]] | None:
        """Edges (or nodes) from first to last with equal stencils: shifts and weights of nodes.

        None with holes or periods.
        """
        if self.holes.shape[1] > 1 or self.periodic or not self.used.all():
            return None
        used, shift = self.used[:, 0], self.shift[:, 0]
        new = np.flatnonzero((np.diff(used) != 0) | (np.diff(shift) != 0)) + 1
        bounds = [0, *new.tolist(), len(used)]
        stretches = []
        for first, last in pairwise(bounds):
            nodes, start = int(used[first]), int(shift[first])
            table = (slope_weights if self.slopes else edge_weights)(nodes)[start]
            pairs = [(k - start, float(weight)) for k, weight in enumerate(table) if weight]
            stretches.append((first, last, pairs))
        return stretches


def _add_terms(
    out: np.ndarray, row: np.ndarray, first: int, last: int, weights: list[tuple[int, float]]
) -> None:
    """Weighted sums of nodes along the first axis, in the order of the nodes."""
    inner = out[first:last]
    for k, (shift, weight) in enumerate(weights):
        part = row[first + shift : last + shift]
        if k:
            inner += part * weight
        else:
            np.multiply(part, weight, out=inner)


@cache
def plain_rule(order: int, points: int, periodic: bool, slopes: bool = False) -> Rule:
    """The rule along an axis without holes; one line represents all lines."""
    return Rule.of(order, np.zeros((points, 1), dtype=bool), periodic, slopes)


def _choose(
    used: np.ndarray,
    shift: np.ndarray,
    open_: np.ndarray,
    nodes: int,
    holes: np.ndarray,
    periodic: bool,
    slopes: bool,
) -> None:
    """Assign the most centred stencil of known nodes to open edges (or nodes), if there is one."""
    if nodes > len(holes) or not open_.any():
        return
    wrapped = np.concatenate([holes, holes[: nodes - 1]]) if periodic else holes
    counts = np.concatenate([np.zeros((1, holes.shape[1]), int), wrapped.cumsum(axis=0)])
    fits = counts[nodes:] == counts[:-nodes]
    shifts = range(nodes if slopes or nodes == 1 else nodes - 1)
    middle = (len(shifts) - 1) / 2
    left = open_.copy()
    places = np.arange(len(used))
    for s in sorted(shifts, key=lambda s: (abs(s - middle), s)):
        first = (places - s) % len(holes) if periodic else places - s
        inside = (first >= 0) & (first < len(fits))
        good = np.zeros_like(left)
        good[inside] = left[inside] & fits[first[inside]]
        used[good], shift[good] = nodes, s
        left &= ~good
        if not left.any():
            return


def applied(matrix: csr_array, values: np.ndarray, axis: int, lines: int = 1) -> np.ndarray:
    """Apply a sparse matrix along one axis of an array of shape (rows, grid...).

    lines: number of lines of nodes with separate rows in the matrix; 1 if all lines share them.
    """
    moved = np.moveaxis(values, axis, 0)
    if lines == 1:
        result = matrix @ moved.reshape(len(moved), -1)
        return np.moveaxis(result.reshape(-1, *moved.shape[1:]), 0, axis)
    inner = np.moveaxis(moved, 1, -1)
    result = matrix @ inner.reshape(-1, inner.shape[-1])
    return np.moveaxis(np.moveaxis(result.reshape(-1, *inner.shape[1:]), -1, 1), 0, axis)


# -- between the nodes ----------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Blocks:
    """Stencils of points between the nodes: blocks of known nodes, products of polynomials.

    first: first node of each block, shape (d, k). used: number of nodes along each axis, shape
    (k,); 0 for a point without a block. thin: whether the point is at a node along an axis, so that
    only this node is used there, shape (d, k).
    """

    first: np.ndarray
    used: np.ndarray
    thin: np.ndarray


class KnownNodes:
    """The known nodes of a grid, with cumulative sums that test whole blocks at once."""

    def __init__(self, shape: tuple[int, ...], periodic: tuple[bool, ...], holes: np.ndarray):
        self.shape: tuple[int, ...] = shape
        self.periodic: tuple[bool, ...] = periodic
        self.holes: np.ndarray | None = holes if holes.any() else None

    @cached_property
    def _sums(self) -> np.ndarray:
        """Number of holes before each node along all axes; periodic axes are doubled."""
        assert self.holes is not None
        counts = self.holes.astype(np.int64)
        for axis, is_periodic in enumerate(self.periodic):
            counts = np.concatenate([counts, counts], axis=axis) if is_periodic else counts
            counts = counts.cumsum(axis=axis)
        return np.pad(counts, [(1, 0)] * counts.ndim)

    def _is_known(self, first: np.ndarray, nodes: int, thin: np.ndarray) -> np.ndarray:
        """Whether blocks are in the grid and all their nodes are known, shape (k,)."""
        fits = np.ones(first.shape[1], dtype=bool)
        low, high = [], []
        for row, wide, points, wraps in zip(first, ~thin, self.shape, self.periodic, strict=True):
            size = np.where(wide, nodes, 1)
            if not wraps:
                fits &= (row >= 0) & (row + size <= points)
            low.append(row % points if wraps else np.clip(row, 0, points - size))
            high.append(low[-1] + size)
        if self.holes is None:
            return fits
        total = np.zeros(first.shape[1], dtype=np.int64)
        for ends in product((0, 1), repeat=len(low)):
            corner = tuple(b if end else a for a, b, end in zip(low, high, ends, strict=True))
            total += (-1) ** (len(low) - sum(ends)) * self._sums[corner]
        return fits & (total == 0)

    def blocks(self, places: np.ndarray, order: int) -> Blocks:
        """The most centred blocks of known nodes; of lower order if there are none.

        places: in units of the spacing, shape (d, k).
        """
        cells = np.floor(places + SLACK).astype(int)
        # In a grid with holes, a point on a line of nodes uses only nodes of this line.
        thin = np.abs(places - cells) < SLACK
        if self.holes is None:
            thin[:] = False
        first = cells - np.where(thin, 0, order // 2 - 1)
        for axis, (points, wraps) in enumerate(zip(self.shape, self.periodic, strict=True)):
            if not wraps:
                last = points - np.where(thin[axis], 1, order)
                first[axis] = np.clip(first[axis], 0, last)
                cells[axis] = np.clip(cells[axis], 0, points - 2 + thin[axis])
        used = np.full(places.shape[1], order)
        blocks = Blocks(first, used, thin)
        if self.holes is not None:
            used[~self._is_known(first, order, thin)] = 0
            for nodes in range(order, 1, -2):
                self._search(blocks, np.flatnonzero(used == 0), cells, nodes)
        return blocks

    def other(self, blocks: Blocks, places: np.ndarray, order: int) -> Blocks:
        """Blocks of the order to compare with, as for `Rule.other`."""
        rival = self.blocks(places, order)
        same = np.flatnonzero((rival.used == blocks.used) & (rival.used > 0))
        cells = np.where(rival.thin, rival.first, np.floor(places + SLACK).astype(int))
        for nodes in np.unique(rival.used[same]).tolist():
            rest = same[rival.used[same] == nodes]
            if nodes > 2:
                self._search(rival, rest, cells, nodes - 2)
            else:
                # Use only the nearest node: the error is then too large instead of missing.
                first = rival.first[:, rest]
                rival.first[:, rest] = first + (places[:, rest] - first > 1 / 2)
                rival.used[rest] = 1
        return rival

    def _search(self, found: Blocks, rest: np.ndarray, cells: np.ndarray, nodes: int) -> None:
        """Assign the most centred known blocks of a number of nodes to points."""
        middle = nodes / 2 - 1
        options = sorted(
            product(range(nodes - 1), repeat=len(cells)),
            key=lambda shifts: (sum((s - middle) ** 2 for s in shifts), shifts),
        )
        for shifts in options:
            if not len(rest):
                return
            thin = found.thin[:, rest]
            start = cells[:, rest] - np.where(thin, 0, np.array(shifts)[:, None])
            good = self._is_known(start, nodes, thin)
            found.first[:, rest[good]], found.used[rest[good]] = start[:, good], nodes
            rest = rest[~good]

    def terms(self, blocks: Blocks, places: np.ndarray) -> Iterator[Term]:
        """Terms of the weighted sums for points: points, nodes (d, k), weights (k,)."""
        d = len(self.shape)
        kinds = blocks.used * 2**d + 2 ** np.arange(d) @ blocks.thin
        for kind in np.unique(kinds).tolist():
            nodes = kind >> d
            if not nodes:
                continue
            points = np.flatnonzero(kinds == kind)
            rows = slice(None) if len(points) == len(kinds) else points
            first = blocks.first[:, rows]
            sizes = [1 if kind >> axis & 1 else nodes for axis in range(d)]
            offsets = places[:, rows] - first
            weights = [lagrange(n, x) for n, x in zip(sizes, offsets, strict=True)]
            for shift in np.ndindex(*sizes):
                weight = np.prod([w[s] for w, s in zip(weights, shift, strict=True)], axis=0)
                where = tuple(
                    (row + s) % n if wraps else row + s
                    for row, s, n, wraps in zip(
                        first, shift, self.shape, self.periodic, strict=True
                    )
                )
                yield rows, where, weight

    def interpolated(self, values: np.ndarray, blocks: Blocks, places: np.ndarray) -> np.ndarray:
        """Values between the nodes, shape (entries, k), from shape (entries, grid...)."""
        total = np.zeros((len(values), places.shape[1]))
        for rows, where, weight in self.terms(blocks, places):
            total[:, rows] += weight * values[(slice(None), *where)]
        return total


Term = tuple[slice | np.ndarray, tuple[np.ndarray, ...], np.ndarray]
