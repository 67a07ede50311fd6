"""Torn faces: faces that carry torsion, and the tetrahedra at both sides of each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geomtorsion.materials.crystals.torsion import Torsion


@dataclass(frozen=True, eq=False)
class TornFaces:
    """Faces with torsion, in the order of their atoms.

    cells: the tetrahedra at both sides, 4 atoms and 12 images, -1 where there is none, (n, 2, 16).
    centres: of these, shape (n, 2, 3). images: of the second relative to the first, (n, 3).
    values: torsion, whole numbers, shape (n, 3).
    """

    cells: np.ndarray
    centres: np.ndarray
    images: np.ndarray
    values: np.ndarray

    @classmethod
    def of(cls, torsion: Torsion, numbers: np.ndarray) -> TornFaces:
        """Torn faces of a torsion on atoms with these numbers, increasing."""
        mesh, values = torsion.mesh, torsion.values
        _, sides, images = mesh.faces
        torn = np.flatnonzero(values.any(axis=1) & (sides >= 0).any(axis=1))
        cells = sides[torn]
        offsets = mesh.offsets[cells].reshape(len(torn), 2, 12)
        there = np.concatenate([numbers[mesh.corners[cells]], offsets], axis=2)
        return cls(
            np.where(cells[..., None] < 0, -1, there), mesh.centres[cells], images[torn],
            values[torn],
        )  # fmt: skip
