"""Known grains: grains of the frame before, which keep their numbers and frames in time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.materials.crystals.frames import Frame
from geomtorsion.materials.crystals.grains import (
    Grain,
    Grains,
    in_variant,
    quaternion_of,
    wall_between,
)
from geomtorsion.materials.crystals.local_frames import symmetry_of
from geomtorsion.materials.crystals.method import METHOD


@dataclass(frozen=True, eq=False)
class KnownGrains:
    """Grains of one frame of a trajectory, for the next frame.

    frames: of each grain, by its number. owner: the grain of each atom, as in `Grains.number`,
    shape (atoms,). used: number of grain labels
    used so far.
    """

    frames: Mapping[int, Frame]
    owner: np.ndarray
    used: int

    @classmethod
    def of(cls, grains: Grains) -> KnownGrains:
        """The grains of a frame."""
        return cls({grain.number: grain.frame for grain in grains}, grains.number, grains.used)

    @property
    def largest(self) -> Frame:
        """The frame of the grain with the most atoms, which does not vanish within one step."""
        numbers = sorted(self.frames)
        counts = [int((self.owner == number).sum()) for number in numbers]
        return self.frames[numbers[int(np.argmax(counts))]]

    def followed(self, grains: Grains) -> Grains:
        """The grains of the next frame with the numbers and frames of these.

        Pairs are chosen so that most atoms stay in their grain. A grain of another lattice, or one
        turned by more than the angle of a wall, is another grain. New grains get new numbers.
        """
        old, new = sorted(self.frames), list(grains)
        count = min(len(self.owner), len(grains.number))
        before, after = self.owner[:count], grains.number[:count]
        common = np.zeros((len(new), len(old)))
        for row, grain in enumerate(new):
            for column, number in enumerate(old):
                if _is_same(grain.frame, self.frames[number]):
                    both = (after == grain.number) & (before == number)
                    common[row, column] = both.sum()
        old_numbers = {
            row: old[column]
            for row, column in zip(*scipy.optimize.linear_sum_assignment(-common), strict=True)
            if common[row, column]
        }
        used, successors, names = self.used, [], {}
        for row, grain in enumerate(new):
            number = old_numbers.get(row, used)
            used += row not in old_numbers
            frame = grain.frame
            if row in old_numbers and not grains.is_single:
                frame = in_variant(frame, self.frames[number]).along(self.frames[number])
            successors.append(replace(grain, number=number, frame=frame))
            names[grain.number] = successors[-1]
        owner = grains.number.copy()
        for code, grain in names.items():
            owner[grains.number == code] = grain.number
        vanished = tuple(number for number in old if number not in old_numbers.values())
        return replace(
            grains,
            grains=tuple(sorted(successors, key=lambda grain: grain.number)),
            number=owner,
            walls=tuple(
                wall_between(*_in_order(*(names[k] for k in wall.grains)), wall.atoms)
                for wall in grains.walls
            ),
            used=used,
            vanished=vanished,
        )


def _in_order(one: Grain, other: Grain) -> tuple[Grain, Grain]:
    """Two grains in the order of their numbers."""
    return (one, other) if one.number < other.number else (other, one)


def _is_same(one: Frame, other: Frame) -> bool:
    """Whether two frames may belong to one grain at two times."""
    if one.lattice.name != other.lattice.name:
        return False
    group = symmetry_of(one.lattice.name)
    _, angles = group.nearest(quaternion_of(one)[None], quaternion_of(other)[None])
    return bool(angles[0] < METHOD.wall)
