"""Edges: networks as arrays, and the integrals of a coframe along all their straight edges."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.errors import NetworkError, SingularPointError
from geomtorsion.loops.arcs import Parameters, Part, Segment, shown
from geomtorsion.loops.complexes import Complex
from geomtorsion.loops.defects import find_defects, lines_alone
from geomtorsion.loops.domain import edge_values, refuse_points
from geomtorsion.loops.forms import Form, Forms, forms
from geomtorsion.loops.integrals import line_route
from geomtorsion.loops.poles import SAMPLES, refuse_poles, steep
from geomtorsion.loops.quadrature import PIECE, ROUNDING, cut, gauss_pair, graded, halved
from geomtorsion.loops.validation import rows
from geomtorsion.loops.winding import nearest
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import CALCULATED

if TYPE_CHECKING:
    import networkx as nx

    from geomtorsion.geometry import Frame

# Most edges are so short that fewer points of Gauss than Kronrod's are enough.
POINTS = (4, 7)
# Nearer than half a step between these points, as share of an edge, lines make a peak that they may
# miss: it is twice as wide as the line is far.
NEAR = 1 / (2 * max(POINTS))


@dataclass(frozen=True, eq=False)
class EdgeList:
    """A large network without a graph object.

    positions: coordinates of the nodes, shape (nodes, n).
    pairs: numbers of the two nodes of each edge, shape (edges, 2).
    labels: names of the nodes; their numbers by default.

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
        return {label: k for k, label in enumerate(self.labels or range(len(self.positions)))}

    @cached_property
    def complex(self) -> Complex:
        """Nodes and edges without positions."""
        return Complex.of_edges(self.pairs, len(self.positions), labels=self.labels)


def edge_list(graph: nx.Graph[Hashable] | EdgeList, position: str, dimension: int) -> EdgeList:
    """Arrays of a graph (or of an `EdgeList`), with every position and edge checked.

    Raises
    ------
    NetworkError
        There are no edges, a node has no usable position, or an edge no length.
    """
    if isinstance(graph, EdgeList):
        shape = (None, dimension)
        positions = checks.array(
            graph.positions, "positions", NetworkError, shape=shape, infinite=None
        )
        pairs = checks.whole_array(graph.pairs, "edges", NetworkError, 2)
        labels: Sequence[Hashable] = graph.labels or range(len(positions))
    else:
        positions, pairs, labels = _of_graph(graph, position, dimension)
    if not len(pairs):
        raise NetworkError("the network has no edges: there is nothing to integrate along.")
    if pairs.min() < 0 or pairs.max() >= len(positions):
        raise NetworkError(
            f"edges: expected node numbers from 0 to {len(positions) - 1}, got "
            f"{pairs.min()} to {pairs.max()}."
        )
    bad = np.flatnonzero(~np.isfinite(positions).all(axis=1))
    if len(bad):
        raise NetworkError(
            f"node {labels[int(bad[0])]!r}: expected finite coordinates, got "
            f"{positions[bad[0]].tolist()}."
        )
    still = np.flatnonzero((positions[pairs[:, 0]] == positions[pairs[:, 1]]).all(axis=1))
    if len(still):
        a, b = (labels[int(node)] for node in pairs[still[0]])
        raise NetworkError(
            f"the edge between {a!r} and {b!r} has no length: both ends are at "
            f"{positions[pairs[still[0], 0]].tolist()}. Remove it or move one of them."
        )
    return EdgeList(positions, pairs, labels)


def _of_graph(
    graph: nx.Graph[Hashable], position: str, dimension: int
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
                f"node {label!r}: {position!r}: expected {dimension} numbers, got {place!r}."
            )
        rows.append(row)
    numbers = {label: k for k, label in enumerate(labels)}
    pairs = [(numbers[a], numbers[b]) for a, b in graph.edges()]
    positions = np.array(rows, dtype=float).reshape(len(rows), dimension)
    return positions, np.array(pairs, dtype=np.int64).reshape(len(pairs), 2), labels


@dataclass(frozen=True, eq=False)
class EdgeIntegrals:
    """Integrals along edges.

    vectors: shape (edges, n); errors: bound on the largest component of each, shape (edges,).
    evaluations: points at which the coframe was evaluated.
    """

    vectors: np.ndarray
    errors: np.ndarray
    evaluations: int


def edge_integrals(
    frame: Frame,
    starts: np.ndarray,
    ends: np.ndarray,
    accuracy: float = 1e-12,
    *,
    parameters: Parameters | None = None,
) -> EdgeIntegrals:
    """Integral of e^i_mu dq^mu along straight edges, shape (edges, n) each; errors are measured.

    Raises
    ------
    SingularPointError
        An edge passes through a point where the coframe is singular; the message names it.
    ChartEdgeError
        An edge leaves the domain that the frame declares.
    NetworkError
        The frame is complex.
    """
    if frame.complex:
        raise NetworkError(
            "networks are summed in real numbers, but the frame is declared complex. "
            "Use burgers_vector or develop for single loops, or a real frame."
        )
    compiled = forms(frame, parameters)
    shares, distances = _nearest_line(frame, starts, ends, parameters)
    _refuse_outside(frame, starts, ends, parameters)
    vectors, errors = np.empty(starts.shape), np.empty(len(starts))
    evaluations = 0
    alone = _near_other_poles(frame, compiled, starts, ends)
    for k in alone.tolist():
        vectors[k], errors[k], points = _by_itself(compiled, starts[k], ends[k], accuracy, k)
        evaluations += points
    others = np.delete(np.arange(len(starts)), alone)
    # As many as fit in the cache go fastest.
    together = PIECE // sum(POINTS)
    for begin in range(0, len(others), together):
        # A slice if all edges are meant, so that adjacent memory is used together.
        part = others[begin : begin + together] if len(alone) else slice(begin, begin + together)
        vectors[part], errors[part], points = _block(
            compiled.coframe, starts[part], ends[part], shares[part], distances[part], accuracy,
            others[begin : begin + together],
        )  # fmt: skip
        evaluations += points
    return EdgeIntegrals(vectors, errors, evaluations)


def _block(
    coframe: Form,
    starts: np.ndarray,
    ends: np.ndarray,
    shares: np.ndarray,
    distances: np.ndarray,
    accuracy: float,
    numbers: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, int]:
    """Vectors and errors of a block of edges, and how many points were evaluated."""
    begin, step = starts.T, (ends - starts).T
    lengths = np.abs(step).max(axis=0)
    count = len(starts)

    def sampler(owner: np.ndarray, s: np.ndarray) -> np.ndarray:
        slopes = np.repeat(step[:, owner], s.shape[1], axis=1)
        points = np.repeat(begin[:, owner], s.shape[1], axis=1) + slopes * s.ravel()
        return coframe.along(coframe.values(points), slopes).reshape(-1, *s.shape)

    # A peak near a singular line would be missed; the nearer it is, the narrower.
    widths = distances / lengths
    cuts = [
        (int(k), s)
        for k in np.flatnonzero(widths < NEAR)
        for s in graded(float(shares[k]), float(widths[k]), NEAR)
    ]
    whole = cut(np.arange(count), np.zeros(count), cuts)
    # Ends rounded in their last place, and the evaluation of the coframe between them.
    places = np.maximum(np.abs(starts), np.abs(ends)).max(axis=1)
    noise = ROUNDING + ROUNDING / 4 * places / np.minimum(lengths, distances)
    with np.errstate(all="ignore"):
        integrals = halved(
            sampler, np.arange(count), whole, gauss_pair(*POINTS), 0.0, accuracy * lengths, noise
        )
    if integrals.worst is not None:
        k, s = integrals.worst
        where = starts[k] + s * (ends[k] - starts[k])
        raise SingularPointError(
            f"edge {numbers[k]} passes through {shown(where)}, where the integral of the coframe "
            "does not converge: it is singular there. Lead the edge past that point."
        )
    assert integrals.sizes is not None
    return integrals.values.T, integrals.truncation + noise * integrals.sizes, integrals.points


def _refuse_outside(
    frame: Frame, starts: np.ndarray, ends: np.ndarray, parameters: Parameters | None
) -> None:
    """Refuse edges with a point outside the declared domain, looked at as in rules of loops."""
    domain = edge_values(frame, parameters)
    if domain is None:
        return
    together = PIECE // SAMPLES
    s = np.linspace(0, 1, SAMPLES)
    for begin in range(0, len(starts), together):
        low, high = starts[begin : begin + together].T, ends[begin : begin + together].T
        points = low[:, :, None] + (high - low)[:, :, None] * s
        refuse_points(domain, points.reshape(len(points), -1), "an edge")


def _near_other_poles(
    frame: Frame, compiled: Forms, starts: np.ndarray, ends: np.ndarray
) -> np.ndarray:
    """Numbers of the edges near poles that are not straight lines."""
    poles = compiled.poles
    near = [np.zeros(0, dtype=np.int64)]
    if poles is None or lines_alone(frame, poles):
        return near[0]
    together = PIECE // SAMPLES
    s = np.linspace(0, 1, SAMPLES)
    for begin in range(0, len(starts), together):
        low, high = starts[begin : begin + together].T, ends[begin : begin + together].T
        points = low[:, :, None] + (high - low)[:, :, None] * s
        near.append(begin + np.flatnonzero(steep(poles, points)))
    return np.concatenate(near)


def _by_itself(
    compiled: Forms, start: np.ndarray, end: np.ndarray, accuracy: float, number: int
) -> tuple[np.ndarray, float, int]:
    """Vector and error of one edge, as a side of a loop, and points evaluated.

    Raises
    ------
    SingularPointError
        It goes through a pole; the message names edge and point.
    """
    size = float(np.abs(end - start).max())
    side = Segment((0.0,) * len(start), tuple(((end - start) / size).tolist()))
    part = Part(tuple(start.tolist()), size, (side,))
    try:
        route = line_route(compiled, part, accuracy, refuse_poles(compiled.poles, part))
    except SingularPointError as reason:
        raise SingularPointError(str(reason).replace("the loop", f"edge {number}")) from None
    return size * route.values[:, 0], size * float(route.error[0]), route.points


def _nearest_line(
    frame: Frame, starts: np.ndarray, ends: np.ndarray, parameters: Parameters | None
) -> tuple[np.ndarray, np.ndarray]:
    """Where each edge is nearest to a line on which the coframe is singular, and how near.

    Returns
    -------
    Share of the way along each edge, and distance, infinite without lines; shape (edges,) each.

    Raises
    ------
    SingularPointError
        An edge goes through such a line; the message names edge, point and line.
    """
    shares, distances = np.zeros(len(starts)), np.full(len(starts), np.inf)
    for defect in find_defects(frame):
        if defect.across is None:
            continue
        across = np.array(rows(defect.across, frame.dimension))
        place = np.array(defect.place(parameters))
        starts_across, ends_across = (across @ (points - place).T for points in (starts, ends))
        share, distance = nearest(starts_across, ends_across)
        size = np.maximum(np.abs(starts_across).max(axis=0), np.abs(ends_across).max(axis=0))
        bad = np.flatnonzero(distance <= CALCULATED * size)
        if len(bad):
            k = int(bad[0])
            where = starts[k] + share[k] * (ends[k] - starts[k])
            raise SingularPointError(
                f"edge {k} passes through the {defect}, at {shown(where)}, where the coframe has "
                "no finite value. Lead it past that point."
            )
        shares = np.where(distance < distances, share, shares)
        distances = np.minimum(distances, distance)
    return shares, distances
