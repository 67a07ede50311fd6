"""Line arrays: dislocation lines as numbers, one by one and as straight pieces, with their box."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from geomtorsion.errors import NetworkError
from geomtorsion.loops import Cochain, Complex
from geomtorsion.loops.validation import listed
from geomtorsion.materials.lines.box import Box
from geomtorsion.materials.lines.reactions import Vector
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.outgoing import count_text

if TYPE_CHECKING:
    import networkx as nx


@dataclass(frozen=True, eq=False, init=False)
class LineArrays:
    """Straight dislocation lines between nodes in three dimensions, each described once.

    positions: of the nodes, shape (nodes, 3).
    pairs: first and second node of each line, along its sense, shape (lines, 2).
    burgers: b of each line, shape (lines, n).
    box: the cell of the simulation; without one nothing repeats.
    images: number of periods by which the second node is moved, shape (lines, 3); the nearest image
        if not given.
    labels: names of the nodes; their numbers if not given.
    constraints: the number that a simulation gives each node, shape (nodes,); zero if not given.
    planes: normal of the glide plane of each line, shape (lines, 3), if known.
    grains: number of the grain of each line, None where it is not known; () if no line has one.
    known: data of a file about these grains: `clusters` by number, and `walls` between them.

    Raises
    ------
    NetworkError
        Shapes do not fit, a node does not exist, or a number is not finite.
    """

    positions: np.ndarray
    pairs: np.ndarray
    burgers: np.ndarray
    box: Box | None
    images: np.ndarray
    labels: Sequence[Hashable]
    constraints: np.ndarray
    planes: np.ndarray | None
    grains: Sequence[int | None]
    known: Mapping[str, Any]

    def __repr__(self) -> str:
        return (
            f"LineArrays({count_text(len(self.positions), 'node')}, "
            f"{count_text(len(self.pairs), 'line')})"
        )

    def __init__(
        self,
        positions: ArrayLike,
        pairs: ArrayLike,
        burgers: ArrayLike,
        box: Box | None = None,
        images: ArrayLike | None = None,
        labels: Sequence[Hashable] = (),
        constraints: ArrayLike | None = None,
        planes: ArrayLike | None = None,
        grains: Sequence[int | None] = (),
        known: Mapping[str, Any] | None = None,
    ) -> None:
        def put(name: str, value: object) -> None:
            object.__setattr__(self, name, value)

        put("positions", checks.array(positions, "positions", NetworkError, shape=(None, 3)))
        checks.measured(self.positions, "positions", NetworkError)
        count = len(self.positions)
        put("pairs", checks.whole_array(pairs, "pairs", NetworkError, 2))
        put("burgers", checks.array(burgers, "burgers", NetworkError, shape=(None, None)))
        checks.measured(self.burgers, "burgers", NetworkError)
        lines, remedy = len(self.pairs), "Give as many as pairs."
        checks.check_one_each(self.burgers, lines, "lines", "burgers", NetworkError, remedy)
        put("box", None if box is None else checks.instance(box, Box, "box", NetworkError))
        put("labels", listed(labels, "labels") or range(count))
        codes = np.zeros(count, np.int64) if constraints is None else constraints
        column = [[x] for x in checks.entries(checks.rows(codes), "constraints", NetworkError)]
        put("constraints", checks.whole_array(column, "constraints", NetworkError, 1).ravel())
        checks.check_one_each(self.constraints, count, "nodes", "constraints", NetworkError)
        put("planes", None)
        if planes is not None:
            shape = (len(self.pairs), 3)
            put("planes", checks.array(planes, "planes", NetworkError, shape=shape))
        put("grains", checks.entries(grains, "grains", NetworkError))
        if self.grains:
            checks.check_one_each(self.grains, lines, "lines", "grains", NetworkError, remedy)
        put("known", dict(known or {}))
        Complex(count, self.pairs, np.zeros((len(self.pairs), 0), np.int64), labels=self.labels)
        put("images", self._found_images(images))
        with np.errstate(over="ignore", invalid="ignore"):
            extent = float(self.lengths.sum()) * float(np.abs(self.burgers).max(initial=0.0))
        if not extent < np.inf:
            raise NetworkError(
                "positions: expected lengths of lines within the range of floats, got larger ones. "
                "Give positions in other units."
            )

    def _found_images(self, given: ArrayLike | None) -> np.ndarray:
        """The given images, or the nearest ones."""
        if self.box is None:
            if given is not None and np.size(given):
                raise NetworkError(
                    "images: expected a box for the periodic images of lines, got none. Give box."
                )
            return np.zeros((len(self.pairs), 0), dtype=np.int64)
        if given is not None:
            periods = checks.whole_array(given, "images", NetworkError, 3)
            if periods[:, ~np.asarray(self.box.periodic)].any():
                raise NetworkError(
                    "images: expected 0 along edges that are not periodic, got another number. "
                    "Give 0 there."
                )
            return periods
        first, second = self.pairs.T
        return self.box.images(self.positions[second] - self.positions[first])

    @cached_property
    def cochain(self) -> Cochain:
        """b on the lines, as a cochain with periodic images: sums along any chain of lines."""
        edges = Complex(len(self.positions), self.pairs, self.images, labels=self.labels)
        return Cochain(edges, self.burgers)

    @property
    def image_list(self) -> list[list[int]]:
        """Images as Python lists."""
        return self.images.tolist()

    @property
    def constraint_list(self) -> list[int]:
        """Constraints as a Python list."""
        return self.constraints.tolist()

    @cached_property
    def steps(self) -> np.ndarray:
        """From the first node of each line to the second, in its image, shape (lines, 3)."""
        periods = None if self.box is None else self.box.vectors
        return Cochain.between(self.cochain.complex, self.positions, periods).values

    @cached_property
    def lengths(self) -> np.ndarray:
        """Length of each line, shape (lines,)."""
        return np.linalg.norm(self.steps, axis=1)

    @cached_property
    def excess(self) -> np.ndarray:
        """b out minus b in at each node, shape (nodes, n): the boundary of the chain of lines."""
        return -(self.cochain.complex.boundary(0).T @ self.burgers)

    @cached_property
    def screw_shares(self) -> np.ndarray:
        """Share of b^2 along each line, cos^2 of the angle between the two, shape (lines,)."""
        sizes = np.linalg.norm(self.burgers, axis=1) * self.lengths
        along = (self.burgers * self.steps).sum(axis=1)
        return np.where(sizes > 0, along / np.where(sizes > 0, sizes, 1.0), 0.0) ** 2


class DislocationLine(tuple[Hashable, Hashable, Hashable, Vector]):
    """A line of a network: the tuple (start, end, key, b), and other known properties.

    Examples
    --------
    >>> from geomtorsion import DislocationNetwork
    >>> net = DislocationNetwork.of_lines(
    ...     [("a", "b", (1, 0))], surface="ab", positions={"a": (0, 0, 0), "b": (3, 4, 0)}
    ... )
    >>> start, end, key, b = net.lines[0]
    >>> start, end, net.lines[0].length, net.lines[0].kind
    ('a', 'b', 5.0, 'surface')
    """

    data: Mapping[str, Any]
    ends: tuple[Mapping[str, Any], Mapping[str, Any]]
    box: Box | None

    @classmethod
    def of(
        cls,
        graph: nx.MultiDiGraph[Hashable],
        edge: tuple[Hashable, Hashable, Hashable],
        data: Mapping[str, Any],
        box: Box | None,
    ) -> DislocationLine:
        """An edge of a graph."""
        start, end, key = edge
        line = cls((start, end, key, data["burgers"]))
        line.data, line.box = data, box
        line.ends = (graph.nodes[start], graph.nodes[end])
        return line

    @property
    def burgers(self) -> Vector:
        """b along the sense of the line, in the coordinates of the network, shape (n,)."""
        return self[3]

    @property
    def burgers_lattice(self) -> Vector:
        """b along the axes of the crystal in lattice constants, exact; () if it is not known."""
        return self.data.get("burgers_lattice", ())

    @property
    def family(self) -> str | None:
        """The family of b in the crystal, such as 1/2<1 1 1>, if it is known."""
        return self.data.get("family")

    @property
    def grain(self) -> int | None:
        """The grain that contains the line and whose axes apply to b; None if it is not known."""
        return self.data.get("grain")

    @property
    def image(self) -> tuple[int, ...]:
        """Number of periods by which the end is moved, shape (3,); () if it is not given."""
        return self.data.get("image", ())

    @cached_property
    def path(self) -> np.ndarray:
        """Points along the line, unwrapped, shape (k, 3); the last is its end, in its image.

        Raises
        ------
        NetworkError
            A node has no position.
        """
        if "path" in self.data:
            return self.data["path"]
        ends = [node.get("position") for node in self.ends]
        if None in ends:
            raise NetworkError(
                f"line {self[0]!r} -> {self[1]!r}: expected positions of its nodes, got none. Give "
                "all of them: of_lines(..., positions={node: (x, y, z)})."
            )
        points = checks.array(ends, "positions", NetworkError, shape=(2, None))
        if self.box is not None:
            image = self.image or self.box.images(points[1:] - points[:1])[0]
            points[1] += np.array(image) @ np.asarray(self.box.vectors)
        return points

    @property
    def length(self) -> float:
        """Length along its points, in the coordinates of the network."""
        return float(np.linalg.norm(np.diff(self.path, axis=0), axis=1).sum())

    @property
    def area(self) -> np.ndarray:
        """Vector area of a closed line, shape (3,): b . area is the inserted volume."""
        spokes = self.path - self.path[0]
        return np.cross(spokes[:-1], spokes[1:]).sum(axis=0) / 2

    @property
    def kind(self) -> str:
        """ "closed", "periodic", "wall", "surface" or "joined".

        "closed": it ends where it begins; "periodic": it ends there in another image; "wall": an
        end is in a wall between grains; "surface": an end is on a surface; "joined": both ends are
        junctions.
        """
        if self[0] == self[1]:
            return "periodic" if any(self.image) else "closed"
        if any(node.get("wall") for node in self.ends):
            return "wall"
        return "surface" if any(node.get("surface") for node in self.ends) else "joined"

    @property
    def is_closed(self) -> bool:
        """Whether it ends where it begins, not in another image."""
        return self.kind == "closed"


def line_arrays(graph: nx.MultiDiGraph[Hashable], box: Box | None) -> tuple[LineArrays, list[int]]:
    """Straight pieces of all lines of a graph, and the line of each piece.

    Raises
    ------
    NetworkError
        A node has no position in three dimensions, or there are images, but no box.
    """
    nodes, edges = graph.nodes(data=True), list(graph.edges(data=True))
    _check_nodes(nodes, edges)
    numbers = {node: k for k, node in enumerate(graph)}
    has_images = bool(edges) and "image" in edges[0][2]
    positions: list[Any] = [data["position"] for _, data in nodes]
    pairs, owner, images = [], [], []
    for k, (a, b, data) in enumerate(edges):
        inner = data["path"][1:-1].tolist() if "path" in data else []
        chain = [numbers[a], *range(len(positions), len(positions) + len(inner)), numbers[b]]
        positions += inner
        pairs += list(pairwise(chain))
        owner += [k] * (len(chain) - 1)
        if has_images:
            # Inner points are unwrapped: only the last piece leads into another image.
            images += [(0, 0, 0)] * len(inner) + [data["image"]]
    planes = [edges[k][2].get("plane") for k in owner]
    constraints = [data.get("constraint", 0) for _, data in nodes]
    more = len(positions) - len(numbers)
    names = list(graph)
    labels = names if not more else [*names, *(("point", k) for k in range(more))]
    columns: dict[str, Any] = {
        "positions": positions or np.zeros((0, 3)),
        "pairs": np.array(pairs, dtype=np.int64).reshape(-1, 2),
        "burgers": [[float(x) for x in edges[k][2]["burgers"]] for k in owner] or np.zeros((0, 3)),
        "images": images or None,
        "constraints": constraints + [0] * more,
        "planes": None if None in planes or not planes else planes,
    }
    return LineArrays(box=box, labels=labels, **columns), owner


def _check_nodes(nodes: Iterable[Any], edges: Sequence[Any]) -> None:
    """Refuse nodes without a position, and images of some lines only."""
    for node, data in nodes:
        if data.get("position") is None:
            raise NetworkError(
                f"node {checks.shown(node)}: expected a position, got none. Give one for each "
                "node: of_lines(..., positions={node: (x, y, z)})."
            )
    known = ["image" in data for *_, data in edges]
    if any(known) and not all(known):
        a, b, _ = edges[known.index(False)]
        raise NetworkError(
            f"line {a!r} -> {b!r}: expected an image as for other lines, got none. Give each line "
            "an image, or none of them."
        )
