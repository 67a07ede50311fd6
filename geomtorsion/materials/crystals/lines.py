"""Lines: from torsion on faces to dislocation lines with junctions, lengths and images."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from geomtorsion.materials.crystals.torsion import TornFaces, components
from geomtorsion.materials.crystals.triangulation import distinct


@dataclass(frozen=True, eq=False)
class Strand:
    """A dislocation line between two nodes, or a closed line.

    start, end: numbers of its nodes; equal where it closes, in the same or in another image.
    burgers: whole numbers, shape (3,); path: positions, unwrapped, shape (k, 3).
    image: number of periods by which its end is moved, shape (3,).
    """

    start: int
    end: int
    burgers: np.ndarray
    path: np.ndarray
    image: np.ndarray

    @property
    def length(self) -> float:
        """Length along the path."""
        return length_of(self.path)

    def reversed(self, vectors: np.ndarray) -> Strand:
        """The same line in the other sense, starting from the position of its end in the cell."""
        path = self.path[::-1] - self.image @ vectors
        return Strand(self.end, self.start, -self.burgers, path, -self.image)


def length_of(path: np.ndarray) -> float:
    """Length along points, shape (k, 3)."""
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())


def smoothed(path: np.ndarray, closed: bool, width: float) -> np.ndarray:
    """A path without waves shorter than a width; its ends stay unless it closes.

    Points at equal distances, less the straight line from the first to the last, are a periodic
    function; a line with ends is first continued backwards with the other sign. Each wave is
    multiplied by 1 - (1 - g)^2, with g a Gauss curve: long waves lose nothing to the second
    order.
    """
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    at = np.concatenate([[0.0], np.cumsum(steps)])
    if not at[-1] > 0:
        return path
    count = max(int(np.ceil(4 * at[-1] / width)), 4)
    even = np.linspace(0, at[-1], count + 1)
    points = np.stack([np.interp(even, at, x) for x in path.T], axis=1)
    line = points[0] + np.linspace(0, 1, count + 1)[:, None] * (points[-1] - points[0])
    rest = (points - line)[:-1]
    length = at[-1]
    if not closed:
        rest = np.concatenate([rest, np.zeros((1, 3)), -rest[:0:-1]])
        length *= 2
    waves = 2 * np.pi * np.fft.rfftfreq(len(rest), length / len(rest))
    # Half of a wave that is cut to a tenth is then about twice as long as a core is wide.
    gauss = np.exp(-0.5 * (1.5 * waves * width) ** 2)
    bend = np.fft.irfft(np.fft.rfft(rest, axis=0) * (1 - (1 - gauss) ** 2)[:, None], len(rest), 0)
    bend = np.concatenate([bend[:count], bend[:1]]) if closed else bend[: count + 1]
    return line + bend


@dataclass(frozen=True, eq=False)
class DualGraph:
    """Faces with torsion as edges from one tetrahedron to the next.

    pairs: tetrahedra at both sides, those outside a surface as new nodes, shape (n, 2).
    burgers: whole numbers, shape (n, 3); images: of the second node for the first, shape (n, 3).
    places: of nodes, shape (nodes, 3); surface: whether a node is on a surface.
    """

    pairs: np.ndarray
    burgers: np.ndarray
    images: np.ndarray
    places: np.ndarray
    surface: np.ndarray

    @classmethod
    def of(cls, faces: TornFaces) -> DualGraph:
        """The faces as a graph; nodes are in the order of tetrahedra, nodes on surfaces last."""
        there = faces.cells[:, :, 0] >= 0
        centres = faces.centres[there]
        first, which = distinct(faces.cells[there].T)
        outside = ~np.all(there, axis=1)
        pairs = np.empty(there.shape, dtype=np.int64)
        pairs[there] = which
        pairs[~there] = len(first) + np.arange(outside.sum())
        # The end is in the face, next to its only tetrahedron.
        images = np.where(outside[:, None], 0, faces.images)
        inner = faces.centres[outside][there[outside]]
        places = np.concatenate([centres[first], inner])
        return cls(pairs, faces.values, images, places, np.arange(len(places)) >= len(first))


def flux(graph: DualGraph, vectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Component of each node, and sum of b (x) dl over each component, shape (components, 3, 3).

    It is the integral of the Nye tensor: b (x) L on a line of period L, zero on closed lines.
    """
    number = components(len(graph.places), graph.pairs)
    a, b = graph.pairs.T
    steps = graph.places[b] - graph.places[a] + graph.images @ vectors
    sums = np.zeros((number.max(initial=-1) + 1, 3, 3))
    np.add.at(sums, number[a], graph.burgers[:, :, None] * steps[:, None, :])
    return number, sums


def strands(graph: DualGraph, vectors: np.ndarray) -> list[Strand]:
    """Chains of nodes at which two edges of one b meet, each as one line."""
    count = len(graph.places)
    around: list[list[tuple[int, int]]] = [[] for _ in range(count)]
    for k, (a, b) in enumerate(graph.pairs.tolist()):
        around[a].append((k, 1))
        around[b].append((k, -1))
    passed = [
        len(x) == 2 and x[0][0] != x[1][0] and not s
        for x, s in zip(around, graph.surface.tolist(), strict=True)
    ]
    done = np.zeros(len(graph.pairs), dtype=bool)
    chains = []

    def follow(first: int, sense: int) -> Strand:
        """Follow a line to a node where it ends, or back to its beginning."""
        edge, going = first, sense
        start = int(graph.pairs[edge, 0 if going > 0 else 1])
        offset = np.zeros(3, dtype=np.int64)
        path = [graph.places[start]]
        while True:
            done[edge] = True
            node = int(graph.pairs[edge, 1 if going > 0 else 0])
            offset = offset + going * graph.images[edge]
            path.append(graph.places[node] + offset @ vectors)
            if not passed[node] or node == start:
                break
            one, other = around[node]
            edge, going = other if one[0] == edge else one
        return Strand(start, node, sense * graph.burgers[first], np.array(path), offset)

    for node in range(count):
        if not passed[node]:
            for edge, sense in around[node]:
                if not done[edge]:
                    chains.append(follow(edge, sense))
    # The remaining edges are closed; each call follows a whole ring.
    rings = (follow(edge, 1) for edge in range(len(done)) if not done[edge])
    return [*chains, *rings]


def simplified(
    found: list[Strand], surface: np.ndarray, vectors: np.ndarray, width: float
) -> list[Strand]:
    """Lines between junctions nearer to each other than a width become one junction.

    Smaller structures are inside a core, where lines cannot be separated. A ring no wider than a
    core is a point defect, and two lines between the same junctions that form a ring no wider
    than a core are one line. Sums of b at the junctions do not change.
    """
    lines = dict(enumerate(_without_eyes(found, surface, vectors, width)))
    short = sorted(
        (k for k, one in lines.items() if one.start != one.end and one.length < width),
        key=lambda k: lines[k].length,
    )
    for k in short:
        line = lines[k]
        if line.start == line.end or surface[[line.start, line.end]].any():
            continue
        gone, junction = line.end, line.start
        del lines[k]
        # The removed node moves to the beginning of the line, so many periods back.
        place, offset = line.path[0] - line.image @ vectors, line.image
        for m, neighbour in list(lines.items()):
            if gone in (neighbour.start, neighbour.end):
                lines[m] = _moved(neighbour, gone, junction, place, offset, vectors)
    rings = [k for k, one in lines.items() if one.start == one.end and not one.image.any()]
    for k in rings:
        if length_of(smoothed(lines[k].path, True, width)) < np.pi * width:
            del lines[k]
    return _joined(lines, surface, vectors)


def _without_eyes(
    found: list[Strand], surface: np.ndarray, vectors: np.ndarray, width: float
) -> list[Strand]:
    """Merge lines that part and meet again within a core into one with the sum of their b."""
    lines: dict[int, Strand] = {}
    line_at: dict[tuple[int, ...], int] = {}
    for k, strand in enumerate(found):
        line = strand if strand.start <= strand.end else strand.reversed(vectors)
        ends = (line.start, line.end, *line.image.tolist())
        twin = lines.get(line_at.setdefault(ends, k))
        if twin is None or strand.start == strand.end:
            lines[k] = line
        elif line.length + twin.length < np.pi * width:
            first = min(line, twin, key=lambda x: x.length)
            lines[line_at[ends]] = replace(first, burgers=line.burgers + twin.burgers)
        else:
            lines[k] = line
    nonzero_lines = {k: line for k, line in lines.items() if line.burgers.any()}
    return found if len(nonzero_lines) == len(found) else _joined(nonzero_lines, surface, vectors)


def _moved(
    line: Strand, gone: int, kept: int, place: np.ndarray, offset: np.ndarray, vectors: np.ndarray
) -> Strand:
    """A line with its ends at one node moved to another, whose position in the cell is `place`."""
    start, end, path, image = line.start, line.end, line.path, line.image
    if end == gone:
        path = np.concatenate([path, [place + image @ vectors]])
        end, image = kept, image - offset
    if start == gone:
        path = np.concatenate([[place], path]) + offset @ vectors
        start, image = kept, image + offset
    return Strand(start, end, line.burgers, path, image)


def _joined(lines: dict[int, Strand], surface: np.ndarray, vectors: np.ndarray) -> list[Strand]:
    """Merge lines of one b that meet at a node where no other line ends."""
    at: dict[int, list[int]] = {}
    for k, line in lines.items():
        for node in (line.start, line.end):
            at.setdefault(node, []).append(k)
    for node in list(at):
        ends = at[node]
        if len(ends) != 2 or ends[0] == ends[1] or surface[node]:
            continue
        first, second = (lines[k] for k in ends)
        if first.end != node:
            first = first.reversed(vectors)
        if second.start != node:
            second = second.reversed(vectors)
        path = np.concatenate([first.path, second.path[1:] + first.image @ vectors])
        image = first.image + second.image
        strand = Strand(first.start, second.end, first.burgers, path, image)
        lines[ends[0]] = strand
        del lines[ends[1]], at[node]
        at[second.end] = [ends[0] if k == ends[1] else k for k in at[second.end]]
    return list(lines.values())
