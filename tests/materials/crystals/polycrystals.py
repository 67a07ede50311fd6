"""Polycrystals: Voronoi cells filled with crystals of known orientation."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from tests.materials.crystals.synthetic import CELLS, LATTICE_SITES, displaced


def turned(degrees: float, axis: Sequence[float]) -> np.ndarray:
    """The matrix of a rotation about an axis."""
    unit = np.array(axis) / np.linalg.norm(axis)
    return Rotation.from_rotvec(np.radians(degrees) * unit).as_matrix()


def filled(lattice: str, turn: np.ndarray, reach: float, constant: float = 1.0) -> np.ndarray:
    """Atoms of a crystal in a ball around the origin; turn: rotation from crystal to specimen."""
    cells = CELLS[lattice] * constant
    count = np.ceil(reach / cells).astype(int) + 1
    steps = np.stack(np.meshgrid(*[np.arange(-n, n) for n in count], indexing="ij"), axis=-1)
    sites = (steps.reshape(-1, 1, 3) + np.array(LATTICE_SITES[lattice])).reshape(-1, 3) * cells
    sites = sites + 0.117 * constant
    return sites[np.linalg.norm(sites, axis=1) < reach] @ turn.T


def polycrystal(
    lattices: Sequence[str],
    turns: Sequence[np.ndarray],
    seeds: np.ndarray,
    size: float,
    constants: Sequence[float] | None = None,
    burgers: Sequence[float] | None = None,
    apart: float = 0.7,
) -> tuple[np.ndarray, np.ndarray]:
    """A periodic cube of Voronoi grains around seeds, and the grain number of each atom.

    burgers: b of a Volterra line along z through the middle of grain 0, in specimen axes.
    apart: least distance between atoms of two grains, in neighbour distances of fcc.
    """
    images = np.stack(np.meshgrid(*[[-1, 0, 1]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    every = (seeds[:, None] + images * size).reshape(-1, 3)
    owner = np.repeat(np.arange(len(seeds)), len(images))
    tree = cKDTree(every)
    places, numbers = [], []
    for k, (lattice, turn) in enumerate(zip(lattices, turns, strict=True)):
        constant = 1.0 if constants is None else constants[k]
        atoms = filled(lattice, turn, size, constant)
        if burgers is not None and k == 0:
            atoms = displaced(atoms, np.array([0.131, 0.077]), burgers)
        atoms = atoms + seeds[k]
        nearest = tree.query(atoms)[1]
        # Only the cell around the seed itself, not a cell around one of its images.
        own = np.linalg.norm(every[nearest] - seeds[k], axis=1) < 1e-9
        mine = own & (owner[nearest] == k)
        places.append(atoms[mine] % size)
        numbers.append(np.full(mine.sum(), k))
    found, number = np.concatenate(places), np.concatenate(numbers)
    pairs = cKDTree(found, boxsize=size).query_pairs(apart * 0.7, output_type="ndarray")
    pairs = pairs[number[pairs[:, 0]] != number[pairs[:, 1]]]
    kept = np.ones(len(found), dtype=bool)
    for a, b in pairs.tolist():
        if kept[a] and kept[b]:
            kept[b] = False
    return found[kept], number[kept]


def bicrystal(
    lattice: str,
    turn: np.ndarray,
    burgers: Sequence[float] | None = None,
    axis: int = 0,
    size: tuple[float, float, float] = (13, 10, 6),
    both: bool = False,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Two crystals that meet in the plane x = 0 (or z = 0 for axis 2), within +-size, open.

    The first crystal is not turned. burgers: b of a line in it along z, at x = -6 (or x = 0).
    both: whether the second crystal has the same line at x = 6, with b along the same crystal
    axes; the rotation is then about z.
    """
    reach = float(np.linalg.norm(size)) + 2
    below, above = filled(lattice, np.eye(3), reach), filled(lattice, turn, reach)
    if burgers is not None:
        centre = np.array([-6.131 if axis == 0 else 0.131, 0.077])
        below = displaced(below, centre, burgers)
        if both:
            above = displaced(above, centre * [-1, 1], turn @ np.array(burgers))
    places = np.concatenate([below[below[:, axis] < 0], above[above[:, axis] >= 0]])
    number = np.repeat([0, 1], [(below[:, axis] < 0).sum(), (above[:, axis] >= 0).sum()])
    inside = (np.abs(places) < np.array(size) - 1e-6).all(axis=1)
    places, number = places[inside], number[inside]
    # Neighbours are 0.43 apart in diamond and at least 0.71 apart in the other lattices.
    margin = 0.3 if lattice == "diamond" else 0.45
    pairs = cKDTree(places).query_pairs(margin, output_type="ndarray")
    kept = np.ones(len(places), dtype=bool)
    kept[pairs[:, 1]] = False
    return places[kept], number[kept], np.array(size, dtype=float) * 2


@cache
def amorphous(size: float, density: float) -> np.ndarray:
    """Atoms without order in a cube around the origin: random positions, then pushed apart."""
    rng = np.random.default_rng(0)
    places = rng.uniform(-size / 2, size / 2, (round(density * size**3), 3))
    least = 0.95 * (2**0.5 / density) ** (1 / 3)
    for _ in range(60):
        pairs = cKDTree(places % size, boxsize=size).query_pairs(least, output_type="ndarray")
        steps = places[pairs[:, 1]] - places[pairs[:, 0]]
        steps -= size * np.rint(steps / size)
        sizes = np.linalg.norm(steps, axis=1)[:, None]
        push = 0.3 * (least - sizes) * steps / sizes
        np.add.at(places, pairs[:, 1], push)
        np.add.at(places, pairs[:, 0], -push)
    places = (places + size / 2) % size - size / 2
    # All tests share this array.
    places.flags.writeable = False
    return places
