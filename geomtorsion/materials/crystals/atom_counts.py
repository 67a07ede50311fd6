"""Atom counts: atoms and columns that a file says it has, checked before ase reads it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise

from geomtorsion.checks import shown
from geomtorsion.errors import FileFormatError

_WHOLE = re.compile("[+-]?[0-9]+")


def check_declared(name: str, kind: str, rows: list[str]) -> None:
    """Refuse counts above what the file has room for, since ase takes memory for them at once.

    An atom takes a row, and a column takes a word in each row.
    """
    for number, what, words, most in _counts(kind, rows):
        sizes = [abs(int(x)) if len(x) <= 18 else 10**18 for x in words if _WHOLE.fullmatch(x)]
        if sum(sizes) > most:
            raise FileFormatError(
                f"{name}: line {number + 1}: expected at most {most:,} {what}, for which the file "
                f"has room, got {shown(' '.join(words))}. Correct the number, or export the file "
                "again."
            )


def _counts(kind: str, rows: list[str]) -> Iterator[tuple[int, str, list[str], int]]:
    """Rows of a table that say how many things follow.

    number of the row from 0, what is counted, words of the row, most that there can be.
    """
    most = len(rows)
    if kind == "vasp":
        # Of the fourth version, or, below a row of symbols, of the fifth.
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
            key, equals, said = row.partition("=")
            key, count = key.strip(), said.split()[:1]
            if equals and key == "Number of particles":
                yield number, "atoms", count, most
                atoms = max(1, int(count[0])) if count and count[0].isdecimal() else atoms
            elif equals and key == "entry_count":
                yield number, "columns", count, max(6, words // atoms)
    elif kind == "lammps-data":
        for number, row in enumerate(rows):
            words = row.split()
            if words[1:2] == ["atoms"]:
                yield number, "atoms", words[:1], most


def check_columns(name: str, line: int, rows: list[str]) -> None:
    """Refuse an extended XYZ frame that names more columns than its rows have words."""
    try:
        # An extra: whoever reads such a file has it.
        from ase.io.extxyz import key_val_str_to_dict

        said = key_val_str_to_dict(rows[1].strip()).get("Properties")
    except (ValueError, TypeError, RecursionError):
        # ase will refuse it in its own words.
        return
    counts = said.split(":")[2::3] if isinstance(said, str) else []
    wanted = sum(int(x) if len(x) <= 18 else 10**18 for x in counts if x.isdecimal())
    most = max((len(row.split()) for row in rows[2:]), default=0)
    if wanted > most:
        raise FileFormatError(
            f"{name}: line {line + 1}: expected Properties of at most {most:,} columns, as many as "
            f"the rows have words, got {wanted:,}. Correct the line, or export the file again."
        )


def check_count_of_data(name: str, rows: list[str]) -> None:
    """Refuse a LAMMPS data file with more or fewer atoms than it says: ase drops the others."""
    told = [row.partition("#")[0].split() for row in rows]
    said = next((words for words in told[1:] if words[1:] == ["atoms"]), ["none"])
    start = next((k for k, words in enumerate(told) if words == ["Atoms"]), None)
    if start is None or not said[0].isdecimal():
        raise FileFormatError(
            f"{name}: the number of atoms and a section Atoms were needed, but one of them is "
            "missing. Is the file complete?"
        )
    # Rows of atoms begin with a number, other sections with a word.
    after = (k for k, words in enumerate(told) if k > start and words and words[0][0].isalpha())
    count = sum(bool(words) for words in told[start + 1 : next(after, len(told))])
    if count != int(said[0]):
        raise FileFormatError(
            f"{name}: line {start + 1}: {said[0]} atoms were said to come, but {count:,} rows "
            "follow. Correct the number, or export the file again."
        )


def check_count_of_gro(name: str, rows: list[str]) -> None:
    """Refuse a GRO file that has not as many rows as it says: ase takes the last for the cell."""
    said = rows[1].strip() if len(rows) > 1 else ""
    if not said.isdecimal() or len(said) > 18 or len(rows) != int(said) + 3:
        raise FileFormatError(
            f"{name}: line 2: the number of atoms, so many rows, and one with the cell were "
            f"needed, but {shown(said)} and {max(len(rows) - 2, 0):,} rows came. Is it complete, "
            "and of one frame?"
        )
