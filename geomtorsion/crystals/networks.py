"""Networks: dislocation lines of a crystal as a DislocationNetwork."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from math import gcd

import numpy as np

from geomtorsion.crystals.frames import Frame
from geomtorsion.crystals.lattices import Lattice
from geomtorsion.crystals.lines import DualGraph, length_of, simplified, strands
from geomtorsion.crystals.method import METHOD
from geomtorsion.crystals.torsion import Torsion
from geomtorsion.loops.box import Box
from geomtorsion.loops.dislocation_network import DislocationNetwork


def network_of(torsion: Torsion, frame: Frame) -> DislocationNetwork:
    """The lines that carry torsion, smoothed, in the frame of a crystal."""
    import networkx as nx  # 0.15 s, and networks alone need it

    cell = torsion.mesh.cell
    graph = DualGraph.of(torsion)
    width = METHOD.width * frame.lattice.nearest * frame.constant
    found = nx.MultiDiGraph()
    lines = simplified(strands(graph, cell.vectors), graph.surface, cell.vectors, width)
    ends = Counter(node for line in lines for node in (line.start, line.end))
    numbers: dict[int, int] = {}
    for line in lines:
        alone = line.start == line.end and ends[line.start] == 2
        path = smoothed(line.path, alone, width)
        if alone and not line.image.any() and length_of(path) < 2 * width:
            # No wider than a core: a point defect.
            continue
        for node in (line.start, line.end):
            if node not in numbers:
                numbers[node] = len(numbers)
                # Of a line without junctions only the line itself says where it begins.
                place = path[0] if alone else graph.places[node]
                outside = bool(graph.surface[node])
                found.add_node(numbers[node], position=tuple(place.tolist()), surface=outside)
        found.add_edge(
            numbers[line.start],
            numbers[line.end],
            burgers=tuple(frame.vectors(line.burgers[None])[0].tolist()),
            burgers_lattice=frame.lattice.fractions(line.burgers),
            family=family(frame.lattice, line.burgers),
            path=path,
            image=tuple(line.image.tolist()),
        )
    return DislocationNetwork(found, box=Box(cell.vectors, periodic=cell.periodic))


def smoothed(path: np.ndarray, closed: bool, width: float) -> np.ndarray:
    """A path without waves shorter than a width; its ends stay unless it closes.

    Points at equal distances, less the straight line from the first to the last, are a periodic
    function: of a line with ends after it has been continued backwards with the other sign. Of its
    waves those are kept that 1 - (1 - g)^2 keeps, g a Gauss curve: long ones lose nothing to the
    second order.
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
    gauss = np.exp(-0.5 * (waves * width) ** 2)
    kept = np.fft.irfft(np.fft.rfft(rest, axis=0) * (1 - (1 - gauss) ** 2)[:, None], len(rest), 0)
    kept = np.concatenate([kept[:count], kept[:1]]) if closed else kept[: count + 1]
    return line + kept


def family(lattice: Lattice, values: np.ndarray) -> str:
    """The family of a Burgers vector, such as 1/2<1 1 0>."""
    b = lattice.fractions(values)
    if lattice.name == "hcp":
        # Four indices: [u v t w] with t = -(u + v), so that families look alike.
        b = ((2 * b[0] - b[1]) / 3, (2 * b[1] - b[0]) / 3, -(b[0] + b[1]) / 3, b[2])
        order = [*sorted(b[:3], key=lambda x: (abs(x), x), reverse=True), abs(b[3])]
        if order[0] < 0:
            order[:3] = [-x for x in order[:3]]
    else:
        order = sorted(map(abs, b), reverse=True)
    below = 1
    for x in order:
        below = below * x.denominator // gcd(below, x.denominator)
    whole = [int(x * below) for x in order]
    common = gcd(*whole)
    factor = Fraction(common, below)
    inner = " ".join(str(x // common) for x in whole)
    return f"{factor if factor != 1 else ''}<{inner}>"
