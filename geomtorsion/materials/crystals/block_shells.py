"""Block shells: which atoms of a crystal in blocks need tetrahedra, block by block in a folder."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion.errors import CheckpointError
from geomtorsion.materials.blocks import read_array, write_array
from geomtorsion.materials.crystals.frames import Frame
from geomtorsion.materials.crystals.near_torsion import Atoms
from geomtorsion.materials.crystals.shells import dilated, reach_of_shells, shells_of
from geomtorsion.materials.crystals.sorted_atoms import Block, Part, SortedAtoms
from geomtorsion.materials.crystals.surroundings import Places
from geomtorsion.materials.crystals.triangulation import Cell

# Steps from neighbour to neighbour on which it depends whether an atom needs tetrahedra.
STEPS = (
    "to a neighbour that is open",
    "to a vacancy that leans on it",
    "to a neighbour in a triangle",
    "to the next one in this triangle",
    "to a vacancy beside it",
    "to an atom that sees this vacancy, or another one beside it",
    "to an atom that sees that other one",
    "to the neighbours of this atom",
)


def file_of(folder: str, block: Block, what: str) -> Path:
    """What is kept of a block."""
    return Path(folder, f"block-{'_'.join(map(str, block))}-{what}.npy")


def missing(folder: str, count: int, total: int) -> CheckpointError:
    """The error where blocks are not there."""
    return CheckpointError(
        f"{folder}: {count} of {total} blocks are missing. Call blocked_crystal again: it goes on "
        "where it ended."
    )


@dataclass(frozen=True, eq=False)
class BlockShells:
    """Atoms in blocks, all read in one frame, and what their neighbours tell of each.

    folder: of the files. atoms: sorted, on disk. frame: how they lie.
    """

    folder: str
    atoms: SortedAtoms
    frame: Frame

    def file(self, block: Block, what: str) -> Path:
        """What is kept of a block."""
        return file_of(self.folder, block, what)

    def missing(self, count: int) -> CheckpointError:
        """The error where blocks are not there."""
        return missing(self.folder, count, len(self.atoms.blocks))

    def compute(self, block: Block) -> None:
        """Find the atoms of a block whose neighbours do not exclude torsion, and those beside."""
        reach = reach_of_shells(self.frame)
        part, own = self.atoms.around(block, len(STEPS) * reach)
        open_box = Cell(np.eye(3), np.zeros(3, dtype=bool))
        shells = shells_of(Places(part.places, open_box, reach), self.frame)
        if self.frame.lattice.basis:
            write_array(self.file(block, "kinds"), shells.kind[own].astype(np.int8))
        fits = np.all(shells.near >= 0, axis=1)
        write_array(self.file(block, "fits"), fits[own])
        write_array(self.file(block, "deep"), ~dilated(fits, shells.near)[own])
        # Each vacancy belongs to one block, that of the first atom beside it.
        filled = int(own[shells.vacancies].sum())
        write_array(self.file(block, "vacancies"), np.array([filled], dtype=np.int64))
        write_array(self.file(block, "open"), dilated(~shells.closed, shells.near)[own])

    def kept(self, block: Block) -> np.ndarray | None:
        """Which atoms of a block need tetrahedra, if known."""
        return read_array(self.file(block, "open"), (None,), bool)

    def _known(self, block: Block, what: str, kind: type, rows: Any) -> np.ndarray:
        """Rows of what is kept of a block."""
        found = read_array(self.file(block, what), (None,), kind)
        if found is None:
            raise self.missing(1)
        return np.array(found[rows])

    def wanted(self, block: Block) -> np.ndarray:
        """Which atoms of a block need tetrahedra, shape (atoms,)."""
        return self._known(block, "open", bool, slice(None))

    def deep(self, block: Block) -> Part:
        """The atoms of a block that do not fit into the frame, and neither do their neighbours."""
        return self.atoms.inside(block)[self._known(block, "deep", bool, slice(None))]

    def near(
        self, places: np.ndarray, distance: float, what: str = "open"
    ) -> tuple[Atoms, np.ndarray]:
        """All atoms as near to some places as a distance, and which of them need tetrahedra; or
        "fits": which have all their neighbours where the lattice has them."""
        none = np.zeros(0, dtype=np.int64)
        parts, kinds, wanted = [], [none], [none.astype(bool)]
        for block, rows, part in self.atoms.near(places, distance):
            parts.append(part)
            wanted.append(self._known(block, what, bool, rows))
            if self.frame.lattice.basis:
                kinds.append(self._known(block, "kinds", np.int8, rows).astype(np.int64))
            else:
                kinds.append(np.zeros(len(rows), dtype=np.int64))
        whole = Part.stacked(parts)
        order = np.argsort(whole.numbers)
        atoms = Atoms(whole.numbers[order], whole.places[order], np.concatenate(kinds)[order])
        return atoms, np.concatenate(wanted)[order]

    @property
    def vacancies(self) -> int:
        """How many single vacancies there are."""
        return sum(
            int(self._known(k, "vacancies", np.int64, slice(None))[0]) for k in self.atoms.blocks
        )
