"""Spanning forest: sums along it, and the closure failure of every other edge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy  # loads its parts on first use


@dataclass(frozen=True, eq=False)
class Forest:
    """A spanning forest with the sums of edge values from each root.

    potential: shape (nodes, n); zero at the roots. error: shape (nodes,).
    parent: the node before each on the way to its root; -1 at roots. depth: edges to the root.
    root: number of the component of each node.
    chords: numbers of the edges that are not in the forest: one fundamental cycle each, along the
        chord and back in the forest.
    closure: closure failure of each of these cycles, shape (chords, n); closure_error: (chords,).
    images: how often each of these cycles winds around the periods, shape (chords, d); d is 0 where
        there are none. Only where all are zero is the closure a Burgers vector.
    """

    potential: np.ndarray
    error: np.ndarray
    parent: np.ndarray
    depth: np.ndarray
    root: np.ndarray
    chords: np.ndarray
    closure: np.ndarray
    closure_error: np.ndarray
    images: np.ndarray


def spanning_forest(
    nodes: int,
    edges: np.ndarray,
    values: np.ndarray,
    errors: np.ndarray | None = None,
    images: np.ndarray | None = None,
) -> Forest:
    """Breadth-first forest of a graph, by scipy.sparse.csgraph, and the closure of its chords.

    Parameters
    ----------
    edges
        Node numbers, shape (edges, 2), each run through from the first to the second.
    values, errors
        What each edge adds, shape (edges, n), and its error, shape (edges,). Whole numbers stay
        whole, and their sums are exact.
    images
        Periods from the first node to the second, shape (edges, d).

    Examples
    --------
    >>> import numpy as np
    >>> triangle = np.array([[0, 1], [1, 2], [2, 0]])
    >>> found = spanning_forest(3, triangle, np.array([[1], [2], [4]]))
    >>> found.chords.tolist(), abs(found.closure).tolist()
    ([1], [[7]])
    """
    tail, head = edges[:, 0], edges[:, 1]
    component, order, before = _breadth_first(nodes, tail, head)
    # From here on nodes are counted in the order of the search: parents then ascend, and related
    # nodes are adjacent in memory.
    place = np.empty(nodes, dtype=np.int64)
    place[order] = np.arange(nodes)
    above = np.where(before < 0, np.arange(nodes), place[before])
    used, sign = _edges_to(above, place[tail], place[head])
    zero = used < 0
    used[zero] = 0
    images = np.zeros((len(edges), 0), dtype=np.int64) if images is None else images
    if not len(edges):
        # Without edges there is none to look up, not even in vain.
        values, images = (np.zeros((1, x.shape[1]), dtype=x.dtype) for x in (values, images))
        errors = None
    steps = [np.where(zero[:, None], 0, sign[:, None] * x[used]) for x in (values, images)]
    bounds = np.zeros(nodes) if errors is None else np.where(zero, 0.0, errors[used])
    levels = np.where(zero, 0, 1)
    potential, offset, bounds, levels = _climbed(above, [*steps, bounds, levels])
    rounding = np.zeros(nodes)
    if values.dtype.kind == "f":
        size = np.abs(potential).max(axis=1, initial=0.0)
        rounding = 2.0**-52 * np.log2(levels + 2.0) * size
    chord = np.ones(len(edges), dtype=bool)
    chord[used[~zero]] = False
    chords = np.flatnonzero(chord)
    start, end = place[tail[chords]], place[head[chords]]
    error = bounds + rounding
    own = 0.0 if errors is None else errors[chords]
    before[before < 0] = -1
    parent = np.empty(nodes, dtype=np.int64)
    parent[order] = before
    return Forest(
        potential=potential[place],
        error=error[place],
        parent=parent,
        depth=levels[place],
        root=component,
        chords=chords,
        closure=potential[start] + values[chords] - potential[end],
        closure_error=own + error[start] + error[end],
        images=offset[start] + images[chords] - offset[end],
    )


def _breadth_first(
    nodes: int, tail: np.ndarray, head: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Component of each node, all nodes in the order of the search, and the node before each."""
    size = (nodes + 1, nodes + 1)

    def table(rows: np.ndarray, columns: np.ndarray) -> scipy.sparse.csr_array:
        return scipy.sparse.csr_array((np.ones(len(rows)), (rows, columns)), size)

    graph = table(tail, head)
    _, component = scipy.sparse.csgraph.connected_components(graph, directed=False)
    component = component[:nodes]
    _, roots = np.unique(component, return_index=True)
    # One more node, joined to a root in each component, makes one tree of the forest.
    more = np.full(len(roots), nodes)
    both = table(np.concatenate([tail, head, more]), np.concatenate([head, tail, roots]))
    order, before = scipy.sparse.csgraph.breadth_first_order(both, nodes, directed=True)
    order = order[1:]
    before = before[order].astype(np.int64)
    before[before == nodes] = -1
    return component, order, before


def _edges_to(
    above: np.ndarray, tail: np.ndarray, head: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The edge from the node above to each node, -1 at roots, and its sense; shape (nodes,) each.

    The first of parallel edges is taken, the others become chords.
    """

    def first(chosen: np.ndarray, ends: np.ndarray) -> np.ndarray:
        edges = np.full(len(above), len(tail))
        # The last of several assignments holds: in reverse order, the assignment of the first edge.
        mine = np.flatnonzero(chosen)[::-1]
        edges[ends[mine]] = mine
        return edges

    proper = tail != head
    forward = first(proper & (above[head] == tail), head)
    back = first(proper & (above[tail] == head), tail)
    used = np.minimum(forward, back)
    return np.where(used < len(tail), used, -1), np.where(forward <= back, 1, -1)


def _climbed(above: np.ndarray, steps: list[np.ndarray]) -> list[np.ndarray]:
    """Sums of each array along the way to the root, nodes counted so that parents ascend."""
    steps = list(steps)
    # Each pass doubles the length of the summed path: log2(depth) passes.
    while True:
        further = above[above]
        if (further == above).all():
            return steps
        for k, step in enumerate(steps):
            if step.size:
                steps[k] = step + step[above]
        above = further
