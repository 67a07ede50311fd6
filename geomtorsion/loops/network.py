"""Network: points and edges; each edge is integrated once, every cycle follows by signed sums."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.errors import LimitError, NetworkError
from geomtorsion.geometry import Frame
from geomtorsion.loops.arcs import Parameters, shown
from geomtorsion.loops.cochain import Cochain, Cycle, CycleBurgers
from geomtorsion.loops.edges import EdgeIntegrals, EdgeList, edge_integrals, edge_list
from geomtorsion.loops.forms import forms
from geomtorsion.loops.loop import Loop
from geomtorsion.loops.node_rule import NodeRule, node_rule
from geomtorsion.loops.protocols import HasEdges
from geomtorsion.loops.spanning_forest import Forest
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

if TYPE_CHECKING:
    import networkx as nx


# networkx takes minutes for the minimum cycle basis of a graph with more edges.
MINIMUM_BASIS_EDGES = 200
# More cycles than this are not listed, which takes seconds: there are arrays for them.
MOST_LISTED = 100_000


@dataclass(frozen=True, eq=False)
class Network:
    """Graph in the space of a frame: Burgers vectors of all cycles from one integral per edge.

    frame: the `Frame` whose coframe is integrated, or a `SampledFrame` that contains all edges.
    graph: networkx graph whose nodes have coordinates, or an `EdgeList` of arrays; edges are
        straight in the coordinates.
    position: the node attribute that holds q^mu, shape (n,).
    accuracy: of each edge, relative to its length in coordinates.
    parameters: values of the frame's parameters.

    Examples
    --------
    >>> import networkx as nx
    >>> from geomtorsion.spaces import load
    >>> graph = nx.cycle_graph(4)
    >>> corners = {0: (1, 0, 0), 1: (0, 1, 0), 2: (-1, 0, 0), 3: (0, -1, 0)}
    >>> nx.set_node_attributes(graph, corners, "position")
    >>> net = Network(load("screw_dislocation").frame, graph, parameters={"b": 0.25})
    >>> net.burgers([0, 1, 2, 3]).vector.round(12).tolist()
    [0.0, 0.0, 0.25]
    """

    frame: Frame | HasEdges
    graph: nx.Graph[Hashable] | EdgeList
    position: str = "position"
    accuracy: float = 1e-12
    parameters: Parameters | None = field(default=None)

    # -- edges ----------------------------------------------------------------------------------

    @cached_property
    def edges(self) -> EdgeList:
        """Positions and edges as arrays, checked.

        Raises
        ------
        NetworkError
            A node has no usable position, or an edge no length; the message names it.
        """
        return edge_list(self.graph, self.position, self.frame.dimension)

    @cached_property
    def integrals(self) -> EdgeIntegrals:
        """The integral of the coframe along every edge, from its first node to its second."""
        places, pairs = self.edges.positions, self.edges.pairs
        starts, ends = places[pairs[:, 0]], places[pairs[:, 1]]
        if not isinstance(self.frame, Frame):
            return self.frame.along_edges(starts, ends)
        return edge_integrals(self.frame, starts, ends, self.accuracy, parameters=self.parameters)

    @cached_property
    def cochain(self) -> Cochain:
        """The integrals as values on the edges: all cycles are sums of these."""
        integrals = self.integrals
        return Cochain(self.edges.complex, integrals.vectors, integrals.errors)

    def edge(self, start: Hashable, end: Hashable) -> np.ndarray:
        """The integral from one node to a neighbour, shape (n,).

        Raises
        ------
        NetworkError
            There is no such edge.
        """
        complex = self.edges.complex
        ends = (np.array([complex.number(node)]) for node in (start, end))
        (number,), (sign,) = complex.steps(*ends)
        return sign * self.integrals.vectors[number]

    # -- cycles ---------------------------------------------------------------------------------

    def burgers(self, cycle: Sequence[Hashable]) -> CycleBurgers:
        """Burgers vector of a cycle: the signed sum of its edges.

        Parameters
        ----------
        cycle
            Nodes in order, as networkx gives them; the last is joined to the first.

        Raises
        ------
        NetworkError
            Two neighbours are not joined by an edge, or there are fewer than three nodes.
        """
        # Straight edges between the same nodes are all the same: the first will do.
        # A path to and fro encloses nothing.
        chain, edges, senses = self.edges.complex.along(cycle, least=3)
        return self.cochain.along(tuple(chain), edges, senses)

    @cached_property
    def forest(self) -> Forest:
        """Sums along a spanning forest and the closure of every chord, as arrays.

        For large networks this is the answer: `forest.chords` are the edges outside the forest,
        `forest.closure` the Burgers vectors of their fundamental cycles.
        """
        return self.cochain.forest

    @property
    def cycle_count(self) -> int:
        """Number of independent cycles: edges - nodes + components."""
        return len(self.edges.pairs) - len(self.edges.positions) + self.component_count

    @cached_property
    def component_count(self) -> int:
        """Number of connected components."""
        nodes, pairs = len(self.edges.positions), self.edges.pairs
        table = scipy.sparse.coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(nodes, nodes))
        return int(scipy.sparse.csgraph.connected_components(table, directed=False)[0])

    def cycles(self, basis: str = "fundamental") -> tuple[Cycle, ...]:
        """A basis of the cycles, each as its nodes in order.

        Parameters
        ----------
        basis
            "fundamental": one cycle for each edge outside a spanning forest, which it runs
            through forwards. "minimum": the shortest cycles, for small networks only.

        Raises
        ------
        LimitError
            The network is too large to list its cycles; the message states the limit.
        """
        if checks.choice(basis, ("fundamental", "minimum"), "basis", NetworkError) == "minimum":
            return self._minimum_cycles()
        if self.cycle_count > MOST_LISTED:
            raise LimitError(
                f"{self.cycle_count} cycles are too many to list; the limit is {MOST_LISTED}. "
                "Use .forest, which has chords and closures as arrays."
            )
        # Lists: one number of an array takes several times as long as one of these.
        parent, depth = self.forest.parent.tolist(), self.forest.depth.tolist()
        chords = self.edges.pairs[self.forest.chords].tolist()
        return tuple(self._around(tail, head, parent, depth) for tail, head in chords)

    def _around(self, tail: int, head: int, parent: list[int], depth: list[int]) -> Cycle:
        """The fundamental cycle of an edge outside the forest: along it, and back in the forest."""
        ahead, back = [head], [tail]
        while ahead[-1] != back[-1]:
            side = ahead if depth[ahead[-1]] >= depth[back[-1]] else back
            side.append(parent[side[-1]])
        labels = self.edges.labels
        return tuple(labels[node] for node in (*back[:1], *ahead, *back[-2:0:-1]))

    def _minimum_cycles(self) -> tuple[Cycle, ...]:
        """The minimum cycle basis, by networkx."""
        import networkx as nx  # 0.15 s, and only this basis needs it

        if len(self.edges.pairs) > MINIMUM_BASIS_EDGES:
            raise LimitError(
                f"the minimum cycle basis of {len(self.edges.pairs)} edges takes too long; the "
                f"limit is {MINIMUM_BASIS_EDGES} edges. Use the fundamental cycles."
            )
        labels = self.edges.labels
        plain = nx.Graph()
        plain.add_nodes_from(labels)
        plain.add_edges_from((labels[a], labels[b]) for a, b in self.edges.pairs.tolist())
        return tuple(tuple(cycle) for cycle in nx.minimum_cycle_basis(plain))

    def basis_burgers(self, basis: str = "fundamental") -> tuple[CycleBurgers, ...]:
        """Burgers vectors of all cycles of a basis."""
        return tuple(self.burgers(cycle) for cycle in self.cycles(basis))

    def loop(self, cycle: Sequence[Hashable]) -> Loop:
        """A cycle as a loop, for `burgers_vector` and `develop`."""
        places, numbers = self.edges.positions, self.edges.numbers
        chain = list(cycle)
        for node in chain:
            if node not in numbers:
                raise NetworkError(f"node {node!r} is not in the network.")
        return Loop.polygon([places[numbers[node]].tolist() for node in chain], name="cycle")

    # -- conservation ---------------------------------------------------------------------------

    def node_rule(self, cells: Sequence[Sequence[Sequence[Hashable]]] | None = None) -> NodeRule:
        """Conservation: over the faces of a closed cell the Burgers vectors sum to zero.

        Parameters
        ----------
        cells
            Closed surfaces, each a list of cycles turned outwards; every tetrahedron of the
            network (four nodes joined pairwise) if not given.

        Returns
        -------
        NodeRule: how many cells were checked, which violate the rule, and which faces a defect
        line pierces (there line integral and flux of torsion differ).
        """
        if not isinstance(self.frame, Frame):
            raise NetworkError(
                "the node rule compares line integrals with the flux of torsion, which samples of "
                "a frame do not give exactly. Use .cochain.coboundary() of the SampledFrame."
            )
        return node_rule(
            forms(self.frame, self.parameters), self.edges, self.cochain, cells, self.accuracy
        )

    def __repr__(self) -> str:
        edges = self.edges
        low, high = edges.positions.min(axis=0), edges.positions.max(axis=0)
        return (
            f"Network({len(edges.positions)} nodes, {len(edges.pairs)} edges, "
            f"from {shown(low)} to {shown(high)})"
        )
