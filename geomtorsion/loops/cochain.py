"""Cochain: values on nodes, edges, faces or cells of a complex, and their sums."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence, Sized
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import scipy  # loads its parts on first use
from numpy.typing import ArrayLike

from geomtorsion.conventions import Signed
from geomtorsion.errors import NetworkError
from geomtorsion.loops.complexes import Complex
from geomtorsion.loops.spanning_forest import Forest, spanning_forest
from geomtorsion.loops.validation import check_sums, largest, value_rows
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

if TYPE_CHECKING:
    import networkx as nx
    from scipy.sparse import csr_array

NAMES = ("node", "edge", "face", "cell")
Cycle = tuple[Hashable, ...]


@dataclass(frozen=True, eq=False)
class CycleBurgers(Signed):
    """Closure failure of a cycle of a network.

    cycle: nodes in order; vector: b^i, shape (n,); error: bound on its largest component.
    images: how often the cycle winds around each period, shape (d,). If it winds around any, the
        vector is a measured period, and minus the true period a Burgers vector.
    """

    cycle: Cycle
    vector: np.ndarray
    error: float
    images: tuple[int, ...] = ()

    @property
    def vanishes(self) -> bool:
        """Whether the vector is zero within its error."""
        return bool(abs(self.vector).max() <= self.error)


@dataclass(frozen=True, eq=False)
class ChainSums:
    """Sums of a cochain over chains.

    vectors: shape (chains, n), whole where the values are; errors: bound on the largest component
        of each, shape (chains,); images: periods around which each chain winds, (chains, d).
    """

    vectors: np.ndarray
    errors: np.ndarray
    images: np.ndarray


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Cochain:
    """Values on the edges of a network, such as steps measured from atom to atom.

    Equation
    --------
    (d c)(face) = sum of c over its boundary: the Burgers vector of the face, for edges the discrete
    torsion; d d = 0, exactly: Burgers vectors of the faces of a closed cell sum to zero (Bianchi).

    complex: the nodes, edges, faces and cells.
    values: one row for each edge, from its first node to its second, shape (edges, n); whole
        numbers (int64) stay whole, and all their sums are exact.
    errors: bound on the largest component of each row, shape (edges,); zero by default.
    degree: 0 for values on nodes, 1 on edges, 2 on faces, 3 on cells.

    Raises
    ------
    NetworkError
        Shapes do not fit, or a value is not a finite real number; the message names it.
    LimitError
        Whole numbers so large that their sums may leave 64 bits.

    Examples
    --------
    Steps around a dislocation, in units of the lattice: four times three, and one more to close.

    >>> ring = [[0, 1], [1, 2], [2, 3], [3, 0]]
    >>> steps = Cochain.of_edges(ring, [[3, 0], [0, 3], [-4, 0], [0, -3]])
    >>> steps.around([0, 1, 2, 3]).vector.tolist()
    [-1, 0]
    >>> steps.forest.closure.tolist()        # of a basis of all cycles: here one
    [[-1, 0]]

    On a complex with faces the coboundary is the torsion of each face. Its coboundary vanishes:

    >>> import numpy as np
    >>> grid = Complex.grid((2, 2, 2))
    >>> crystal = Cochain(grid, np.arange(12)[:, None] ** 2)
    >>> torsion = crystal.coboundary()
    >>> torsion.values.ravel().tolist(), torsion.coboundary().values.tolist()
    ([16, 16, 35, 35, 8, 8], [[0]])
    """

    complex: Complex
    values: np.ndarray
    errors: np.ndarray | None
    degree: int

    def __init__(
        self,
        complex: Complex,
        values: ArrayLike,
        errors: ArrayLike | None = None,
        degree: int = 1,
    ) -> None:
        def put(name: str, value: object) -> None:
            object.__setattr__(self, name, value)

        put("complex", checks.instance(complex, Complex, "complex", NetworkError))
        put("degree", checks.count(degree, "degree", NetworkError, 0, len(NAMES) - 1))
        count = complex.size(degree)
        put("values", value_rows(values, NAMES[degree], count))
        put("errors", None)
        if errors is None:
            return
        bounds = checks.array(errors, "errors", NetworkError, shape=(count,))
        if (bounds < 0).any():
            k = int(np.argmax(bounds < 0))
            raise NetworkError(f"errors[{k}] = {bounds[k]:g}: expected bounds of zero or more.")
        put("errors", bounds)

    # -- makers -----------------------------------------------------------------------------------

    @classmethod
    def of_edges(
        cls,
        pairs: np.ndarray | Sequence[Sequence[int]],
        values: ArrayLike,
        errors: ArrayLike | None = None,
        *,
        images: np.ndarray | Sequence[Sequence[int]] | None = None,
        nodes: int | None = None,
        labels: Sequence[Hashable] = (),
    ) -> Cochain:
        """Measured edge vectors, without any frame.

        Parameters
        ----------
        pairs
            Numbers of the two nodes of each edge, shape (edges, 2).
        values, errors
            Difference between the second node and the first, shape (edges, n), and bounds on its
            largest component, shape (edges,).
        images
            Offset of the periodic image of the second node, in periods, shape (edges, d), if the
            crystal is periodic.
        nodes, labels
            Number of nodes (None: the nodes that the pairs name), and their names.

        Examples
        --------
        A chain of two atoms in a period of length 5, where the lattice has 2 + 2:

        >>> steps = Cochain.of_edges([[0, 1], [1, 0]], [[2], [2]], images=[[0], [1]])
        >>> steps.forest.closure.tolist(), steps.forest.images.tolist()
        ([[4]], [[1]])
        """
        edge_complex = Complex.of_edges(pairs, nodes, images, labels)
        return cls(edge_complex, value_rows(values, NAMES[1], len(edge_complex.pairs)), errors)

    @classmethod
    def of_graph(
        cls,
        graph: nx.DiGraph[Hashable],
        value: str = "vector",
        error: str = "error",
        image: str = "image",
    ) -> Cochain:
        """Edge vectors from the attributes of a directed networkx graph (or multigraph).

        Raises
        ------
        NetworkError
            The graph is not directed, or an edge lacks its value.

        Examples
        --------
        >>> import networkx as nx
        >>> graph = nx.DiGraph()
        >>> graph.add_weighted_edges_from(
        ...     [("a", "b", (1, 0)), ("b", "c", (0, 1)), ("c", "a", (-1, 0))], weight="vector"
        ... )
        >>> Cochain.of_graph(graph).around("abc").vector.tolist()
        [0, 1]
        """
        if not hasattr(graph, "is_directed") or not graph.is_directed():
            raise NetworkError(
                f"expected a networkx.DiGraph or MultiDiGraph, got {type(graph).__name__}: "
                "a step has a sense, from its first node to its second."
            )
        labels = list(graph.nodes)
        numbers = {label: k for k, label in enumerate(labels)}
        rows = list(graph.edges(data=True))
        for a, b, data in rows:
            if value not in data:
                raise NetworkError(
                    f"the edge from {a!r} to {b!r} has no {value!r}. Give every edge its vector."
                )
        pairs = [(numbers[a], numbers[b]) for a, b, _ in rows]
        offsets = [data.get(image) for _, _, data in rows]
        d = max((len(x) for x in offsets if isinstance(x, Sized)), default=0)
        images = [(0,) * d if x is None else x for x in offsets] if d else None
        errors = [data.get(error, 0.0) for _, _, data in rows]
        edge_complex = Complex.of_edges(
            np.array(pairs, dtype=np.int64).reshape(-1, 2), len(labels), images, labels
        )  # fmt: skip
        vectors = [data[value] for _, _, data in rows]
        return cls(edge_complex, vectors, errors if any(errors) else None)

    @classmethod
    def between(
        cls,
        complex: Complex,
        positions: np.ndarray | Sequence[Sequence[float]],
        periods: np.ndarray | Sequence[Sequence[float]] | None = None,
    ) -> Cochain:
        """Differences of positions along the edges: a cochain whose sum around every face is zero.

        Parameters
        ----------
        positions
            Coordinates of the nodes, shape (nodes, n).
        periods
            Vector of each period, shape (d, n); required if the complex has images.

        Examples
        --------
        >>> ring = Complex.grid((3,), periodic=True)
        >>> Cochain.between(ring, [[0], [4], [5]], [[10]]).values.ravel().tolist()
        [4, 1, 5]
        """
        steps = cls(complex, positions, degree=0).coboundary()
        images = complex.images
        if not images.shape[1]:
            return steps
        if periods is None:
            raise NetworkError(
                f"periods: expected the change of positions over {images.shape[1]} periods, "
                "shape (d, n), because the complex has images; got None."
            )
        shape = (images.shape[1], steps.values.shape[1])
        cell = value_rows(periods, "period", shape[0])
        if cell.shape != shape:
            raise NetworkError(f"periods: expected shape {shape}, got {cell.shape}.")
        return replace(steps, values=steps.values + images @ cell)

    # -- algebra ----------------------------------------------------------------------------------

    @property
    def is_whole(self) -> bool:
        """Whether the values are whole numbers, whose sums are exact."""
        return self.values.dtype.kind == "i"

    @property
    def bounds(self) -> np.ndarray:
        """The errors, zero where none were given, shape (edges,)."""
        return np.zeros(len(self.values)) if self.errors is None else self.errors

    def __add__(self, other: Cochain) -> Cochain:
        if not isinstance(other, Cochain):
            return NotImplemented
        if other.complex is not self.complex or other.degree != self.degree:
            raise NetworkError("sum: expected cochains of one complex and one degree.")
        if other.values.shape != self.values.shape:
            raise NetworkError(
                f"cochains of {self.values.shape[1]} and {other.values.shape[1]} components cannot "
                "be added."
            )
        errors = None
        if self.errors is not None or other.errors is not None:
            errors = self.bounds + other.bounds
        return Cochain(self.complex, self.values + other.values, errors, self.degree)

    def __neg__(self) -> Cochain:
        return replace(self, values=-self.values)

    def __sub__(self, other: Cochain) -> Cochain:
        return self + (-other) if isinstance(other, Cochain) else NotImplemented

    def mapped(self, matrix: np.ndarray | Sequence[Sequence[float]]) -> Cochain:
        """The values times a matrix, row by row: for example from lattice coordinates to lengths.

        Parameters
        ----------
        matrix
            Shape (n, m); row k is the image of the k-th unit vector.

        Examples
        --------
        >>> steps = Cochain.of_edges([[0, 1]], [[1, 2]])
        >>> steps.mapped([[0.5, 0.0], [0.0, 0.25]]).values.tolist()
        [[0.5, 0.5]]
        """
        n = self.values.shape[1]
        table = value_rows(matrix, "row of the matrix", n)
        if self.is_whole and table.dtype.kind == "i":
            check_sums(float(n * largest(self.values)) * largest(table))
        result, errors = self.values @ table, self.errors
        if errors is not None:
            errors = errors * float(np.abs(table).sum(axis=0).max(initial=0.0))
        if result.dtype.kind == "f":
            # Each of n terms is rounded, and each partial sum.
            size = (np.abs(self.values) @ np.abs(table)).max(axis=1, initial=0.0)
            errors = (0.0 if errors is None else errors) + 2.0**-53 * (n + 1) * size
        return Cochain(self.complex, result, errors, self.degree)

    def coboundary(self) -> Cochain:
        """Sums over the boundary of each edge, face or cell: the cochain one degree higher.

        The coboundary of steps along edges is the closure failure of every face, the discrete
        torsion. The coboundary of a coboundary is zero, for floats up to rounding, which the errors
        contain.

        Raises
        ------
        NetworkError
            The complex has no faces, or no cells.
        """
        sums = self.over(self.complex.boundary(self.degree))
        errors = None if self.is_whole and self.errors is None else sums.errors
        return Cochain(self.complex, sums.vectors, errors, self.degree + 1)

    def divergence(self) -> ChainSums:
        """At each node: sum over the edges that leave it minus sum over the edges that arrive.

        For Burgers vectors on dislocation lines it is zero where lines meet (node rule).

        Examples
        --------
        >>> lines = Cochain.of_edges([[0, 2], [1, 2], [2, 3]], [[1, 0], [0, 1], [1, 1]])
        >>> lines.divergence().vectors.tolist()
        [[1, 0], [0, 1], [0, 0], [-1, -1]]
        """
        self._on_edges()
        return self._summed((-self.complex.boundary(0)).T.tocsr())

    def over(self, chains: csr_array | np.ndarray | Mapping[int, int]) -> ChainSums:
        """Sums over chains: whole multiples of edges (or of faces, or cells).

        Parameters
        ----------
        chains
            {edge: multiple} of one chain, or a matrix (sparse or not) of multiples, shape
            (chains, edges).

        Examples
        --------
        >>> steps = Cochain.of_edges([[0, 1], [1, 2]], [[1.0], [2.0]], [0.125, 0.25])
        >>> found = steps.over({0: 1, 1: -1})
        >>> found.vectors.tolist(), found.errors.round(9).tolist()
        ([[-1.0]], [0.375])
        """
        return self._summed(self._chains(chains))

    def _summed(self, table: csr_array) -> ChainSums:
        """Sums over the rows of a matrix of whole multiples."""
        sizes = abs(table)
        if self.is_whole:
            check_sums(float(sizes.sum(axis=1).max(initial=0)) * largest(self.values))
        vectors = np.asarray(table @ self.values)
        errors = sizes @ self.bounds
        if not self.is_whole:
            # Each of k terms is rounded, and each partial sum.
            terms = np.diff(table.indptr)
            absolute = (sizes @ np.abs(self.values)).max(axis=1, initial=0.0)
            errors = errors + 2.0**-53 * (terms + 1) * absolute
        images = self.complex.images
        if self.degree != 1 or not images.shape[1]:
            return ChainSums(vectors, errors, np.zeros((len(vectors), 0), dtype=np.int64))
        return ChainSums(vectors, errors, np.asarray(table @ images))

    def _chains(self, chains: csr_array | np.ndarray | Mapping[int, int]) -> csr_array:
        """Chains as a sparse matrix of whole numbers."""
        count, name = len(self.values), NAMES[self.degree]
        if isinstance(chains, Mapping):
            wanted = f"numbers of {name}s from 0 to {count - 1}"
            columns = np.array(
                [
                    checks.count(k, "chain", NetworkError, 0, count - 1, expected=wanted)
                    for k in chains
                ],
                dtype=np.int64,
            )
            signs = np.array(list(chains.values()))
            if not signs.size:
                signs = np.zeros(0, dtype=np.int64)
            if signs.ndim != 1 or signs.dtype.kind not in "iu":
                raise NetworkError("chain: expected whole multiples: {edge: 1, other edge: -1}.")
            entries = signs, (np.zeros_like(columns), columns)
            return scipy.sparse.csr_array(entries, shape=(1, count))
        table = chains if scipy.sparse.issparse(chains) else np.atleast_2d(np.asarray(chains))
        if table.shape[-1] != count or table.dtype.kind not in "iu":
            raise NetworkError(
                f"chains: expected whole numbers of shape (chains, {count}), got {table.dtype} "
                f"of shape {table.shape}."
            )
        # A copy, since sums of doubled entries would be made in the matrix that was given.
        matrix = scipy.sparse.csr_array(table, copy=True)
        matrix.sum_duplicates()
        return matrix

    # -- cycles -----------------------------------------------------------------------------------

    @cached_property
    def forest(self) -> Forest:
        """Sums along a spanning forest and the closure of every chord, as arrays.

        `forest.chords` are the edges outside the forest, `forest.closure` the closure failures of
        their fundamental cycles (a basis of all cycles), `forest.potential` the resulting position
        of each node.

        Raises
        ------
        NetworkError
            The values are not on edges.
        """
        self._on_edges()
        return spanning_forest(
            self.complex.nodes, self.complex.pairs, self.values, self.errors, self.complex.images
        )

    def around(self, cycle: Sequence[Hashable]) -> CycleBurgers:
        """The closure failure of a cycle of nodes: the signed sum of its edges.

        Raises
        ------
        NetworkError
            Two neighbours are not joined by an edge, or by several edges with different values.
        """
        self._on_edges()
        nodes, edges, senses = self.complex.along(cycle)
        several = self._several
        for k, edge in enumerate(edges.tolist()):
            if several[edge]:
                a, b = nodes[k], nodes[(k + 1) % len(nodes)]
                raise NetworkError(
                    f"edges of different values join {a!r} and {b!r}: give the cycle by edges, "
                    ".over({edge: sense})."
                )
        return self.along(tuple(nodes), edges, senses)

    def along(self, cycle: Cycle, edges: np.ndarray, senses: np.ndarray) -> CycleBurgers:
        """The sum along edges, by number and sense; they must form a cycle (not checked)."""
        rows = senses[:, None] * self.values[edges]
        images = tuple((senses @ self.complex.images[edges]).tolist())
        if self.is_whole:
            return CycleBurgers(cycle, rows.sum(axis=0), float(self.bounds[edges].sum()), images)
        vector = np.array([math.fsum(column) for column in rows.T.tolist()])
        error = math.fsum(self.bounds[edges].tolist())
        size = float(np.abs(vector).max(initial=0.0))
        return CycleBurgers(cycle, vector, error + 2.0**-53 * size, images)

    @cached_property
    def _several(self) -> np.ndarray:
        """Edges beside which another one of a different value joins the same nodes."""
        low, high = np.sort(self.complex.pairs, axis=1).T
        key = low * self.complex.nodes + high
        sign = np.where(self.complex.pairs[:, 0] == low, 1, -1)
        _, first, which = np.unique(key, return_index=True, return_inverse=True)
        differs = np.zeros(len(key), dtype=bool)
        for table in (self.values, self.complex.images):
            turned = sign[:, None] * table
            differs |= (turned != turned[first[which]]).any(axis=1)
        several = np.zeros(len(first), dtype=bool)
        several[which[differs]] = True
        return several[which]

    def _on_edges(self) -> None:
        """Refuse cochains without cycles."""
        if self.degree != 1:
            raise NetworkError(
                f"values on {NAMES[self.degree]}s have no cycles: expected values on edges."
            )

    def __repr__(self) -> str:
        count, n = self.values.shape
        kind = "whole" if self.is_whole else "float"
        name = NAMES[self.degree]
        return f"Cochain({count} {name}{'' if count == 1 else 's'}, {n} {kind} components)"
