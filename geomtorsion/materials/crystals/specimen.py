"""Specimen: atoms of unknown order, and whether they are one crystal."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.materials.crystals.frames import (
    NEIGHBOURS,
    Frame,
    best_frame,
    fitted,
    is_ordered,
    occupied,
    sampled,
)
from geomtorsion.materials.crystals.grains import quaternion_of
from geomtorsion.materials.crystals.lattices import LATTICES, Lattice
from geomtorsion.materials.crystals.local_frames import clear_misfit, local_frames, symmetry_of
from geomtorsion.materials.crystals.method import METHOD
from geomtorsion.materials.crystals.shells import dilated, reach_of_shells
from geomtorsion.materials.crystals.surroundings import Places
from geomtorsion.materials.crystals.triangulation import Cell
from geomtorsion.rigid.attitude import matrix_from_quaternion

# Numbers of neighbours, shape (atoms, k), and vectors to them, shape (atoms, k, 3).
Neighbours = tuple[np.ndarray, np.ndarray]
# Largest number of neighbours that any of the lattices needs.
MOST = max(lattice.shells for lattice in LATTICES.values())


def own_first(own: Lattice) -> list[Lattice]:
    """All lattices, with the one of a specimen first, as it was found."""
    return [own, *(lattice for name, lattice in LATTICES.items() if name != own.name)]


@dataclass(frozen=True, eq=False)
class Specimen:
    """Atoms, and the frame of one of their grains.

    atoms: in their cell. frame: as found for all atoms together.
    keep_orient, keep_constant: whether these were given.
    """

    atoms: Places
    frame: Frame
    keep_orient: bool = False
    keep_constant: bool = False

    @property
    def places(self) -> np.ndarray:
        """Positions of the atoms in the cell, shape (atoms, 3)."""
        return self.atoms.places

    @property
    def cell(self) -> Cell:
        """The cell of the atoms."""
        return self.atoms.cell

    @property
    def lattices(self) -> list[Lattice]:
        """All lattices to look for, with the one of the frame first."""
        return own_first(self.frame.lattice)

    @property
    def nearest(self) -> float:
        """Distance of neighbours in the frame, coordinates."""
        return self.frame.lattice.nearest * self.frame.constant

    def neighbours(self, atoms: np.ndarray, count: int = MOST) -> Neighbours:
        """Numbers of the nearest neighbours of some atoms and the vectors to them."""
        return self.atoms.neighbours(atoms, count)

    def occupied(self, atoms: np.ndarray) -> np.ndarray:
        """Which of some atoms have another atom at every neighbour vector of the frame."""
        mask = np.zeros(len(atoms), dtype=bool)
        for start in range(0, len(atoms), METHOD.together):
            part = slice(start, start + METHOD.together)
            mask[part] = occupied(self.frame, self.neighbours(atoms[part], NEIGHBOURS)[1])
        return mask


@dataclass(frozen=True, eq=False)
class Local:
    """The lattice of each atom, -1 where there is none, and its orientation, shape (atoms, 4)."""

    phase: np.ndarray
    quaternions: np.ndarray
    constants: np.ndarray


def local_of(lattices: list[Lattice], vectors: np.ndarray) -> Local:
    """The lattice into which the neighbours of each atom fit best, and its orientation."""
    count = len(vectors)
    phase = np.full(count, -1)
    best = np.full(count, np.inf)
    quaternions, constants = np.zeros((count, 4)), np.ones(count)
    left = np.arange(count)
    for number, lattice in enumerate(lattices):
        local = local_frames(lattice, vectors[left])
        better = local.good & (local.misfit < best[left])
        mine = left[better]
        phase[mine], best[mine] = number, local.misfit[better]
        quaternions[mine] = local.quaternions[better]
        constants[mine] = local.constants[better]
        # An atom with so small a misfit fits into no other lattice: two misfits add up to more.
        left = left[~(local.good & (local.misfit < clear_misfit(lattice.name) / 2))]
    return Local(phase, quaternions, constants)


def share_of_lattices(
    own: Lattice, neighbours: Callable[[np.ndarray], Neighbours], atoms: np.ndarray
) -> dict[str, float]:
    """Share of some atoms whose neighbours fit into each lattice, each atom in a frame of its own.

    It is zero where the neighbours of such atoms are not oriented alike: some atoms of a glass
    also have neighbours as in a crystal.

    Parameters
    ----------
    own
        A lattice as it was found, with c/a of hcp, instead of the ideal one.
    neighbours
        The numbers of the nearest other atoms, and the vectors to them, for given atoms.
    """
    lattices = own_first(own)
    # In a glass a few atoms show that neighbours are nowhere oriented alike.
    some = _shares(lattices, neighbours, atoms[few(len(atoms))])
    return _shares(lattices, neighbours, atoms) if any(some.values()) else some


def _shares(
    lattices: list[Lattice], neighbours: Callable[[np.ndarray], Neighbours], atoms: np.ndarray
) -> dict[str, float]:
    """As `share_of_lattices`, for all of these atoms."""
    numbers, vectors = neighbours(atoms)
    local = local_of(lattices, vectors)
    every = [np.flatnonzero(local.phase == k) for k in range(len(lattices))]
    some = [mine[:: max(len(mine) // (10 * METHOD.seeds), 1)] for mine in every]
    beside = [numbers[x, : y.shells].ravel() for x, y in zip(some, lattices, strict=True)]
    # An atom may be a neighbour of several others.
    around = np.unique(np.concatenate(beside))
    local_around = local_of(lattices, neighbours(around)[1]) if len(around) else local
    shares = {}
    for k, lattice in enumerate(lattices):
        shares[lattice.name] = len(every[k]) / len(atoms)
        if not len(some[k]):
            continue
        rows = np.searchsorted(around, beside[k])
        mean = np.repeat(local.quaternions[some[k]], lattice.shells, axis=0)
        _, angles = symmetry_of(lattice.name).nearest(mean, local_around.quaternions[rows])
        alike = ((local_around.phase[rows] == k) & (angles < METHOD.wall)).mean()
        # In noise, as many atoms fit next to a fitting atom as anywhere else.
        if alike < shares[lattice.name] / 2 or not _are_ordered(lattice, local, every[k], vectors):
            shares[lattice.name] = 0.0
    return shares


def _are_ordered(lattice: Lattice, local: Local, mine: np.ndarray, vectors: np.ndarray) -> bool:
    """Whether most of some equally oriented atoms have their neighbours in place in the mean."""
    frame = mean_frame(lattice, local, mine, vectors)
    whole = mine[fitting(frame, vectors[mine])]
    return len(whole) > 0 and is_ordered(frame, vectors[whole])


def mean_frame(lattice: Lattice, local: Local, part: np.ndarray, vectors: np.ndarray) -> Frame:
    """The frame of a group: the best rotation for all neighbours, started at its median."""
    group, q = symmetry_of(lattice.name), local.quaternions
    some = part[np.linspace(0, len(part) - 1, min(METHOD.sample, len(part))).astype(int)]
    seeds = some[np.linspace(0, len(some) - 1, min(METHOD.seeds, len(some))).astype(int)]
    spread = []
    for seed in seeds:
        _, angles = group.nearest(np.tile(q[seed], (len(some), 1)), q[some])
        spread.append(float(np.minimum(angles, METHOD.wall).mean()))
    first = seeds[int(np.argmin(spread))]
    start = Frame(lattice, matrix_from_quaternion(q[first]).T, float(local.constants[first]))
    _, angles = group.nearest(np.tile(q[first], (len(some), 1)), q[some])
    return best_frame(start, vectors[some[angles < METHOD.wall]][:, : lattice.shells])


def is_other(specimen: Specimen, vectors: np.ndarray) -> np.ndarray:
    """Which atoms have another lattice or orientation than the frame, shape (atoms,)."""
    local = local_of(specimen.lattices, vectors)
    own = np.tile(quaternion_of(specimen.frame), (len(vectors), 1))
    _, angles = symmetry_of(specimen.frame.lattice.name).nearest(own, local.quaternions)
    return (local.phase > 0) | ((local.phase == 0) & (angles > METHOD.wall))


def seems_many(specimen: Specimen, atoms: np.ndarray, whole: np.ndarray) -> bool:
    """Whether some atoms have another lattice or orientation; whole: which fit into the frame."""
    odd = atoms[~whole]
    if len(odd) and is_other(specimen, specimen.neighbours(odd)[1]).any():
        return True
    return bool(len(_turned(specimen, few(len(specimen.places)))))


def few(count: int) -> np.ndarray:
    """Numbers of a few of so many atoms, evenly spaced."""
    return np.linspace(0, count - 1, min(10 * METHOD.seeds, count)).astype(int)


def _turned(specimen: Specimen, some: np.ndarray) -> np.ndarray:
    """Atoms of a sample turned from the mean orientation by more than the angle of a wall.

    It detects two grains where bonds can still be read in a frame between them, up to some 25
    degrees.
    """
    lattice = specimen.frame.lattice
    _, vectors = specimen.neighbours(some)
    local = local_of([lattice], vectors)
    good = np.flatnonzero(local.phase == 0)
    if not len(good):
        return good
    most = np.tile(quaternion_of(mean_frame(lattice, local, good, vectors)), (len(good), 1))
    _, angles = symmetry_of(lattice.name).nearest(most, local.quaternions[good])
    return some[good[angles > METHOD.wall]]


def turned_together(specimen: Specimen, some: np.ndarray) -> bool:
    """Whether one of some atoms is turned together with atoms around it, not only by noise."""
    lattice = specimen.frame.lattice
    for atom in _turned(specimen, some):
        numbers, own = specimen.neighbours(np.array([atom]))
        _, vectors = specimen.neighbours(numbers[0, : lattice.shells])
        local = local_of([lattice], np.concatenate([own, vectors]))
        q = local.quaternions
        _, angles = symmetry_of(lattice.name).nearest(np.tile(q[0], (len(q), 1)), q)
        if ((local.phase == 0) & (angles < METHOD.wall / 2))[1:].sum() > lattice.shells / 2:
            return True
    return False


def fitting(frame: Frame, vectors: np.ndarray) -> np.ndarray:
    """`Fit.whole` of any number of atoms."""
    shells, mask = frame.lattice.shells, np.zeros(len(vectors), dtype=bool)
    for start in range(0, len(vectors), METHOD.together // shells):
        part = slice(start, start + METHOD.together // shells)
        mask[part] = fitted(frame, vectors[part, :shells]).whole
    return mask


def is_single(specimen: Specimen, near: np.ndarray | None) -> bool:
    """Whether the atoms are a single crystal, with its defects and surfaces.

    Inside of another grain or phase no atom fits into the frame of the crystal, and neither does
    any of its neighbours: hardly an atom of a single crystal needs a further test.

    near: neighbours by lattice vector, as `Shells` has them, shape (atoms, k); None where numbers
        do not identify images.
    """
    count = len(specimen.places)
    if near is None:
        numbers, vectors = specimen.neighbours(np.arange(count))
        fits = fitting(specimen.frame, vectors)
        touched = dilated(fits, numbers[:, : specimen.frame.lattice.shells])
    else:
        fits = np.all(near >= 0, axis=1)
        touched = dilated(fits, near)
    deep = np.flatnonzero(~touched)
    if turned_together(specimen, few(count)):
        return False
    if not len(deep):
        return True
    # A grain has more atoms than an atom has neighbours; a sample finds a large grain.
    least = specimen.frame.lattice.shells
    some = deep[sampled(len(deep))]
    if len(some) < len(deep) and is_other(specimen, specimen.neighbours(some)[1]).sum() > least:
        return False
    _, vectors = specimen.neighbours(deep)
    if is_other(specimen, vectors).sum() > least:
        return False
    return not is_lost(specimen, deep, vectors, fits).any()


def is_lost(
    specimen: Specimen, atoms: np.ndarray, vectors: np.ndarray, held: np.ndarray
) -> np.ndarray:
    """Which of some atoms are in a region without a lattice that is wider than any core.

    The share of held atoms in the region is as small as in a liquid, but these atoms have as many
    neighbours as in a crystal.
    """
    frame, cell, places = specimen.frame, specimen.cell, specimen.places
    longest = np.linalg.norm(vectors[:, frame.lattice.shells - 1], axis=1)
    mask = longest < reach_of_shells(frame)
    far = 2 * METHOD.width * specimen.nearest

    def around(chosen: np.ndarray) -> np.ndarray:
        points, _, _ = cell.with_ghosts(places[chosen], far)
        tree = scipy.spatial.cKDTree(points)
        return tree.query_ball_point(places[atoms[mask]], far, return_length=True)

    every = np.ones(len(places), dtype=bool)
    mask[mask] = around(held) < METHOD.share * around(every)
    if mask.any():
        # Noise adds other atoms to the nearest ones; in a crystal the places are still occupied.
        odd = np.flatnonzero(~held)
        some = held.copy()
        some[odd] = specimen.occupied(odd)
        mask[mask] = around(some) < METHOD.share * around(every)
    return mask


def nearest_held(
    specimen: Specimen, atoms: np.ndarray, held: np.ndarray, reach: float
) -> tuple[np.ndarray, np.ndarray]:
    """The nearest held atom to each of some atoms, and its distance.

    They are the number of all atoms, and infinity, where none is within reach.
    """
    chosen = np.flatnonzero(held)
    points, numbers, _ = specimen.cell.with_ghosts(specimen.places[chosen], reach)
    if not len(points):
        return np.full(len(atoms), len(held)), np.full(len(atoms), np.inf)
    tree = scipy.spatial.cKDTree(points)
    distances, k = tree.query(specimen.places[atoms], distance_upper_bound=reach)
    return np.append(chosen[numbers], len(held))[k], distances
