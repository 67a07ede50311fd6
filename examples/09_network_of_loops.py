"""Network of loops: integrate each edge once, know every cycle; find the dislocations in a crystal.

    python examples/09_network_of_loops.py
    python examples/09_network_of_loops.py --size 60 --picture network.png

A crystal holds a few screw dislocations at places that nobody tells us. A net of measuring points
is laid through it; every edge is integrated once, and the meshes that do not close show the lines.
Then steps that were measured in a periodic crystal, without a frame; and lines as a network of
their own: a junction, a reaction, and a mistake found.
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
    """A square net in the plane z = 0, its knots a little out of place."""
    rng = np.random.default_rng(7)
    graph = nx.grid_2d_graph(size, size)
    step = 2 * extent / (size - 1)
    for i, j in graph:
        x, y = (step * np.array([i, j]) - extent) + 0.2 * step * (rng.random(2) - 0.5)
        graph.nodes[i, j]["position"] = (x, y, 0.0)
    return graph


def meshes(size: int) -> list[list[tuple[int, int]]]:
    """The smallest cycles of the net, counter-clockwise."""
    cells = [(i, j) for i in range(size - 1) for j in range(size - 1)]
    return [[(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)] for i, j in cells]


def find_the_lines(size: int, picture: Path | None) -> None:
    """Every mesh that does not close holds a line."""
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
    print(f"  round the rim: b = {whole.vector[2]:+.12f}, the sum of all of them")
    assert abs(whole.vector[2] - float(sum(HIDDEN.values()))) <= whole.error
    if picture is not None:
        from geomtorsion.pictures.network import draw_network

        draw_network(Network(crystal, grid(9, 4.0))).savefig(picture, dpi=150)
        print(f"  {picture} written")


def many_edges() -> None:
    """Arrays instead of a graph: a hundred thousand edges, and potentials instead of cycles."""
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
    print(f"{len(pairs)} edges: every cycle misses one of {sorted(steps)} or nothing")
    assert {abs(step) for step in steps} <= {0.5, 1.0, 1.5}


def measured_steps() -> None:
    """No frame at all: steps from atom to atom, in units of a periodic crystal's lattice."""
    shape = (40, 30)
    crystal = Complex.grid(shape, periodic=True)
    steps = np.zeros((len(crystal.pairs), 3), dtype=int)
    steps[: shape[0] * shape[1], 0] = 1
    steps[shape[0] * shape[1] :, 1] = 1
    # Between two screws of opposite sign the steps in y climb by one.
    middle = np.ravel_multi_index((np.arange(10, 25), np.full(15, 7)), shape)
    steps[shape[0] * shape[1] + middle, 2] = 1
    measured = Cochain(crystal, steps)
    torsion = measured.coboundary()
    pierced = np.flatnonzero(torsion.values.any(axis=1))
    print(f"\n{measured} on a torus: faces {pierced.tolist()} do not close,")
    print(
        f"  b = {torsion.values[pierced].tolist()}, and all together {torsion.values.sum(axis=0)}"
    )
    assert torsion.values[pierced].tolist() == [[0, 0, 1], [0, 0, -1]]
    forest = measured.forest
    inside = ~forest.images.any(axis=1)
    found = set(map(tuple, forest.closure[inside].tolist()))
    print(f"  cycles that wind round no period miss one of {sorted(found)}")
    assert found <= {(0, 0, 0), (0, 0, 1), (0, 0, -1)}


def lines_as_a_network() -> None:
    """b is conserved where lines meet; a reaction must balance; a mistake is shown."""
    lines = [("top", "knot", (1, 0, 0)), ("left", "knot", (0, 1, 0)), ("knot", "end", (1, 1, 0))]
    net = DislocationNetwork.of_lines(lines, surface=["top", "left", "end"])
    assert net.node_rule() == ()
    third = Fraction(1, 3)
    split = Reaction([(1, 1, 0)], [(2 * third, third, third), (third, 2 * third, -third)])
    print(f"\na split that balances; b^2 changes by {split.energy_change}: {split.is_favourable}")
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
    """Find hidden lines with a net; then treat them as a network of their own."""
    parser = argparse.ArgumentParser(description="Burgers vectors of all cycles of a network.")
    parser.add_argument("--size", type=int, default=30, help="knots on a side of the net")
    parser.add_argument("--picture", type=Path, help="draw a net into this file")
    options = parser.parse_args(arguments)
    if options.size < 12:
        parser.error("a net of fewer than 12 x 12 knots does not tell the lines apart")
    find_the_lines(options.size, options.picture)
    many_edges()
    measured_steps()
    lines_as_a_network()
    assert sum(HIDDEN.values()) == Fraction(1, 2)


if __name__ == "__main__":
    main()
