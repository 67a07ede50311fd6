"""Atom rows: atoms of one frame of a file, and numbers in the rows of its text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from geomtorsion.checks import cut, shown
from geomtorsion.errors import FileFormatError


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


def words_of(name: str, lines: Sequence[int], rows: Sequence[str], width: int) -> list[list[str]]:
    """The words of rows of one width; lines: the number of each row in the file."""
    table = [row.split() for row in rows]
    odd = next((k for k, words in enumerate(table) if len(words) != width), None)
    if odd is not None:
        raise FileFormatError(
            f"{name}: line {lines[odd]}: expected {width} columns as in the other rows, got "
            f"{shown(rows[odd].strip())}. Is the file complete?"
        )
    return table


def numbers_of(
    name: str, lines: Sequence[int], words: Sequence[Sequence[str]], columns: Sequence[int]
) -> np.ndarray:
    """The numbers in some columns of rows, shape (rows, columns)."""
    texts = [row[k] for row in words for k in columns]
    text = "".join(texts)
    if text.isascii() and "_" not in text:
        try:
            return np.fromiter(map(float, texts), float, len(texts)).reshape(-1, len(columns))
        except ValueError:
            pass
    for number, row in zip(lines, words, strict=False):
        for k in columns:
            if not is_number(row[k]):
                raise FileFormatError(
                    f"{name}: line {number}: expected a number in column {k + 1} as in the other "
                    f"rows, got {shown(' '.join(row))}. Is the file complete?"
                )
            check_number(name, number, row[k])
    return np.array(texts, dtype=float).reshape(-1, len(columns))


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


def completed(edges: np.ndarray) -> np.ndarray | None:
    """Edges of a cell, with unit vectors across the others for zero edges; None without any.

    Examples
    --------
    >>> abs(completed(np.array([[2.0, 0, 0], [0, 3, 0], [0, 0, 0]]))[2]).tolist()
    [0.0, 0.0, 1.0]
    """
    there = edges.any(axis=1)
    if not there.any():
        return None
    vectors = edges.copy()
    vectors[~there] = np.linalg.svd(edges[there])[2][int(there.sum()) :]
    return vectors
