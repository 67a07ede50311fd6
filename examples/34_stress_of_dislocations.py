"""Stress of dislocations: a wall of edges, a loop in copper, and a network of a simulation.

    python examples/34_stress_of_dislocations.py
    python examples/34_stress_of_dislocations.py --picture loop.png --file chains.data --cost

Dislocations are torsion: pieces of crystal that do not fit together. The crystal takes the
distortion of least elastic energy that has this torsion. The stress of a wall of edge dislocations
is known in closed form (Hirth and Lothe). A loop in anisotropic copper has no closed form: there
the forces must be the slope of the energy, and circuits must find b again.
"""

import argparse
import time
import tracemalloc
from pathlib import Path

import numpy as np

import geomtorsion as gt

COPPER = gt.ElasticConstants.cubic(168.4, 121.4, 75.4, unit="GPa")
MU, NU = 48.0, 0.34
# Beside a checkout: a network of 5,930 lines, the result of a simulation of dislocations.
SIMULATED = Path(__file__).parents[2] / "shared/data/networks/180chains_16.10e.data"


def wall(x: float, y: float) -> float:
    """sigma_xy / b of a wall of edges at x = 0, one line per unit of y [Hirth and Lothe 1982]."""
    u, v = 2 * np.pi * x, 2 * np.pi * y
    shape = (np.cosh(u) * np.cos(v) - 1) / (np.cosh(u) - np.cos(v)) ** 2
    return MU * np.pi * x / (1 - NU) * shape


def compare_walls() -> None:
    """Two opposite walls in one cell, and the images of both, against the closed form."""
    length, b = 6.0, 0.01
    box = gt.Box.of_bounds([0, 0, 0], [length, 1, 1])
    lines = gt.LineArrays(
        [[0, 0, 0], [length / 2, 0, 0]],
        [[0, 0], [1, 1]],
        [[b, 0, 0], [-b, 0, 0]],
        box,
        images=[[0, 0, 1]] * 2,
    )
    net = gt.DislocationNetwork.of_arrays(lines)
    isotropic = gt.ElasticConstants.isotropic(MU, NU, unit="GPa")
    points = np.array([[0.375, 0.1, 0], [0.5, 0.15625, 0], [0.75, 0.4, 0]])
    # The lines run along z, so that one node along z is enough.
    parts = [
        gt.stresses(net, isotropic, shape=(768, 128, 1), core=core, convention="Hirth-Lothe")
        for core in (0.04, 0.04 / np.sqrt(2))
    ]
    wide, narrow = (part.at(points)[0, 1] for part in parts)
    # Away from the lines a Gaussian core adds a multiple of its width squared.
    for (x, y, _), sigma in zip(points, 2 * narrow - wide, strict=True):
        known = b * sum(
            wall(x - k * length, y) - wall(x - (k + 0.5) * length, y) for k in range(-4, 5)
        )
        print(f"  at ({x}, {y}): sigma_xy = {sigma:+.8f} GPa, closed form {known:+.8f}")
        assert abs(sigma - known) < 1e-9


def square(edge: float) -> gt.DislocationNetwork:
    """A square loop whose first side is at y = edge; lengths in nm."""
    corners = [[12, edge, 20], [28, edge, 20], [28, 28, 20], [12, 28, 20]]
    sides = [[0, 1], [1, 2], [2, 3], [3, 0]]
    box = gt.Box.of_bounds([0, 0, 0], [40, 40, 40])
    return gt.DislocationNetwork.of_arrays(
        gt.LineArrays(corners, sides, [[0.181, 0.0, 0.181]] * 4, box)
    )


def relax_a_loop() -> gt.materials.elasticity.Stresses:
    """Energy, forces and circuits of a loop in copper, each checked against another."""
    found, up, down = (gt.stresses(square(edge), COPPER, shape=40) for edge in (12, 12.05, 11.95))
    print(f"loop: {found}")
    print(f"  error of the stress {found.error:.0e}, of the energy {found.energy_error:.0e}")
    force, slope = found.forces[0, 1] * 16, (up.energy - down.energy) / 0.1
    print(f"  force on a side {force:.6f}, minus the slope of the energy {-slope:.6f} GPa nm^2")
    assert abs(force + slope) < 1e-4 * abs(force)
    loop = gt.Loop.circle([20, 12, 20], 7.5, plane=(1, 2))
    measured, known = found.frame.burgers(loop), square(12).burgers(loop)
    print(f"  a circuit in the relaxed coframe: b = {measured.vector.round(5)}, {known.vector}")
    # A share exp(-7.5^2 / (2 * 2^2)) of a Gaussian core of 2 nm is outside the circuit.
    inside = 1 - np.exp(-(7.5**2) / 8)
    assert np.abs(measured.vector - inside * known.vector).max() < 3e-5
    return found


def relax_a_simulation(path: Path) -> None:
    """Stress and forces in a simulated network, in which b is counted as Hirth and Lothe do."""
    net = gt.DislocationNetwork.read(path)
    found = gt.stresses(net, COPPER, shape=16, balance=True, convention="Hirth-Lothe")
    print(f"{path.name}: {found}, error {found.error:.0e}")
    print(*(f"  {text}" for text in found.corrections), sep="\n")
    along = np.abs((found.forces * net.arrays.steps).sum(axis=1)).max()
    assert along < 1e-9 * np.abs(found.forces).max() * net.arrays.lengths.max()


def measure_cost() -> None:
    """Time and memory for each node, and time for each mode and straight piece."""
    spent = []
    for nodes, parts in ((32, 1), (64, 1), (64, 16)):
        loops = square(12).arrays
        pairs, vectors = np.repeat(loops.pairs, parts, 0), np.repeat(loops.burgers, parts, 0)
        lines = gt.LineArrays(loops.positions, pairs, vectors, loops.box)
        net = gt.DislocationNetwork.of_arrays(lines)
        tracemalloc.start()
        clock = time.process_time()
        assert gt.stresses(net, COPPER, shape=nodes).largest > 0
        spent.append(time.process_time() - clock)
        most = tracemalloc.get_traced_memory()[1] / nodes**3
        tracemalloc.stop()
        print(
            f"  {nodes}^3 nodes, {4 * parts} pieces: {spent[-1]:.2f} s, {most:.0f} bytes per node"
        )
    each = (spent[2] - spent[1]) / 60 / (64**3 / 2)
    print(f"  {spent[1] / 64**3 * 1e6:.1f} us per node, {each * 1e9:.0f} ns per wave and piece")


def main(arguments: list[str] | None = None) -> None:
    """A wall, a loop, and a simulated network if its file exists."""
    parser = argparse.ArgumentParser(description="Stress of dislocations.")
    parser.add_argument("--file", type=Path, help="a ParaDiS .data file of your own")
    parser.add_argument("--picture", type=Path, help="draw the stress of the loop into this file")
    parser.add_argument("--cost", action="store_true", help="measure time and memory")
    options = parser.parse_args(arguments)
    print("two walls of edge dislocations:")
    compare_walls()
    found = relax_a_loop()
    assert found.error < 1e-6 * found.largest
    if options.picture is not None:
        figure = found.plot(component="xz", plane="xz", layer=20)
        gt.pictures.save(figure, options.picture)
    if options.cost:
        measure_cost()
    path = options.file or SIMULATED
    if path.is_file():
        relax_a_simulation(path)


if __name__ == "__main__":
    main()
