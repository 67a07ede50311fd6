"""Network lines: each line of a network with its path, and its pieces as arrays."""

import networkx as nx
import numpy as np
import pytest

from geomtorsion import Box, DislocationNetwork, Loop
from geomtorsion.errors import NetworkError


def bowed(image=(0, 0, 0)):
    """One line through three points besides its node, in a box."""
    graph = nx.MultiDiGraph()
    graph.add_node("a", position=(1.0, 1.0, 1.0))
    end = np.array([1.0, 1.0, 1.0]) + 4 * np.array(image)
    path = np.array([[1, 1, 1], [3, 1, 1], [3, 3, 1], [1, 3, 1], end])
    graph.add_edge("a", "a", burgers=(0, 0, 1), path=path, image=image, family="<1 0 0>")
    return DislocationNetwork(graph, box=Box.of_bounds([0, 0, 0], [4, 4, 4]))


def test_a_line_knows_its_path():
    """Length, kind and area follow from the points along the line."""
    (line,) = bowed().lines
    assert (line.kind, line.is_closed, line.length, line.family) == ("closed", True, 8, "<1 0 0>")
    assert line.area.tolist() == [0, 0, 4]
    assert line == ("a", "a", 0, (0, 0, 1))
    (through,) = bowed((0, 0, 1)).lines
    assert (through.kind, through.is_closed, through.image) == ("periodic", False, (0, 0, 1))


def test_pieces_have_the_same_sums():
    """Density, Nye tensor and circuits use the path, not the straight line."""
    net = bowed()
    assert net.density == 8 / 64
    assert net.arrays.lengths.tolist() == [2, 2, 2, 2]
    assert net.burgers(Loop.circle([2, 1, 1], 0.5, plane=(1, 2))).vector.tolist() == [0, 0, 1]
    (curve,) = net.polylines
    assert (curve.is_closed, curve.length) == (True, 8)
    assert bowed((0, 0, 1)).nye[2] == pytest.approx([0, 0, 4 / 64])


def test_lengths_need_positions():
    """Kinds are available without positions, lengths are not."""
    net = DislocationNetwork.of_lines([("a", "b", (1, 0))], surface="a")
    assert net.lines[0].kind == "surface"
    with pytest.raises(NetworkError, match="expected positions of its nodes, got none"):
        _ = net.lines[0].length
