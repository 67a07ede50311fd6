"""Lines between atoms: dislocations put into a crystal are found under noise and as a closed loop.

    python examples/18_lines_between_atoms.py
    python examples/18_lines_between_atoms.py --noise 0.1

Each bond is read as the nearest lattice vector: whole numbers, the coframe of the crystal. Their
sum around a triangle of atoms is the torsion, and lines are where it is not zero. Four screws of
alternating sign are put into an iron-like crystal, periodic in all directions, and the atoms are
displaced at random. Then a disc of atoms is removed and the crystal closed over it: a prismatic
loop, which encloses as many vacancies as atoms were removed.
"""

import argparse

import numpy as np

import geomtorsion as gt

CONSTANT = 2.87


def body_centred(repeats: tuple[int, int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Atoms of a perfect bcc crystal with a = 1, and the edges of its cell."""
    corners = np.stack(np.meshgrid(*map(np.arange, repeats), indexing="ij"), axis=-1)
    sites = corners.reshape(-1, 1, 3) + np.array([[0, 0, 0], [0.5, 0.5, 0.5]])
    return sites.reshape(-1, 3), np.array(repeats, dtype=float)


def four_screws(repeats: tuple[int, int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Screws along z with b = a [0 0 1] and the opposite b, on a square."""
    places, cell = body_centred(repeats)
    moved = places.copy()
    for corner in ((0, 0), (0, 1), (1, 0), (1, 1)):
        sign = 1 - 2 * (sum(corner) % 2)
        for image in np.ndindex(3, 3):
            # The line does not pass through an atom.
            centre = (np.array(corner) / 2 + 0.263 + np.array(image) - 1) * cell[:2]
            x, y = (places[:, :2] - centre).T
            moved[:, 2] += sign * np.arctan2(y, x) / (2 * np.pi)
    return moved, cell


def closed_over_a_disc(repeats: tuple[int, int, int], radius: float) -> tuple[np.ndarray, ...]:
    """A crystal without a disc of one lattice constant, its faces joined; and the removed atoms."""
    places, cell = body_centred(repeats)
    middle = cell / 2 + [0.1, 0.05, 0]
    x, y, z = (places - middle).T
    inside = (x**2 + y**2 < radius**2) & (z >= -0.5) & (z < 0.5)
    # Solid angle of the disc over 4 pi, a sum over points of it: atoms at the disc are displaced by
    # half of b, and far atoms do not move.
    spots = np.stack(np.meshgrid(*[np.linspace(-radius, radius, 41)] * 2), axis=-1).reshape(-1, 2)
    spots = spots[(spots**2).sum(axis=1) < radius**2]
    height = np.where(z >= 0, z - 0.25, z + 0.25)
    height = np.where(np.abs(height) < 0.25, np.copysign(0.25, z), height)
    across = ((np.stack([x, y], axis=1)[:, None] - spots) ** 2).sum(axis=2)
    share = np.pi * radius**2 / len(spots) / (4 * np.pi)
    angle = share * (height[:, None] / (across + height[:, None] ** 2) ** 1.5).sum(axis=1)
    moved = places.copy()
    moved[:, 2] -= np.clip(angle, -0.5, 0.5)
    return moved[~inside], cell, inside


def main(arguments: list[str] | None = None) -> None:
    """Find screws under noise, then a loop, and compare each with the known input."""
    parser = argparse.ArgumentParser(description="Dislocation lines of atoms.")
    parser.add_argument(
        "--noise", type=float, default=0.06, help="in units of the neighbour distance"
    )
    options = parser.parse_args(arguments)

    places, cell = four_screws((16, 16, 4))
    shaken = np.random.default_rng(1).normal(size=places.shape)
    places = places + options.noise * np.sqrt(0.75) * shaken
    crystal = gt.crystals.Crystal(places * CONSTANT, cell * CONSTANT)
    net = crystal.dislocations()
    print(f"{crystal}; all neighbours fit for {crystal.share:.0%} of the atoms")
    print(net)
    assert [line.family for line in net.lines] == ["<1 0 0>"] * 4
    assert all(line.kind == "periodic" for line in net.lines)
    assert np.allclose(net.nye, 0, atol=1e-9)

    places, cell, gone = closed_over_a_disc((14, 14, 10), 4.0)
    crystal = gt.crystals.Crystal(places * CONSTANT, cell * CONSTANT)
    (loop,) = crystal.dislocations().lines
    atom = crystal.constant**3 / 2
    enclosed = np.array(loop.burgers, float) @ loop.area / atom
    print(f"\na {loop.kind} line, {loop.family}, length {loop.length:.1f}: {enclosed:.1f} atoms")
    print(f"{gone.sum()} atoms were removed")
    assert loop.is_closed
    assert np.isclose(enclosed, -gone.sum(), rtol=0.01)


if __name__ == "__main__":
    main()
