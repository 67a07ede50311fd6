"""Channel 5: orientation maps in two files, .cpr (text) and .crc (numbers) (Oxford, HKL)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from geomtorsion.errors import FileFormatError
from geomtorsion.materials.maps.map_phases import (
    LAUE_NUMBERS,
    check_laue,
    described,
    whole_phases,
)
from geomtorsion.materials.maps.map_points import Declared, MapFile, MapPoints, gridded
from geomtorsion.materials.maps.phases import Phase
from geomtorsion.support import checks
from geomtorsion.support.checks import cut
from geomtorsion.support.files import BOUNDS, read_text
from geomtorsion.support.text_rows import TextRows, lines_of

# Number of a field -> its name and type; the phase, one byte, is before all fields.
_FIELDS = {
    1: ("x", "<f4"), 2: ("y", "<f4"), 3: ("phi1", "<f4"), 4: ("Phi", "<f4"), 5: ("phi2", "<f4"),
    6: ("deviation", "<f4"), 7: ("contrast", "u1"), 8: ("slope", "u1"), 9: ("field 9", "u1"),
    10: ("bands", "u1"), 11: ("error", "u1"), 12: ("reliability", "<f4"),
}  # fmt: skip
_ANGLES = ("phi1", "Phi", "phi2")


def read_channel5(path: Path, given: Mapping[int, str] | None = None) -> MapFile:
    """Read a map from its two files, given the path of either; angles in radians, steps in um.

    Raises
    ------
    FileFormatError
        One of the files is missing, or they do not belong together.
    """
    laue = checks.table(given, "laue", FileFormatError)
    text, numbers = (_partner(path, end) for end in (".cpr", ".crc"))
    keys = _Keys(text.name, read_text(text, otherwise="latin-1"))
    fields = [_field(keys, k + 1) for k in range(keys.whole("fields", "count", BOUNDS.phases))]
    names = [name for name, _ in fields]
    missing = [name for name in _ANGLES if name not in names]
    if missing or len(set(names)) < len(names):
        raise FileFormatError(
            f"{text.name}: [Fields]: expected each of phi1, Phi and phi2 once (fields 3, 4, 5), "
            f"got {cut(', '.join(names)) or 'none'}. Export the map again, or as .ctf."
        )
    kind = np.dtype([("phase", "u1"), *fields])
    is_grid = ("job", "xcells") in keys.values
    if is_grid:
        columns, rows = (keys.whole("job", key) for key in ("xcells", "ycells"))
        count = rows * columns
    else:
        columns, rows, count = 0, 0, keys.whole("job", "noofpoints")
    size = numbers.stat().st_size
    if size != count * kind.itemsize:
        raise FileFormatError(
            f"{numbers.name}: expected {count:,} points of {kind.itemsize} bytes, as declared in "
            f"{text.name}, got {size:,} bytes. Copy both files of the map again."
        )
    table = np.fromfile(numbers, dtype=kind)
    euler = np.stack([table[name].astype(float) for name in _ANGLES], axis=1)
    last = keys.whole("phases", "count", BOUNDS.phases)
    phases = {k: _phase(keys, k, laue) for k in range(1, last + 1)}
    check_laue(text.name, laue, phases)
    phase = whole_phases(numbers.name, table["phase"].astype(float), phases)
    indexed = np.asarray(np.isfinite(euler).all(axis=1))
    if (np.abs(euler[indexed & (phase > 0)]) > 4 * np.pi + 1e-3).any():
        raise FileFormatError(
            f"{numbers.name}: expected angles in radians, got larger ones. Are both files of one "
            "map? Copy them again, or export it as .ctf."
        )
    declared = None
    if is_grid:
        declared = _grid(keys, text.name, rows, columns)
        (dx, dy), (row, column) = declared.steps, declared.pixels
        x, y = dx * column, dy * row
    elif "x" in names and "y" in names:
        x, y = table["x"].astype(float), table["y"].astype(float)
    else:
        raise FileFormatError(
            f"{text.name}: expected a map on a grid (xCells, yCells in [Job]), got {count:,} "
            "points without a grid. Circuits need neighbouring pixels: export a map on a grid."
        )
    return gridded(
        MapPoints(
            numbers.name, size, x, y, np.where(indexed[:, None], euler, 0.0),
            np.where(indexed, phase, 0), phases, declared,
        )
    )  # fmt: skip


def _grid(keys: _Keys, name: str, rows: int, columns: int) -> Declared:
    """The grid of a map, with its steps."""
    dx, dy = (keys.number("job", f"griddist{axis}") for axis in "xy")
    if min(dx, dy) <= 0:
        raise FileFormatError(
            f"{name}: [Job]: expected steps GridDistX and GridDistY above 0, got {dx:g} "
            f"and {dy:g}. Correct them."
        )
    return Declared(np.full(rows, columns), (dx, dy))


def _partner(path: Path, end: str) -> Path:
    """Path of one of the two files of a map."""
    paths = [path.with_suffix(each) for each in (end, end.upper())]
    there = [one for one in paths if one.is_file()]
    if not there:
        raise FileFormatError(
            f"{path.name}: expected two files, {paths[0].with_suffix('.cpr').name} and "
            f"{paths[0].with_suffix('.crc').name}, got no {paths[0].name}. Put it into the same "
            "folder."
        )
    return there[0]


class _Keys:
    """Values of all sections by section and key; blanks in these names are ignored."""

    def __init__(self, name: str, text: str) -> None:
        self.rows = TextRows(name)
        self.values: dict[tuple[str, str], tuple[int, str]] = {}
        section = ""
        for line, row in enumerate(map(str.strip, lines_of(text)), 1):
            key, equals, value = row.partition("=")
            if row.startswith("["):
                section = row.strip("[]").replace(" ", "").lower()
            elif equals and not row.startswith(";"):
                self.values[section, key.replace(" ", "").lower()] = line, value.strip()

    def text(self, section: str, key: str, default: str = "nothing") -> str:
        """The value of a key, whose line a refusal names."""
        self.rows.line, value = self.values.get((section, key), (0, default))
        return value

    def number(self, section: str, key: str) -> float:
        """The finite number of a key."""
        word = self.text(section, key).replace(",", ".")
        return self.rows.number(word, f"[{section}] {key}")

    def whole(self, section: str, key: str, most: int = 2**31 - 1) -> int:
        """The positive whole number of a key."""
        return self.rows.whole(self.text(section, key), f"[{section}] {key}", 1, most + 1)


def _field(keys: _Keys, k: int) -> tuple[str, str]:
    """Name and type of a field; undocumented fields have four bytes."""
    number = keys.whole("fields", f"field{k}")
    return _FIELDS.get(number, (f"field {number}", "<f4"))


def _phase(keys: _Keys, k: int, laue: Mapping[int, str]) -> Phase:
    """Read a phase from its section."""
    section = f"phase{k}"
    lengths, angles = (
        [keys.number(section, key) for key in names]
        for names in (("a", "b", "c"), ("alpha", "beta", "gamma"))
    )
    title = keys.text(section, "structurename", section)
    group = LAUE_NUMBERS.get(keys.number(section, "lauegroup"))
    where = f"{keys.rows.name}: [Phase{k}]"
    return described(where, k, title, group, laue, (lengths, angles), "y")
