"""Speed of networks: a million edges, bases of cycles, developments; ratios in one run."""

from __future__ import annotations

import time
from collections.abc import Callable
from itertools import combinations
from pathlib import Path

import networkx as nx
import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture
from scipy.spatial import Delaunay

from geomtorsion.geometry import Connection, cartan, levi_civita
from geomtorsion.loops import Cochain, EdgeList, Loop, Network, develop
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.lines import DislocationNetwork
from geomtorsion.spaces import load
from tests.benchmarks.memory import peak_gigabytes
from tests.materials.lines.synthetic_networks import rings
from tests.real import real

REAL = "networks/180chains_16.10e.data"


def square_net(edges: int) -> EdgeList:
    """A net in the plane z = 0.1 with about the given number of edges, off the origin."""
    side = round((edges / 2) ** 0.5)
    line = np.linspace(-1, 1, side) + 0.1 / side
    x, y = np.meshgrid(line, line, indexing="ij")
    places = np.stack([x.ravel(), y.ravel(), np.full(side**2, 0.1)], axis=1)
    number = np.arange(side**2).reshape(side, side)
    along = [np.stack([number[:-1], number[1:]], -1), np.stack([number[:, :-1], number[:, 1:]], -1)]
    return EdgeList(places, np.concatenate([pairs.reshape(-1, 2) for pairs in along]))


@pytest.mark.parametrize("edges", [10_000, 100_000, 1_000_000])
def test_all_cycles_of_a_large_network(benchmark: BenchmarkFixture, edges: int) -> None:
    """Positions of a million edges give the closures of all fundamental cycles in under 10 s."""
    frame, net = load("screw_dislocation").frame, square_net(edges)

    def closures() -> Network:
        network = Network(frame, net, parameters={"b": 1.0})
        _ = network.forest
        return network

    found = benchmark.pedantic(closures, rounds=2, warmup_rounds=1 if edges < 10**6 else 0)
    # The torsion is only on the axis: each cycle has 0 or 1 turns around it.
    windings = found.forest.closure[:, 2]
    assert np.abs(windings - windings.round()).max() < 1e-9
    assert windings.round().any()
    print(f"{peak_gigabytes():.2f} GB at most so far")
    assert shortest(benchmark) < 10


def test_all_cycles_of_a_million_measured_steps(benchmark: BenchmarkFixture) -> None:
    """Whole numbers on a million edges, without a frame, give all closures in under 2 s."""
    net = square_net(1_000_000)
    steps = np.rint(np.diff(net.positions[net.pairs], axis=1)[:, 0] * 707 / 2).astype(int)
    steps[1234] += (0, 0, 5)

    def closures() -> Cochain:
        made = Cochain.of_edges(net.pairs, steps)
        _ = made.forest
        return made

    found = benchmark.pedantic(closures, rounds=3)
    assert found.is_whole
    assert set(np.unique(found.forest.closure[:, 2]).tolist()) <= {-5, 0, 5}
    assert found.forest.closure[:, 2].any()
    print(f"{peak_gigabytes():.2f} GB at most so far")
    assert shortest(benchmark) < 2


def shortest(benchmark: BenchmarkFixture) -> float:
    """The shortest run, in seconds."""
    assert benchmark.stats is not None
    return float(benchmark.stats["min"])


def lines_asked(benchmark: BenchmarkFixture, path: Path, loop: Loop) -> DislocationNetwork:
    """Read a ParaDiS file, compute node rule, families and a circuit, and print the times."""
    took: dict[str, float] = {}
    found: list[DislocationNetwork] = []

    def asked() -> None:
        def timed(name: str, call: Callable[[], object]) -> None:
            start = time.process_time()
            call()
            took[name] = time.process_time() - start

        timed("read", lambda: found.append(DislocationNetwork.read(path)))
        net = found[-1]
        timed("node rule", lambda: (net.lines, net.node_rule()))
        timed("families", net.families)
        timed("circuit", lambda: net.burgers(loop))

    benchmark.pedantic(asked, rounds=1)
    print({name: round(seconds, 2) for name, seconds in took.items()})
    return found[-1]


def test_a_dislocation_network_of_100000_lines(benchmark: BenchmarkFixture, tmp_path: Path) -> None:
    """Five thousand rings in a periodic box take less than 40 s."""
    made = rings(5000, seed=2, size=1000.0, sides=20)
    DislocationNetwork.of_arrays(made).save(tmp_path / "rings.data")
    net = lines_asked(benchmark, tmp_path / "rings.data", Loop.circle([500, 500, 500], 300))
    assert len(net.lines) == 100_000
    assert net.node_rule() == ()
    assert shortest(benchmark) < 40


def test_a_dislocation_network_of_5930_lines(benchmark: BenchmarkFixture) -> None:
    """Time of the network of a simulation, if its file is beside the project."""
    net = lines_asked(benchmark, real(REAL), Loop.circle([0, 0, 0], 20_000))
    assert len(net.lines) == 5930
    assert net.node_rule() == ()


def test_forest_against_networkx(benchmark: BenchmarkFixture) -> None:
    """The forest of scipy and pointer doubling is ten times faster than networkx on each cycle."""
    frame, net = load("heisenberg").frame, square_net(20_000)
    values = {symbol.name: 1.0 for symbol in frame.parameters}
    network = Network(frame, net, parameters=values)
    vectors = network.integrals.vectors
    forest = benchmark.pedantic(lambda: _fresh(network).forest, rounds=3)
    ours = shortest(benchmark)
    start = time.perf_counter()
    graph = nx.Graph()
    graph.add_edges_from((a, b, {"k": k}) for k, (a, b) in enumerate(net.pairs.tolist()))
    basis = nx.cycle_basis(graph)
    for cycle in basis:
        for a, b in zip(cycle, (*cycle[1:], cycle[0]), strict=True):
            k = graph[a][b]["k"]
            _ = vectors[k] if net.pairs[k, 0] == a else -vectors[k]
    theirs = time.perf_counter() - start
    assert len(basis) == len(forest.chords)
    assert theirs > 10 * ours, f"networkx {theirs:.2f} s, forest {ours:.2f} s"


def _fresh(network: Network) -> Network:
    """The same network with only its integrals computed."""
    again = Network(network.frame, network.graph, parameters=network.parameters)
    again.__dict__["integrals"] = network.integrals
    return again


@pytest.mark.parametrize("name", ["screw_dislocation", "heisenberg", "so3"])
def test_a_hundred_thousand_cells(benchmark: BenchmarkFixture, name: str) -> None:
    """The tetrahedra of a Delaunay net are found and their integrals and fluxes checked in 4 s."""
    rng = np.random.default_rng(1)
    points = rng.uniform([0.3, 0.4, -1], [1.5, 2.0, 1], (10_800, 3))
    corners = Delaunay(points).simplices
    pairs = np.concatenate([corners[:, [a, b]] for a, b in combinations(range(4), 2)])
    net = EdgeList(points, np.unique(np.sort(pairs, axis=1), axis=0))
    frame = load(name).frame
    network = Network(frame, net, parameters={s.name: 1.0 for s in frame.parameters})
    _ = network.integrals
    rule = benchmark.pedantic(network.node_rule, rounds=3)
    # Four pairwise joined nodes need not be a simplex: there are a third more than simplices.
    assert rule.checked > max(len(corners), 100_000)
    assert rule.holds
    assert not rule.pierced
    assert shortest(benchmark) < 4


CONNECTIONS = {"so3, Cartan": ("so3", cartan), "so3, Levi-Civita": ("so3", levi_civita)}


@pytest.mark.parametrize("name", list(CONNECTIONS))
@pytest.mark.parametrize("radius", [0.3, 1e-6])
def test_one_development(benchmark: BenchmarkFixture, name: str, radius: float) -> None:
    """Time of one compiled loop by both methods, to twelve digits."""
    space, maker = CONNECTIONS[name]
    connection: Connection = maker(load(space).frame)
    loop = Loop.circle([0.3, 1.0, 0.2], radius, (1, 2))
    turn = benchmark(develop, connection, loop)
    assert turn.check.agrees
    assert turn.error < 1e-12 * radius


def test_plaquettes_of_a_large_grid(benchmark: BenchmarkFixture) -> None:
    """Time of all cells, with errors, of a distortion field on 512 x 512 nodes."""
    axes = [np.linspace(-1, 1, 512)] * 2
    x, y = np.meshgrid(*axes, indexing="ij")
    grid = SampledFrame(axes, np.array([[np.cos(y), x * y], [np.sin(x * y), 1 + x]]))
    cells = benchmark.pedantic(lambda: SampledFrame(grid.axes, grid.coframe).plaquettes(), rounds=3)
    exact = (y + np.sin(y))[:-1, :-1], (1 - x * np.cos(x * y))[:-1, :-1]
    assert np.abs(cells.density - np.array(exact)).max() < 1e-2
