"""Grains: the single crystals of a polycrystal, and the walls between them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np

from geomtorsion.errors import CrystalError
from geomtorsion.materials.crystals.frames import Frame, InFrame
from geomtorsion.materials.crystals.local_frames import symmetry_of
from geomtorsion.materials.maps.symmetry import angle_of
from geomtorsion.rigid.attitude import matrix_from_quaternion, product, quaternion_from_matrix
from geomtorsion.support import checks


class Nowhere(IntEnum):
    """Stand-in for the grain of an atom that belongs to none."""

    wall = -1
    none = -2


@dataclass(frozen=True, eq=False, repr=False)
class Grain(InFrame):
    """A single crystal of a polycrystal.

    number: from 0; 0 is the grain of `crystal.frame`, the others are sorted by size, largest first.
        In a trajectory a grain keeps its number.
    frame: its lattice and orientation; orient is the variant nearest to grain 0 of this lattice.
    atoms: their numbers, ascending, with the atoms of its dislocation cores, shape (n,).
    centre: centre of gravity of the atoms, in the cell, shape (3,).
    """

    number: int
    frame: Frame
    atoms: np.ndarray
    centre: np.ndarray

    def __repr__(self) -> str:
        return f"Grain({self.number}: {len(self.atoms):,} atoms, {self.lattice})"


@dataclass(frozen=True, eq=False, repr=False)
class Wall:
    """Wall between two grains: a grain boundary, or a phase boundary.

    grains: their numbers, ascending. atoms: numbers of atoms that belong to neither, shape (n,).
    angle: of the misorientation, the least of all symmetric equivalents, rad; None between
        different lattices. axis: of the rotation, a unit vector in crystal axes within the standard
        triangle, shape (3,).
    """

    grains: tuple[int, int]
    atoms: np.ndarray
    angle: float | None
    axis: tuple[float, float, float] | None

    @property
    def degrees(self) -> float | None:
        """The angle in degrees."""
        return None if self.angle is None else float(np.degrees(self.angle))

    @property
    def description(self) -> str:
        """The misorientation in words."""
        if self.angle is None or self.axis is None:
            return "of different lattices"
        axis = " ".join(f"{round(x, 3) + 0.0:g}" for x in self.axis)
        return f"misoriented by {self.degrees:.2f} degrees about [{axis}]"

    def __repr__(self) -> str:
        return f"Wall(grains {self.grains[0]} and {self.grains[1]}, {self.description})"


@dataclass(frozen=True, eq=False, repr=False)
class Grains:
    """All grains of a crystal, in order, and the walls between neighbours.

    number: the grain of each atom, -1 in a wall, -2 in a region without a lattice, shape (atoms,).
    walls: walls between grains that touch, by the numbers of the grains.
    fitting: share of the atoms whose neighbours fit the lattice of their grain; None for a single
        crystal.
    used: number of grain labels used so far, in this frame of a trajectory and before.
    vanished: numbers of grains of the frame before that no longer exist.
    """

    grains: tuple[Grain, ...]
    number: np.ndarray
    walls: tuple[Wall, ...]
    fitting: float | None
    used: int
    vanished: tuple[int, ...] = ()

    @property
    def is_single(self) -> bool:
        """Whether it is one crystal that contains all atoms."""
        return self.fitting is None

    @property
    def shares(self) -> dict[str, float]:
        """Share of the atoms in each lattice, in walls ("wall") and in regions without ("none")."""
        shares: dict[str, float] = {}
        for grain in self.grains:
            part = len(grain.atoms) / len(self.number)
            shares[grain.lattice] = shares.get(grain.lattice, 0.0) + part
        for code in Nowhere:
            if (self.number == code).any():
                shares[code.name] = float((self.number == code).mean())
        return shares

    def wall(self, one: int, other: int) -> Wall:
        """The wall between two grains, or its misorientation where they do not touch.

        Raises
        ------
        CrystalError
            A number belongs to no grain, or both are the same.
        """
        first, second = sorted((self[one], self[other]), key=lambda grain: grain.number)
        if first is second:
            raise CrystalError(
                f"wall: expected two different grains, got grain {first.number} twice. Name "
                "another one."
            )
        for wall in self.walls:
            if wall.grains == (first.number, second.number):
                return wall
        return wall_between(first, second, np.zeros(0, dtype=np.int64))

    def __len__(self) -> int:
        return len(self.grains)

    def __iter__(self) -> Iterator[Grain]:
        return iter(self.grains)

    def __getitem__(self, number: int) -> Grain:
        """The grain with a number."""
        index = checks.count(number, "number", CrystalError)
        for grain in self.grains:
            if grain.number == index:
                return grain
        numbers = ", ".join(str(grain.number) for grain in self.grains)
        raise CrystalError(
            f"number: expected the number of a grain ({checks.cut(numbers)}), got {index}. Give "
            "one of these."
        )

    def __repr__(self) -> str:
        count = len(self.grains)
        parts = ", ".join(f"{name} {part:.1%}" for name, part in self.shares.items())
        return f"Grains({count} grain{'s' * (count != 1)}: {parts})"


def single_grain(frame: Frame, places: np.ndarray) -> Grains:
    """A single crystal as a single grain."""
    count = len(places)
    grain = Grain(0, frame, np.arange(count), places.mean(axis=0))
    return Grains((grain,), np.zeros(count, dtype=np.int64), (), None, 1)


def wall_between(one: Grain, other: Grain, atoms: np.ndarray) -> Wall:
    """The wall between two grains."""
    angle, axis = None, None
    if one.lattice == other.lattice:
        turn = symmetry_of(one.lattice).disorientation(
            quaternion_of(one.frame), quaternion_of(other.frame)
        )
        angle = float(angle_of(turn))
        size = np.linalg.norm(turn[1:])
        axis = tuple((turn[1:] / size).tolist()) if size > 0 else (0.0, 0.0, 1.0)
    return Wall((one.number, other.number), atoms, angle, axis)


def quaternion_of(frame: Frame) -> np.ndarray:
    """The orientation of a frame, crystal to specimen, scalar first, shape (4,)."""
    return quaternion_from_matrix(frame.orient.T)


def in_variant(frame: Frame, like: Frame) -> Frame:
    """The same frame in the variant of its symmetry nearest to another frame of its lattice."""
    group, own = symmetry_of(frame.lattice.name), quaternion_of(frame)
    variant, _ = group.nearest(quaternion_of(like)[None], own[None])
    turned = product(own, group.quaternions[variant[0]])
    return replace(frame, orient=matrix_from_quaternion(turned).T)
