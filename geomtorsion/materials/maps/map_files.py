"""Map files: orientation maps in .ctf (Oxford, HKL), .ang (EDAX, TSL) and, through orix, HDF5."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from geomtorsion import checks
from geomtorsion.checks import LARGEST_ARRAYS, cut, shown
from geomtorsion.errors import (
    FileFormatError,
    GeomtorsionError,
    MissingExtraError,
    OrientationError,
)
from geomtorsion.files import BOUNDS, finite_number, read_text
from geomtorsion.hdf5 import check_hdf5
from geomtorsion.materials.maps.phases import Phase
from geomtorsion.materials.maps.results import UNITS

# EDAX writes 4 pi for each angle of a point that was not indexed.
NOT_INDEXED = 4 * np.pi - 1e-3
SIZES = ("XCells", "YCells")
CTF_LAUE: dict[float, str] = dict(
    enumerate(
        "-1 2/m mmm 4/m 4/mmm -3 -3m 6/m 6/mmm m-3 m-3m".split(),
        start=1,
    )
)
ANG_LAUE = {
    "1": "-1", "2": "2/m", "20": "2/m", "22": "mmm", "4": "4/m", "42": "4/mmm", "3": "-3",
    "32": "-3m", "6": "6/m", "62": "6/mmm", "23": "m-3", "43": "m-3m",
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class MapFile:
    """What a file of an orientation map holds.

    euler: Bunge's angles phi1, Phi, phi2 in radians, shape (rows, columns, 3).
    phase: number of the phase of each pixel, 0 where nothing was indexed, shape (rows, columns).
    phases: number -> phase. steps: of x and y. shift: of every second row, as a share of the step
        of x: 0 for square grids, 1/2 (or -1/2) for hexagonal ones.
    """

    euler: np.ndarray
    phase: np.ndarray
    phases: Mapping[int, Phase]
    steps: tuple[float, float]
    shift: float = 0.0


# How a .ctf file begins.
CTF = "Channel Text File"


def read_text_map(path: Path, laue: Mapping[int, str] | None) -> MapFile:
    """A map from a .ctf or .ang file."""
    groups = checks.table(laue, "laue", FileFormatError)
    text = read_text(path, LARGEST_ARRAYS, otherwise="latin-1")
    # Names may hold letters at which `splitlines` breaks, such as the three dots of Windows.
    lines = re.split(r"\r\n|\r|\n", text.removesuffix("\n").removesuffix("\r"))
    source = _Source(path.name, lines, groups)
    found = source.ctf() if path.suffix.lower() == ".ctf" else source.ang()
    _check_laue(path.name, groups, found.phases)
    return found


def _check_laue(name: str, laue: Mapping[int, str], phases: Mapping[int, Phase]) -> None:
    """Refuse groups of phases that are not in the file."""
    for number in laue:
        if number not in (0, *phases):
            raise FileFormatError(
                f"{name}: laue: number {shown(number)} is that of no phase. Those of the file are "
                f"{', '.join(map(str, phases))}."
            )


@dataclass(frozen=True, eq=False)
class _Source:
    """The lines of a file, and what a user says about its phases."""

    name: str
    lines: list[str]
    laue: dict[int, str]

    def fail(self, line: int, message: str) -> NoReturn:
        """Refuse the file at a line, counted from 0."""
        raise FileFormatError(f"{self.name}: line {line + 1}: {message}")

    def number(self, line: int, text: str, what: str) -> float:
        """A finite number that stands in a line."""
        found = finite_number(text.strip().replace(",", "."))
        if found is None:
            self.fail(line, f"{what}: a number was needed, but {text.strip()[:60]!r} came.")
        return found

    def whole(self, line: int, text: str, what: str) -> int:
        """A whole number of things that stands in a line."""
        found = self.number(line, text, what)
        # A file holds a line for each thing that it counts.
        most = len(self.lines)
        if found != int(found) or not 1 <= found <= most:
            self.fail(
                line,
                f"{what}: a whole number from 1 to {most:,} (lines of the file) was needed, but "
                f"{text.strip()[:60]} came. Is the file truncated? Export it again.",
            )
        return int(found)

    def phase(
        self,
        line: int,
        number: int,
        name: str,
        laue: str | None,
        lattice: tuple[list[float], list[float]],
        horizontal: str,
    ) -> Phase:
        """A phase, with the Laue group that the user gives or the file."""
        group = self.laue.get(number, self.laue.get(0, laue))
        if group is None:
            self.fail(
                line,
                f"phase {number} ({name}): its symmetry is not known. Give it, "
                f'such as laue={{{number}: "m-3m"}}.',
            )
        lengths, angles = ((x[0], x[1], x[2]) for x in lattice)
        try:
            return Phase(name, group, lengths, angles, horizontal)
        except OrientationError as error:
            self.fail(line, str(error))

    # -- .ctf -------------------------------------------------------------------------------------

    def ctf(self) -> MapFile:
        """A map of Oxford Instruments; angles in degrees."""
        if not self.lines or not self.lines[0].startswith(CTF):
            self.fail(0, "'Channel Text File' was needed. Is this a .ctf file?")
        header: dict[str, tuple[int, str]] = {}
        start = None
        for k, row in enumerate(self.lines[:200]):
            fields = row.split("\t")
            if fields[0] == "Phase" and "X" in fields:
                start = k
                break
            header.setdefault(fields[0].strip(), (k, fields[1] if len(fields) > 1 else ""))
        if start is None:
            self.fail(
                len(self.lines) - 1,
                "the row of column names (Phase, X, Y, ...) is missing. The file is truncated: "
                "export it again.",
            )

        def asked(key: str) -> float:
            if key not in header:
                self.fail(start, f"{key} is missing above it. Export the map as a grid.")
            return self.number(header[key][0], header[key][1], key)

        columns, rows = (self.whole(*header.get(key, (start, "")), key) for key in SIZES)
        steps = asked("XStep"), asked("YStep")
        first = header.get("Phases", (start, ""))[0]
        count = self.whole(*header.get("Phases", (start, "")), "Phases")
        phases = {}
        for number in range(1, count + 1):
            k = first + number
            parts = self.lines[k].split("\t") if k < start else []
            if len(parts) < 4:
                self.fail(min(k, start), f"phase {number} of {count} is missing. Export it again.")
            lattice = [
                [self.number(k, x, f"lattice of phase {number}") for x in part.split(";")]
                for part in parts[:2]
            ]
            if [len(part) for part in lattice] != [3, 3]:
                self.fail(k, f"phase {number}: three lengths and three angles were needed.")
            # Groups that are not listed, and what is no whole number, are not known.
            laue = CTF_LAUE.get(self.number(k, parts[3], f"Laue group of phase {number}"))
            phases[number] = self.phase(
                k, number, parts[2].strip(), laue, (lattice[0], lattice[1]), "y"
            )
        names = [name.strip() for name in self.lines[start].split("\t")]
        wanted = ("Phase", "X", "Y", "Euler1", "Euler2", "Euler3")
        for name in wanted:
            if name not in names:
                self.fail(start, f"column {name} is missing. Export it with the map.")
        table = self.table(start + 1, len(names), rows * columns, f"{columns} x {rows} points")
        phase, x, y, *angles = (table[:, names.index(name)] for name in wanted)
        self.check_grid(start + 1, x, y, np.full(rows, columns), steps, 0.0)
        found = self.check_phases(start + 1, phase, phases)
        self.check_angles(start + 1, np.stack(angles, axis=1), 720, "degrees")
        euler = np.radians(np.stack(angles, axis=1)).reshape(rows, columns, 3)
        return MapFile(euler, found.reshape(rows, columns), phases, steps)

    # -- .ang -------------------------------------------------------------------------------------

    def ang(self) -> MapFile:
        """A map of EDAX; angles in radians; square or hexagonal grid."""
        start = next((k for k, row in enumerate(self.lines) if not row.startswith("#")), None)
        if start is None or start == 0:
            self.fail(
                0, "a header of lines with # and rows of numbers was needed. Export it again."
            )
        header: dict[str, tuple[int, str]] = {}
        phases: dict[int, Phase] = {}
        about: dict[str, tuple[int, str]] = {}
        for k, row in enumerate(self.lines[:start]):
            words = row[1:].replace(":", " ", 1).split(None, 1)
            if not words:
                continue
            key, value = words[0], words[1].strip() if len(words) > 1 else ""
            about = {} if key == "Phase" else about
            about[key] = header[key] = (k, value)
            if key == "LatticeConstants":
                if len(phases) >= BOUNDS.phases:
                    self.fail(k, f"expected at most {BOUNDS.phases} phases, got more. Remove some.")
                number, phase = self.ang_phase(about)
                phases[number] = phase
        for key in ("GRID", "XSTEP", "YSTEP", "NCOLS_ODD", "NCOLS_EVEN", "NROWS"):
            if key not in header:
                self.fail(start, f"{key} is missing above it. Export the map with its full header.")
        if not phases:
            self.fail(start, "no phase is described above it. Export the map with its full header.")
        odd, even, rows = (
            self.whole(*header[key], key) for key in ("NCOLS_ODD", "NCOLS_EVEN", "NROWS")
        )
        dx, dy = (self.number(*header[key], key) for key in ("XSTEP", "YSTEP"))
        is_hexagonal = header["GRID"][1].lower().startswith("hex")
        counts = np.where(np.arange(rows) % 2, even, odd)
        width = len(self.lines[start].split())
        if width < 8:
            self.fail(start, f"8 columns or more were needed, but {width} came. Export it again.")
        table = self.table(start, width, int(counts.sum()), f"{rows} rows of pixels")
        # A longer second row begins half a step before the first one.
        shift = (0.5 if odd >= even else -0.5) if is_hexagonal else 0.0
        self.check_grid(start, table[:, 3], table[:, 4], counts, (dx, dy), shift)
        self.check_angles(start, table[:, :3], 4 * np.pi + 1e-3, "radians")
        phase = table[:, 7]
        if list(phases) == [1] and not (phase == 1).any():
            # With one phase alone the column may hold zeros.
            phase = np.where(phase == 0, 1.0, phase)
        known = (table[:, :3] < NOT_INDEXED).all(axis=1) & (table[:, 6] >= 0)
        found = np.where(known, self.check_phases(start, np.where(known, phase, 0), phases), 0)
        columns = int(counts.max())
        row = np.repeat(np.arange(len(counts)), counts)
        column = np.arange(len(row)) - np.repeat(np.cumsum(counts) - counts, counts)
        euler = np.zeros((len(counts), columns, 3))
        whole = np.zeros((len(counts), columns), dtype=np.int64)
        euler[row, column], whole[row, column] = table[:, :3], found
        return MapFile(euler, whole, phases, (dx, dy), shift)

    def ang_phase(self, about: Mapping[str, tuple[int, str]]) -> tuple[int, Phase]:
        """A phase from the lines that describe it."""
        line, text = about["LatticeConstants"]
        for key in ("Phase", "Symmetry"):
            if key not in about:
                self.fail(line, f"{key} is missing above it. Export the map with its full header.")
        number = self.whole(*about["Phase"], "Phase")
        numbers = [self.number(line, x, "lattice constant") for x in text.split()]
        if len(numbers) != 6:
            self.fail(line, f"three lengths and three angles were needed, but {text!r} came.")
        name = about.get("MaterialName", (line, f"phase {number}"))[1]
        laue = ANG_LAUE.get(about["Symmetry"][1])
        lattice = (numbers[:3], numbers[3:])
        return number, self.phase(about["Symmetry"][0], number, name, laue, lattice, "x")

    # -- both -------------------------------------------------------------------------------------

    def table(self, start: int, width: int, wanted: int, what: str) -> np.ndarray:
        """The rows of numbers from a line on; shape (points, width)."""
        rows = self.lines[start:]
        while rows and not rows[-1].strip():
            rows.pop()
        if len(rows) < wanted:
            self.fail(
                start + len(rows) - 1,
                f"the header says {what}, that is {wanted:,} rows, but the file ends after "
                f"{len(rows):,}. It is truncated: export it again.",
            )
        if len(rows) > wanted:
            self.fail(
                start + wanted,
                f"the header says {what}, that is {wanted:,} rows, but {len(rows):,} follow. "
                "Correct the header, or export the map again.",
            )
        text = "\n".join(rows)
        # Some countries write decimals with a comma; a point without an orientation may have none.
        text = text.replace(",", ".")
        try:
            found = np.loadtxt(io.StringIO(text), ndmin=2, comments=None)
            if found.shape == (wanted, width) and np.isfinite(found).all():
                return found
        except ValueError:
            pass
        for k, row in enumerate(rows, start):
            parts = re.split(r"\s+", row.strip())
            if len(parts) != width:
                self.fail(k, f"{width} columns were needed, but {len(parts)} came.")
            for part in parts:
                self.number(k, part, "entry")
        self.fail(start, f"{width} columns of numbers were needed. Export the map again.")

    def check_grid(
        self,
        start: int,
        x: np.ndarray,
        y: np.ndarray,
        counts: np.ndarray,
        steps: tuple[float, float],
        shift: float,
    ) -> None:
        """Refuse points that do not lie where a grid of these steps has them."""
        if min(steps) <= 0:
            raise FileFormatError(
                f"{self.name}: positive steps were needed, but {steps[0]:g} and {steps[1]:g} came. "
                "Export the map as a grid of points, not as a line or a list."
            )
        row = np.repeat(np.arange(len(counts)), counts)
        column = np.arange(len(row)) - np.repeat(np.cumsum(counts) - counts, counts)
        for name, found, place, step in (
            ("X", x, column + shift * (row % 2), steps[0]),
            ("Y", y, row, steps[1]),
        ):
            # Coordinates are written with few digits, but each is nearest to its own place.
            off = np.rint((found - found[0]) / step - place) != 0
            if off.any():
                k = int(np.argmax(off))
                expected = found[0] + step * place[k]
                self.fail(
                    start + k,
                    f"{name} = {found[k]:g}, where steps of {step:g} make {expected:g} of it. "
                    "Steps are mixed, or points are missing: export the map on its full grid.",
                )

    def check_angles(self, start: int, angles: np.ndarray, most: float, unit: str) -> None:
        """Refuse angles of more than two turns, which are those of another unit."""
        far = (np.abs(angles) > most).any(axis=1)
        if far.any():
            k = int(np.argmax(far))
            came = ", ".join(f"{angle:g}" for angle in angles[k])
            self.fail(
                start + k,
                f"Euler angles in {unit} were needed, but {came} came. Convert them, or export the "
                "map again.",
            )

    def check_phases(
        self, start: int, phase: np.ndarray, phases: Mapping[int, Phase]
    ) -> np.ndarray:
        """Numbers of phases as whole numbers; one that the header does not know is refused."""
        unknown = ~np.isin(phase, [0, *phases])
        if unknown.any():
            k = int(np.argmax(unknown))
            known = ", ".join(f"{n} ({p.name})" for n, p in phases.items()) or "none"
            self.fail(
                start + k,
                f"phase {phase[k]:g} is not described in the header. Known are {known}; 0 is a "
                "pixel without an orientation.",
            )
        return phase.astype(np.int64)


def _check_places(name: str, found: Any, steps: tuple[float, float]) -> None:
    """Refuse points of orix that do not stand row by row."""
    rows, columns = found.shape
    row, column = np.divmod(np.arange(rows * columns), columns)
    for axis, values, place, step in (
        ("x", found.x, column, steps[0]),
        ("y", found.y, row, steps[1]),
    ):
        off = np.rint((values - values[0]) / step) != place
        if off.any():
            k = int(np.argmax(off))
            raise FileFormatError(
                f"{name}: point {k + 1}: {axis} = {values[k]:g}, where steps of {step:g} make "
                f"{values[0] + step * place[k]:g} of it. Sort the points by rows, or export the "
                "map as .ctf or .ang."
            )


def read_orix(path: Path, given: Mapping[int, str] | None = None) -> MapFile:
    """A square grid of an HDF5 file that orix knows (its own, kikuchipy's, EMsoft's, Bruker's).

    Numbers of phases are those of orix and one more: its phases begin with 0. Steps are in um.

    given: number of a phase (0 of every other one) -> name of its Laue group, instead of what the
    file says.

    Raises
    ------
    MissingExtraError
        orix is not installed.
    FileFormatError
        orix cannot read the file, or it holds no whole square grid.
    """
    laue = checks.table(given, "laue", FileFormatError)
    try:
        # GPL: imported where it is installed, and never needed for anything else.
        io, h5py = import_module("orix.io"), import_module("h5py")
    except ImportError:
        raise MissingExtraError(
            f"{path.name}: HDF5 files need orix, which is not installed. Run `pip install "
            "'geomtorsion[ebsd]'`, or export the map as .ctf or .ang."
        ) from None
    names = check_hdf5(path, h5py)
    try:
        with warnings.catch_warnings():
            # Angles in degrees that stand for radians: orix reads them and says so.
            warnings.filterwarnings("error", "Angles are quite high")
            found = io.load(str(path))
        rows, columns = found.shape
        euler = found.rotations.to_euler()
        number = np.where(found.is_indexed, found.phase_id + 1, 0)
        steps = float(found.dx), float(found.dy)
    except Exception as error:  # noqa: BLE001
        # Readers of several formats, each with errors of its own.
        reason = cut(str(error)) or type(error).__name__
        raise FileFormatError(
            f"{path.name}: orix cannot read a map of rows and columns from it ({reason}); it "
            f"begins with {cut(', '.join(names)) or 'nothing'}. Export it as .ctf or .ang."
        ) from None
    euler = np.reshape(euler, (-1, *np.shape(euler)[-1:]))
    if len(euler) != rows * columns or min(steps) <= 0:
        raise FileFormatError(
            f"{path.name}: {rows} x {columns} points were needed, but {len(euler)} points "
            f"with steps {steps[0]:g} and {steps[1]:g} came. Export the map on its full grid."
        )
    # Of Bruker's files orix puts the points in order, but not their places.
    if "XSAMPLE" not in found.prop:
        _check_places(path.name, found, steps)
    # orix writes px where nobody said how large a step is.
    said = str(found.scan_unit)
    if said not in UNITS:
        raise FileFormatError(
            f"{path.name}: steps in {', '.join(UNITS)} were needed, but they are in {shown(said)}. "
            "Set steps and scan_unit in orix and save the map again, or export it as .ctf or .ang."
        )
    unit = UNITS[said] / UNITS["um"]
    phases = {}
    for key, phase in found.phases:
        if key < 0:
            continue
        group = None if phase.point_group is None else phase.point_group.laue.name
        lattice = phase.structure.lattice
        known = laue.get(key + 1, laue.get(0, group))
        if known is None:
            raise FileFormatError(
                f"{path.name}: phase {key + 1} ({phase.name}): its symmetry is not known. Give it, "
                f'such as laue={{{key + 1}: "m-3m"}}.'
            )
        try:
            phases[int(key) + 1] = Phase(
                str(phase.name),
                known,
                (float(lattice.a), float(lattice.b), float(lattice.c)),
                (float(lattice.alpha), float(lattice.beta), float(lattice.gamma)),
            )
        except GeomtorsionError as error:
            raise FileFormatError(f"{path.name}: {error}") from None
    _check_laue(path.name, laue, phases)
    return MapFile(
        np.asarray(euler, dtype=float).reshape(rows, columns, 3),
        np.asarray(number).reshape(rows, columns),
        phases,
        (steps[0] * unit, steps[1] * unit),
    )
