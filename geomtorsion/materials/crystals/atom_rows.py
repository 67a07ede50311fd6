"""Atom rows: atoms of one frame of a file, and numbers in the rows of its text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from geomtorsion.errors import FileFormatError
from geomtorsion.support import checks
from geomtorsion.support.checks import cut, shown


@dataclass(frozen=True, eq=False)
class AtomData:
    """Atoms of one frame of a file.

    positions: shape (atoms, 3), in the unit of the file (ase: angstrom).
    cell: edges as rows, shape (3, 3), or None if there is none.
    periodic: along which edges it repeats. species: chemical symbols, or numbers of types as text;
        None where the file has none.
    where: the file and frame.
    """

    positions: np.ndarray
    cell: np.ndarray | None
    periodic: tuple[bool, bool, bool]
    species: tuple[str, ...] | None
    where: str

    def chosen(self, species: Sequence[str] | None) -> AtomData:
        """Only the atoms of some species; all atoms without any species.

        Raises
        ------
        FileFormatError
            The file has no species, or none of this name.
        """
        if species is None:
            return self
        present = sorted(set(self.species or ()))
        for name in species:
            if name not in present:
                choices = cut(", ".join(present)) or "it has none"
                raise FileFormatError(
                    f"{self.where}: species: expected species of the file ({choices}), got "
                    f"{shown(name)}. Name one of these, or omit species for all atoms."
                )
        names = self.species or ()
        rows = np.flatnonzero(np.isin(np.array(names), list(species)))
        return replace(
            self, positions=self.positions[rows], species=tuple(names[k] for k in rows.tolist())
        )


def check_number(name: str, line: int, word: str) -> None:
    """Refuse words that only Python accepts as a number, such as 1_8 for 18."""
    if (not word.isascii() or "_" in word) and is_number(word):
        raise FileFormatError(
            f"{name}: line {line}: expected a number in plain digits, got {shown(word)}, which "
            f"would be read as {float(word):g}. Correct it, or export the file again."
        )


def is_number(word: str) -> bool:
    """Whether Python accepts a word as a number."""
    try:
        float(word)
    except ValueError:
        return False
    return True


def completed(where: str, edges: np.ndarray) -> np.ndarray | None:
    """Edges of a cell, with unit vectors across the others for zero edges; None without any.

    where: the file, for messages.

    Examples
    --------
    >>> abs(completed("a.xyz", np.array([[2.0, 0, 0], [0, 3, 0], [0, 0, 0]]))[2]).tolist()
    [0.0, 0.0, 1.0]
    """
    checks.array(edges, f"{where}: cell", FileFormatError)
    there = edges.any(axis=1)
    for k, edge in enumerate(edges):
        checks.measured(edge, f"{where}: cell[{k}]", FileFormatError, is_length=True)
    if not there.any():
        return None
    vectors = edges.copy()
    vectors[~there] = np.linalg.svd(edges[there])[2][int(there.sum()) :]
    return vectors
