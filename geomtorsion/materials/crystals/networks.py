"""Networks: dislocation lines of a crystal as a DislocationNetwork."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from fractions import Fraction
from math import gcd

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.materials.crystals.frames import Frame
from geomtorsion.materials.crystals.grains import Grains
from geomtorsion.materials.crystals.lattices import Lattice
from geomtorsion.materials.crystals.lines import DualGraph, simplified, smoothed, strands
from geomtorsion.materials.crystals.method import METHOD
from geomtorsion.materials.crystals.torsion import TornFaces
from geomtorsion.materials.crystals.triangulation import Cell
from geomtorsion.materials.lines.box import Box
from geomtorsion.materials.lines.crystal_analysis import Cluster
from geomtorsion.materials.lines.dislocation_network import DislocationNetwork


def network_of(
    faces: TornFaces,
    cell: Cell,
    frame: Frame,
    width: float,
    extra: Callable[[np.ndarray, np.ndarray], float],
    cluster: Cluster,
) -> DislocationNetwork:
    """The lines that carry torsion, smoothed, in the frame of a crystal.

    width: of a core. extra: volume of the atoms in excess of sites around a closed path, given the
    points of all other lines; 0.0 where they cannot be counted. A closed line is drawn so that
    b . A is that volume, since bonds across it change their label slightly inside of it. cluster:
    the crystal as OVITO describes it.
    """
    import networkx as nx  # 0.15 s, and only networks need it

    graph = DualGraph.of(faces)
    multigraph = nx.MultiDiGraph(clusters={None: cluster})
    lines = simplified(strands(graph, cell.vectors), graph.surface, cell.vectors, width)
    ends = Counter(node for line in lines for node in (line.start, line.end))
    alone = [line.start == line.end and ends[line.start] == 2 for line in lines]
    paths = [smoothed(line.path, one, width) for line, one in zip(lines, alone, strict=True)]
    for k, line in enumerate(lines):
        if alone[k] and not line.image.any():
            others = [np.zeros((0, 3)), *(one.path for one in lines if one is not line)]
            volume = extra(line.path, np.concatenate(others))
            paths[k] = _with_area(paths[k], frame.vectors(line.burgers[None])[0], volume)
    numbers: dict[int, int] = {}
    for line, path, one in zip(lines, paths, alone, strict=True):
        for node in (line.start, line.end):
            if node not in numbers:
                numbers[node] = len(numbers)
                # The beginning of a line without junctions is known only from the line itself.
                place = path[0] if one else graph.places[node]
                outside = bool(graph.surface[node])
                multigraph.add_node(numbers[node], position=tuple(place.tolist()), surface=outside)
        multigraph.add_edge(
            numbers[line.start],
            numbers[line.end],
            burgers=tuple(frame.vectors(line.burgers[None])[0].tolist()),
            burgers_lattice=frame.lattice.fractions(line.burgers),
            family=family(frame.lattice, line.burgers),
            path=path,
            image=tuple(line.image.tolist()),
        )
    return DislocationNetwork(multigraph, box=Box(cell.vectors, periodic=cell.periodic))


def network_of_grains(
    networks: Sequence[DislocationNetwork], grains: Grains, cell: Cell, places: np.ndarray
) -> DislocationNetwork:
    """The networks of single grains as one; b of each line is along the axes of its grain.

    An end next to atoms of no grain or of another grain is in a wall. A line that reaches no
    further from a wall than the width of a core belongs to the wall.

    Parameters
    ----------
    networks
        For each grain, as found in that grain by itself.
    cell, places
        The cell, and the positions of all atoms in it, shape (atoms, 3).
    """
    import networkx as nx  # 0.15 s, and only networks need it

    union = nx.MultiDiGraph()
    for grain, network in zip(grains, networks, strict=True):
        if not network.lines:
            continue
        width = METHOD.width * grain.frame.lattice.nearest * grain.frame.constant
        outside = _Outside(places[grains.number != grain.number], cell, width)
        graph = nx.MultiDiGraph(network.graph)
        for _, data in graph.nodes(data=True):
            data["wall"] = data["surface"] and outside.all_near(np.array([data["position"]]))
        for part in list(nx.weakly_connected_components(graph)):
            edges = graph.subgraph(part).edges(data=True)
            if outside.all_near(np.concatenate([data["path"] for *_, data in edges])):
                graph.remove_nodes_from(part)
        for *_, data in graph.edges(data=True):
            data["grain"] = grain.number
        names = {node: len(union) + k for k, node in enumerate(graph)}
        union.update(nx.relabel_nodes(graph, names))
    clusters = {grain.number: cluster_of(grain.frame, len(grain.atoms)) for grain in grains}
    union.graph.update(clusters=clusters, walls=[wall.grains for wall in grains.walls])
    return DislocationNetwork(union, box=Box(cell.vectors, periodic=cell.periodic))


def cluster_of(frame: Frame, atoms: int = 0) -> Cluster:
    """A crystal or a grain as OVITO describes it."""
    lattice, scale = frame.lattice, np.ones(3)
    if lattice.is_hexagonal:
        # OVITO takes the hcp vectors for the ideal c/a, with neighbours 1/sqrt(2) apart.
        scale = np.sqrt([2, 2, 3 / 4 * lattice.ratio**2])
    return Cluster(lattice.name, frame.matrix.T * scale, atoms)


def family(lattice: Lattice, values: np.ndarray) -> str:
    """The family of a Burgers vector, such as 1/2<1 1 0>."""
    b = lattice.fractions(values)
    if lattice.is_hexagonal:
        # Four indices: [u v t w] with t = -(u + v), so that families look alike.
        b = ((2 * b[0] - b[1]) / 3, (2 * b[1] - b[0]) / 3, -(b[0] + b[1]) / 3, b[2])
        order = sorted(b[:3], key=lambda x: (abs(x), x))
        sign = -1 if next((x for x in order if x), 1) < 0 else 1
        order = [*(sign * x for x in order), abs(b[3])]
    else:
        order = sorted(map(abs, b), key=lambda x: (x == 0, x))
    below = 1
    for x in order:
        below = below * x.denominator // gcd(below, x.denominator)
    whole = [int(x * below) for x in order]
    common = gcd(*whole)
    factor = Fraction(common, below)
    inner = " ".join(str(x // common) for x in whole)
    return f"{factor if factor != 1 else ''}<{inner}>"


def _with_area(path: np.ndarray, burgers: np.ndarray, volume: float) -> np.ndarray:
    """A closed path scaled about its centre so that b . A is a volume, if it nearly is already."""
    middle = path[:-1].mean(axis=0)
    spokes = path - middle
    path_volume = np.cross(spokes[:-1], spokes[1:]).sum(axis=0) @ burgers / 2
    # A core cannot hide twice as much area: other defects have been counted as well.
    if not 0.5 < volume / (path_volume or np.inf) < 2:
        return path
    return middle + np.sqrt(volume / path_volume) * spokes


class _Outside:
    """Atoms outside a grain, and atoms as near to them as the width of a core."""

    def __init__(self, places: np.ndarray, cell: Cell, width: float) -> None:
        points, _, _ = cell.with_ghosts(places, width)
        self.tree = scipy.spatial.cKDTree(points) if len(points) else None
        self.cell, self.width = cell, width

    def all_near(self, points: np.ndarray) -> bool:
        """Whether all of some points are near."""
        if self.tree is None:
            return False
        return bool(self.tree.query(self.cell.wrapped(points)[0])[0].max() < self.width)
