"""Map tables: orientation maps as text with named columns, such as phi1, Phi, phi2, phase, x, y."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from geomtorsion.errors import FileFormatError, OrientationError
from geomtorsion.materials.columns import (
    Names,
    candidates,
    chosen_columns,
    other_reader,
    table_names,
)
from geomtorsion.materials.maps.map_phases import check_laue, described
from geomtorsion.materials.maps.map_points import MapFile, MapPoints, gridded
from geomtorsion.support import checks
from geomtorsion.support.checks import LARGEST_ARRAYS, cut, shown
from geomtorsion.support.files import BOUNDS, finite_number, read_text
from geomtorsion.support.text_rows import lines_of, number_table

# Name of a column in other programs, in lower case without units -> its quantity.
_NAMES = {
    **dict.fromkeys(
        ("phi1", "phi_1", "phi 1", "φ1", "euler1", "euler 1", "euler_1", "euler angle 1", "e1",
         "euler phi1", "eulerphi1", "ea1"), "phi1"),
    **dict.fromkeys(
        ("phi", "φ", "ϕ", "euler2", "euler 2", "euler_2", "euler angle 2", "e2", "euler phi",
         "eulerphi", "ea2"), "Phi"),
    **dict.fromkeys(
        ("phi2", "phi_2", "phi 2", "φ2", "euler3", "euler 3", "euler_3", "euler angle 3", "e3",
         "euler phi2", "eulerphi2", "ea3"), "phi2"),
    **dict.fromkeys(
        ("phase", "phaseid", "phase_id", "phase id", "phaseindex", "phase index"), "phase"),
    **dict.fromkeys(("euler", "euler angles", "eulerangles"), "euler"),
    **dict.fromkeys(("x", "x position", "x_position", "xpos", "x_pos"), "x"),
    **dict.fromkeys(("y", "y position", "y_position", "ypos", "y_pos"), "y"),
}  # fmt: skip
_NEEDED = ("phi1", "Phi", "phi2", "x", "y")
QUANTITIES = "phi1, Phi, phi2, x, y, phase; euler for all three angles in HDF5"


def map_quantity(word: str) -> str | None:
    """The quantity in a column of this name, or None.

    Examples
    --------
    >>> map_quantity("Euler2"), map_quantity("PhaseID"), map_quantity("MAD")
    ('Phi', 'phase', None)
    """
    return _NAMES.get(word.strip().lower())


def seems_table(content: bytes) -> bool:
    """Whether the first row after the comments, or the last comment, names the columns."""
    text = content.removeprefix(b"\xef\xbb\xbf").decode("utf-8", "replace")
    return _header(text.splitlines()) is not None


def read_map_table(
    path: Path,
    given: Mapping[int, str] | None = None,
    columns: Mapping[str, int | str] | None = None,
) -> MapFile:
    """Read a table with a row of column names, in any order; unknown columns are ignored.

    The names are in the first row, or in the last row of comments (#, %), separated by blanks,
    tabs, commas or semicolons. Angles are in degrees, unless a name has the unit (rad); positions
    are in um. Without a phase column, or if all phases are 0, all points have phase 1. A table
    contains no symmetry: give `laue`.

    columns: name or number, from 0, of the column of a quantity; without names, all of them.

    Raises
    ------
    FileFormatError
        A column is missing, a row has another length, or the symmetry of a phase is not given.
    OrientationError
        A chosen column is not in the table.
    """
    laue = checks.table(given, "laue", FileFormatError)
    text = read_text(path, LARGEST_ARRAYS, otherwise="latin-1")
    lines = lines_of(text)
    header = _chosen(path, lines, columns) if columns else _header(lines)
    if header is None:
        first = next((line for line in lines if line.strip()), "")
        raise FileFormatError(
            f"{path.name}: expected a row of names {', '.join(_NEEDED)} and phase, got "
            f"{shown(cut(first.strip(), 80))}. {other_reader(lines, 'OrientationMap.read')}Write "
            'these names above their columns, or give their numbers: columns={"phi1": 0, ...} '
            "(--columns phi1=0,...)."
        )
    indices = [k for k in range(header.row + 1, len(lines)) if lines[k].strip(" \t,;")]
    rows = [lines[k] for k in indices]
    places = header.places
    words = [places[name] for name in ("phase",) if name in places]
    table, phase_texts = number_table(
        path.name, [k + 1 for k in indices], rows, header.width, [places[n] for n in _NEEDED],
        words, split=header.split,
    )  # fmt: skip
    by_name = dict(zip(_NEEDED, table.T, strict=True))
    euler = np.stack([by_name[name] for name in ("phi1", "Phi", "phi2")], axis=1)
    indexed = np.asarray(np.isfinite(euler).all(axis=1))
    euler = np.where(indexed[:, None], euler if header.is_radian else np.radians(euler), 0.0)
    far = (np.abs(euler) > 4 * np.pi + 1e-3).any(axis=1)
    if far.any():
        k = indices[int(np.argmax(far))]
        unit = "radians (declared in the header)" if header.is_radian else "degrees"
        raise FileFormatError(
            f"{path.name}: line {k + 1}: expected Euler angles of at most two turns in {unit}, got "
            f"{shown(lines[k].strip())}. Correct the header or the row."
        )
    phase = _phases(path.name, phase_texts, indexed)
    numbers = sorted(set(phase.tolist()) - {0})
    phases = {n: described(path.name, n, f"phase {n}", None, laue) for n in numbers}
    check_laue(path.name, laue, phases)
    x, y = by_name["x"], by_name["y"]
    bad = ~(np.isfinite(x) & np.isfinite(y))
    if bad.any():
        k = indices[int(np.argmax(bad))]
        raise FileFormatError(
            f"{path.name}: line {k + 1}: expected numbers x and y, got "
            f"{shown(lines[k].strip())}. Correct the row."
        )
    return gridded(
        MapPoints(
            path.name, len(text), x, y, euler, phase, phases,
            start=indices[0] + 1 if indices else None,
        )
    )  # fmt: skip


def _phases(name: str, texts: Sequence[Sequence[str]], indexed: np.ndarray) -> np.ndarray:
    """Phase of each point, shape (points,); 0 where a point was not indexed.

    texts: the column of the phase, if there is one.
    """
    if not texts:
        return indexed.astype(np.int64)
    # A word, such as the name of a phase, gives no number.
    codes = {text: finite_number(text.strip()) or 0.0 for text in set(texts[0])}
    phase = np.where(indexed, [codes[text] for text in texts[0]], 0.0)
    if not phase.any():
        # MTEX writes phase 0 for each point of a map without phases.
        return indexed.astype(np.int64)
    odd = [x for x in sorted({*phase.tolist()}) if x != int(x) or not 0 <= x <= BOUNDS.phases]
    if odd:
        raise FileFormatError(
            f"{name}: phase: expected whole numbers from 0 to {BOUNDS.phases}, got "
            f"{odd[0]:g}. Number the phases from 1; 0 is a point without an orientation."
        )
    return phase.astype(np.int64)


@dataclass(frozen=True)
class _Header:
    """The header of a map: its row of names, the column of each quantity, and the unit of angles.

    width: number of columns.
    """

    row: int
    split: str | None
    width: int
    places: Mapping[str, int]
    is_radian: bool


def _header(lines: Sequence[str]) -> _Header | None:
    """The header of a table with the names of a map; None for any other table."""
    for names in candidates(lines):
        places = _places(names)
        if set(_NEEDED) <= set(places):
            return _with_unit(lines, names, places)
    return None


def _places(names: Names) -> dict[str, int]:
    """Number of the column of each quantity; the first name of a quantity counts."""
    found = [(map_quantity(word), k) for k, word in enumerate(names.words)]
    return {key: k for key, k in reversed(found) if key is not None}


def _with_unit(lines: Sequence[str], names: Names, places: Mapping[str, int]) -> _Header:
    """The header, with the unit of angles that the names or the lines above them state."""
    units = {names.units[places[key]].lower() for key in ("phi1", "Phi", "phi2")}
    text = " ".join(lines[: names.row + 1]).lower()
    is_radian = bool({"rad", "radian", "radians"} & units) or "radian" in text
    return _Header(names.row, names.split, len(names.words), places, is_radian)


def _chosen(path: Path, lines: Sequence[str], columns: Mapping[str, int | str]) -> _Header:
    """The header of a table with columns that the user names."""
    names = table_names(path, lines, columns, OrientationError)
    named, names = chosen_columns(path, names, columns, OrientationError)
    places = _places(names) | named
    lacking = [key for key in _NEEDED if key not in places]
    if lacking:
        raise OrientationError(
            f"columns: expected columns of {', '.join(_NEEDED)}, got no {', '.join(lacking)} for "
            f"{path.name}. Add them."
        )
    return _with_unit(lines, names, places)
