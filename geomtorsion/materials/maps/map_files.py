"""Map files: orientation maps in .ctf (Oxford, HKL) and .ang (EDAX, TSL, ASTAR) files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
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
from geomtorsion.support.checks import LARGEST_ARRAYS, cut, shown
from geomtorsion.support.files import BOUNDS, ending, read_text
from geomtorsion.support.text_rows import TextRows, lines_of, number_table

# EDAX writes 4 pi for each angle of a point that was not indexed.
NOT_INDEXED = 4 * np.pi - 1e-3
SIZES = ("XCells", "YCells")
ANG_LAUE = {
    "1": "-1", "2": "2/m", "20": "2/m", "22": "mmm", "4": "4/m", "42": "4/mmm", "3": "-3",
    "32": "-3m", "6": "6/m", "62": "6/mmm", "23": "m-3", "43": "m-3m",
}  # fmt: skip


# The first words of a .ctf file.
CTF = "Channel Text File"


def read_text_map(path: Path, laue: Mapping[int, str] | None) -> MapFile:
    """Read a map from a .ctf or .ang file; x and y decide where header and points disagree."""
    groups = checks.table(laue, "laue", FileFormatError)
    text = read_text(path, LARGEST_ARRAYS, otherwise="latin-1")
    # Names may contain characters at which `splitlines` breaks, such as the ellipsis of Windows.
    rows = TextRows(path.name, lines_of(text.removesuffix("\n").removesuffix("\r")))
    source = _Source(rows, groups, len(text))
    points = source.ctf() if ending(path) == ".ctf" else source.ang()
    check_laue(path.name, groups, points.phases)
    return gridded(points)


@dataclass(frozen=True, eq=False)
class _Source:
    """The rows of a file, the Laue groups given by the user, and the length of the file."""

    rows: TextRows
    laue: dict[int, str]
    size: int

    @property
    def name(self) -> str:
        return str(self.rows.name)

    @property
    def lines(self) -> Sequence[str]:
        return self.rows.lines

    def at(self, line: int) -> TextRows:
        """The rows, for a refusal of a line, counted from 0."""
        self.rows.line = line + 1
        return self.rows

    def number(self, line: int, text: str, what: str) -> float:
        """The finite number in a field of a line."""
        return self.at(line).number(text.strip().replace(",", "."), what)

    def whole(self, line: int, text: str, what: str) -> int:
        """The positive whole number in a field of a line."""
        value = self.number(line, text, what)
        word = f"{value:.0f}" if value.is_integer() else text.strip()
        # The file has at least one line for each counted row, column or phase.
        return self.at(line).whole(word, what, 1, len(self.lines) + 1)

    # -- .ctf -------------------------------------------------------------------------------------

    def ctf(self) -> MapPoints:
        """Points of a .ctf file (Oxford Instruments); angles in degrees."""
        if not self.lines or not self.lines[0].startswith(CTF):
            first = shown(cut(self.lines[0].strip(), 60)) if self.lines else "an empty file"
            self.at(0).fail(f"expected 'Channel Text File', got {first}. Is this a .ctf file?")
        start, header = self.ctf_header()
        if header.get("JobMode", (0, ""))[1].strip().lower() == "interactive":
            count = sum(bool(row.strip()) for row in self.lines[start + 1 :])
            self.at(header["JobMode"][0]).fail(
                f"expected a map on a grid (JobMode Grid), got {count:,} points without a grid "
                "(JobMode Interactive). Circuits need neighbouring pixels: export a map on a grid.",
            )
        declared = None
        if all(key in header for key in (*SIZES, "XStep", "YStep")):
            columns, rows = (self.whole(*header[key], key) for key in SIZES)
            steps = [self.number(*header[key], key) for key in ("XStep", "YStep")]
            declared = Declared(np.full(rows, columns), (steps[0], steps[1]))
        line, text = header.get("Phases", (start, ""))
        count = self.whole(line, text, "Phases")
        phases = {k: self.ctf_phase(line + k, k, start, count) for k in range(1, count + 1)}
        names = [name.strip() for name in self.lines[start].split("\t")]
        titles = ("Phase", "X", "Y", "Euler1", "Euler2", "Euler3")
        for name in titles:
            if name not in names:
                self.at(start).fail(f"expected a column {name}, got none. Export it with the map.")
        table = self.table(start + 1, len(names))
        phase, x, y, *angles = (table[:, names.index(name)] for name in titles)
        self.check_angles(start + 1, np.stack(angles, axis=1), 720, "degrees")
        return MapPoints(
            self.name, self.size, x, y, np.radians(np.stack(angles, axis=1)),
            whole_phases(self.name, phase, phases, start + 2), phases, declared, start + 2,
        )  # fmt: skip

    def ctf_header(self) -> tuple[int, dict[str, tuple[int, str]]]:
        """The line of the column names, and for each key above it its line and value."""
        header: dict[str, tuple[int, str]] = {}
        for k, row in enumerate(self.lines[:200]):
            fields = row.split("\t")
            if fields[0] == "Phase" and "X" in fields:
                return k, header
            header.setdefault(fields[0].strip(), (k, fields[1] if len(fields) > 1 else ""))
        self.at(len(self.lines) - 1).fail(
            "expected a row of column names (Phase, X, Y, ...), got none. Is the file "
            "truncated? Export it again.",
        )

    def ctf_phase(self, k: int, number: int, start: int, count: int) -> Phase:
        """A phase of the header from its line k; start: line of the column names."""
        parts = self.lines[k].split("\t") if k < start else []
        if len(parts) < 4:
            self.at(min(k, start)).fail(
                f"expected phase {number} of {count}, got no description of it. Export the map "
                "again.",
            )
        lattice = [
            [self.number(k, x, f"lattice of phase {number}") for x in part.split(";")]
            for part in parts[:2]
        ]
        if [len(part) for part in lattice] != [3, 3]:
            self.at(k).fail(
                f"phase {number}: expected three lengths and three angles, got "
                f"{' and '.join(str(len(part)) for part in lattice)}. Export the map again.",
            )
        # Numbers that are not listed or not whole give an unknown group, None.
        laue = LAUE_NUMBERS.get(self.number(k, parts[3], f"Laue group of phase {number}"))
        return described(
            f"{self.name}: line {k + 1}", number, parts[2].strip(), laue, self.laue,
            (lattice[0], lattice[1]), "y",
        )  # fmt: skip

    # -- .ang -------------------------------------------------------------------------------------

    def ang(self) -> MapPoints:
        """Points of an .ang file (EDAX in um, ASTAR in nm); square or hexagonal grid.

        Columns are angles in radians, x, y, quality, confidence and phase. ASTAR files may have no
        column for the phase.
        """
        start = next((k for k, row in enumerate(self.lines) if not row.startswith("#")), None)
        if start is None or start == 0:
            self.at(0).fail(
                "expected a header of lines with # and rows of numbers below it, got no "
                f"{'rows' if start is None else 'header'}. Export the map again.",
            )
        header, phases = self.ang_header(start)
        if not phases:
            self.at(start).fail(
                "expected a phase in the header, got none. Export the map with full header."
            )
        declared = self.ang_grid(header)
        width = len(self.lines[start].split())
        if width < 5:
            self.at(start).fail(
                f"expected five or more columns (three angles, x, y), got {width}. "
                "Export it again.",
            )
        table = self.table(start, width)
        self.check_angles(start, table[:, :3], 4 * np.pi + 1e-3, "radians")
        is_astar = any("ACOM" in row for row in self.lines[:start])
        phase = self.ang_phases(start, table, phases, is_astar)
        indexed = (table[:, :3] < NOT_INDEXED).all(axis=1)
        if width > 6 and not is_astar:
            # A confidence of -1 marks a point that was not indexed.
            indexed &= table[:, 6] >= 0
        phase_codes = whole_phases(self.name, np.where(indexed, phase, 0), phases, start + 1)
        unit = 1e-3 if is_astar else 1.0
        if declared is not None:
            dx, dy = declared.steps
            declared = Declared(declared.counts, (unit * dx, unit * dy), declared.shift)
        return MapPoints(
            self.name, self.size, unit * table[:, 3], unit * table[:, 4], table[:, :3], phase_codes,
            phases, declared, start + 1,
        )  # fmt: skip

    def ang_header(self, start: int) -> tuple[dict[str, tuple[int, str]], dict[int, Phase]]:
        """For each key above a line its line and value, the last one; and the phases."""
        header: dict[str, tuple[int, str]] = {}
        phases: dict[int, Phase] = {}
        description: dict[str, tuple[int, str]] = {}
        for k, row in enumerate(self.lines[:start]):
            words = row[1:].replace(":", " ", 1).split(None, 1)
            if not words:
                continue
            key, value = words[0], words[1].strip() if len(words) > 1 else ""
            if key == "Phase" or (key == "MaterialName" and "LatticeConstants" in description):
                description = {}
            description[key] = header[key] = (k, value)
            if key == "LatticeConstants":
                if len(phases) >= BOUNDS.phases:
                    self.at(k).fail(
                        f"expected at most {BOUNDS.phases} phases, got more. Remove some."
                    )
                number, phase = self.ang_phase(description, len(phases) + 1)
                phases[number] = phase
        return header, phases

    def ang_grid(self, header: Mapping[str, tuple[int, str]]) -> Declared | None:
        """The grid in a header; None if the header does not describe one."""
        keys = ("NCOLS_ODD", "NCOLS_EVEN", "NROWS")
        if not all(key in header for key in ("GRID", "XSTEP", "YSTEP", *keys)):
            return None
        odd, even, rows = (self.whole(*header[key], key) for key in keys)
        dx, dy = (self.number(*header[key], key) for key in ("XSTEP", "YSTEP"))
        # If the second row is longer, it begins half a step before the first one.
        is_hexagonal = header["GRID"][1].lower().startswith("hex")
        shift = (0.5 if odd >= even else -0.5) if is_hexagonal else 0.0
        return Declared(np.where(np.arange(rows) % 2, even, odd), (dx, dy), shift)

    def ang_phases(
        self, start: int, table: np.ndarray, phases: Mapping[int, Phase], is_astar: bool
    ) -> np.ndarray:
        """The phase of each point: the eighth column, or without it the only phase."""
        column = table[:, 7] if table.shape[1] > 7 else None
        if column is not None and is_astar and not np.isin(column, [0, *phases]).all():
            # In files with one phase, this column holds a reliability.
            column = None
        if column is None:
            if len(phases) > 1:
                self.at(start).fail(
                    f"expected the phase of each point in column 8, since the header has "
                    f"{len(phases)} phases, got {table.shape[1]} columns. Export it with the map.",
                )
            return np.full(len(table), next(iter(phases)))
        if list(phases) == [1] and not (column == 1).any():
            # In files with one phase, the column may hold zeros.
            return np.where(column == 0, 1.0, column)
        if is_astar and (column == 0).any() and column.max() < len(phases):
            # Points count phases from 0 if the header gives them no numbers.
            return column + 1
        return column

    def ang_phase(self, about: Mapping[str, tuple[int, str]], following: int) -> tuple[int, Phase]:
        """A phase from the lines that describe it; without a number it gets `following`."""
        line, text = about["LatticeConstants"]
        if "Symmetry" not in about:
            self.at(line).fail(
                "expected Symmetry above, got none. Export the map with its full header."
            )
        number = self.whole(*about["Phase"], "Phase") if "Phase" in about else following
        numbers = [self.number(line, x, "lattice constant") for x in text.split()]
        if len(numbers) != 6:
            self.at(line).fail(
                f"expected three lengths and three angles, got {shown(text)}. Correct them."
            )
        name = about.get("MaterialName", (line, f"phase {number}"))[1]
        laue = ANG_LAUE.get(about["Symmetry"][1])
        lattice = (numbers[:3], numbers[3:])
        where = f"{self.name}: line {about['Symmetry'][0] + 1}"
        return number, described(where, number, name, laue, self.laue, lattice)

    # -- both -------------------------------------------------------------------------------------

    def table(self, start: int, width: int) -> np.ndarray:
        """The rows of numbers from a line to the end of the file; shape (points, width)."""
        rows = list(self.lines[start:])
        while rows and not rows[-1].strip():
            rows.pop()
        # Some locales write a decimal comma, except perhaps at points without an orientation.
        if any("," in row for row in rows):
            rows = [row.replace(",", ".") for row in rows]
        if not rows:
            self.at(start - 1).fail(
                "expected points, got the end of the file. Is the file complete?"
            )
        lines = range(start + 1, start + 1 + len(rows))
        return number_table(self.name, lines, rows, width, finite=True)[0]

    def check_angles(self, start: int, angles: np.ndarray, most: float, unit: str) -> None:
        """Refuse angles of more than two turns, which must be in another unit."""
        far = (np.abs(angles) > most).any(axis=1)
        if far.any():
            k = int(np.argmax(far))
            came = ", ".join(f"{angle:g}" for angle in angles[k])
            self.at(start + k).fail(
                f"expected Euler angles in {unit}, got {came}. Convert them, or export the map "
                "again.",
            )
