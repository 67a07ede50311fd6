"""Torn faces: those that carry torsion, told by the atoms about them wherever they are found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geomtorsion.materials.crystals.torsion import Torsion
from geomtorsion.materials.crystals.triangulation import distinct

# Columns of a table: of a face the first two edges, of the tetrahedra at its sides their atoms with
# their images, and centres; of the second side its image for the first; torsion.
_PARTS = (10, 16, 16, 3, 3, 3, 3)
_KEY, _FIRST, _SECOND, _CENTRE, _OTHER, _IMAGE, _VALUE = (
    slice(sum(_PARTS[:k]), sum(_PARTS[: k + 1])) for k in range(len(_PARTS))
)
COLUMNS = sum(_PARTS)


@dataclass(frozen=True, eq=False)
class TornFaces:
    """Faces with torsion, in the order of their atoms.

    cells: the tetrahedra at both sides, 4 atoms and 12 images, -1 where there is none, (n, 2, 16).
    centres: of these, shape (n, 2, 3). images: of the second for the first in its place, (n, 3).
    values: torsion, whole numbers, shape (n, 3).
    """

    table: np.ndarray

    @property
    def cells(self) -> np.ndarray:
        """The tetrahedra."""
        return np.stack([self.table[:, _FIRST], self.table[:, _SECOND]], axis=1)

    @property
    def centres(self) -> np.ndarray:
        """Their centres of gravity."""
        return np.stack([self.table[:, part].view(float) for part in (_CENTRE, _OTHER)], axis=1)

    @property
    def images(self) -> np.ndarray:
        """Images of second tetrahedra."""
        return self.table[:, _IMAGE]

    @property
    def values(self) -> np.ndarray:
        """Torsion of each face."""
        return self.table[:, _VALUE]

    @classmethod
    def of(
        cls, torsion: Torsion, numbers: np.ndarray, cells: np.ndarray | None = None
    ) -> TornFaces:
        """Those of a torsion on atoms with these numbers, increasing; cells: tetrahedra to which
        they should belong, shape (cells,), all if not given."""
        mesh = torsion.mesh
        rows, sides, images = mesh.faces
        pairs, moved, _ = mesh.edges
        values = torsion.values
        there = sides >= 0
        if cells is not None:
            there &= cells[sides]
        chosen = np.flatnonzero(values.any(axis=1) & there.any(axis=1))
        table = np.zeros((len(chosen), COLUMNS), dtype=np.int64)
        ends = [
            np.column_stack([numbers[pairs[rows[chosen, k]]], moved[rows[chosen, k]]])
            for k in (0, 1)
        ]
        table[:, _KEY] = np.column_stack(ends)
        for side, part, centre in ((0, _FIRST, _CENTRE), (1, _SECOND, _OTHER)):
            cell = sides[chosen, side]
            corners = numbers[mesh.corners[cell]]
            found = np.column_stack([corners, mesh.offsets[cell].reshape(-1, 12)])
            table[:, part] = np.where(cell[:, None] < 0, -1, found)
            table[:, centre] = np.ascontiguousarray(mesh.centres[cell]).view(np.int64)
        table[:, _IMAGE], table[:, _VALUE] = images[chosen], values[chosen]
        return cls(table)

    @classmethod
    def joined(cls, tables: Sequence[np.ndarray]) -> TornFaces:
        """Those of several tables, each face once."""
        table = np.concatenate([np.zeros((0, COLUMNS), dtype=np.int64), *tables])
        return cls(table[distinct(table[:, _KEY].T)[0]])
