"""Block grains: whether a crystal in blocks is a single one, and its grains if it is not."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from geomtorsion.materials.blocks import read_array, run_blocks, write_array
from geomtorsion.materials.crystals.block_shells import BlockShells
from geomtorsion.materials.crystals.frames import NEIGHBOURS
from geomtorsion.materials.crystals.method import METHOD
from geomtorsion.materials.crystals.sorted_atoms import Block, Part
from geomtorsion.materials.crystals.specimen import (
    MOST,
    Specimen,
    few,
    is_lost,
    is_other,
    turned_together,
)
from geomtorsion.materials.crystals.surroundings import Places, Surroundings, nearest_points


@dataclass(frozen=True, eq=False)
class BlockGrains:
    """What of a crystal in blocks does not fit into its frame, block by block; files of its blocks
    are those of its shells."""

    shells: BlockShells

    @property
    def _far(self) -> float:
        """How wide a core is, twice."""
        frame = self.shells.frame
        return 2 * METHOD.width * frame.lattice.nearest * frame.constant

    @cached_property
    def seems_single(self) -> bool:
        """Whether none of a few atoms is turned as others about it are."""
        frame, atoms = self.shells.frame, self.shells.atoms
        chosen = Part.joined(list(atoms.chosen(few(atoms.count)).values()))
        near = Part.joined([part for _, _, part in atoms.near(chosen.places, 2 * self._far)])
        _ = Surroundings(near.places, near.numbers, 0.0).apart
        specimen = Specimen(Places(near.places, atoms.cell, self._far), frame)
        return not turned_together(specimen, np.searchsorted(near.numbers, chosen.numbers))

    def judge(self, block: Block) -> None:
        """Count the atoms of a block that lie in another lattice or orientation, and those that lie
        in a region without any."""
        frame, atoms = self.shells.frame, self.shells.atoms
        deep = self.shells.deep(block)
        found = np.zeros(2, dtype=np.int64)
        if len(deep.numbers):

            def about(places: np.ndarray, distance: float) -> Surroundings:
                part = atoms.close(block, places, distance)
                whole = not atoms.cell.periodic.any() and len(part.numbers) == atoms.count
                return Surroundings(part.places, part.numbers, distance, whole)

            _, vectors = nearest_points(about, deep.places, MOST, self._far)
            near, fits = self.shells.near(deep.places, 3 * self._far, "fits")
            specimen = Specimen(Places(near.places, atoms.cell, self._far), frame)
            rows = np.searchsorted(near.numbers, deep.numbers)
            lost = len(near.numbers) > NEIGHBOURS and is_lost(specimen, rows, vectors, fits).any()
            found[:] = is_other(specimen, vectors).sum(), lost
        write_array(self.shells.file(block, "judged"), found)

    def run(self, workers: int = 1, client: object = None) -> None:
        """Judge all blocks that are not yet judged."""
        left = [k for k in self.shells.atoms.blocks if self._judged(k) is None]
        run_blocks(self.judge, left, workers, client, "blocks for grains")

    def _judged(self, block: Block) -> np.ndarray | None:
        """What was counted in a block, if known."""
        return read_array(self.shells.file(block, "judged"), (2,), np.int64)

    @property
    def is_single(self) -> bool:
        """Whether nothing but one crystal is there, as `specimen.is_single` has it."""
        found = [self._judged(block) for block in self.shells.atoms.blocks]
        if any(row is None for row in found):
            raise self.shells.missing(sum(row is None for row in found))
        others, lost = np.sum([row for row in found if row is not None], axis=0).tolist()
        return not lost and others <= self.shells.frame.lattice.shells
