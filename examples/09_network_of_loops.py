"""Network of loops: integrate each edge once, obtain each cycle, and find the dislocations.

    python examples/09_network_of_loops.py
    python examples/09_network_of_loops.py --size 60 --picture network.png

A crystal contains a few screw dislocations at unknown positions. A net of measuring points runs
through it. Each edge is integrated once, and the meshes that do not close show the lines. Then come
steps that were measured in a periodic crystal, without a frame, and lines as a network of their
own: a junction, a reaction, and a detected mistake.
"""

import argparse
from fractions import Fraction
from pathlib import Path

import networkx as nx
import numpy as np

from geomtorsion.errors import NetworkError
from geomtorsion.loops import Cochain, Complex, EdgeList, Network, parallel_screws
from geomtorsion.materials.lines import DislocationNetwork, Reaction

HIDDEN = {(0.3, 0.4): 1, (-2.2, 1.7): Fraction(1, 2), (1.6, -2.4): -1}


def grid(size: int, extent: float) -> nx.Graph:
    """A square net in the plane z = 0 with slightly shifted nodes."""
    rng = np.random.default_rng(7)
    graph = nx.grid_2d_graph(size, size)
    step = 2 * extent / (size - 1)
    for i, j in graph:
        x, y = (step * np.array([i, j]) - extent) + 0.2 * step * (rng.random(2) - 0.5)
        graph.nodes[i, j]["position"] = (x, y, 0.0)
    return graph


def meshes(size: int) -> list[list[tuple[int, int]]]:
    """The smallest cycles of the net, counterclockwise."""
    cells = [(i, j) for i in range(size - 1) for j in range(size - 1)]
    return [[(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)] for i, j in cells]


def find_the_lines(size: int, picture: Path | None) -> None:
    """Find the lines: each mesh that does not close contains one."""
    crystal = parallel_screws(list(HIDDEN), list(HIDDEN.values()))
    net = Network(crystal, grid(size, 4.0))
    print(f"{net}: {net.cycle_count} independent cycles")
    found = [mesh for mesh in map(net.burgers, meshes(size)) if not mesh.vanishes]
    assert len(found) == len(HIDDEN)
    for mesh in found:
        places = [net.edges.positions[net.edges.numbers[node]][:2] for node in mesh.cycle]
        middle = np.mean(places, axis=0)
        nearest = min(HIDDEN, key=lambda line: float(np.hypot(*(np.array(line) - middle))))
        print(f"  near {middle.round(2)}: b = {mesh.vector[2]:+.12f} +- {mesh.error:.0e}")
        assert abs(mesh.vector[2] - float(HIDDEN[nearest])) <= mesh.error
    rim = [(k, 0) for k in range(size)] + [(size - 1, k) for k in range(1, size)]
    rim += [(k, size - 1) for k in range(size - 2, -1, -1)]
    rim += [(0, k) for k in range(size - 2, 0, -1)]
    whole = net.burgers(rim)
    print(f"  around the rim: b = {whole.vector[2]:+.12f}, the sum of all lines")
    assert abs(whole.vector[2] - float(sum(HIDDEN.values()))) <= whole.error
    if picture is not None:
        from geomtorsion.pictures.network import draw_network

        draw_network(Network(crystal, grid(9, 4.0))).savefig(picture, dpi=150)
        print(f"  {picture} written")


def many_edges() -> None:
    """Use arrays instead of a graph, and potentials instead of cycles, for 100,000 edges."""
    count = 224
    line = np.linspace(-4.01, 4, count)
    places = np.stack([*(a.ravel() for a in np.meshgrid(line, line)), np.zeros(count**2)], axis=1)
    number = np.arange(count**2).reshape(count, count)
    pairs = np.concatenate(
        [
            np.stack([number[:, :-1].ravel(), number[:, 1:].ravel()], axis=1),
            np.stack([number[:-1].ravel(), number[1:].ravel()], axis=1),
        ]
    )
    crystal = parallel_screws(list(HIDDEN), list(HIDDEN.values()))
    forest = Network(crystal, EdgeList(places, pairs)).forest
    steps = set(forest.closure[:, 2].round(9).tolist()) - {0.0}
    print(f"{len(pairs)} edges: each cycle has a gap of 0 or one of {sorted(steps)}")
    assert {abs(step) for step in steps} <= {0.5, 1.0, 1.5}


def measured_steps() -> None:
    """Use steps between atoms, in lattice units of a periodic crystal, without any frame."""
    shape = (40, 30)
    crystal = Complex.grid(shape, periodic=True)
    steps = np.zeros((len(crystal.pairs), 3), dtype=int)
    steps[: shape[0] * shape[1], 0] = 1
    steps[shape[0] * shape[1] :, 1] = 1
    # Between two screws of opposite sign each step in y also rises by one.
    middle = np.ravel_multi_index((np.arange(10, 25), np.full(15, 7)), shape)
    steps[shape[0] * shape[1] + middle, 2] = 1
    measured = Cochain(crystal, steps)
    torsion = measured.coboundary()
    pierced = np.flatnonzero(torsion.values.any(axis=1))
    print(f"\n{measured} on a torus: faces {pierced.tolist()} do not close,")
    print(f"  b = {torsion.values[pierced].tolist()}, in total {torsion.values.sum(axis=0)}")
    assert torsion.values[pierced].tolist() == [[0, 0, 1], [0, 0, -1]]
    forest = measured.forest
    inside = ~forest.images.any(axis=1)
    found = set(map(tuple, forest.closure[inside].tolist()))
    print(f"  cycles within the cell have a gap in {sorted(found)}")
    assert found <= {(0, 0, 0), (0, 0, 1), (0, 0, -1)}


def lines_as_a_network() -> None:
    """Check that b is conserved at nodes and in a reaction, and find a mistake."""
    lines = [("top", "knot", (1, 0, 0)), ("left", "knot", (0, 1, 0)), ("knot", "end", (1, 1, 0))]
    net = DislocationNetwork.of_lines(lines, surface=["top", "left", "end"])
    assert net.node_rule() == ()
    third = Fraction(1, 3)
    split = Reaction([(1, 1, 0)], [(2 * third, third, third), (third, 2 * third, -third)])
    print(f"\na reaction: b^2 changes by {split.energy_change}; favourable: {split.is_favourable}")
    wrong = DislocationNetwork.of_lines(
        [*lines[:2], ("knot", "end", (1, 2, 0))], ["top", "left", "end"]
    )
    print(*wrong.node_rule())
    try:
        wrong.checked()
    except NetworkError as error:
        print(error)
    assert [one.node for one in wrong.node_rule()] == ["knot"]


def main(arguments: list[str] | None = None) -> None:
    """Find hidden lines with a net, then treat lines as a network of their own."""
    parser = argparse.ArgumentParser(description="Burgers vectors of all cycles of a network.")
    parser.add_argument("--size", type=int, default=30, help="nodes along a side of the net")
    parser.add_argument("--picture", type=Path, help="draw a net into this file")
    options = parser.parse_args(arguments)
    if options.size < 12:
        parser.error(f"expected a size of at least 12 to separate the lines, got {options.size}")
    find_the_lines(options.size, options.picture)
    many_edges()
    measured_steps()
    lines_as_a_network()
    assert sum(HIDDEN.values()) == Fraction(1, 2)


if __name__ == "__main__":
    main()
