"""Networks: dislocation lines of a crystal as a DislocationNetwork."""

from __future__ import annotations

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
    lines = strands(graph, cell.vectors)
    for strand in simplified(lines, graph.surface, cell.vectors, width):
        path = smoothed(strand.path, strand.image @ cell.vectors, strand.start == strand.end, width)
        closed = strand.start == strand.end and not strand.image.any()
        if closed and length_of(path) < 2 * width:
            # No wider than a core: a point defect.
            continue
        if strand.start == strand.end and strand.start not in found:
            # Nothing but the line itself says where it begins.
            found.add_node(strand.start, position=tuple(path[0].tolist()), surface=False)
        for node in (strand.start, strand.end):
            if node not in found:
                place = tuple(graph.places[node].tolist())
                found.add_node(node, position=place, surface=bool(graph.surface[node]))
        b = frame.vectors(strand.burgers[None])[0]
        found.add_edge(
            strand.start,
            strand.end,
            burgers=tuple(b.tolist()),
            burgers_lattice=frame.lattice.fractions(strand.burgers),
            family=family(frame.lattice, strand.burgers),
            path=path,
            image=tuple(strand.image.tolist()),
        )
    named = nx.convert_node_labels_to_integers(found)
    origin = np.zeros(3)
    return DislocationNetwork(named, box=Box(cell.vectors, origin, cell.periodic))


def smoothed(path: np.ndarray, period: np.ndarray, closed: bool, width: float) -> np.ndarray:
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
