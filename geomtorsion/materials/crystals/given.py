"""Given: cell and orientation of a crystal, as far as the user gives them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from geomtorsion.errors import CrystalError
from geomtorsion.materials.crystals.lattices import lattice_named
from geomtorsion.materials.crystals.triangulation import Cell
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

POSITIONS = "positions"


@dataclass(frozen=True, eq=False)
class Given:
    """Cell and frame of a crystal, None for parts that are to be found.

    cell: edges as rows, shape (3, 3). periodic: along which it repeats, shape (3,).
    lattice, orient, constant: as of a `Crystal`.
    """

    cell: np.ndarray | None
    periodic: np.ndarray
    lattice: str | None
    orient: np.ndarray | None
    constant: float | None

    @classmethod
    def of(
        cls,
        cell: ArrayLike | None,
        periodic: Sequence[bool],
        lattice: str | None,
        orient: ArrayLike | None,
        constant: float | None,
    ) -> Given:
        """The checked input; errors name the expected values."""
        edges = None if cell is None else _cell(cell)
        remedy = "Give one for each edge of the cell."
        flags = checks.flags(periodic, 3, "periodic", CrystalError, remedy=remedy)
        wraps = np.array(flags, dtype=bool) & (cell is not None)
        if lattice is not None:
            lattice_named(lattice)
        return cls(edges, wraps, lattice, _rotation(orient), _constant(constant))

    @cached_property
    def box(self) -> Cell:
        """The cell, or an arbitrary one where nothing is periodic."""
        vectors = np.eye(3) if self.cell is None else self.cell
        return Cell(vectors, self.periodic)


def positions_of(given: object) -> np.ndarray:
    """Positions of atoms, shape (atoms, 3), checked to span a finite volume."""
    positions = checks.array(given, POSITIONS, CrystalError, shape=(None, 3))
    return checks.measured(positions, POSITIONS, CrystalError)


def _cell(given: ArrayLike) -> np.ndarray:
    """Edges of the cell as rows."""
    edges = checks.array(given, "cell", CrystalError)
    if edges.shape == (3,):
        edges = np.diag(edges)
    if edges.shape != (3, 3):
        raise CrystalError(
            f"cell: expected three edges as rows, shape (3, 3), got shape {edges.shape}. Give "
            "them, or three lengths of perpendicular edges."
        )
    for k, edge in enumerate(edges):
        checks.measured(edge, f"cell[{k}]", CrystalError, is_length=True)
    volume = abs(np.linalg.det(edges))
    if not volume > 8 * np.finfo(float).eps * np.prod(np.linalg.norm(edges, axis=1)):
        raise CrystalError(
            f"cell: expected three edges that span a volume, got {checks.shown(edges.tolist())}. "
            "Give an edge also where nothing repeats, or omit the cell of an open crystal."
        )
    return edges


def _rotation(given: ArrayLike | None) -> np.ndarray | None:
    """A rotation, corrected to the last digit."""
    if given is None:
        return None
    matrix = checks.array(given, "orient", CrystalError, shape=(3, 3))
    u, sizes, v = np.linalg.svd(matrix)
    if np.abs(sizes - 1).max() > 1e-3 or np.linalg.det(matrix) < 0:
        raise CrystalError(
            f"orient: expected a rotation, got {checks.shown(matrix.tolist())}. Give the crystal "
            "axes in the specimen as rows: of length one, perpendicular and right-handed."
        )
    nearest = u @ v
    # A rotation up to rounding stays unchanged, frame by frame of a trajectory.
    if np.abs(nearest - matrix).max() < 16 * np.finfo(float).eps:
        return matrix
    return nearest


def _constant(given: float | None) -> float | None:
    """A length."""
    if given is None:
        return None
    size = checks.positive(given, "constant", CrystalError)
    return checks.measured(size, "constant", CrystalError, is_length=True)
