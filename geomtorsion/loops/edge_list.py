"""Edge list: positions and edges of a network as arrays, checked once."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.errors import NetworkError

if TYPE_CHECKING:
    import networkx as nx


@dataclass(frozen=True, eq=False)
class EdgeList:
    """A large network without a graph object.

    positions: coordinates of the nodes, shape (nodes, n).
    pairs: numbers of the two nodes of each edge, shape (edges, 2).
    labels: what the nodes are called; their numbers if not given.

    Examples
    --------
    >>> import numpy as np
    >>> from geomtorsion.geometry import Frame
    >>> from geomtorsion.loops import Network
    >>> square = EdgeList(
    ...     np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]]),
    ...     np.array([[0, 1], [1, 2], [2, 3], [3, 0]]),
    ... )
    >>> Network(Frame(["x", "y"], [[1, 0], [0, 1]]), square).cycle_count
    1
    """

    positions: np.ndarray
    pairs: np.ndarray
    labels: Sequence[Hashable] = ()

    @cached_property
    def numbers(self) -> dict[Hashable, int]:
        """Label -> number of the node."""
        return {label: k for k, label in enumerate(self.labels)}


def edge_list(graph: Any, position: str, dimension: int) -> EdgeList:
    """Arrays of a graph (or of an `EdgeList`), with every position and edge checked.

    Raises
    ------
    NetworkError
        There are no edges, a node has no usable position, or an edge no length.
    """

    if isinstance(graph, EdgeList):
        positions = np.asarray(graph.positions, dtype=float)
        pairs = np.asarray(graph.pairs)
        labels: Sequence[Hashable] = graph.labels or range(len(positions))
    else:
        positions, pairs, labels = _of_graph(graph, position, dimension)
    if positions.ndim != 2 or positions.shape[1] != dimension:
        raise NetworkError(
            f"positions of shape (nodes, {dimension}) were needed, but {positions.shape} came."
        )
    if not len(pairs):
        raise NetworkError("the network has no edges: there is nothing to integrate along.")
    if pairs.ndim != 2 or pairs.shape[1] != 2 or not np.issubdtype(pairs.dtype, np.integer):
        raise NetworkError(
            f"edges: whole numbers of shape (edges, 2) were needed, but {pairs.dtype} of shape "
            f"{pairs.shape} came."
        )
    if pairs.min() < 0 or pairs.max() >= len(positions):
        raise NetworkError(
            f"edges: node numbers from 0 to {len(positions) - 1} were needed, but "
            f"{pairs.min()} to {pairs.max()} came."
        )
    bad = np.flatnonzero(~np.isfinite(positions).all(axis=1))
    if len(bad):
        raise NetworkError(
            f"node {labels[int(bad[0])]!r}: finite coordinates were needed, but "
            f"{positions[bad[0]].tolist()} came."
        )
    still = np.flatnonzero((positions[pairs[:, 0]] == positions[pairs[:, 1]]).all(axis=1))
    if len(still):
        a, b = (labels[int(node)] for node in pairs[still[0]])
        raise NetworkError(
            f"the edge between {a!r} and {b!r} has no length: both ends lie at "
            f"{positions[pairs[still[0], 0]].tolist()}. Remove it or move one of them."
        )
    return EdgeList(positions, pairs, labels)


def _of_graph(
    graph: nx.Graph, position: str, dimension: int
) -> tuple[np.ndarray, np.ndarray, list[Hashable]]:
    """Arrays of a networkx graph."""

    labels = list(graph.nodes)
    rows = []
    for label, place in graph.nodes(data=position):
        if place is None:
            raise NetworkError(
                f"node {label!r} has no {position!r}. Give every node its coordinates with "
                f"networkx.set_node_attributes(graph, positions, {position!r})."
            )
        try:
            row = tuple(float(x) for x in place)
        except (TypeError, ValueError):
            row = ()
        if len(row) != dimension:
            raise NetworkError(
                f"node {label!r}: {position!r} needs {dimension} numbers, but {place!r} came."
            )
        rows.append(row)
    numbers = {label: k for k, label in enumerate(labels)}
    pairs = [(numbers[a], numbers[b]) for a, b in graph.edges()]
    positions = np.array(rows, dtype=float).reshape(len(rows), dimension)
    return positions, np.array(pairs, dtype=np.int64).reshape(len(pairs), 2), labels
