"""Dislocation networks: node rule, junctions, reactions."""

from fractions import Fraction as F

import networkx as nx
import pytest
import sympy as sp

from geomtorsion.errors import NetworkError
from geomtorsion.materials.lines import DislocationNetwork, Reaction

PERFECT = (F(1, 2), F(-1, 2), 0)
SHOCKLEY = [(F(2, 6), F(-1, 6), F(-1, 6)), (F(1, 6), F(-2, 6), F(1, 6))]


@pytest.fixture
def star() -> DislocationNetwork:
    lines = [("a", "j", (1, 0, 0)), ("b", "j", (0, 1, 0)), ("j", "c", (1, 1, 0))]
    return DislocationNetwork.of_lines(lines, surface="abc")


def test_node_rule_counts_in_and_out(star):
    """Inner nodes balance, surface nodes are free, and an unbalanced node shows its excess."""
    assert star.node_rule() == ()
    assert star.checked() is star
    assert star.junctions == ("j",)
    bare = DislocationNetwork.of_lines([(u, v, b) for u, v, _, b in star.lines], surface="ab")
    (violation,) = bare.node_rule()
    assert (violation.node, violation.excess) == ("c", (-1, -1, 0))
    with pytest.raises(NetworkError, match="node 'c'.*-1, -1, 0"):
        bare.checked()


def test_exact_and_floating_vectors():
    """Thirds are exact, square roots are simplified, floats have a tolerance."""
    thirds = [("a", "j", (F(1, 3), 0)), ("b", "j", (F(2, 3), 0)), ("j", "c", (1, 0))]
    assert DislocationNetwork.of_lines(thirds, "abc").node_rule() == ()
    root = sp.sqrt(2)
    roots = [("a", "j", (root, 0)), ("b", "j", (1, 0)), ("j", "c", ((root**2 - 1) / (root - 1), 0))]
    assert DislocationNetwork.of_lines(roots, "abc").node_rule() == ()
    floats = [("a", "j", (0.1, 0)), ("b", "j", (0.2, 0)), ("j", "c", (0.3, 0))]
    assert DislocationNetwork.of_lines(floats, "abc").node_rule() == ()
    off = [("a", "j", (0.1, 0)), ("b", "j", (0.2, 0)), ("j", "c", (0.3001, 0))]
    assert len(DislocationNetwork.of_lines(off, "abc").node_rule()) == 1
    third_off = [("a", "j", (F(1, 3), 0)), ("j", "c", (F(333333333, 1000000000), 0))]
    assert len(DislocationNetwork.of_lines(third_off, "ac").node_rule()) == 1


def test_sense_and_burgers_vector_turn_together(star):
    """A reversed line has the opposite b, and the node rule still holds."""
    turned = star.reversed(("a", "j", 0))
    assert ("j", "a", 0, (-1, 0, 0)) in turned.lines
    assert turned.node_rule() == ()
    assert ("a", "j", 0, (1, 0, 0)) in star.lines


def test_lines_split_and_zip(star):
    """A line dissociates between its nodes; two lines join up to a new junction."""
    split = star.split(("j", "c", 0), [(1, 0, 0), (0, 1, 0)])
    assert split.node_rule() == ()
    assert len(split.lines) == 4
    away = star.reversed(("a", "j", 0)).reversed(("b", "j", 0))
    zipped = away.zipped(("j", "a", 0), ("j", "b", 0), "k")
    assert ("j", "k", 0, (-1, -1, 0)) in zipped.lines
    assert zipped.node_rule() == ()
    pair = DislocationNetwork.of_lines([("o", "a", (1, 0)), ("o", "b", (-1, 0))], surface="ab")
    gone = pair.zipped(("o", "a", 0), ("o", "b", 0), "k")
    assert not gone.graph.has_edge("o", "k")
    assert gone.node_rule() == ()
    with pytest.raises(NetworkError, match="difference is"):
        star.split(("j", "c", 0), [(1, 0, 0), (0, 2, 0)])
    with pytest.raises(NetworkError, match="leave the same node"):
        star.zipped(("a", "j", 0), ("b", "j", 0), "k")
    with pytest.raises(NetworkError, match="junction: expected a new name, got node"):
        away.zipped(("j", "a", 0), ("j", "b", 0), "c")
    with pytest.raises(NetworkError, match="expected the .start, end, key. of a line, got"):
        star.split(("c", "j", 0), [(1, 1, 0)])


def test_reactions_conserve_b_and_follow_frank():
    """The textbook split of an fcc dislocation, a sum that fails, and an unfavourable reaction."""
    split = Reaction([PERFECT], SHOCKLEY)
    assert split.energy_change == F(-1, 6)
    assert split.is_favourable
    lomer = Reaction([(F(1, 2), 0, F(1, 2)), (F(-1, 2), F(1, 2), 0)], [(0, F(1, 2), F(1, 2))])
    assert lomer.energy_change == F(-1, 2)
    assert not Reaction(SHOCKLEY, [PERFECT]).is_favourable
    # Perpendicular vectors: b^2 stays the same.
    assert not Reaction([(1, 1, 0)], [(1, 0, 0), (0, 1, 0)]).is_favourable
    with pytest.raises(NetworkError, match=r"\(1/2, -1/2, 0\) before"):
        Reaction([PERFECT], SHOCKLEY[:1])
    with pytest.raises(
        NetworkError, match="(before|after): expected at least one dislocation, got none"
    ):
        Reaction([], SHOCKLEY)
    with pytest.raises(NetworkError, match="finite"):
        Reaction([(float("nan"), 0)], [(0, 0)])


def test_bad_networks_are_refused():
    """A wrong kind of graph, and missing, zero, unequal or wrong vectors are refused."""
    with pytest.raises(NetworkError, match="MultiDiGraph"):
        DislocationNetwork(nx.Graph())  # type: ignore[arg-type]
    graph = nx.MultiDiGraph()
    graph.add_edge(0, 1)
    with pytest.raises(NetworkError, match="expected an attribute 'burgers', got none"):
        DislocationNetwork(graph)
    for b, message in (
        ((0, 0, 0), "b = 0"),
        ("abc", "expected a Burgers vector, got 'abc'"),
        ((1, "x"), "expected a number, got 'x'"),
        ((1, float("inf")), "expected a finite number, got inf"),
    ):
        with pytest.raises(NetworkError, match=message):
            DislocationNetwork.of_lines([(0, 1, b)])  # type: ignore[list-item]
    with pytest.raises(NetworkError, match="3 numbers"):
        DislocationNetwork.of_lines([(0, 1, (1, 0, 0)), (1, 2, (1, 0))])
    with pytest.raises(NetworkError, match="surface: expected nodes of lines, got"):
        DislocationNetwork.of_lines([(0, 1, (1, 0))], surface=[7])
    with pytest.raises(NetworkError, match="expected a node of a line, got"):
        DislocationNetwork.of_lines([(0, 1, (1, 0))]).excess(7)


def test_the_network_keeps_its_own_graph():
    """A later change of the given graph changes no network, and the inner graph is frozen."""
    graph = nx.MultiDiGraph()
    graph.add_edge(0, 1, burgers=(1, 0))
    net = DislocationNetwork(graph)
    graph.add_edge(1, 2, burgers=(5, 5))
    assert len(net.lines) == 1
    with pytest.raises(nx.NetworkXError, match="[Ff]rozen"):
        net.graph.add_edge(3, 4)
