"""Complex: nodes, edges, faces and cells, with the boundary of each as whole numbers."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.errors import NetworkError
from geomtorsion.loops.validation import listed, once_round
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.checks import whole_array

if TYPE_CHECKING:
    from scipy.sparse import csr_array


@dataclass(frozen=True, eq=False, repr=False)
class Complex:
    """Cell complex: a graph, with optional faces (cycles of edges) and cells (closed by faces).

    nodes: number of nodes; their numbers count from 0.
    pairs: first and second node of each edge, shape (edges, 2); several edges may join the same
        nodes, and an edge may end where it begins (in another image).
    images: number of periods between the two nodes of each edge, shape (edges, d): the second
        node is in the periodic image with this offset. d = 0: nothing is periodic.
    faces: sense in which each face runs through each edge, sparse, shape (faces, edges).
    cells: sense in which each cell has each face, sparse, shape (cells, faces): 1 outwards.
    labels: names of the nodes; their numbers by default.

    Raises
    ------
    NetworkError
        A node does not exist, or a face or cell is not closed (in the space without periods).

    Examples
    --------
    >>> cube = Complex.grid((2, 2, 2))
    >>> cube, abs(cube.boundary(1) @ cube.boundary(0)).sum()
    (Complex(8 nodes, 12 edges, 6 faces, 1 cell), np.int64(0))
    """

    nodes: int
    pairs: np.ndarray
    images: np.ndarray
    faces: csr_array | None = None
    cells: csr_array | None = None
    labels: Sequence[Hashable] = ()

    def __post_init__(self) -> None:
        """Check that every boundary is closed, exactly."""
        pairs = whole_array(self.pairs, "pairs", NetworkError, 2)
        checks.count(self.nodes, "nodes", NetworkError)
        object.__setattr__(self, "pairs", pairs)
        if len(pairs) and (pairs.min() < 0 or pairs.max() >= self.nodes):
            raise NetworkError(
                f"edges: expected node numbers from 0 to {self.nodes - 1}, got "
                f"{pairs.min()} to {pairs.max()}."
            )
        images = whole_array(self.images, "images", NetworkError)
        remedy = "Each row counts the periods from the first node of an edge to the second."
        checks.check_one_each(images, len(pairs), "edges", "images", NetworkError, remedy)
        object.__setattr__(self, "images", images)
        # A range of numbers stays a range: a list of a million names is made only on request.
        labels = self.labels if isinstance(self.labels, range) else listed(self.labels, "labels")
        object.__setattr__(self, "labels", labels)
        if labels:
            checks.check_one_each(labels, self.nodes, "nodes", "labels", NetworkError)
        for table, name in zip(self._up, ("faces", "cells"), strict=True):
            _check_table(table, name)
        if self.faces is not None:
            self._check_closed(1, "face", "edges")
            if images.size and (self.faces @ images).any():
                k = int(np.flatnonzero((self.faces @ images).any(axis=1))[0])
                raise NetworkError(
                    f"face {k} winds around a period: {(self.faces @ images)[k].tolist()}. A face "
                    "must close where it began, not in another image."
                )
        if self.cells is not None:
            self._check_closed(2, "cell", "faces")

    def _check_closed(self, degree: int, name: str, sides: str) -> None:
        """Refuse a boundary that has a boundary itself."""
        here, below = self.boundary(degree), self.boundary(degree - 1)
        if here.shape[1] != below.shape[0]:
            raise NetworkError(
                f"{name}s: expected a column for each of {below.shape[0]} {sides}, got "
                f"{here.shape[1]}."
            )
        rest = here @ below
        rest.eliminate_zeros()
        if rest.nnz:
            k = int(rest.tocoo().coords[0][0])
            raise NetworkError(
                f"{name} {k} is not closed: its {sides} {here[[k]].indices.tolist()} have a "
                "boundary. Give them in order, each with its sense."
            )

    # -- makers -----------------------------------------------------------------------------------

    @classmethod
    def of_edges(
        cls,
        pairs: np.ndarray | Sequence[Sequence[int]],
        nodes: int | None = None,
        images: np.ndarray | Sequence[Sequence[int]] | None = None,
        labels: Sequence[Hashable] = (),
    ) -> Complex:
        """Graph of edges. nodes: number of nodes; None: the nodes that the pairs name."""
        ends = whole_array(pairs, "pairs", NetworkError, 2)
        node_count = int(ends.max(initial=-1)) + 1
        count = node_count if nodes is None else checks.count(nodes, "nodes", NetworkError)
        offsets = (
            _no_images(ends) if images is None else whole_array(images, "images", NetworkError)
        )
        return cls(count, ends, offsets, labels=labels)

    @classmethod
    def of_simplices(
        cls, simplices: np.ndarray | Sequence[Sequence[int]], nodes: int | None = None
    ) -> Complex:
        """Triangles, shape (k, 3), or tetrahedra, shape (k, 4), with all their edges and faces.

        Faces and cells have the sense of the simplices, as `scipy.spatial.Delaunay` gives them.

        Examples
        --------
        >>> Complex.of_simplices([[0, 1, 2, 3]])
        Complex(4 nodes, 6 edges, 4 faces, 1 cell)
        """
        corners = whole_array(simplices, "simplices", NetworkError)
        count = corners.shape[1]
        if count not in (3, 4):
            raise NetworkError(f"simplices: expected 3 or 4 corners each, got {count}.")
        if (np.diff(np.sort(corners, axis=1), axis=1) == 0).any():
            raise NetworkError("simplices: the corners of each must differ.")
        node_count = int(corners.max(initial=-1)) + 1
        size = node_count if nodes is None else checks.count(nodes, "nodes", NetworkError)
        cells = None
        if count == 4:
            corners, cells = sides_of(corners)
        pairs, faces = sides_of(corners)
        return cls(size, pairs, _no_images(pairs), faces, cells)

    @classmethod
    def grid(cls, shape: Sequence[int], periodic: Sequence[bool] | bool = False) -> Complex:
        """A grid of nodes in any number of dimensions, all its faces and (from three on) cells.

        Edges are numbered axis by axis, in the order of their first nodes; faces by pairs of axes,
        oriented from the first axis to the second, and cells likewise.

        Parameters
        ----------
        shape
            Nodes along each axis; node (i, j, ...) has the number that
            `numpy.ravel_multi_index` gives it.
        periodic
            Whether the last node of an axis is joined to the first, one period further on.

        Examples
        --------
        >>> Complex.grid((4, 3), periodic=(True, False))
        Complex(12 nodes, 20 edges, 8 faces)
        """
        axes = enumerate(listed(shape, "shape"))
        sizes = tuple(checks.count(n, f"shape[{k}]", NetworkError) for k, n in axes)
        every = [periodic] * len(sizes) if isinstance(periodic, bool) else periodic
        return _grid(cls, sizes, checks.flags(every, len(sizes), "periodic", NetworkError))

    def with_faces(self, cycles: Sequence[Sequence[Hashable]] | np.ndarray) -> Complex:
        """The same graph with faces, each a cycle of nodes in order.

        Raises
        ------
        NetworkError
            Two neighbours are not joined by an edge.
        """
        rows: list[np.ndarray] = []
        if isinstance(cycles, np.ndarray):
            corners = whole_array(cycles, "cycles", NetworkError)
            owner = np.repeat(np.arange(len(corners)), corners.shape[1])
            starts, ends = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
            count = len(corners)
        else:
            named = [
                once_round(cycle, f"cycles[{k}]")
                for k, cycle in enumerate(listed(cycles, "cycles"))
            ]
            rows = [np.array([self.number(x) for x in cycle], dtype=np.int64) for cycle in named]
            owner = np.repeat(np.arange(len(rows)), [len(row) for row in rows])
            starts = np.concatenate([np.zeros(0, np.int64), *rows])
            ends = np.concatenate([np.zeros(0, np.int64), *(np.roll(row, -1) for row in rows)])
            count = len(rows)
        edges, senses = self.steps(starts, ends)
        table = (senses, (owner, edges))
        faces = scipy.sparse.csr_array(table, shape=(count, len(self.pairs)))
        return Complex(self.nodes, self.pairs, self.images, faces, None, self.labels)

    # -- boundaries -------------------------------------------------------------------------------

    def boundary(self, degree: int) -> csr_array:
        """Boundaries as a matrix of whole numbers: of edges (0), faces (1) and cells (2).

        Each row belongs to a bounded element: the matrix takes values on nodes to their differences
        along edges, values on edges to sums around faces, values on faces to sums over cells.
        The product of two successive matrices is exactly zero.

        Raises
        ------
        NetworkError
            The complex has no faces, or no cells.
        """
        if checks.count(degree, "degree", NetworkError, 0, 2) == 0:
            return self._differences
        matrix = self.faces if degree == 1 else self.cells
        if matrix is None:
            name = "faces" if degree == 1 else "cells"
            raise NetworkError(
                f"the complex has no {name}. Make one with them: Complex.grid, "
                "Complex.of_simplices or .with_faces(cycles)."
            )
        return matrix

    @cached_property
    def _differences(self) -> csr_array:
        """Second node minus first, shape (edges, nodes)."""
        count = len(self.pairs)
        signs = np.tile(np.array([-1, 1]), count)
        start = np.arange(0, 2 * count + 1, 2)
        matrix = scipy.sparse.csr_array(
            (signs, self.pairs.flatten(), start), shape=(count, self.nodes)
        )
        # An edge that ends where it begins, in another image, has both its signs in one place.
        matrix.sum_duplicates()
        return matrix

    def size(self, degree: int) -> int:
        """Number of nodes (0), edges (1), faces (2) or cells (3)."""
        counts = (self.nodes, len(self.pairs), *(0 if x is None else x.shape[0] for x in self._up))
        return counts[degree]

    @property
    def _up(self) -> tuple[csr_array | None, csr_array | None]:
        """Faces and cells."""
        return self.faces, self.cells

    # -- nodes and edges --------------------------------------------------------------------------

    @cached_property
    def _numbers(self) -> dict[Hashable, int]:
        """Label -> number of the node."""
        return {label: k for k, label in enumerate(self.labels or range(self.nodes))}

    def number(self, label: Hashable) -> int:
        """The number of a node.

        Raises
        ------
        NetworkError
            There is no such node.
        """
        try:
            return self._numbers[label]
        except (KeyError, TypeError):
            raise NetworkError(f"node {checks.shown(label)} is not in the network.") from None

    def label(self, node: int) -> Hashable:
        """Name of a node."""
        return self.labels[node] if self.labels else node

    @cached_property
    def _table(self) -> tuple[np.ndarray, np.ndarray]:
        """Keys of the pairs of nodes that edges join, ascending, and the first edge of each."""
        low, high = self.pairs.min(axis=1), self.pairs.max(axis=1)
        return np.unique(low * self.nodes + high, return_index=True)

    @property
    def neighbours(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Joined pairs of nodes (lower, higher), ascending; the index where each lower begins."""
        keys = self._table[0]
        low, high = keys // self.nodes, keys % self.nodes
        low, high = low[low != high], high[low != high]
        return low, high, np.searchsorted(low, np.arange(self.nodes + 1))

    def joins(self, starts: np.ndarray, ends: np.ndarray) -> np.ndarray:
        """Whether edges join these nodes, shape (k,)."""
        return self._found(starts, ends)[1]

    def _found(self, starts: np.ndarray, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Places of pairs of nodes in the table, and whether they are in it."""
        keys, _ = self._table
        targets = np.minimum(starts, ends) * self.nodes + np.maximum(starts, ends)
        place = np.minimum(np.searchsorted(keys, targets), max(len(keys) - 1, 0))
        return place, keys[place] == targets if len(keys) else np.zeros(len(targets), dtype=bool)

    def steps(self, starts: np.ndarray, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Number and sense of the first edge that joins each start to its end, shape (k,) each.

        Raises
        ------
        NetworkError
            Two of them are not joined by an edge.
        """
        place, present = self._found(starts, ends)
        if not present.all():
            k = int(np.argmin(present))
            a, b = self.label(int(starts[k])), self.label(int(ends[k]))
            raise NetworkError(f"there is no edge between {a!r} and {b!r}.")
        edges = self._table[1][place]
        return edges, np.where(self.pairs[edges, 0] == starts, 1, -1)

    def along(self, cycle: object, least: int = 2) -> tuple[list[Hashable], np.ndarray, np.ndarray]:
        """The nodes of a cycle in order, each once, and number and sense of the edges between them.

        Raises
        ------
        NetworkError
            Two neighbours are not joined by an edge, a node does not exist, or there are too few
            nodes.
        """
        chain = once_round(cycle, "cycle")
        if len(chain) < least:
            raise NetworkError(f"expected a cycle of {least} nodes or more, got {chain}.")
        numbers = np.array([self.number(node) for node in chain], dtype=np.int64)
        return chain, *self.steps(numbers, np.roll(numbers, -1))

    def __repr__(self) -> str:
        names = ("node", "edge", "face", "cell")
        counts = [(self.size(k), name) for k, name in enumerate(names)]
        shown = [f"{n} {name}{'' if n == 1 else 's'}" for n, name in counts if n]
        return f"Complex({', '.join(shown) or 'empty'})"


def _check_table(table: Any, subject: str) -> None:
    """Refuse everything except sparse matrices of whole numbers."""
    if table is None:
        return
    if not (scipy.sparse.issparse(table) and table.dtype.kind in "iu"):
        raise NetworkError(
            f"{subject}: expected a sparse matrix of whole numbers, got {checks.shown(table)}. "
            "Use .with_faces(cycles)."
        )


def _no_images(pairs: np.ndarray) -> np.ndarray:
    """No periods at all."""
    return np.zeros((len(pairs), 0), dtype=np.int64)


def sides_of(simplices: np.ndarray) -> tuple[np.ndarray, csr_array]:
    """The sides of simplices, each once, and with which sense each simplex has each side.

    The boundary of (a, b, c, ...) is (b, c, ...) - (a, c, ...) + (a, b, ...) - ...
    """
    count, corners = len(simplices), simplices.shape[1]
    order = np.argsort(simplices, axis=1)
    rows = np.take_along_axis(simplices, order, axis=1)
    odd = _parity(order)
    every = np.concatenate([np.delete(rows, k, axis=1) for k in range(corners)])
    # Ranks of all columns but the last, then with it: far faster than to compare whole rows.
    top, key, first = int(simplices.max(initial=0)) + 1, every[:, 0], np.arange(len(every))
    for column in every.T[1:]:
        _, first, key = np.unique(key * top + column, return_index=True, return_inverse=True)
    sides, which = every[first], key
    signs = np.concatenate([(-1) ** k * odd for k in range(corners)])
    owner = np.tile(np.arange(count), corners)
    return sides, scipy.sparse.csr_array((signs, (owner, which.ravel())), shape=(count, len(sides)))


def _parity(order: np.ndarray) -> np.ndarray:
    """+1 for even permutations, -1 for odd ones, shape (k,)."""
    sign = np.ones(len(order), dtype=np.int64)
    for a, b in combinations(range(order.shape[1]), 2):
        sign *= np.where(order[:, a] > order[:, b], -1, 1)
    return sign


def _grid(kind: type[Complex], sizes: tuple[int, ...], around: Sequence[bool]) -> Complex:
    """The complex of a grid; see Complex.grid."""
    number = np.arange(int(np.prod(sizes))).reshape(sizes)
    axes = range(len(sizes))

    def present(along: tuple[int, ...]) -> np.ndarray:
        """Nodes from which there is a step along all these axes, shape (k,)."""
        ends = [slice(None if around[k] or k not in along else sizes[k] - 1) for k in axes]
        return number[tuple(ends)].ravel()

    places: dict[tuple[int, ...], np.ndarray] = {}
    counts = [0, 0, 0, 0]
    for degree in (1, 2, 3):
        for along in combinations(axes, degree):
            nodes = present(along)
            table = np.full(number.size, -1)
            table[nodes] = counts[degree] + np.arange(len(nodes))
            places[along] = table
            counts[degree] += len(nodes)
    shifted = [np.roll(number, -1, axis=k).ravel() for k in axes]
    pairs, images = [], []
    for k in axes:
        start = present((k,))
        pairs.append(np.stack([start, shifted[k][start]], axis=1))
        image = np.zeros((len(start), len(sizes)), dtype=np.int64)
        image[:, k] = shifted[k][start] <= start
        images.append(image)
    boundaries: list[csr_array | None] = []
    for degree in (2, 3):
        rows, columns, signs = [], [], []
        for along in combinations(axes, degree):
            nodes = present(along)
            owner = places[along][nodes]
            for m, axis in enumerate(along):
                rest = tuple(k for k in along if k != axis)
                for start, sign in ((nodes, -1), (shifted[axis][nodes], 1)):
                    rows.append(owner)
                    columns.append(places[rest][start])
                    signs.append(np.full(len(owner), sign * (-1) ** m))
        shape = (counts[degree], counts[degree - 1])
        matrix = None
        if rows and shape[0]:
            every = tuple(np.concatenate(x) for x in (signs, rows, columns))
            matrix = scipy.sparse.csr_array((every[0], (every[1], every[2])), shape=shape)
        boundaries.append(matrix)
    offsets = np.concatenate(images)[:, [k for k in axes if around[k]]]
    faces, cells = boundaries
    return kind(number.size, np.concatenate(pairs), offsets, faces, cells)
