"""Dislocation network: lines with Burgers vector and sense, their junctions and reactions."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import sympy as sp

from geomtorsion import checks
from geomtorsion.errors import NetworkError
from geomtorsion.loops.arcs import Number

if TYPE_CHECKING:
    import networkx as nx

# Exact numbers and expressions, or floats.
Entry = Fraction | float | sp.Expr
Vector = tuple[Entry, ...]


def exact_vector(values: Sequence[Number], where: str, dimension: int | None = None) -> Vector:
    """A Burgers vector with exact numbers where they were exact: ints, Fractions, sympy, floats.

    Raises
    ------
    NetworkError
        It is no vector of finite numbers, or not of the dimension.
    """
    if isinstance(values, str) or not hasattr(values, "__len__"):
        raise NetworkError(f"{where}: a Burgers vector was needed, but {values!r} came.")
    result = tuple(_number(value, where) for value in values)
    if dimension is not None and len(result) != dimension:
        raise NetworkError(
            f"{where}: a Burgers vector of {dimension} numbers was needed, but {values!r} came."
        )
    return result


def _number(value: Number, where: str) -> Entry:
    """An exact number or expression, or a finite float."""
    if isinstance(value, sp.Expr) and not isinstance(value, sp.Rational | sp.Float):
        return value
    message = "{subject}: finite numbers were needed, but {value} came."
    found = checks.exact_number(value, where, NetworkError, message=message, infinite=message)
    # Floats are compared within a tolerance: they stay floats.
    return float(found) if isinstance(found, float | sp.Float) else checks.fraction(found)


def total(vectors: Sequence[Vector]) -> Vector:
    """The sum of Burgers vectors."""
    return tuple(sum(column) for column in zip(*vectors, strict=True))


def vanishes(vector: Vector, scale: float, tolerance: float) -> bool:
    """Whether a sum is zero: exactly for exact numbers, within tolerance * scale for floats."""
    for value in vector:
        if isinstance(value, sp.Expr):
            if not sp.simplify(value).is_zero:
                return False
        elif isinstance(value, float):
            if not abs(value) <= tolerance * scale:
                return False
        elif value:
            return False
    return True


def size(vector: Vector) -> float:
    """The length of a Burgers vector."""
    return sum(float(value) ** 2 for value in vector) ** 0.5


def written(vector: Vector) -> str:
    """A Burgers vector in messages."""
    return "(" + ", ".join(f"{v:.6g}" if isinstance(v, float) else str(v) for v in vector) + ")"


@dataclass(frozen=True)
class Reaction:
    """Dislocations b_1 + b_2 + ... that become others, all lines with the same sense.

    before, after: Burgers vectors, each shape (n,).
    tolerance: share of the largest vector within which floats count as equal.

    Raises
    ------
    NetworkError
        The sums differ (the message says by how much), or a vector is none.

    Examples
    --------
    An fcc dislocation splits into two Shockley partials, and gains energy by it:

    >>> from fractions import Fraction as F
    >>> perfect = (F(1, 2), F(-1, 2), 0)
    >>> partials = [(F(2, 6), F(-1, 6), F(-1, 6)), (F(1, 6), F(-2, 6), F(1, 6))]
    >>> split = Reaction([perfect], partials)
    >>> str(split.energy_change), split.is_favourable
    ('-1/6', True)
    """

    before: Sequence[Sequence[Number]]
    after: Sequence[Sequence[Number]]
    tolerance: float = 1e-9

    def __post_init__(self) -> None:
        """Refuse a reaction that does not conserve b."""
        if not self.before or not self.after:
            raise NetworkError("a reaction needs a dislocation before and after.")
        first = exact_vector(self.before[0], "before[0]")
        sides, every = [], []
        for name, vectors in (("before", self.before), ("after", self.after)):
            read = [exact_vector(b, f"{name}[{k}]", len(first)) for k, b in enumerate(vectors)]
            object.__setattr__(self, name, tuple(read))
            sides.append(total(read))
            every += read
        missing = tuple(a - b for a, b in zip(sides[1], sides[0], strict=True))
        if not vanishes(missing, max(map(size, every)), self.tolerance):
            raise NetworkError(
                f"the reaction does not conserve b: {written(sides[0])} before, "
                f"{written(sides[1])} after, the difference is {written(missing)}. Turn all lines "
                "to the same sense (reversing a line turns b round), or add what is missing."
            )

    @property
    def energy_change(self) -> Entry:
        """Sum of b^2 after minus before: Frank's measure of the energy, without interaction."""

        def square(vectors: Sequence[Sequence[Any]]) -> Any:
            return sum(x * x for vector in vectors for x in vector)

        return square(self.after) - square(self.before)

    @property
    def is_favourable(self) -> bool:
        """Whether Frank's rule lets it happen by itself: b^2 becomes less."""
        return bool(self.energy_change < 0)


Line = tuple[Hashable, Hashable, Hashable]


@dataclass(frozen=True)
class NodeViolation:
    """A node at which b is not conserved.

    node: which; excess: sum of b of the lines that leave minus those that arrive, shape (n,).
    """

    node: Hashable
    excess: Vector

    def __str__(self) -> str:
        return f"node {self.node!r}: b out minus b in = {written(self.excess)}"


@dataclass(frozen=True, eq=False)
class DislocationNetwork:
    """Dislocation lines as a networkx MultiDiGraph: edges run along the line sense and carry b.

    graph: every edge has the attribute `burgers`, shape (n,), all of one length; a node with the
        attribute `surface=True` may end lines (they leave the crystal there). The graph is copied.
    tolerance: share of the largest b within which floats count as equal; ints, Fractions and
        sympy numbers are compared exactly.

    Raises
    ------
    NetworkError
        An edge has no Burgers vector, or one that is zero or of another length.

    Examples
    --------
    >>> lines = [("a", "j", (1, 0, 0)), ("b", "j", (0, 1, 0)), ("j", "c", (1, 1, 0))]
    >>> net = DislocationNetwork.of_lines(lines, surface="abc")
    >>> net.node_rule(), net.junctions
    ((), ('j',))
    """

    graph: nx.MultiDiGraph
    tolerance: float = 1e-9
    _scale: float = field(init=False, default=1.0, repr=False)

    def __post_init__(self) -> None:
        """Read the Burgers vectors exactly, once."""
        import networkx as nx  # 0.15 s, and networks alone need it

        if not isinstance(self.graph, nx.MultiDiGraph):
            raise NetworkError(
                f"a networkx.MultiDiGraph was needed, but {type(self.graph).__name__} came: lines "
                "have a sense, and several may join the same nodes."
            )
        copy = self.graph.copy()
        length: int | None = None
        for start, end, key, data in copy.edges(keys=True, data=True):
            where = f"line {start!r} -> {end!r}"
            if "burgers" not in data:
                raise NetworkError(f"{where} has no attribute 'burgers'. Every line needs its b.")
            data["burgers"] = exact_vector(data["burgers"], where, length)
            length = len(data["burgers"])
            if not size(data["burgers"]):
                raise NetworkError(f"{where} (key {key!r}) has b = 0: it is no dislocation.")
        sizes = [size(b) for _, _, b in copy.edges(data="burgers")]
        object.__setattr__(self, "graph", nx.freeze(copy))
        object.__setattr__(self, "_scale", max(sizes, default=1.0))

    @classmethod
    def of_lines(
        cls,
        lines: Iterable[tuple[Hashable, Hashable, Sequence[Number]]],
        surface: Iterable[Hashable] = (),
        positions: Mapping[Hashable, Sequence[float]] | None = None,
    ) -> DislocationNetwork:
        """From lines (start, end, b); `surface` names the nodes where lines leave the crystal."""
        import networkx as nx  # as above

        graph = nx.MultiDiGraph()
        for start, end, b in lines:
            graph.add_edge(start, end, burgers=b)
        outside = set(surface)
        for node in outside - set(graph):
            raise NetworkError(f"surface: node {node!r} belongs to no line.")
        nx.set_node_attributes(graph, {node: node in outside for node in graph}, "surface")
        if positions is not None:
            nx.set_node_attributes(graph, dict(positions), "position")
        return cls(graph)

    @property
    def lines(self) -> tuple[tuple[Hashable, Hashable, Hashable, Vector], ...]:
        """All lines: start, end, key, b."""
        return tuple(
            (u, v, k, d["burgers"]) for u, v, k, d in self.graph.edges(keys=True, data=True)
        )

    @property
    def junctions(self) -> tuple[Hashable, ...]:
        """Nodes in which three lines or more meet."""
        return tuple(node for node, degree in self.graph.degree if degree > 2)

    def excess(self, node: Hashable) -> Vector:
        """Sum of b of the lines that leave a node minus those that arrive.

        Raises
        ------
        NetworkError
            The node is not in the network, or no line touches it.
        """
        if node not in self.graph or not self.graph.degree[node]:
            raise NetworkError(f"no line of the network touches node {node!r}.")
        out = [b for _, _, b in self.graph.out_edges(node, data="burgers")]
        into = [tuple(-x for x in b) for _, _, b in self.graph.in_edges(node, data="burgers")]
        return total([*out, *into])

    def node_rule(self) -> tuple[NodeViolation, ...]:
        """Every inner node at which the Burgers vectors do not sum to zero; none: all is well."""
        found = []
        for node, data in self.graph.nodes(data=True):
            if data.get("surface") or not self.graph.degree[node]:
                continue
            excess = self.excess(node)
            if not vanishes(excess, self._scale, self.tolerance):
                found.append(NodeViolation(node, excess))
        return tuple(found)

    def checked(self) -> DislocationNetwork:
        """The network itself if the node rule holds.

        Raises
        ------
        NetworkError
            It does not; the message names the nodes.
        """
        violations = self.node_rule()
        if violations:
            shown = "; ".join(map(str, violations[:5]))
            raise NetworkError(
                f"b is not conserved at {len(violations)} nodes: {shown}. Check the sense of the "
                "lines, or mark nodes where lines leave the crystal with surface=True."
            )
        return self

    # -- changes ----------------------------------------------------------------------------------

    def reversed(self, line: Line) -> DislocationNetwork:
        """The same network with one line described the other way: sense and b both turned round."""
        b = self._burgers(line)
        start, end, key = line
        graph = self._open()
        data = dict(graph.edges[start, end, key])
        graph.remove_edge(start, end, key)
        graph.add_edge(end, start, **{**data, "burgers": tuple(-x for x in b)})
        return DislocationNetwork(graph, self.tolerance)

    def split(self, line: Line, parts: Sequence[Sequence[Number]]) -> DislocationNetwork:
        """A line that dissociates into several between the same nodes: b -> b1 + b2 + ...

        Raises
        ------
        NetworkError
            The parts do not sum to b.
        """
        reaction = Reaction([self._burgers(line)], parts, self.tolerance)
        start, end, key = line
        graph = self._open()
        graph.remove_edge(start, end, key)
        for b in reaction.after:
            graph.add_edge(start, end, burgers=b)
        return DislocationNetwork(graph, self.tolerance)

    def zipped(self, first: Line, second: Line, junction: Hashable) -> DislocationNetwork:
        """Two lines that leave the same node join into one as far as a new junction: b1 + b2 -> b3.

        If b1 + b2 = 0 they annihilate there: no line joins the node and the junction.

        Raises
        ------
        NetworkError
            They do not start at the same node, or the junction exists already.
        """
        one, two = self._burgers(first), self._burgers(second)
        if first == second or first[0] != second[0]:
            raise NetworkError(
                f"lines {first[:2]} and {second[:2]}: two lines that leave the same node were "
                "needed. Use .reversed to turn one round."
            )
        if junction in self.graph:
            raise NetworkError(f"node {junction!r} exists already; name a new junction.")
        joint = total([one, two])
        graph = self._open()
        for start, end, key in (first, second):
            data = dict(graph.edges[start, end, key])
            graph.remove_edge(start, end, key)
            graph.add_edge(junction, end, **data)
        if not vanishes(joint, self._scale, self.tolerance):
            graph.add_edge(first[0], junction, burgers=joint)
        return DislocationNetwork(graph, self.tolerance)

    def _open(self) -> nx.MultiDiGraph:
        """A copy of the graph that may be changed."""
        import networkx as nx  # as above

        return nx.MultiDiGraph(self.graph)

    def _burgers(self, line: Line) -> Vector:
        """The Burgers vector of a line that exists."""
        if len(line) != 3 or not self.graph.has_edge(*line):
            raise NetworkError(f"there is no line {line!r}; a line is (start, end, key).")
        return self.graph.edges[line]["burgers"]
