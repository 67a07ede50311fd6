"""Map tables: orientation maps as text with named columns, such as phi1, Phi, phi2, phase, x, y."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from geomtorsion.errors import FileFormatError
from geomtorsion.materials.maps.map_phases import check_laue, described
from geomtorsion.materials.maps.map_points import MapFile, MapPoints, gridded
from geomtorsion.support import checks
from geomtorsion.support.checks import LARGEST_ARRAYS, cut, shown
from geomtorsion.support.files import BOUNDS, finite_number, read_text
from geomtorsion.support.text_rows import lines_of, number_table

# Name of a column in other programs, in lower case without units -> its name here.
_NAMES = {
    "phi1": "phi1", "euler1": "phi1", "e1": "phi1", "phi_1": "phi1", "φ1": "phi1",
    "phi": "Phi", "euler2": "Phi", "e2": "Phi", "φ": "Phi", "ϕ": "Phi",
    "phi2": "phi2", "euler3": "phi2", "e3": "phi2", "phi_2": "phi2", "φ2": "phi2",
    "phase": "phase", "phaseid": "phase", "phase_id": "phase", "phaseindex": "phase",
    "x": "x", "y": "y",
}  # fmt: skip
_NEEDED = ("phi1", "Phi", "phi2", "x", "y")
_MARKS = "#%"
# A unit after a name: phi1(deg), x [um].
_UNIT = re.compile(r"[\[(]\s*([^\])]*)[\])]")


def seems_table(content: bytes) -> bool:
    """Whether the first row after the comments, or the last comment, names the columns."""
    text = content.removeprefix(b"\xef\xbb\xbf").decode("utf-8", "replace")
    return _header(text.splitlines()) is not None


def read_map_table(path: Path, given: Mapping[int, str] | None = None) -> MapFile:
    """Read a table with a row of column names, in any order; unknown columns are ignored.

    The names are in the first row, or in the last row of comments (#, %), separated by blanks,
    tabs, commas or semicolons. Angles are in degrees, unless a name has the unit (rad); positions
    are in um. Without a phase column, or if all phases are 0, all points have phase 1. A table
    contains no symmetry: give `laue`.

    Raises
    ------
    FileFormatError
        A column is missing, a row has another length, or the symmetry of a phase is not given.
    """
    laue = checks.table(given, "laue", FileFormatError)
    text = read_text(path, LARGEST_ARRAYS, otherwise="latin-1")
    lines = lines_of(text)
    header = _header(lines)
    if header is None:
        first = next((line for line in lines if line.strip()), "")
        raise FileFormatError(
            f"{path.name}: expected a row of names {', '.join(_NEEDED)} and phase, got "
            f"{shown(cut(first.strip(), 80))}. Write these names above their columns, or export "
            "the map as .ctf or .ang."
        )
    start, names, split, is_radian = header
    indices = [k for k in range(start + 1, len(lines)) if lines[k].strip(" \t,;")]
    rows = [lines[k] for k in indices]
    columns = {name: k for k, name in reversed(list(enumerate(names)))}
    words = [columns[name] for name in ("phase",) if name in columns]
    table, phases_there = number_table(
        path.name, [k + 1 for k in indices], rows, len(names), [columns[n] for n in _NEEDED],
        words, split=split,
    )  # fmt: skip
    columns = dict(zip(_NEEDED, table.T, strict=True))
    euler = np.stack([columns[name] for name in ("phi1", "Phi", "phi2")], axis=1)
    indexed = np.asarray(np.isfinite(euler).all(axis=1))
    euler = np.where(indexed[:, None], euler if is_radian else np.radians(euler), 0.0)
    far = (np.abs(euler) > 4 * np.pi + 1e-3).any(axis=1)
    if far.any():
        k = int(np.argmax(far))
        unit = "radians (declared in the header)" if is_radian else "degrees"
        raise FileFormatError(
            f"{path.name}: line {indices[k] + 1}: expected Euler angles of at most two turns in "
            f"{unit}, got {shown(lines[indices[k]].strip())}. Correct the header or the row."
        )
    phase = indexed.astype(float)
    for texts in phases_there:
        # A word, such as the name of a phase, gives no number.
        codes = {text: finite_number(text.strip()) or 0.0 for text in set(texts)}
        phase = np.where(indexed, [codes[text] for text in texts], 0.0)
    if not phase.any():
        # MTEX writes phase 0 for each point of a map without phases.
        phase = np.where(indexed, 1, 0)
    numbers = sorted(set(phase.tolist()) - {0.0})
    odd = [x for x in numbers if x != int(x) or not 0 < x <= BOUNDS.phases]
    if odd:
        raise FileFormatError(
            f"{path.name}: phase: expected whole numbers from 0 to {BOUNDS.phases}, got "
            f"{odd[0]:g}. Number the phases from 1; 0 is a point without an orientation."
        )
    phases = {int(n): described(path.name, int(n), f"phase {n:g}", None, laue) for n in numbers}
    check_laue(path.name, laue, phases)
    x, y = columns["x"], columns["y"]
    bad = ~(np.isfinite(x) & np.isfinite(y))
    if bad.any():
        raise FileFormatError(
            f"{path.name}: line {indices[int(np.argmax(bad))] + 1}: expected numbers x and y, got "
            f"{shown(lines[indices[int(np.argmax(bad))]].strip())}. Correct the row."
        )
    return gridded(
        MapPoints(
            path.name, len(text), x, y, euler, phase.astype(np.int64), phases,
            start=indices[0] + 1 if indices else None,
        )
    )  # fmt: skip


Header = tuple[int, list[str], str | None, bool]


def _header(lines: Sequence[str]) -> Header | None:
    """Row of the names, the names, the separator (None: blanks), whether angles are in radians."""
    for k, line in enumerate(lines[:1000]):
        row = line.strip().lstrip(_MARKS).strip()
        if not row:
            continue
        # Tabs and blanks may be mixed, so that blanks are tried after tabs.
        for split in (mark for mark in (",", ";", "\t", None) if mark is None or mark in row):
            words = _words(row, split)
            names = [_NAMES.get(_UNIT.sub("", word).strip().lower(), word) for word in words]
            if set(_NEEDED) <= set(names):
                units = {unit[1].lower() for word in words for unit in _UNIT.finditer(word)}
                text = " ".join([*lines[:k], row]).lower()
                is_radian = bool({"rad", "radian", "radians"} & units) or "radian" in text
                return k, names, split, is_radian
        if not line.strip().startswith(tuple(_MARKS)) and k:
            return None
    return None


def _words(row: str, split: str | None) -> list[str]:
    """Names of the columns in a row; split: the separator, None for blanks."""
    if split is None:
        # A blank may separate a unit from its name.
        row = _UNIT.sub(lambda one: f"({one[1]})", re.sub(r"\s+([\[(])", r"\1", row))
    return [word.strip().strip("\"'") for word in row.split(split)]
