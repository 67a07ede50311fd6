"""Surroundings: atoms with their images, in a tree, and the nearest neighbours among them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.errors import CrystalError
from geomtorsion.materials.crystals.frames import sampled
from geomtorsion.materials.crystals.triangulation import Cell
from geomtorsion.support.caching import cached_property


@dataclass(frozen=True, eq=False)
class Surroundings:
    """Points within a distance of some places, or further.

    points: shape (k, 3). numbers: of the atoms of which they are images, shape (k,).
    distance: up to which all points are included. whole: whether there are no others.
    """

    points: np.ndarray
    numbers: np.ndarray
    distance: float
    whole: bool = False

    @cached_property
    def tree(self) -> scipy.spatial.cKDTree:
        """The points in a search tree."""
        return scipy.spatial.cKDTree(self.points, balanced_tree=False, compact_nodes=False)

    @cached_property
    def overlapping(self) -> np.ndarray:
        """Pairs of atoms nearer than a tenth of the usual distance, shape (pairs, 2)."""
        some = self.points[sampled(len(self.points))]
        closest = float(np.median(self.tree.query(some, k=2)[0][:, 1]))
        pairs = self.numbers[self.tree.query_pairs(closest / 10, output_type="ndarray")]
        return np.unique(np.sort(pairs.reshape(-1, 2), axis=1), axis=0)

    @cached_property
    def apart(self) -> Surroundings:
        """These surroundings, unless most atoms overlap: crystals have about equal distances.

        Raises
        ------
        CrystalError
            More than half of the atoms overlap with another.
        """
        pairs = self.overlapping
        if 2 * len(np.unique(pairs)) > len(np.unique(self.numbers)):
            one, other = pairs[0].tolist()
            raise CrystalError(
                f"positions: expected atoms at different positions, got atoms {one} and {other} at "
                f"one position, and {len(pairs) - 1:,} more such pairs. Give a cell as large as "
                "the crystal, and each atom once."
            )
        return self


@dataclass(frozen=True, eq=False)
class Places:
    """Atoms in a cell.

    places: wrapped, shape (atoms, 3). cell: contains them.
    reach: distance within which most have as many neighbours as requested.
    """

    places: np.ndarray
    cell: Cell
    reach: float

    @cached_property
    def _near(self) -> Surroundings:
        return self._as_far_as(self.reach)

    def _as_far_as(self, distance: float) -> Surroundings:
        points, numbers, _ = self.cell.with_ghosts(self.places, distance)
        return Surroundings(points, numbers, distance, not self.cell.periodic.any())

    def within(self, distance: float) -> Surroundings:
        """All atoms, with images at least as far as a distance outside the cell.

        They are those within reach, or newly made ones, so that the result does not depend on
        earlier calls.
        """
        return self._near if distance <= self.reach else self._as_far_as(distance)

    def neighbours(self, atoms: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Numbers of the nearest neighbours of some atoms, and the vectors to them.

        Shapes (atoms, count) and (atoms, count, 3), nearest first. Equally near ones are in the
        order of their numbers.

        Raises
        ------
        CrystalError
            Most atoms overlap, or have fewer neighbours.
        """
        reach, centres = self.reach, self.places[atoms]
        nearest = np.empty((len(centres), count), dtype=np.int64)
        vectors = np.empty((len(centres), count, 3))
        left = np.arange(len(centres))
        while len(left):
            around = self.within(reach)
            points, numbers = around.points, around.numbers
            if around.whole and len(points) <= count:
                raise CrystalError(
                    f"positions: each atom needs {count} neighbours; there are only {len(points)} "
                    "atoms. Give more of the crystal."
                )
            if len(points) > count:
                distances, near = around.apart.tree.query(centres[left], k=count + 1)
                order = np.lexsort((numbers[near], distances), axis=1)[:, 1:]
                near = np.take_along_axis(near, order, axis=1)
                nearest[left] = numbers[near]
                vectors[left] = points[near] - centres[left][:, None]
                left = left[(distances[:, -1] > around.distance) & (not around.whole)]
            # At corners, and in a gas around the crystal, neighbours are far away.
            reach = 2 * around.distance
        return nearest, vectors


def spanned(positions: np.ndarray, cell: Cell) -> float:
    """Approximate volume that the atoms fill.

    It is the cell without its widest empty layers, or a box around the atoms.

    Raises
    ------
    CrystalError
        Up to rounding all atoms are in one plane.
    """
    shares = (positions @ cell.inverse).T
    sizes = [
        _filled(one) if flag else np.ptp(one)
        for one, flag in zip(shares, cell.periodic.tolist(), strict=True)
    ]
    volume = float(np.prod(sizes) * abs(np.linalg.det(cell.vectors)))
    # Along each edge, since a single atom may be far away.
    rounding = 64 * np.finfo(float).eps * np.abs(shares).max(axis=1, initial=0.0)
    if not volume or (np.array(sizes) <= rounding)[~cell.periodic].any():
        raise CrystalError(
            f"positions: expected atoms that fill space, got {len(positions)} atoms in one plane "
            "or on one line. Give several layers of the crystal."
        )
    return volume


def _filled(shares: np.ndarray) -> float:
    """Share of a period without the widest layer that contains no atom.

    The period is divided into as many slices as there are atoms.
    """
    count = len(shares)
    slices = np.floor((shares - np.floor(shares)) * count).astype(np.int64)
    taken = np.flatnonzero(np.bincount(slices))
    gaps = np.diff(taken, append=taken[0] + count)
    return 1 - float(gaps.max() - 1) / count
