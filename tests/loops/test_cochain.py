"""Cochains: values on edges, sums, closures and coboundaries; whole numbers stay exact."""

# Bad input, and results that may be None.
# pyright: reportOptionalMemberAccess=false, reportOptionalOperand=false

from fractions import Fraction

import networkx as nx
import numpy as np
import pytest
from scipy.spatial import Delaunay

from geomtorsion.errors import LimitError, NetworkError
from geomtorsion.loops import Cochain, Complex, parallel_screws
from geomtorsion.loops.edges import edge_integrals
from tests.rounding import rounded


def test_a_circuit_in_a_sample_with_an_edge_dislocation():
    """Read and Shockley's circuit: 5 steps left but 4 right around the dislocation, b = (-1, 0)."""
    steps = [(1, 0)] * 4 + [(0, 1)] * 5 + [(-1, 0)] * 5 + [(0, -1)] * 5
    ring = [(k, (k + 1) % len(steps)) for k in range(len(steps))]
    found = Cochain.of_edges(ring, steps).around(range(len(steps)))
    assert found.vector.tolist() == [-1, 0]
    assert found.vector.dtype.kind == "i"
    assert found.error == 0
    assert not found.vanishes


@pytest.mark.parametrize("shape", [(3, 4, 5), (2, 3, 2, 3)])
@pytest.mark.parametrize("periodic", [False, True])
def test_the_coboundary_of_a_coboundary_is_exactly_zero(shape, periodic):
    """The second coboundary of whole numbers up to 2**40 is exactly zero (Bianchi)."""
    grid = Complex.grid(shape, periodic)
    rng = np.random.default_rng(5)
    nodes = Cochain(grid, rng.integers(-(2**40), 2**40, (grid.nodes, 2)), degree=0)
    assert not nodes.coboundary().coboundary().values.any()
    edges = Cochain(grid, rng.integers(-(2**40), 2**40, (grid.size(1), 3)))
    torsion = edges.coboundary()
    assert (torsion.degree, torsion.is_whole, torsion.values.any()) == (2, True, True)
    bianchi = torsion.coboundary()
    assert bianchi.values.shape == (grid.size(3), 3)
    assert not bianchi.values.any()
    steps = rng.normal(size=(grid.size(1), 3))
    floats = Cochain(grid, steps).coboundary().coboundary()
    assert (np.abs(floats.values).max(axis=1) <= floats.errors).all()
    assert floats.errors.max() < rounded(steps)


def test_torsion_of_scattered_points_agrees_with_the_lines():
    """Edge integrals with two screws: b in the triangles that they pierce, zero elsewhere."""
    rng = np.random.default_rng(1)
    points = rng.uniform(-2, 2, (200, 2))
    triangles = Delaunay(points)
    net = Complex.of_simplices(triangles.simplices, len(points))
    lines = {(0.25, 0.5): 1, (-0.75, -0.3): -2}
    frame = parallel_screws(list(lines), list(lines.values()))
    places = np.column_stack([points, np.zeros(len(points))])
    a, b = places[net.pairs[:, 0]], places[net.pairs[:, 1]]
    found = edge_integrals(frame, a, b, 1e-10)
    torsion = Cochain(net, found.vectors, found.errors).coboundary()
    expected = np.zeros(len(triangles.simplices))
    for place, size in lines.items():
        k = int(triangles.find_simplex(place))
        corners = points[triangles.simplices[k]]
        expected[k] = size * np.sign(np.linalg.det(corners[1:] - corners[0]))
    assert (np.abs(torsion.values[:, 2] - expected) <= torsion.errors).all()
    assert torsion.errors.max() < 1e-7


def random_network(rng, nodes, edges, d):
    """A multigraph with parallel edges and edges to images of nodes."""
    pairs = rng.integers(0, nodes, (edges, 2))
    pairs[: edges // 4] = pairs[edges // 4 : 2 * (edges // 4)]
    return pairs, rng.integers(-1, 2, (edges, d))


@pytest.mark.parametrize("seed", range(6))
def test_closures_of_a_basis_by_walking_every_cycle(seed):
    """Closures and images of the forest agree with walks from node to node."""
    rng = np.random.default_rng(seed)
    pairs, images = random_network(rng, 12, 40, 2)
    values = rng.integers(-9, 10, (40, 3))
    net = Cochain.of_edges(pairs, values, images=images, nodes=14)
    forest = net.forest
    graph = nx.MultiGraph(pairs.tolist())
    graph.add_nodes_from(range(14))
    components = nx.number_connected_components(graph)
    assert len(forest.chords) == 40 - 14 + components
    assert forest.root.max() + 1 == components
    tree = sorted(set(range(40)) - set(forest.chords.tolist()))
    assert nx.is_forest(nx.MultiGraph(pairs[tree].tolist()))
    between = {}
    for k in tree:
        a, b = pairs[k].tolist()
        between[a, b], between[b, a] = (k, 1), (k, -1)
    for chord, closure, image in zip(forest.chords, forest.closure, forest.images, strict=True):
        a, b = pairs[chord].tolist()
        chain = {int(chord): 1}
        for node, sense in ((a, 1), (b, -1)):
            while forest.parent[node] >= 0:
                above = int(forest.parent[node])
                k, sign = between[above, node]
                chain[k] = chain.get(k, 0) + sense * sign
                node = above
        found = net.over(chain)
        assert found.vectors[0].tolist() == closure.tolist()
        assert found.images[0].tolist() == image.tolist()
        # In a cycle each node is left as often as it is entered.
        ends = np.zeros((14,), dtype=int)
        for k, sense in chain.items():
            np.add.at(ends, pairs[k], [-sense, sense])
        assert not ends.any()


def test_positions_close_whatever_the_graph():
    """Differences of positions: each closure is the winding numbers times the periods."""
    rng = np.random.default_rng(2)
    pairs, images = random_network(rng, 9, 30, 2)
    cell = np.array([[7, 1], [-2, 11]])
    net = Complex.of_edges(pairs, 9, images)
    steps = Cochain.between(net, rng.integers(-50, 50, (9, 2)), cell)
    assert (steps.forest.closure == steps.forest.images @ cell).all()
    assert (steps.forest.images != 0).any()


def test_a_dipole_in_a_periodic_crystal():
    """The measured steps on a torus show two screws of opposite sign, and nothing else."""
    shape = (8, 6)
    grid = Complex.grid(shape, periodic=True)
    steps = np.zeros((grid.size(1), 1), dtype=int)
    # Between the two lines each step along y rises by b = 3.
    number = np.arange(48).reshape(shape)
    first = {tuple(pair): k for k, pair in enumerate(grid.pairs.tolist())}
    for i in range(2, 6):
        steps[first[number[i, 2], number[i, 3]]] = 3
    torsion = Cochain(grid, steps).coboundary()
    faces = np.flatnonzero(torsion.values[:, 0])
    assert torsion.values[faces, 0].tolist() == [3, -3]
    assert faces.tolist() == [1 * 6 + 2, 5 * 6 + 2]
    assert torsion.values.sum() == 0
    forest = Cochain(grid, steps).forest
    inner = ~forest.images.any(axis=1)
    assert set(forest.closure[inner, 0].tolist()) <= {-3, 0, 3}


def test_errors_add_up_and_hold():
    """Errors of sums of floats are bounds, compared with fractions; given errors add up."""
    rng = np.random.default_rng(7)
    grid = Complex.grid((6, 7))
    values = rng.normal(size=(grid.size(1), 2)) * 10.0 ** rng.integers(-8, 8, (grid.size(1), 1))
    exact = [[Fraction(x) for x in row] for row in values.tolist()]
    rough = Cochain(grid, values)
    for found in (rough.over(grid.boundary(1)), rough.over(np.ones((1, grid.size(1)), int))):
        assert (found.errors > 0).all()
    chains = grid.boundary(1).toarray()
    found = rough.over(chains)
    for row, vector, error in zip(chains.tolist(), found.vectors, found.errors, strict=True):
        for i in range(2):
            true = sum(m * x[i] for m, x in zip(row, exact, strict=True))
            assert abs(Fraction(float(vector[i])) - true) <= Fraction(float(error))
    told = Cochain(grid, values, np.full(grid.size(1), 0.5)).coboundary()
    assert (np.abs(told.errors - 2) < 1e-6).all()


def test_cochains_add_and_are_mapped():
    """Differences and changes of basis commute with the coboundary; errors follow."""
    grid = Complex.grid((3, 3, 3))
    rng = np.random.default_rng(3)
    one, two = (Cochain(grid, rng.integers(-9, 9, (54, 2))) for _ in range(2))
    both = (one - two).coboundary()
    assert (both.values == one.coboundary().values - two.coboundary().values).all()
    lattice = np.array([[1.0, 0.5, 0.0], [0.0, 0.25, 2.0]])
    mapped = one.mapped(lattice)
    assert np.abs(mapped.coboundary().values - one.coboundary().values @ lattice).max() < 1e-13
    assert one.mapped([[1, 1], [0, 1]]).is_whole
    noisy = Cochain(grid, one.values, np.full(54, 0.1))
    assert np.abs((noisy + noisy).errors - 0.2).max() < 1e-15
    assert np.abs(noisy.mapped(lattice).errors - 0.2).max() < 1e-13


def test_the_divergence_is_the_node_rule():
    """The divergence equals inflow and outflow by hand, and vanishes for closed lines."""
    rng = np.random.default_rng(4)
    pairs, images = random_network(rng, 8, 30, 1)
    values = rng.integers(-5, 6, (30, 2))
    lines = Cochain.of_edges(pairs, values, images=images)
    expected = np.zeros((8, 2), dtype=int)
    for (a, b), value in zip(pairs.tolist(), values, strict=True):
        expected[a] += value
        expected[b] -= value
    assert (lines.divergence().vectors == expected).all()
    ring = Cochain.of_edges([[0, 1], [1, 2], [2, 0]], [[0.1, 0.7]] * 3)
    assert (np.abs(ring.divergence().vectors).max(axis=1) <= ring.divergence().errors).all()


def test_whole_numbers_never_leave_their_bits():
    """Sums of whole numbers are exact just below 64 bits, and refused from there on."""
    ring = [[0, 1], [1, 2], [2, 3], [3, 0]]
    size = 2**59
    assert Cochain.of_edges(ring, [[size]] * 4).around(range(4)).vector.tolist() == [4 * size]
    with pytest.raises(LimitError, match="beyond 64 bits"):
        Cochain.of_edges(ring, [[2**60]] * 4)
    steps = Cochain.of_edges(ring, [[2**40]] * 4)
    assert steps.over({0: 2**21}).vectors.tolist() == [[2**61]]
    with pytest.raises(LimitError, match="beyond 64 bits"):
        steps.over({0: 2**22})
    with pytest.raises(LimitError, match="beyond 64 bits"):
        steps.mapped([[2**30]])


def test_parallel_edges_are_named_by_number():
    """Two edges of different values between the same nodes are distinguished by number."""
    pairs = [[0, 1], [1, 0], [1, 2], [2, 0]]
    steps = Cochain.of_edges(pairs, [[1], [5], [1], [1]])
    with pytest.raises(NetworkError, match="edges of different values join 0 and 1"):
        steps.around([0, 1, 2])
    assert steps.over({1: -1, 2: 1, 3: 1}).vectors.tolist() == [[-3]]
    same = Cochain.of_edges(pairs, [[1], [-1], [1], [1]])
    assert same.around([0, 1, 2]).vector.tolist() == [3]
    images = Cochain.of_edges(pairs, [[1], [-1], [1], [1]], images=[[0], [1], [0], [0]])
    with pytest.raises(NetworkError, match="edges of different values"):
        images.around([0, 1, 2])


def test_a_directed_graph_of_measured_steps():
    """networkx edges carry vectors, errors and images as attributes."""
    graph = nx.MultiDiGraph()
    graph.add_edge("a", "b", vector=(2, 0), error=0.25)
    graph.add_edge("b", "a", vector=(3, 0), image=(1, 0))
    steps = Cochain.of_graph(graph)
    assert steps.forest.closure.tolist() == [[5, 0]]
    assert steps.forest.images.tolist() == [[1, 0]]
    assert steps.bounds.tolist() == [0.25, 0]
    with pytest.raises(NetworkError, match="from 'a' to 'b' has no 'b'"):
        Cochain.of_graph(graph, "b")
    with pytest.raises(NetworkError, match="MultiDiGraph, got Graph"):
        Cochain.of_graph(nx.Graph())  # type: ignore[arg-type]


RING = Complex.of_edges([[0, 1], [1, 2], [2, 0]])


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Cochain(RING, np.ones((2, 1))), r"one row for each edge, shape \(3, n\)"),
        (lambda: Cochain(RING, np.ones((3, 1)), degree=2), r"each face, shape \(0, n\)"),
        (
            lambda: Cochain(RING, np.ones((3, 1)), degree=4),
            "degree: expected a whole number from 0 to 3",
        ),
        (lambda: Cochain(RING, np.array([["a"]] * 3)), "real numbers"),
        (lambda: Cochain(RING, np.array([[1j]] * 3)), "real numbers"),
        (lambda: Cochain(RING, np.array([[0], [1], [np.nan]])), "edge 2: expected finite values"),
        (lambda: Cochain(RING, np.ones((3, 1)), [0, 1]), "errors"),  # type: ignore[arg-type]
        (lambda: Cochain(RING, np.ones((3, 1)), np.array([0, -1, 0])), r"errors\[1\] = -1"),
        (lambda: Cochain(RING, np.ones((3, 1))).coboundary(), "has no faces"),
        (lambda: Cochain(RING, np.ones((3, 1)), degree=0).forest, "values on nodes have no cycles"),
        (lambda: Cochain(RING, np.ones((3, 1))).around([0, 7, 1]), "node 7 is not in"),
        (lambda: Cochain(RING, np.ones((3, 1))).around([0]), "2 nodes or more"),
        (lambda: Cochain(RING, np.ones((3, 1))).over({3: 1}), "edges from 0 to 2"),
        (lambda: Cochain(RING, np.ones((3, 1))).over({0: 0.5}), "whole multiples"),  # type: ignore[dict-item]
        (lambda: Cochain(RING, np.ones((3, 1))).over(np.ones((1, 3))), "whole numbers of shape"),
        (lambda: Cochain(RING, np.ones((3, 1))).mapped([[1.0], [2.0]]), "each row of the matrix"),
        (lambda: Cochain(RING, np.ones((3, 1))) + Cochain(RING, np.ones((3, 2))), "1 and 2"),
        (lambda: Cochain.between(Complex.grid((2,), True), [[0], [1]]), "over 1 periods"),
        (
            lambda: Cochain.between(Complex.grid((2,), True), [[0], [1]], [[1, 2]]),
            r"shape \(1, 1\)",
        ),
    ],
)
def test_bad_cochains_are_refused(make, message):
    """Each kind of bad input has its own message."""
    with pytest.raises(NetworkError, match=message):
        make()


def test_nodes_without_any_edge():
    """Each node without edges is a tree by itself, and there are no closures."""
    for errors in (None, np.zeros(0)):
        found = Cochain.of_edges(np.zeros((0, 2), dtype=int), np.zeros((0, 3)), errors, nodes=4)
        assert found.forest.root.tolist() == [0, 1, 2, 3]
        assert found.forest.potential.tolist() == [[0, 0, 0]] * 4
        assert found.forest.closure.shape == (0, 3)
