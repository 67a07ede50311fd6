"""Dislocation network: lines with Burgers vector and sense, their junctions and reactions."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.errors import NetworkError
from geomtorsion.loops import Complex, Loop, Number
from geomtorsion.materials.lines.box import Box
from geomtorsion.materials.lines.circuit import LineBurgers, circuit_burgers
from geomtorsion.materials.lines.crystal_analysis import clusters_of
from geomtorsion.materials.lines.line_arrays import DislocationLine, LineArrays, line_arrays
from geomtorsion.materials.lines.line_families import Lattice, LineFamily, Symmetry, line_families
from geomtorsion.materials.lines.line_files import lines_text, read_lines
from geomtorsion.materials.lines.opendis import arrays_of_opendis, opendis_of_arrays
from geomtorsion.materials.lines.polylines import Polyline, line_table, node_table, polylines
from geomtorsion.materials.lines.reactions import (
    CONSTRAINTS,
    NodeViolation,
    Reaction,
    Vector,
    exact_vector,
    size,
    total,
    vanishes,
)
from geomtorsion.support import checks, outgoing
from geomtorsion.support.caching import cached_property
from geomtorsion.support.files import written

if TYPE_CHECKING:
    import networkx as nx

Line = tuple[Hashable, Hashable, Hashable]


@dataclass(frozen=True, eq=False)
class DislocationNetwork:
    """Dislocation lines as a networkx MultiDiGraph: edges run along the line sense and carry b.

    graph: every edge has the attribute `burgers`, shape (n,), all of one length; a node with the
        attribute `surface=True` may end lines (they leave the crystal there). The graph is copied.
    tolerance: share of the largest b within which floats count as equal; ints, Fractions and
        sympy numbers are compared exactly.
    box: the cell of a simulation. With it, an edge may have the attribute `image`, shape (3,): the
        number of periods by which its end is moved; the nearest image if not given.

    Raises
    ------
    NetworkError
        An edge has no Burgers vector, or a zero one, or one of another length.

    Examples
    --------
    >>> lines = [("a", "j", (1, 0, 0)), ("b", "j", (0, 1, 0)), ("j", "c", (1, 1, 0))]
    >>> net = DislocationNetwork.of_lines(lines, surface="abc")
    >>> net.node_rule(), net.junctions
    ((), ('j',))
    """

    graph: nx.MultiDiGraph[Hashable]
    tolerance: float = 1e-9
    box: Box | None = None
    _scale: float = field(init=False, default=1.0, repr=False)

    def __repr__(self) -> str:
        lines = outgoing.count_text(self.graph.number_of_edges(), "line")
        return f"DislocationNetwork({outgoing.count_text(len(self.graph), 'node')}, {lines})"

    def __post_init__(self) -> None:
        """Read the Burgers vectors exactly, once."""
        import networkx as nx  # 0.15 s, and only networks need it

        if self.box is not None:
            checks.instance(self.box, Box, "box", NetworkError)
        remedy = "Lines have a sense, and several may join the same nodes."
        checks.instance(self.graph, nx.MultiDiGraph, "graph", NetworkError, remedy=remedy)
        # A frozen graph was made here, or does not change.
        copy = self.graph if nx.is_frozen(self.graph) else self.graph.copy()
        length, largest = None, 0.0
        for start, end, key, data in copy.edges(keys=True, data=True):
            where = f"line {start!r} -> {end!r} (key {key!r})"
            if "burgers" not in data:
                raise NetworkError(f"{where}: expected an attribute 'burgers', got none. Give b.")
            data["burgers"] = exact_vector(data["burgers"], where, length)
            length, strength = len(data["burgers"]), size(data["burgers"])
            if not strength:
                raise NetworkError(f"{where}: expected non-zero b, got b = 0. Remove the line.")
            largest = max(largest, strength)
        object.__setattr__(self, "graph", nx.freeze(copy))
        object.__setattr__(self, "_scale", largest or 1.0)

    @classmethod
    def of_lines(
        cls,
        lines: Iterable[tuple[Hashable, Hashable, Sequence[Number]]],
        surface: Iterable[Hashable] = (),
        positions: Mapping[Hashable, Sequence[float]] | None = None,
    ) -> DislocationNetwork:
        """Network of lines (start, end, b); `surface` names nodes where lines leave the crystal."""
        import networkx as nx  # as above

        graph = nx.MultiDiGraph()
        for k, line in enumerate(checks.entries(lines, "lines", NetworkError)):
            ends = line[:2] if isinstance(line, list | tuple) and len(line) == 3 else ()
            try:
                graph.add_edge(*ends, burgers=line[2])
            except (TypeError, ValueError, IndexError):
                raise NetworkError(
                    f"lines[{k}]: expected (start, end, b), got {checks.shown(line)}."
                ) from None
        named = surface if not isinstance(surface, str | set | frozenset) else list(surface)
        outside = checks.entries(named, "surface", NetworkError)
        for node in outside:
            if not isinstance(node, Hashable) or node not in graph:
                raise NetworkError(f"surface: expected nodes of lines, got {checks.shown(node)}.")
        nx.set_node_attributes(graph, {node: node in outside for node in graph}, "surface")
        if positions is not None:
            places = checks.table(positions, "positions", NetworkError)
            nx.set_node_attributes(graph, places, "position")
        return cls(graph)

    @classmethod
    def of_arrays(
        cls,
        lines: LineArrays,
        tolerance: float = 1e-9,
        burgers: Sequence[Sequence[Number]] | None = None,
    ) -> DislocationNetwork:
        """Network of lines in arrays; nodes at a surface may end lines. burgers: b, if exact.

        Examples
        --------
        A square prismatic loop in a periodic box, and a circuit about one of its sides:

        >>> corners = [[1, 1, 2], [3, 1, 2], [3, 3, 2], [1, 3, 2]]
        >>> sides, box = [[0, 1], [1, 2], [2, 3], [3, 0]], Box.of_bounds([0, 0, 0], [4, 4, 4])
        >>> net = DislocationNetwork.of_arrays(LineArrays(corners, sides, [[0, 0, 1]] * 4, box))
        >>> net.node_rule(), net.density
        ((), 0.125)
        >>> net.burgers(Loop.circle([6, 1, 2], 0.5, plane=(1, 2))).vector.tolist()
        [0.0, 0.0, 1.0]
        """
        import networkx as nx  # as above

        checks.instance(lines, LineArrays, "lines", NetworkError)
        graph, labels = nx.MultiDiGraph(**lines.known), list(lines.labels)
        places, numbers = lines.positions.tolist(), lines.constraint_list
        graph.add_nodes_from(
            (
                label,
                {"position": tuple(x), "surface": CONSTRAINTS.get(c) == "surface", "constraint": c},
            )
            for label, x, c in zip(labels, places, numbers, strict=True)
        )
        vectors = lines.burgers.tolist() if burgers is None else burgers
        columns = {"burgers": map(tuple, vectors), "image": map(tuple, lines.image_list)}
        if lines.planes is not None:
            columns["plane"] = map(tuple, lines.planes.tolist())
        if any(grain is not None for grain in lines.grains):
            columns["grain"] = iter(lines.grains)
        graph.add_edges_from(
            (labels[a], labels[b], dict(zip(columns, row, strict=True)))
            for (a, b), *row in zip(lines.pairs.tolist(), *columns.values(), strict=True)
        )
        return cls(nx.freeze(graph), tolerance, lines.box)

    @classmethod
    def read(cls, path: str | PathLike[str], periodic: bool = True) -> DislocationNetwork:
        """Read a ParaDiS or ExaDiS .data, OVITO .ca or .json file; nothing in it is run as code.

        Parameters
        ----------
        periodic
            Whether the box repeats along its edges, which a .data file does not contain.

        Raises
        ------
        FileFormatError
            The file is missing, truncated or malformed; the message names the line.
        """
        lines, burgers = read_lines(path, periodic)
        return cls.of_arrays(lines, burgers=burgers)

    def save(self, path: str | PathLike[str]) -> None:
        """Write a file in the format of its suffix: .vtk, OVITO .ca, .json, and else ParaDiS .data.

        All but .vtk, which has no box, read as the same network, digit by digit. In .ca lines of
        crystals are in a cluster for each grain, with the families of its lattice.

        Raises
        ------
        NetworkError
            Nodes have no positions, the format needs a box and there is none, b does not have three
            components, or a line is too long for .data, which keeps no images.
        """
        grains = clusters_of(self.graph.graph, self.lines, self.owners, self.polylines)
        text = lines_text(path, self.arrays, self.polylines, self._vectors, grains)
        with written(path) as file:
            file.write_text(text, "utf-8")

    @classmethod
    def of_opendis(cls, data: Mapping[str, Any]) -> DislocationNetwork:
        """Network from the export of OpenDiS: tables `cell`, `nodes` and `segs` of arrays.

        Raises
        ------
        NetworkError
            A table or an array is missing, or has another shape.
        """
        return cls.of_arrays(arrays_of_opendis(data))

    def opendis(self) -> dict[str, dict[str, np.ndarray]]:
        """The tables cell, nodes and segs that OpenDiS imports (`DisNet.import_data`)."""
        return opendis_of_arrays(self.arrays)

    # -- contents ---------------------------------------------------------------------------------

    @cached_property
    def arrays(self) -> LineArrays:
        """Positions, pairs, Burgers vectors and images as arrays, in the order of `lines`.

        Lines along several points are straight pieces.

        Raises
        ------
        NetworkError
            A node has no position in three dimensions, or there are images, but no box.
        """
        return self._pieces[0]

    @cached_property
    def _pieces(self) -> tuple[LineArrays, list[int]]:
        """Straight pieces, and the line to which each belongs."""
        return line_arrays(self.graph, self.box)

    @property
    def owners(self) -> list[int]:
        """The number in `lines` of the line to which each straight piece of `arrays` belongs."""
        return self._pieces[1]

    @property
    def _vectors(self) -> list[Vector]:
        """b of each straight piece, exact where b of its line is."""
        return [self.lines[k].burgers for k in self.owners]

    @cached_property
    def lines(self) -> tuple[DislocationLine, ...]:
        """All lines: tuples of start, end, key and b, with their length and other properties."""
        return tuple(
            DislocationLine.of(self.graph, (u, v, k), d, self.box)
            for u, v, k, d in self.graph.edges(keys=True, data=True)
        )

    @cached_property
    def polylines(self) -> tuple[Polyline, ...]:
        """Lines from junction to junction, or closed, or through the box; see `Polyline`.

        Raises
        ------
        NetworkError
            Nodes have no positions.
        """
        surface = [bool(data.get("surface")) for _, data in self.graph.nodes(data=True)]
        # Points along a line are nodes of the pieces, after the nodes of the graph.
        surface += [False] * (len(self.arrays.positions) - len(surface))
        return polylines(self.arrays, self._vectors, surface, self.tolerance)

    def to_networkx(self) -> nx.MultiDiGraph[Hashable]:
        """A copy of the graph that may be changed: nodes have `position`, edges `burgers`."""
        import networkx as nx  # as above

        return nx.MultiDiGraph(self.graph)

    def __str__(self) -> str:
        if any(data.get("position") is None for _, data in self.graph.nodes(data=True)):
            return node_table(self.lines, len(self.junctions))
        return line_table(self.arrays, self.polylines, len(self.junctions), self.names)

    @property
    def names(self) -> list[str] | None:
        """The family in its crystal of each straight piece of `arrays`, if all are known."""
        families = [self.lines[k].family for k in self.owners]
        names = [name for name in families if name is not None]
        return names if families and len(names) == len(families) else None

    @property
    def junctions(self) -> tuple[Hashable, ...]:
        """Nodes at which three lines or more meet."""
        return tuple(node for node, degree in self.graph.degree if degree > 2)

    def excess(self, node: Hashable) -> Vector:
        """Sum of b over the lines that leave a node minus the sum over the lines that arrive.

        Raises
        ------
        NetworkError
            The node is not in the network, or no line touches it.
        """
        if node not in self.graph or not self.graph.degree[node]:
            raise NetworkError(f"node: expected a node of a line, got {checks.shown(node)}.")
        out = [b for _, _, b in self.graph.out_edges(node, data="burgers")]
        into = [tuple(-x for x in b) for _, _, b in self.graph.in_edges(node, data="burgers")]
        return total([*out, *into])

    def node_rule(self) -> tuple[NodeViolation, ...]:
        """Inner nodes at which the Burgers vectors do not sum to zero; empty if b is conserved."""
        violations = []
        for node in self._suspects():
            data = self.graph.nodes[node]
            if data.get("surface") or not self.graph.degree[node]:
                continue
            excess = self.excess(node)
            if not vanishes(excess, self._scale, self.tolerance):
                violations.append(NodeViolation(node, excess, data.get("constraint", 0)))
        return tuple(violations)

    def _suspects(self) -> Iterable[Hashable]:
        """Nodes at which b may not be conserved: all, or for floats only those with large sums."""
        vectors = [b for *_, b in self.graph.edges(data="burgers")]
        if not vectors or not all(type(x) is float for b in vectors for x in b):
            return self.graph.nodes
        numbers = {node: k for k, node in enumerate(self.graph)}
        pairs = np.array([(numbers[a], numbers[b]) for a, b, _ in self.graph.edges])
        chain = Complex.of_edges(pairs, len(numbers))
        sums = chain.boundary(0).T @ np.array(vectors)
        # Half of the limit for zero, since sums in another order differ in their last digits.
        large = np.abs(sums).max(axis=1) > self.tolerance * self._scale / 2
        nodes = list(self.graph)
        return [nodes[k] for k in np.flatnonzero(large)]

    def checked(self) -> DislocationNetwork:
        """The network itself if the node rule holds.

        Raises
        ------
        NetworkError
            The rule does not hold; the message names the nodes.
        """
        violations = self.node_rule()
        if violations:
            shown, count = "; ".join(map(str, violations[:5])), len(violations)
            raise NetworkError(
                f"b is not conserved at {count} node{'s' * (count != 1)}: {shown}. Check the sense "
                "of the lines, or mark nodes where lines leave the crystal with surface=True."
            )
        return self

    # -- measures ---------------------------------------------------------------------------------

    def burgers(self, loop: Loop, lattice: Lattice | None = None) -> LineBurgers:
        """Burgers vector of a circuit: the sum over all lines, images included, that it links with.

        Signed crossings with a surface that spans the loop, positive where the loop is right-handed
        about the sense of a line; a second surface must give the same.

        Parameters
        ----------
        loop
            A closed path in the coordinates of the nodes; it may leave the box.
        lattice
            Lattice vectors as rows, shape (n, n), or "sc", "fcc", "bcc", "hcp" in units of the
            shortest: b is then also given in whole multiples of them, exactly.

        Raises
        ------
        SingularPointError
            The loop meets a line; the message names it.
        NetworkError
            Lines end between the two surfaces, so that b depends on the surface; or nodes have no
            positions, or a b is not a vector of the lattice.
        """
        return circuit_burgers(self.arrays, self._vectors, loop, lattice, self.tolerance)

    def families(self, symmetry: Symmetry = "cubic") -> tuple[LineFamily, ...]:
        """Lines by the family of their b: number, length, density, screw share; longest first.

        Parameters
        ----------
        symmetry
            "cubic": all that permute and reverse axes; "hexagonal": a prism about z, a along x;
            "none": only b and -b; or matrices, shape (k, n, n).

        Raises
        ------
        NetworkError
            Nodes have no positions, or the symmetry is not known.
        """
        return line_families(self.arrays, symmetry)[0]

    @property
    def density(self) -> float:
        """Length of all lines over the volume of the box, coordinates to the power -2.

        Raises
        ------
        NetworkError
            The network has no box, or nodes have no positions.
        """
        return float(self._per_volume(self.arrays.lengths.sum()))

    @property
    def nye(self) -> np.ndarray:
        """Mean Nye tensor: sum of b^i times step^k over the volume, shape (n, 3).

        Raises
        ------
        NetworkError
            The network has no box, or nodes have no positions.
        """
        return self._per_volume(self.arrays.burgers.T @ self.arrays.steps)

    def _per_volume(self, values: np.ndarray) -> np.ndarray:
        """Values over the volume of the box, which must exist."""
        if self.box is None:
            raise NetworkError(
                "a density needs the volume of the box: expected a network with a box, got one "
                "without. Give DislocationNetwork(graph, box=Box.of_bounds(low, high))."
            )
        with np.errstate(over="ignore", invalid="ignore"):
            densities = values / self.box.volume
        if not np.isfinite(densities).all():
            raise NetworkError(
                "density: expected a float, got a larger number. Give positions in other units."
            )
        return densities

    # -- changes ----------------------------------------------------------------------------------

    def reversed(self, line: Line) -> DislocationNetwork:
        """The same network with one line described the other way: sense and b both reversed."""
        b = self._burgers(line)
        start, end, key = line
        graph = self.to_networkx()
        data = dict(graph.edges[start, end, key])
        graph.remove_edge(start, end, key)
        data["burgers"] = tuple(-x for x in b)
        if "image" in data:
            data["image"] = tuple(-x for x in data["image"])
        graph.add_edge(end, start, **data)
        return DislocationNetwork(graph, self.tolerance, self.box)

    def split(self, line: Line, parts: Sequence[Sequence[Number]]) -> DislocationNetwork:
        """The network after a line dissociates between its nodes: b -> b1 + b2 + ...

        Raises
        ------
        NetworkError
            The parts do not sum to b.
        """
        reaction = Reaction([self._burgers(line)], parts, self.tolerance)
        start, end, key = line
        graph = self.to_networkx()
        data = dict(graph.edges[start, end, key])
        graph.remove_edge(start, end, key)
        for b in reaction.after:
            graph.add_edge(start, end, **{**data, "burgers": b})
        return DislocationNetwork(graph, self.tolerance, self.box)

    def zipped(self, first: Line, second: Line, junction: Hashable) -> DislocationNetwork:
        """The network after two lines from one node join up to a new junction: b1 + b2 -> b3.

        If b1 + b2 = 0 they annihilate there: no line joins the node and the junction.

        Raises
        ------
        NetworkError
            They do not start at the same node, or the junction exists already.
        """
        one, two = self._burgers(first), self._burgers(second)
        if first == second or first[0] != second[0]:
            raise NetworkError(
                f"expected two lines that leave the same node, got {first[:2]} and {second[:2]}. "
                "Use .reversed to reverse one of them."
            )
        if junction in self.graph:
            raise NetworkError(f"junction: expected a new name, got node {checks.shown(junction)}.")
        joint = total([one, two])
        graph = self.to_networkx()
        for start, end, key in (first, second):
            data = dict(graph.edges[start, end, key])
            graph.remove_edge(start, end, key)
            graph.add_edge(junction, end, **data)
        if not vanishes(joint, self._scale, self.tolerance):
            graph.add_edge(first[0], junction, burgers=joint)
        return DislocationNetwork(graph, self.tolerance, self.box)

    def _burgers(self, line: Line) -> Vector:
        """The Burgers vector of a line that exists."""
        # Tuples that contain a list are not names of nodes.
        with suppress(KeyError, TypeError, ValueError):
            if isinstance(line, tuple):
                return self.graph.edges[line]["burgers"]
        raise NetworkError(f"expected the (start, end, key) of a line, got {checks.shown(line)}.")
