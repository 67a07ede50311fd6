"""Networks: one integral per edge, cycles as signed sums, conservation in cells."""

import itertools

import networkx as nx
import numpy as np
import pytest
import sympy as sp

import geomtorsion.spaces as spaces
from geomtorsion.errors import LimitError, MissingValueError, NetworkError
from geomtorsion.geometry import Frame
from geomtorsion.loops import EdgeList, Loop, Network, burgers_vector, parallel_screws
from geomtorsion.loops.spanning_forest import spanning_forest
from tests.rounding import ROUNDED


def grid_graph(shape: tuple[int, ...], shift: float, diagonals: bool = False) -> nx.Graph:
    """A grid about the origin with slightly moved nodes."""
    rng = np.random.default_rng(5)
    graph = nx.Graph()
    centre = (np.array(shape) - 1) / 2
    for node in itertools.product(*map(range, shape)):
        place = np.array(node) - centre + 0.1 * rng.random(len(shape)) + shift
        graph.add_node(node, position=np.append(place, [0.0] * (3 - len(shape))))
    for node in graph:
        for step in itertools.product((-1, 0, 1), repeat=len(shape)):
            other = tuple(a + b for a, b in zip(node, step, strict=True))
            if other in graph and (sum(map(abs, step)) == 1 or (diagonals and any(step))):
                graph.add_edge(node, other)
    return graph


@pytest.fixture(scope="module")
def screws() -> Frame:
    return parallel_screws([(0, 0), (1, 1)], [1, "1/3"])


@pytest.mark.parametrize("basis", ["fundamental", "minimum"])
def test_cycles_have_the_b_of_enclosed_lines(screws, basis):
    """Each cycle of both bases has the sum of winding numbers times b."""
    net = Network(screws, grid_graph((6, 6), 0.17))
    assert net.cycle_count == 25
    assert len(net.cycles(basis)) == 25
    encircling = 0
    for found in net.basis_burgers(basis):
        loop = net.loop(found.cycle)
        expected = loop.winding([0, 0, 0]) + loop.winding([1, 1, 0]) / 3
        assert np.abs(found.vector - [0, 0, expected]).max() <= max(found.error, 1e-13)
        assert found.error < 1e-10
        encircling += bool(expected)
    assert encircling >= 2


@pytest.mark.parametrize("name", ["so3", "heisenberg", "twisted_bar"])
def test_cycles_agree_with_single_loops(name):
    """A cycle, as a signed sum of edges, equals the same polygon as one loop."""
    frame = spaces.load(name).frame
    values = {symbol.name: 0.7 for symbol in frame.parameters}
    net = Network(frame, grid_graph((3, 3, 2), 1.3), parameters=values)
    for cycle in net.cycles()[::3]:
        single = burgers_vector(frame, Loop.from_cycle(net.graph, cycle), parameters=values)  # type: ignore[arg-type]
        found = net.burgers(cycle)
        assert np.abs(found.vector - single.vector).max() <= found.error + single.error
        assert found.error < 1e-10


def test_forest_closures_agree_with_the_cycles(screws):
    """Potentials of the spanning forest give the same vectors as the cycles."""
    net = Network(screws, grid_graph((5, 7), 0.3))
    for closure, bound, cycle in zip(
        net.forest.closure, net.forest.closure_error, net.cycles(), strict=True
    ):
        assert np.abs(closure - net.burgers(cycle).vector).max() <= bound


def test_sense_and_start_of_a_cycle(screws):
    """Reversal changes the sign; another start, or a repeated first node, changes nothing."""
    net = Network(screws, grid_graph((4, 4), 0.2))
    cycle = next(c.cycle for c in net.basis_burgers() if abs(c.vector[2]) > 0.1)
    forth, back = net.burgers(cycle), net.burgers(cycle[::-1])
    assert np.abs(forth.vector + back.vector).max() < ROUNDED
    assert np.abs(forth.vector - net.burgers(cycle[2:] + cycle[:2]).vector).max() < ROUNDED
    assert (net.burgers((*cycle, cycle[0])).vector == forth.vector).all()


def test_node_rule_holds_and_shows_the_pierced_faces(screws):
    """Integrals over closed cells cancel, and faces pierced by a line are named."""
    graph = grid_graph((3, 3, 2), 0.21, diagonals=True)
    rule = Network(screws, graph).node_rule()
    assert rule.checked > 100
    assert rule.holds is True
    assert rule.pierced
    for face, b in rule.pierced:
        loop = Loop.from_cycle(graph, face)
        expected = loop.winding([0, 0, 0]) + loop.winding([1, 1, 0]) / 3
        assert np.abs(b - [0, 0, expected]).max() < 1e-10
    smooth = Network(spaces.load("so3").frame, grid_graph((2, 2, 2), 1.4, diagonals=True))
    result = smooth.node_rule()
    assert (result.holds, result.pierced, result.checked > 10) == (True, (), True)


def test_node_rule_sees_a_flux_that_does_not_cancel():
    """A cell out of which the flux of torsion is not zero is reported."""
    x, y, z = sp.symbols("x y z", real=True)
    r = sp.sqrt(x**2 + y**2 + z**2)
    # The potential of a monopole: torsion is a radial flux, its string the negative z axis.
    factor = 1 / (r * (r + z))
    frame = Frame([x, y, z], [[1, 0, 0], [0, 1, 0], [-y * factor, x * factor, 1]])
    graph = nx.complete_graph(4)
    corners = [(1, 0.7, 1.2), (1.1, -1, -1), (-1, 1.3, -1), (-1, -1, 1)]
    nx.set_node_attributes(graph, dict(enumerate(corners)), "position")
    rule = Network(frame, graph).node_rule()
    assert rule.holds is False
    (violation,) = rule.violations
    # Flux of the monopole out of a surface around it: 4 pi.
    assert abs(violation.total[2] - 4 * np.pi) < 1e-2
    assert [abs(b[2] + 4 * np.pi) < 1e-2 for _, b in rule.pierced] == [True]
    assert "sum of b" in str(rule)


def test_a_face_without_a_finite_flux_decides_nothing():
    """A line at which the torsion has no number runs through two faces of a closed cell."""
    x, y, z = sp.symbols("x y z", real=True)
    frame = Frame([x, y, z], [[1, 0, 0], [0, 1, 0], [sp.exp(1 / (x**2 + y**2) ** 2), 0, 1]])
    graph = nx.complete_graph(4)
    corners = [(3, 0.1, 0), (-1.6, 2.6, 0), (-1.4, -2.7, 0), (6, 0, 3)]
    nx.set_node_attributes(graph, dict(enumerate(corners)), "position")
    rule = Network(frame, graph).node_rule()
    assert (rule.checked, rule.holds, rule.pierced) == (1, True, ())


def test_forests_trees_and_parallel_edges():
    """A network may have no cycles, several components or parallel edges."""
    frame = spaces.load("heisenberg").frame
    values = {symbol.name: 1.0 for symbol in frame.parameters}
    path = nx.path_graph(4)
    nx.set_node_attributes(path, {k: (k, k**2, 0) for k in path}, "position")
    net = Network(frame, path, parameters=values)
    assert (net.cycles(), net.cycle_count, net.component_count) == ((), 0, 1)
    assert net.node_rule().holds is None
    two = nx.disjoint_union(nx.cycle_graph(3), nx.cycle_graph(4))
    angles = {k: (np.cos(2.3 * k), np.sin(2.3 * k), k) for k in two}
    nx.set_node_attributes(two, angles, "position")
    both = Network(frame, two, parameters=values)
    assert (both.component_count, both.cycle_count) == (2, 2)
    assert sorted(map(len, both.cycles())) == [3, 4]
    double = EdgeList(
        np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]]), np.array([[0, 1], [1, 2], [2, 0], [1, 0]])
    )
    assert Network(frame, double, parameters=values).cycle_count == 2
    assert np.abs(Network(frame, double, parameters=values).forest.closure[:, 2]).max() > 0.4


def test_long_chain_is_summed_fast_and_well():
    """A ring of 200,000 edges has depth 100,000; sums stay accurate."""
    count = 200_000
    ring = np.arange(count)
    angle = 2 * np.pi * ring / count
    steps = np.stack([np.cos(angle), np.sin(angle), np.full(count, 0.1)], axis=1)
    pairs = np.stack([ring, np.roll(ring, -1)], axis=1)
    forest = spanning_forest(count, pairs, steps, np.zeros(count))
    assert len(forest.chords) == 1
    missed = np.abs(np.abs(forest.closure[0]) - [0, 0, 0.1 * count]).max()
    assert missed <= forest.closure_error[0] < 1e-6


BAD = [
    (lambda g: g.nodes[0].pop("position"), "node 0 has no 'position'"),
    (lambda g: g.nodes[0].update(position=(1, 2)), "node 0: 'position': expected 3 numbers"),
    (lambda g: g.nodes[0].update(position="abc"), "node 0: 'position': expected 3"),
    (
        lambda g: g.nodes[0].update(position=(0, float("nan"), 0)),
        "node 0: expected finite coordinates",
    ),
    (lambda g: g.nodes[0].update(position=g.nodes[1]["position"]), "has no length"),
    (lambda g: g.remove_edges_from(list(g.edges)), "no edges"),
]


@pytest.mark.parametrize(("spoil", "message"), BAD)
def test_bad_graphs_are_refused(screws, spoil, message):
    """Each kind of bad graph has its own message."""
    graph = nx.cycle_graph(4)
    nx.set_node_attributes(graph, {k: (2 + k, k**2, 0) for k in graph}, "position")
    spoil(graph)
    with pytest.raises(NetworkError, match=message):
        _ = Network(screws, graph).edges


def test_how_many_cycles_are_listed():
    """20,000 cycles are listed; 100,001 cycles are refused with the limit."""
    flat = Frame(["x", "y"], [[1, 0], [0, 1]])
    fan = Network(flat, wheel(20_000))
    assert fan.cycles()[-1] == (20_000, 20_001, 0)
    with pytest.raises(LimitError, match="100001 cycles are too many to list; the limit is 100000"):
        Network(flat, wheel(100_001)).cycles()
    ring = nx.cycle_graph(200)
    nx.set_node_attributes(ring, {k: (k, k**2) for k in ring}, "position")
    assert len(Network(flat, ring).cycles("minimum")[0]) == 200


def wheel(cycles: int) -> EdgeList:
    """A wheel: as many triangles as requested, around one node."""
    rim = np.arange(1, cycles + 2)
    places = np.concatenate([[[0, 0]], np.stack([rim, np.ones_like(rim)], axis=1)])
    spokes = np.stack([np.zeros_like(rim), rim], axis=1)
    return EdgeList(places, np.concatenate([spokes, np.stack([rim[:-1], rim[1:]], axis=1)]))


def test_bad_questions_are_refused(screws):
    """Refused: invalid cycles, a basis too large, an open cell, a parameter without a value."""
    net = Network(screws, grid_graph((15, 15), 0.2))
    with pytest.raises(NetworkError, match="no edge between"):
        net.burgers([(0, 0), (5, 5), (0, 1)])
    with pytest.raises(NetworkError, match="not in the network"):
        net.burgers([(0, 0), "somewhere", (0, 1)])
    with pytest.raises(NetworkError, match="3 nodes"):
        net.burgers([(0, 0), (0, 1)])
    with pytest.raises(LimitError, match="limit is 200 edges"):
        net.cycles("minimum")
    with pytest.raises(NetworkError, match="expected one of fundamental, minimum, got 'any'"):
        net.cycles("any")
    with pytest.raises(NetworkError, match="not closed"):
        net.node_rule([[[(0, 0), (0, 1), (1, 1), (1, 0)]]])
    nodes = EdgeList(np.array([[0.0, 0, 0], [1, 1, 1]]), np.array([[0, 5]]))
    with pytest.raises(NetworkError, match="from 0 to 1"):
        _ = Network(screws, nodes).edges
    unvalued = Network(spaces.load("screw_dislocation").frame, grid_graph((2, 2), 0.3))
    with pytest.raises(MissingValueError):
        _ = unvalued.integrals


def test_a_cycle_that_is_not_a_list_is_refused(screws):
    """A cycle that is not a list raises our own error, here and in Loop.from_cycle."""
    graph = grid_graph((15, 15), 0.2)
    for ask in (Network(screws, graph).burgers, lambda cycle: Loop.from_cycle(graph, cycle)):
        with pytest.raises(NetworkError, match="cycle: expected a list, got 5"):
            ask(5)  # pyright: ignore[reportArgumentType]
