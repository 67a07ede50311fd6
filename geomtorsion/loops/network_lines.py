"""Network lines: the lines of a dislocation network one by one, and as straight pieces."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion import checks
from geomtorsion.errors import NetworkError
from geomtorsion.loops.box import Box
from geomtorsion.loops.line_arrays import LineArrays
from geomtorsion.loops.reactions import Vector

if TYPE_CHECKING:
    import networkx as nx


class DislocationLine(tuple[Hashable, Hashable, Hashable, Vector]):
    """A line of a network: the tuple (start, end, key, b), and what else is known of it.

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
        found = cls((start, end, key, data["burgers"]))
        found.data, found.box = data, box
        found.ends = (graph.nodes[start], graph.nodes[end])
        return found

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
        """The grain in which it lies, along whose axes b is meant; None: it is not known."""
        return self.data.get("grain")

    @property
    def image(self) -> tuple[int, ...]:
        """How many periods further the end is meant, shape (3,); (): it is not given."""
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
                f"line {self[0]!r} -> {self[1]!r}: its nodes have no positions. Give all of them: "
                "of_lines(..., positions={node: (x, y, z)})."
            )
        found = checks.array(ends, "positions", NetworkError, shape=(2, None))
        if self.box is not None:
            image = self.image or self.box.images(found[1:] - found[:1])[0]
            found[1] += np.array(image) @ np.asarray(self.box.vectors)
        return found

    @property
    def length(self) -> float:
        """Length along its points, in the coordinates of the network."""
        return float(np.linalg.norm(np.diff(self.path, axis=0), axis=1).sum())

    @property
    def area(self) -> np.ndarray:
        """Vector area of a closed line, shape (3,): b . area is the volume of what was put in."""
        spokes = self.path - self.path[0]
        return np.cross(spokes[:-1], spokes[1:]).sum(axis=0) / 2

    @property
    def kind(self) -> str:
        """ "closed": ends where it begins; "periodic": ends there in another image; "wall": an end
        lies in a wall between grains; "surface": on a surface; "joined": both ends are
        junctions."""
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
    """Straight pieces of all lines of a graph, and to which line each belongs.

    Raises
    ------
    NetworkError
        A node has no position in three dimensions, or there are images, but no box.
    """
    nodes = graph.nodes(data=True)
    for node, data in nodes:
        if data.get("position") is None:
            raise NetworkError(
                f"node {checks.shown(node)} has no position. Give all of them: "
                "of_lines(..., positions={node: (x, y, z)})."
            )
    numbers = {node: k for k, node in enumerate(graph)}
    edges = list(graph.edges(data=True))
    known = ["image" in data for *_, data in edges]
    if any(known) and not all(known):
        a, b, _ = edges[known.index(False)]
        raise NetworkError(f"line {a!r} -> {b!r} has no image. Give all lines one, or none.")
    positions: list[Any] = [data["position"] for _, data in nodes]
    pairs, owner, images = [], [], []
    for k, (a, b, data) in enumerate(edges):
        inner = data["path"][1:-1].tolist() if "path" in data else []
        chain = [numbers[a], *range(len(positions), len(positions) + len(inner)), numbers[b]]
        positions += inner
        pairs += list(pairwise(chain))
        owner += [k] * (len(chain) - 1)
        if any(known):
            # Inner points are unwrapped: the last piece alone leads into another image.
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
