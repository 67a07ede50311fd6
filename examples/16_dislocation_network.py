"""Dislocation network: a twist boundary, circuits by linking, and a large simulated network.

    python examples/16_dislocation_network.py
    python examples/16_dislocation_network.py --picture network.png --file chains.data

Two crystals rotated against each other by a small angle are joined by a square net of screw
dislocations with spacing d. By Frank's formula a circuit of width L through the boundary has the
Burgers vector 2 L sin(theta/2), with theta about b / d. The net is made, written into a file in the
form that simulations use, read again, and measured. Then a line is broken, and the node rule names
the missing vector.
"""

import argparse
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import geomtorsion as gt

# Beside a checkout: a network of 5,930 lines, the result of a simulation of dislocations.
SIMULATED = Path(__file__).parents[2] / "shared/data/networks/180chains_16.10e.data"


def twist_boundary(count: int, apart: float, height: float) -> gt.LineArrays:
    """count x count screws with b = 1 along x and along y, in the middle of a periodic box."""
    number = np.arange(count**2).reshape(count, count)
    i, j = np.divmod(number.ravel(), count)
    places = np.stack([i * apart, j * apart, np.full(count**2, height / 2)], axis=1)
    pairs, vectors = [], []
    for axis, b in ((0, [1.0, 0, 0]), (1, [0, 1.0, 0])):
        pairs.append(np.stack([number.ravel(), np.roll(number, -1, axis).ravel()], axis=1))
        vectors.append(np.repeat([b], count**2, axis=0))
    box = gt.Box.of_bounds([0, 0, 0], [count * apart, count * apart, height])
    return gt.LineArrays(places, np.concatenate(pairs), np.concatenate(vectors), box)


def ask_the_boundary(net: gt.DislocationNetwork, apart: float) -> None:
    """Compare circuits, density and character with known values."""
    assert net.node_rule() == ()
    (family,) = net.families()
    print(f"{len(net.lines)} lines of b = {family.name}: all screw ({family.screw:.0%})")
    assert family.screw == 1
    assert net.box is not None
    height = float(np.asarray(net.box.vectors)[2, 2])
    print(
        f"density {net.density:.6f}; two sets of lines have 2 / (d h) = {2 / (apart * height):.6f}"
    )
    assert np.isclose(net.density, 2 / (apart * height), rtol=1e-12)
    for lines in (1, 3, 20):
        # Across the lines along x; twenty lines are more than the box has, so images count.
        corner = [0.3 * apart, 0.5 * apart, 0.25 * height]
        circuit = gt.Loop.plaquette(corner, (lines * apart, height / 2), plane=(1, 2))
        found = net.burgers(circuit, lattice="sc")
        print(f"  a circuit across {lines} lines: b = {found.whole.tolist()} lattice vectors")
        assert found.whole.tolist() == [lines, 0, 0]
    theta = 2 * np.arcsin(1 / (2 * apart))
    print(f"the crystals are rotated by {np.degrees(theta):.3f} degrees (Frank)")


def break_a_line(net: gt.DislocationNetwork) -> None:
    """Remove one piece: b is not conserved at its two ends, and the rule reports both."""
    lines = net.arrays
    broken = gt.DislocationNetwork.of_arrays(
        gt.LineArrays(lines.positions, lines.pairs[1:], lines.burgers[1:], lines.box)
    )
    for violation in broken.node_rule():
        print(f"  {violation}; a line with b = {violation.missing} should leave it")
    assert {one.node for one in broken.node_rule()} == set(lines.pairs[0].tolist())


def ask_a_simulation(path: Path) -> None:
    """Measure a simulated network: density, families, and b of each face of the box, twice."""
    net = gt.DislocationNetwork.read(path)
    print(f"\n{path.name}: {len(net.graph)} nodes, {len(net.lines)} lines")
    print(f"  b at the nodes sums to {abs(net.arrays.excess).max():.0e} at most")
    for family in net.families():
        print(f"  {family.name}: {family.density:.3e} per unit^2, {family.screw:.0%} screw")
    assert net.box is not None
    sides, corner = np.asarray(net.box.vectors), np.asarray(net.box.origin)
    for axis in range(3):
        # A face of the periodic box: the b that crosses it is the mean Nye tensor times its area.
        one, two = sides[(axis + 1) % 3], sides[(axis + 2) % 3]
        face = gt.Loop.plaquette(corner + 0.1, (1, 1), plane=(one, two))
        found = net.burgers(face)
        wanted = net.nye @ np.cross(one, two)
        print(
            f"  through face {axis}: b = {found.vector.round(4)}, {len(found.crossings)} crossings"
        )
        assert np.allclose(found.vector, wanted, atol=1e-6)


def main(arguments: list[str] | None = None) -> None:
    """Measure a net with known answers, a broken one, and a simulated one if its file exists."""
    parser = argparse.ArgumentParser(description="Burgers vectors in dislocation networks.")
    parser.add_argument("--file", type=Path, help="a ParaDiS .data file of your own")
    parser.add_argument("--picture", type=Path, help="draw the boundary into this file")
    options = parser.parse_args(arguments)
    apart = 40.0
    made = gt.DislocationNetwork.of_arrays(twist_boundary(8, apart, 300.0))
    with TemporaryDirectory() as folder:
        made.save(Path(folder) / "boundary.data")
        net = gt.DislocationNetwork.read(Path(folder) / "boundary.data")
    ask_the_boundary(net, apart)
    print("one piece removed:")
    break_a_line(made)
    if options.picture is not None:
        circuit = gt.Loop.plaquette([12, 20, 75], (120, 150), plane=(1, 2))
        gt.pictures.save(gt.pictures.draw_lines(net, [circuit]), options.picture)
    path = options.file or SIMULATED
    if path.is_file():
        ask_a_simulation(path)
    assert np.allclose(net.nye, np.diag([1, 1, 0]) / (apart * 300))


if __name__ == "__main__":
    main()
