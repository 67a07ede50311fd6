"""Plane lattices: which lattice atoms in a plane have, and the local direction of its axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.errors import CrystalError

# Atoms around each that are compared.
AROUND = 13
# Columns are lattice vectors of length one.
_TRIANGULAR = np.array([[1.0, 0.5], [0.0, np.sqrt(3) / 2]])


@dataclass(frozen=True, eq=False)
class PlaneLattice:
    """A lattice in the plane.

    name: of the lattice. neighbours: nearest neighbours of an atom. fold: order of the rotation
    that maps them onto each other. base: shortest steps between atoms as columns, in units of the
    shortest. cell: lattice vectors as columns, in these steps: the atoms of a honeycomb are on two
    of three sites of a triangular lattice.
    """

    name: str
    neighbours: int
    fold: int
    base: np.ndarray
    cell: np.ndarray

    @property
    def period(self) -> float:
        """Angle by which the lattice may be turned onto itself."""
        return 2 * np.pi / self.fold


LATTICES = {
    one.name: one
    for one in (
        PlaneLattice("hexagonal", 6, 6, _TRIANGULAR, np.eye(2)),
        PlaneLattice("square", 4, 4, np.eye(2), np.eye(2)),
        PlaneLattice("honeycomb", 3, 6, _TRIANGULAR, np.array([[1.0, -1.0], [1.0, 2.0]])),
    )
}


def directions(steps: np.ndarray, lattice: PlaneLattice) -> np.ndarray:
    """Mean of exp(i fold angle) over the nearest neighbours, shape (atoms,).

    steps: to the atoms around each, sorted by distance, as complex numbers, shape (atoms, k).
    """
    near = steps[:, : lattice.neighbours]
    return ((near / np.abs(near)) ** lattice.fold).mean(axis=1)


def regular_lattice(steps: np.ndarray) -> PlaneLattice:
    """The lattice with the clearest gap behind its nearest neighbours, times their order."""

    def clarity(lattice: PlaneLattice) -> float:
        distance, count = np.abs(steps), lattice.neighbours
        gap = (distance[:, count] - distance[:, count - 1]) / distance[:, 0]
        return float(np.median(gap * np.abs(directions(steps, lattice))))

    return max(LATTICES.values(), key=clarity)


def common_steps(steps: np.ndarray) -> np.ndarray | None:
    """Two shortest steps that most atoms have, as columns; None if there are none.

    They are lattice vectors of a single crystal, whatever its lattice.
    """
    size = float(np.median(np.abs(steps[:, 0])))
    shared: list[complex] = []
    trials = steps[:: max(len(steps) // 20, 1)].ravel()
    for trial in sorted(trials.tolist(), key=abs):
        if any(abs(trial - one) < size / 4 or abs(trial + one) < size / 4 for one in shared):
            continue
        away = np.abs(steps - trial)
        nearest = steps[np.arange(len(steps)), away.argmin(axis=1)]
        fits = away.min(axis=1) < size / 4
        # A sublattice of a honeycomb has half of the atoms.
        if fits.mean() < 0.7:
            continue
        mean = complex(nearest[fits].mean())
        if shared and abs((np.conj(shared[0]) * mean).imag) < abs(shared[0]) * size / 4:
            continue
        shared.append(mean)
        if len(shared) == 2:
            one, two = shared
            if (np.conj(one) * two).imag < 0:
                two = -two
            return np.array([[one.real, two.real], [one.imag, two.imag]])
    return None


def is_regular(vectors: np.ndarray) -> bool:
    """Whether two lattice vectors span a hexagonal or a square lattice, within 3 %."""
    return name_of(vectors) in ("hexagonal", "square")


def name_of(vectors: np.ndarray) -> str:
    """Name of the lattice of two short vectors, as columns, with a margin of 3 %."""
    one, two = np.linalg.norm(vectors, axis=0)
    cosine = abs(vectors[:, 0] @ vectors[:, 1]) / (one * two)
    if abs(one - two) < 0.03 * one:
        if cosine < 0.03:
            return "square"
        return "hexagonal" if abs(cosine - 0.5) < 0.03 else "centred rectangular"
    return "rectangular" if cosine < 0.03 else "oblique"


def nearest_steps(points: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the atoms around each of the first `count` points, and the steps to them.

    Steps are complex numbers, sorted by length, shape (count, AROUND).
    """
    if len(points) <= AROUND:
        raise CrystalError(
            f"positions: expected more than {AROUND} atoms, so that a lattice can be recognized, "
            f"got {len(points)}. Repeat the cell."
        )
    distance, near = scipy.spatial.cKDTree(points).query(points[:count], AROUND + 1)
    if not distance[:, 1].all():
        k = int(np.argmin(distance[:, 1]))
        raise CrystalError(
            f"positions: expected different atoms, got atoms {k} and {near[k, 1]} at one position. "
            "Keep one of them."
        )
    steps = points[near[:, 1:]] - points[:count, None]
    return near[:, 1:], steps[..., 0] + 1j * steps[..., 1]
