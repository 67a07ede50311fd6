"""Value tables: displacement, strain, distortion or coframe as text, in columns of any program."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

import numpy as np

from geomtorsion.errors import FileFormatError, GridError
from geomtorsion.materials.columns import (
    COMMENTS,
    Names,
    candidates,
    chosen_columns,
    names_from,
    other_reader,
    table_names,
)
from geomtorsion.materials.fields.contents import Contents
from geomtorsion.materials.fields.point_values import PointValues
from geomtorsion.materials.fields.quantities import (
    form_of,
    of_form,
    quantities,
    values_of,
)
from geomtorsion.materials.fields.surfaces import over_two_axes
from geomtorsion.support.checks import cut, shown
from geomtorsion.support.files import BOUNDS, opened, read_text
from geomtorsion.support.npz import LARGEST_ARRAYS
from geomtorsion.support.text_rows import number_table

_DAVIS, _TECPLOT = "#DaVis", "VARIABLES"
_QUOTED = re.compile(r'"([^"]*)"')
# For DaVis and other programs: a third axis adds a third component.
_WIDTHS = {4: 2, 6: 3}


@dataclass(frozen=True)
class _Header:
    """The header of a table: its names, the columns of its quantities, and what they hold."""

    names: Names
    places: Mapping[str, int]
    form: str


def holds_values(path: Path) -> bool:
    """Whether a text file begins like a table of values at points."""
    with opened(path) as file:
        text = file.read(BOUNDS.beginning).decode("utf-8-sig", "replace")
    return _header(text.splitlines()) is not None


def read_values(path: Path, columns: Mapping[str, int | str] | None = None) -> Contents:
    """Read values at the nodes of a grid, in any order; nodes without a row are holes.

    See `read_points` for the columns.

    Raises
    ------
    FileFormatError
        Columns are missing, a row has another length, or the points are not a regular grid.
    """
    return over_two_axes(read_points(path, columns)).gridded(path)


def read_points(path: Path, columns: Mapping[str, int | str] | None = None) -> PointValues:
    """Read values at points, from columns with the names of many programs.

    The columns are named in the first row (x, y, u, v, or other names of these quantities, see
    `quantities`; units in brackets) or in the row VARIABLES of a Tecplot file. Below a row #DaVis
    they are in the order x, y, u, v. They are separated by blanks, tabs, commas or semicolons. A
    point with a negative sigma (the mark of DICe and of VIC for a failed correlation) is a hole.

    columns: name or number, from 0, of the column of a quantity; without names, all of them.

    Raises
    ------
    FileFormatError
        Columns are missing, or a row has another length.
    GridError
        A chosen column is not in the table.
    """
    text = read_text(path, LARGEST_ARRAYS, otherwise="latin-1")
    lines = text.splitlines()
    header = _chosen(path, lines, columns) if columns else _header(lines)
    if header is None:
        raise _without_names(path, lines)
    names = header.names
    line_numbers = [k for k in range(names.row + 1, len(lines)) if _is_row(lines[k].lstrip())]
    if not line_numbers:
        raise FileFormatError(
            f"{path}: expected nodes below the header, got none. Is the file complete?"
        )
    rows = [lines[k] for k in line_numbers]
    if names.split != ",":
        # Some locales write a decimal comma.
        rows = [row.replace(",", ".") for row in rows]
    lines_read = [k + 1 for k in line_numbers]
    keys = list(header.places)
    table, _ = number_table(
        path, lines_read, rows, len(names.words), list(header.places.values()), split=names.split
    )
    by_key = dict(zip(keys, table.T, strict=True))
    units = {key: names.units[k] for key, k in header.places.items()}
    places = {axis: by_key.pop(axis) for axis in "xyz" if axis in by_key}
    failed = by_key.pop("failed", None)
    form, values = values_of(path, header.form, by_key, units)
    if failed is not None:
        values = np.where(failed < 0, np.nan, values)
    vector_unit = next((units[key] for key in "uvw" if key in units), "")
    axis_unit = units[next(iter(places))]
    return PointValues(
        places, values, [f"line {k}" for k in lines_read], axis_unit, vector_unit, form
    )


def _without_names(path: Path, lines: Sequence[str]) -> FileFormatError:
    """The error of a table whose columns have no names."""
    first = next((line for line in lines if line.strip()), "")
    return FileFormatError(
        f"{path}: expected a row of names such as x, y, u, v, or a text file of DaVis, got "
        f"{shown(cut(first.strip(), 80))}. {other_reader(lines, 'SampledFrame.read')}"
        'Name the columns, or give their numbers: columns={"x": 0, "y": 1, "u": 2, "v": 3} '
        "(--columns x=0,y=1,u=2,v=3)."
    )


def _is_row(line: str) -> bool:
    """Whether a line without blanks in front holds values."""
    return bool(line) and not line[0].isalpha() and not line.startswith(COMMENTS)


def refuse_writing(path: Path, contents: Contents) -> NoReturn:
    """Raise an error: these files can only be read."""
    raise GridError(
        f"{path}: expected a format that can be written, got {path.suffix!r}, which is read-only. "
        "Save the data as .npz or .csv."
    )


def _chosen(path: Path, lines: Sequence[str], columns: Mapping[str, int | str]) -> _Header:
    """The header of a table with columns that the user names."""
    names = table_names(path, lines, columns, GridError)
    named, names = chosen_columns(path, names, columns, GridError)
    places = quantities(names) | named
    axes = {key: places[key] for key in "xyz" if key in places}
    if len(axes) < 2:
        raise GridError(
            f"columns: expected the columns of x and y, got {cut(', '.join(named))} for "
            f"{path.name}. Add them."
        )
    # Quantities named by the user decide the form; names in the file add the others.
    form = form_of(axes | named) or form_of(places)
    if form is None:
        raise GridError(
            f"columns: expected columns of a displacement (u, v), of strain and rotation (exx, "
            f"exy, eyy, wxy) or of a coframe, got {cut(', '.join(places))} for {path.name}. Add "
            "them."
        )
    return _Header(names, _of(form, places), form)


def _of(form: str, places: Mapping[str, int]) -> dict[str, int]:
    """The columns that values of this form need."""
    return {
        key: k for key, k in places.items()
        if key in ("x", "y", "z", "failed") or of_form(form, key)
    }  # fmt: skip


def _header(lines: Sequence[str]) -> _Header | None:
    """The header of a table of a field; None for any other table."""
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
        words = ("xyz"[:d], "uvw"[:d])
        names = Names(rows[0], None, tuple("".join(words)), (unit,) * d + (vector,) * d)
        return _Header(names, {word: k for k, word in enumerate(names.words)}, "displacement")
    for k in rows:
        line = lines[k].strip()
        if line.upper().startswith(_TECPLOT):
            words = _QUOTED.findall(line) or line.partition("=")[2].split(",")
            return _named(names_from(k, words, None))
        if not line.startswith(COMMENTS) and not line.upper().startswith("TITLE"):
            break
    for names in candidates(lines):
        header = _named(names)
        if header is not None:
            return header
    return None


def _named(names: Names) -> _Header | None:
    """The header from a row of column names."""
    places = quantities(names)
    form = form_of(places)
    return None if form is None else _Header(names, _of(form, places), form)
