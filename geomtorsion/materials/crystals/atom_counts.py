"""Atom counts: the numbers of atoms and columns in a file, checked before ase reads it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise

from geomtorsion.errors import FileFormatError
from geomtorsion.support.checks import shown

_WHOLE = re.compile("[+-]?[0-9]+")


def check_declared(name: str, kind: str, rows: list[str]) -> None:
    """Refuse counts that exceed the size of the file, since ase allocates memory for them at once.

    An atom takes a row, and a column takes a word in each row.
    """
    for number, what, words, most in _counts(kind, rows):
        sizes = [abs(int(x)) if len(x) <= 18 else 10**18 for x in words if _WHOLE.fullmatch(x)]
        if sum(sizes) > most:
            raise FileFormatError(
                f"{name}: line {number + 1}: expected at most {most:,} {what}, as many as the file "
                f"can hold, got {shown(' '.join(words))}. Correct the number, or export the file "
                "again."
            )


def _counts(kind: str, rows: list[str]) -> Iterator[tuple[int, str, list[str], int]]:
    """Rows of a table that count the entries after them.

    number of the row from 0, the counted thing, words of the row, largest possible count.
    """
    most = len(rows)
    if kind == "vasp":
        # A row of the fourth version or, below a row of symbols, of the fifth.
        for number in (5, 6):
            words = rows[number].split() if number < most else []
            if words and _WHOLE.fullmatch(words[0]):
                yield number, "atoms", words, most
                return
    elif kind == "vasp-xdatcar":
        for number, (symbols, row) in enumerate(pairwise(map(str.split, rows)), 1):
            if row and symbols and symbols[0][0].isalpha() and _WHOLE.fullmatch(row[0]):
                yield number, "atoms", row, most
                # ase makes a formula of symbols and counts: H9 and 9 are 99 atoms to it.
                for symbol in symbols:
                    yield number - 1, "atoms of one symbol", re.findall("[0-9]+", symbol), most
    elif kind == "eon":
        start = 0
        while start + 7 < most:
            words = rows[start + 7].split()
            yield start + 7, "atoms", words, most
            kinds = [int(x) for x in words if x.isdecimal() and len(x) <= 18]
            # A title of nine rows, two rows a kind, and a row for each atom.
            start += 9 + 2 * len(kinds) + sum(kinds)
    elif kind == "cfg":
        words = sum(len(row.split()) for row in rows)
        atoms = 1
        for number, row in enumerate(rows):
            key, equals, value = row.partition("=")
            key, count = key.strip(), value.split()[:1]
            if equals and key == "Number of particles":
                yield number, "atoms", count, most
                atoms = max(1, int(count[0])) if count and count[0].isdecimal() else atoms
            elif equals and key == "entry_count":
                yield number, "columns", count, max(6, words // atoms)


def check_count_of_gro(name: str, rows: list[str]) -> None:
    """Refuse a GRO file with a wrong number of rows, since ase takes the last row for the cell."""
    count = rows[1].strip() if len(rows) > 1 else ""
    if not count.isdecimal() or len(count) > 18 or len(rows) != int(count) + 3:
        raise FileFormatError(
            f"{name}: line 2: expected the number of atoms, then one row for each atom and one row "
            f"with the cell. Line 2 is {shown(count)}, and {max(len(rows) - 2, 0):,} rows follow. "
            "Is the file complete, and does it hold only one frame?"
        )
