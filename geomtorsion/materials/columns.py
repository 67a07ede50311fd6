"""Columns: the row of names of a table, and the columns that a user names."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from geomtorsion.errors import FileFormatError, GeomtorsionError
from geomtorsion.support import checks
from geomtorsion.support.checks import cut, shown
from geomtorsion.support.files import finite_number

# A unit after a name: x (mm), u [um].
UNIT = re.compile(r"\s*[\[(]\s*([^\])]*)[\])]")
# Signs at the start of a comment.
COMMENTS = ("#", "%", "*", "//", "!")
# Signs between fields; blanks are tried last, because they may surround other signs.
SPLITS = (",", ";", "\t", None)


@dataclass(frozen=True)
class Names:
    """Names of the columns of a table.

    row: number of the row of names, from 0; without names, of the row above the first numbers.
    split: sign between fields, None for blanks. words: the names without units, as written, or
    empty texts. units: in brackets after the names, in lower case.
    """

    row: int
    split: str | None
    words: tuple[str, ...]
    units: tuple[str, ...]

    @property
    def plain(self) -> list[str]:
        """The names in lower case."""
        return [word.lower() for word in self.words]


def names_in(row: int, line: str, split: str | None) -> Names:
    """Names in a line."""
    if split is None:
        # A blank may separate a unit from its name, or the words of a unit.
        line = UNIT.sub(lambda unit: f"({unit[1].replace(' ', '_')})", line)
    return names_from(row, line.split(split), split)


def names_from(row: int, words: Sequence[str], split: str | None) -> Names:
    """Names from the words of a row."""
    clean = [word.strip().strip("\"'").strip() for word in words]
    if split is not None and clean and not clean[-1]:
        # Some programs write a sign after the last name as well.
        clean.pop()
    units = [unit[1].strip() if (unit := UNIT.search(word)) else "" for word in clean]
    return Names(row, split, tuple(UNIT.sub("", word).strip() for word in clean), tuple(units))


def candidates(lines: Sequence[str]) -> Iterator[Names]:
    """Names in each row above the numbers, for each sign that may separate them."""
    for k, line in enumerate(lines):
        row = line.strip().lstrip("".join(COMMENTS)).strip()
        for split in SPLITS:
            if row and (split is None or split in row):
                yield names_in(k, row, split)
        if numbers_in(line) is not None:
            return


def numbers_in(line: str) -> tuple[str | None, int] | None:
    """Separator and number of fields in a row of numbers; None for any other row."""
    if line.lstrip().startswith(COMMENTS):
        return None
    for split in SPLITS:
        fields = [field.strip() for field in line.strip().split(split)]
        if split is not None and fields and not fields[-1]:
            fields.pop()
        if split != ",":
            fields = [field.replace(",", ".") for field in fields]
        if len(fields) > 1 and all(finite_number(field) is not None for field in fields[:2]):
            return split, len(fields)
    return None


def table_names(
    path: Path,
    lines: Sequence[str],
    columns: Mapping[str, int | str],
    error: type[GeomtorsionError],
) -> Names:
    """The row of names that holds the named columns, or the row above the first numbers.

    Raises
    ------
    FileFormatError
        There are no numbers, or a named column is missing.
    """
    first = next(((k, *shape) for k, line in enumerate(lines) if (shape := numbers_in(line))), None)
    if first is None:
        raise FileFormatError(f"{path}: expected rows of numbers, got none. Is this a table?")
    row, split, width = first
    fitting = [names for names in candidates(lines[:row]) if len(names.words) == width]
    wanted = [word for word in columns.values() if isinstance(word, str)]
    for names in fitting:
        if all(_place(names, word) is not None for word in wanted):
            return Names(row - 1, names.split, names.words, names.units)
    if wanted:
        lacking = next(word for word in wanted if not fitting or _place(fitting[-1], word) is None)
        there = f"columns {cut(', '.join(fitting[-1].words))}" if fitting else "no row of names"
        raise error(
            f"columns: expected a column {shown(cut(lacking, 60))} in {path.name}, got {there}. "
            f"Give its name or its number, from 0 to {width - 1}."
        )
    if fitting:
        return Names(row - 1, fitting[-1].split, fitting[-1].words, fitting[-1].units)
    return Names(row - 1, split, ("",) * width, ("",) * width)


def _place(names: Names, word: str) -> int | None:
    """Number of the column of a name, without regard to its unit and, if unique, its case."""
    plain = UNIT.sub("", word).strip()
    if plain in names.words:
        return names.words.index(plain)
    return names.plain.index(plain.lower()) if plain.lower() in names.plain else None


def chosen_columns(
    path: Path, names: Names, columns: Mapping[str, int | str], error: type[GeomtorsionError]
) -> tuple[dict[str, int], Names]:
    """Number of each column that the user names, by its quantity, and the names with its units.

    Raises
    ------
    GeomtorsionError
        There is no such column; the class is `error`.
    """
    width, places, units = len(names.words), {}, list(names.units)
    for key, word in columns.items():
        place = _place(names, word) if isinstance(word, str) else word
        if place is None or not 0 <= place < width:
            raise error(
                f"columns: {key}: expected the name of a column in {path.name} or a number from 0 "
                f"to {width - 1}, got {shown(word)}. The columns are "
                f"{cut(', '.join(filter(None, names.words))) or 'without names'}."
            )
        places[UNIT.sub("", key)] = place
        if unit := UNIT.search(key):
            units[place] = unit[1]
    return places, replace(names, units=tuple(units))


def checked_columns(
    columns: object, meaning: Callable[[str], str | None], error: type[GeomtorsionError], known: str
) -> dict[str, int | str]:
    """Columns by quantity, from a mapping of quantities to names or numbers; empty for None.

    A quantity may have a unit in brackets, such as phi1 (rad).

    meaning: quantity of a word, or None. known: the quantities, for the message.

    Raises
    ------
    GeomtorsionError
        It is not a mapping, a quantity is unknown, or a column is neither a text nor a number.
    """
    checked: dict[str, int | str] = {}
    if columns is None:
        return checked
    for key, value in checks.table(columns, "columns", error).items():
        unit = UNIT.search(key) if isinstance(key, str) else None
        quantity = meaning(UNIT.sub("", key)) if isinstance(key, str) else None
        if quantity is None:
            raise error(
                f"columns: expected a quantity ({known}), got {shown(key)}. Write "
                'columns={"x": 0, "y": "Y [um]"}.'
            )
        if isinstance(value, bool) or not isinstance(value, str | int):
            raise error(
                f"columns: {key}: expected the name of a column or its number from 0, got "
                f"{shown(value)}."
            )
        checked[quantity if unit is None else f"{quantity} ({unit[1]})"] = value
    return checked


# Readers of tables, and names of columns that belong to only one of them.
_READERS = (
    (
        "an orientation map", "OrientationMap.read",
        ("phi1", "phi_1", "φ1", "euler1", "euler 1", "euler angle 1", "e1"),
    ),
    (
        "a field", "SampledFrame.read or ScatteredFrame.read",
        ("u", "ux", "u_x", "disp_x", "displacement_x", "e_0_0", "beta_0_0", "exx", "strain_xx"),
    ),
)  # fmt: skip


def other_reader(lines: Sequence[str], own: str) -> str:
    """A sentence that names the reader of a table, by its columns; empty for the own reader."""
    for names in candidates(lines):
        for what, reader, words in _READERS:
            if own not in reader and set(words) & set(names.plain):
                return f"These columns belong to {what}: use {reader}. "
    return ""
