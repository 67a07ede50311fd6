"""Displacement tables: displacements as text, with columns x, y, u, v, or written by DaVis."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

import numpy as np

from geomtorsion.errors import FileFormatError, GridError
from geomtorsion.materials.fields.contents import Contents
from geomtorsion.materials.fields.displaced_points import (
    AXES,
    COMPONENTS,
    FAILED,
    DisplacedPoints,
)
from geomtorsion.support.checks import cut, shown
from geomtorsion.support.files import BOUNDS, opened, read_text
from geomtorsion.support.npz import LARGEST_ARRAYS
from geomtorsion.support.text_rows import number_table

_DAVIS, _TECPLOT = "#DaVis", "VARIABLES"
# A unit after a name: x (mm), u [um].
_UNIT = re.compile(r"\s*[\[(]\s*([^\])]*)[\])]")
_QUOTED = re.compile(r'"([^"]*)"')
# For DaVis and other programs: a third axis adds a third component.
_WIDTHS = {4: 2, 6: 3}


@dataclass(frozen=True)
class _Header:
    """The header of a table.

    row: number of the row of names, from 0. split: separator of columns, None for blanks.
    axes: columns of the coordinates. components: columns of the displacement. failed: columns that
    are negative where the displacement is not known. unit, vector_unit: of coordinates and
    displacement.
    """

    row: int
    split: str | None
    axes: tuple[int, ...]
    components: tuple[int, ...]
    width: int
    unit: str = ""
    vector_unit: str = ""
    failed: tuple[int, ...] = ()


def holds_displacement(path: Path) -> bool:
    """Whether a text file begins like a table of displacements."""
    with opened(path) as file:
        text = file.read(BOUNDS.beginning).decode("utf-8-sig", "replace")
    return _header(text.splitlines()) is not None


def read_displacement(path: Path) -> Contents:
    """Read displacements at the nodes of a grid, in any order; nodes without a row are holes.

    See `read_points` for the columns.

    Raises
    ------
    FileFormatError
        Columns are missing, a row has another length, or the points are not a regular grid.
    """
    return read_points(path).gridded(path)


def read_points(path: Path) -> DisplacedPoints:
    """Read displacements at points, from columns with the names of many programs.

    The columns are named in the first row (x, y, u, v, or the names in `column_names`; units in
    brackets) or in the row VARIABLES of a Tecplot file. Below a row #DaVis they are in the order x,
    y, u, v. They are separated by blanks, tabs, commas or semicolons. A point with a negative sigma
    (the mark of DICe and of VIC for a failed correlation) is a hole.

    Raises
    ------
    FileFormatError
        Columns are missing, or a row has another length.
    """
    text = read_text(path, LARGEST_ARRAYS, otherwise="latin-1")
    lines = text.splitlines()
    header = _header(lines)
    if header is None:
        first = next((line for line in lines if line.strip()), "")
        raise FileFormatError(
            f"{path}: expected a row of names such as x, y, u, v, or a text file of DaVis, got "
            f"{shown(cut(first.strip(), 80))}. Name the columns, or save arrays as .npz."
        )
    line_numbers = [
        k for k in range(header.row + 1, len(lines))
        if lines[k].strip() and not lines[k].lstrip()[:1].isalpha() and lines[k].lstrip()[0] != "#"
    ]  # fmt: skip
    if not line_numbers:
        raise FileFormatError(
            f"{path}: expected nodes below the header, got none. Is the file complete?"
        )
    rows = [lines[k] for k in line_numbers]
    if header.split != ",":
        # Some locales write a decimal comma.
        rows = [row.replace(",", ".") for row in rows]
    lines_read = [k + 1 for k in line_numbers]
    table, _ = number_table(path, lines_read, rows, header.width, split=header.split)
    values = table[:, list(header.components)].T.copy()
    for column in header.failed:
        values[:, table[:, column] < 0] = np.nan
    names = ("x", "y", "z")[: len(header.axes)]
    return DisplacedPoints(
        {name: table[:, k] for name, k in zip(names, header.axes, strict=True)},
        values,
        [f"line {k}" for k in lines_read],
        header.unit,
        header.vector_unit,
    )


def refuse_writing(path: Path, contents: Contents) -> NoReturn:
    """Raise an error: these files can only be read."""
    raise GridError(
        f"{path}: expected a format that can be written, got {path.suffix!r}, which is read-only. "
        "Save the data as .npz or .csv."
    )


def _header(lines: Sequence[str]) -> _Header | None:
    """The header of a table of displacements; None for any other table."""
    rows = [k for k, line in enumerate(lines) if line.strip()]
    if not rows:
        return None
    first = lines[rows[0]].strip()
    if first.startswith(_DAVIS):
        body = lines[rows[1]].split() if len(rows) > 1 else ["", "", "", ""]
        d = _WIDTHS.get(len(body))
        units = _QUOTED.findall(first)[1::2]
        if d is None:
            return None
        unit, vector = (units[k] if len(units) > k else "" for k in (0, 2))
        axes, components = tuple(range(d)), tuple(range(d, 2 * d))
        return _Header(rows[0], None, axes, components, 2 * d, unit, vector)
    for k in rows:
        line = lines[k].strip()
        if line.upper().startswith(_TECPLOT):
            return _named(k, _QUOTED.findall(line) or line.partition("=")[2].split(","), None)
        if line.upper().startswith("TITLE") or line.startswith(("#", "%", "*")):
            continue
        split = next((mark for mark in (",", ";", "\t") if mark in line), None)
        if split is None:
            line = re.sub(r"\s+([\[(])", r"\1", line)
        return _named(k, line.split(split), split)
    return None


def _named(row: int, words: Sequence[str], split: str | None) -> _Header | None:
    """The header from a row of column names."""
    clean = [word.strip().strip("\"'") for word in words]
    plain = [_UNIT.sub("", word).strip().lower() for word in clean]
    axes, columns = (
        [next((plain.index(n) for n in names if n in plain), -1) for names in table]
        for table in (AXES, COMPONENTS)
    )
    axes = tuple(k for k in axes if k >= 0)
    components = tuple(k for k in columns if k >= 0)
    if len(axes) < 2 or len(components) < 2 or set(plain[:1]) == {"e_0_0"}:
        return None
    units = [unit[1].strip() if (unit := _UNIT.search(word)) else "" for word in clean]
    failed = tuple(k for k, name in enumerate(plain) if name in FAILED)
    return _Header(
        row, split, axes, components, len(clean), units[axes[0]], units[components[0]], failed
    )
