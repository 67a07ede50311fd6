"""Circuits around lines of networks: exact sums, lattices, and lines that end."""

# The tests pass what users pass, including wrong types, and read optional values.
# pyright: reportArgumentType=false, reportOptionalIterable=false

from fractions import Fraction as F

import networkx as nx
import numpy as np
import pytest

from geomtorsion.errors import ArgumentError, NetworkError
from geomtorsion.loops import Loop
from geomtorsion.materials.lines import Box, DislocationNetwork, LineArrays
from tests.materials.lines.synthetic_networks import rings, straight

PLACES = {"a": (-3, -3, 0), "b": (3, -3, 0), "j": (0, 0, 0), "c": (0, 5, 0)}
BOX = Box.of_bounds([0, 0, 0], [4, 4, 4])
LINES = [("a", "j", (F(1, 3), 0, 0)), ("b", "j", (F(2, 3), 1, 0)), ("j", "c", (1, 1, 0))]


def test_exact_vectors_stay_exact():
    """Thirds sum to one, and a loop that links no line has b = 0."""
    net = DislocationNetwork.of_lines(LINES, surface="abc", positions=PLACES)
    about = Loop.circle([0, -2, 0], 2.5, (2, 0))
    found = net.burgers(about)
    assert found.exact == (1, 1, 0)
    assert isinstance(found.exact[0], F)
    assert net.burgers(about.times(-2)).exact == (-2, -2, 0)
    assert net.burgers(Loop.circle([0, 3, 0], 1, (2, 0))).exact == found.exact
    assert net.burgers(Loop.circle([-1.5, -1.5, 0], 0.5, (2, 0))).exact == (F(1, 3), 0, 0)
    assert net.burgers(Loop.circle([0, 0, 4], 2)).exact == (0, 0, 0)


def test_circuits_in_whole_lattice_vectors():
    """Floating-point b of a simulation give whole numbers and the same vector."""
    lines = rings(12, seed=8)
    net = DislocationNetwork.of_arrays(lines)
    found = net.burgers(Loop.circle([5, 5, 5], 6), "fcc")
    assert found.crossings
    assert found.whole.dtype == np.int64
    half = [(0, 1, 1), (1, 0, 1), (1, 1, 0)]
    back = [
        sum(n * row[i] for n, row in zip(found.whole.tolist(), half, strict=True)) for i in range(3)
    ]
    assert found.vector == pytest.approx([x / 2**0.5 for x in back], abs=1e-12)
    with pytest.raises(NetworkError, match="expected a lattice that contains each b"):
        net.burgers(Loop.circle([5, 5, 5], 3), "sc")


def test_lines_that_end_leave_no_answer():
    """If b is not conserved near the loop, two surfaces disagree; far from there they agree."""
    ended = LineArrays([[0, 0, -9], [0, 0, 0.05]], [[0, 1]], [[0, 0, 1.0]])
    net = DislocationNetwork.of_arrays(ended)
    assert [one.node for one in net.node_rule()] == [0, 1]
    with pytest.raises(
        NetworkError, match=r"for two of them, because lines end in between.*node_rule"
    ):
        net.burgers(Loop.circle([0, 0, 0], 1))
    assert net.burgers(Loop.circle([0, 0, -5], 1)).exact == (0, 0, 1)


def test_a_circuit_needs_positions_and_a_loop():
    """Each refusal is an error of our own."""
    bare = DislocationNetwork.of_lines(LINES, surface="abc")
    with pytest.raises(NetworkError, match="node 'a': expected a position, got none"):
        bare.burgers(Loop.circle([0, 0, 0], 1))
    net = DislocationNetwork.of_arrays(straight([(0, 0)], [(0.0, 0.0, 1.0)]))
    with pytest.raises(ArgumentError, match="expected a Loop"):
        net.burgers("circle")
    with pytest.raises(NetworkError, match="needs the volume of the box"):
        _ = DislocationNetwork.of_lines(LINES, "abc", PLACES).density


def test_changes_keep_images_and_box():
    """A reversed, split or zipped line links the loop as before."""
    box = Box.of_bounds([0, 0, 0], [4, 4, 4])
    corners = [[1, 1, 2], [3, 1, 2], [3, 3, 2], [1, 3, 2]]
    sides = [[0, 1], [1, 2], [2, 3], [3, 0]]
    net = DislocationNetwork.of_arrays(LineArrays(corners, sides, [[0, 0, 2.0]] * 4, box))
    loop = Loop.circle([2, 5, 6], 0.5, (1, 2))
    wanted = net.burgers(loop).exact
    assert wanted == (0, 0, 2)
    assert net.reversed((0, 1, 0)).burgers(loop).exact == wanted
    assert net.split((0, 1, 0), [(0, 0, 1), (0, 0, 1)]).burgers(loop).exact == wanted
    across = LineArrays([[3.5, 1, 1], [0.5, 1, 1]], [[0, 1]], [[1.0, 0, 0]], box)
    thread = DislocationNetwork.of_arrays(across)
    assert thread.arrays.images.tolist() == [[1, 0, 0]]
    assert thread.reversed((0, 1, 0)).arrays.images.tolist() == [[-1, 0, 0]]


def test_images_are_all_given_or_none():
    """An edge without an image among others is refused, and so are images without a box."""
    graph = nx.MultiDiGraph()
    for node, place in enumerate([(0, 0, 0), (1, 0, 0)]):
        graph.add_node(node, position=place)
    graph.add_edge(0, 1, burgers=(1, 0, 0), image=(1, 0, 0))
    with pytest.raises(
        NetworkError, match="expected a box for the periodic images of lines, got none"
    ):
        _ = DislocationNetwork(graph).arrays
    graph.add_edge(1, 0, burgers=(1, 0, 0))
    with pytest.raises(NetworkError, match="line 1 -> 0: expected an image"):
        _ = DislocationNetwork(graph, box=Box.of_bounds([0, 0, 0], [2, 2, 2])).arrays


def test_a_network_without_lines():
    """A network with only a node has no violations, families or density, and no circuits."""
    empty = DislocationNetwork.of_arrays(
        LineArrays([[0, 0, 0]], np.zeros((0, 2), int), np.zeros((0, 3)), BOX)
    )
    assert empty.node_rule() == ()
    assert empty.families() == ()
    assert empty.density == 0
    with pytest.raises(NetworkError, match="got one without lines"):
        empty.burgers(Loop.circle([0, 0, 0], 1))
