"""Grain networks: the dislocation lines of all grains in one network, with their ends in walls."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.materials.crystals.grains import Grains
from geomtorsion.materials.crystals.method import METHOD
from geomtorsion.materials.crystals.networks import cluster_of
from geomtorsion.materials.crystals.triangulation import Cell
from geomtorsion.materials.lines.box import Box
from geomtorsion.materials.lines.dislocation_network import DislocationNetwork


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
