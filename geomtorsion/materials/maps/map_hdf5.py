"""Map HDF5: orientation maps in HDF5 files of instruments and programs, by h5py."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion.errors import (
    FileFormatError,
    GeomtorsionError,
    LimitError,
    MissingExtraError,
    OrientationError,
)
from geomtorsion.materials.columns import UNIT
from geomtorsion.materials.maps.hdf5_layouts import (
    ANGLES,
    QUANTITIES,
    Layout,
    data_sets,
    header_of,
    last,
    layout_of,
    phases_of,
)
from geomtorsion.materials.maps.map_files import NOT_INDEXED
from geomtorsion.materials.maps.map_phases import check_laue, described, whole_phases
from geomtorsion.materials.maps.map_points import Declared, MapFile, MapPoints, gridded
from geomtorsion.materials.maps.phases import Phase
from geomtorsion.materials.maps.results import UNITS
from geomtorsion.support import checks
from geomtorsion.support.checks import LARGEST_ARRAYS, cut, shown
from geomtorsion.support.files import BOUNDS
from geomtorsion.support.hdf5 import Item, check_hdf5, is_data_set, is_group

_ANGLES = ("phi1", "Phi", "phi2")
# Quantities that together give the angles.
_ALL = (set(_ANGLES), {"dictionary", "matches"})
# Units of angles in names and attributes.
_UNITS = {
    **dict.fromkeys(("rad", "radian", "radians"), ANGLES["rad"]),
    **dict.fromkeys(("deg", "degree", "degrees", "°"), ANGLES["deg"]),
}


@dataclass(frozen=True, eq=False)
class _Scan:
    """A map in a file: its group, the data set of each quantity, and a plane of a volume.

    units: of angles, by quantity, as given by the user. plane: index of the plane, or None. level:
    coordinate z of the plane, if each point has its own, or None.
    """

    name: str
    group: Item
    sets: Mapping[str, Item]
    units: Mapping[str, str]
    plane: int | None = None
    level: float | None = None


def read_hdf5_map(
    path: Path,
    given: Mapping[int, str] | None = None,
    columns: Mapping[str, int | str] | None = None,
    part: int | str | None = None,
) -> MapFile:
    """Read a map from an HDF5 file with data sets of angles, positions and phases.

    It knows the layouts of Oxford (.h5oina), EDAX (.oh5, .h5), Bruker, EMsoft, orix, kikuchipy and
    DREAM.3D (see `hdf5_layouts`), and others if their data sets have usual names. Positions are in
    um unless the file names another unit.

    Parameters
    ----------
    given
        Number of a phase (0: all others) -> its Laue group. orix counts phases from 0, this reader
        from 1.
    columns
        Quantity (phi1, Phi, phi2, or euler for all three; x, y, phase) -> path of its data set.
    part
        Number from 0, or name, of one of several maps or planes in the file.

    Raises
    ------
    MissingExtraError
        h5py is not installed.
    FileFormatError
        The file is damaged, or holds no map with known names; the message lists the data sets.
    OrientationError
        The file holds several maps and none was chosen, or a chosen data set is missing.
    LimitError
        The map declares more data than fit in memory.
    """
    laue = checks.table(given, "laue", FileFormatError)
    try:
        h5py = import_module("h5py")
    except ImportError:
        raise MissingExtraError(
            f"{path.name}: HDF5 files need h5py, which is not installed. Run `pip install "
            "'geomtorsion[files]'`, or export the map as .ctf or .ang."
        ) from None
    check_hdf5(path, h5py)
    try:
        with h5py.File(path, "r") as file:
            scans = _scans(path, file) if not columns else _chosen(path, file, columns)
            if not scans:
                raise FileFormatError(
                    f"{path.name}: expected data sets phi1, Phi, phi2 or Euler of a map, "
                    f"or coframe of a field, got "
                    f'{_listed(file)}. Name them: columns={{"euler": '
                    '"path", "x": "path", "y": "path"} (--columns euler=path,...).'
                )
            scan = _part(path, scans, part)
            points = _points(path, file, scan, laue)
    except GeomtorsionError:
        raise
    except Exception as error:  # noqa: BLE001
        # A group instead of numbers, or a wrong shape, can raise many types of error.
        raise FileFormatError(
            f"{path.name}: expected the data sets of an orientation map, got others "
            f"({type(error).__name__}: {cut(str(error))}). Export it again, or as .ctf."
        ) from None
    check_laue(path.name, laue, points.phases)
    return gridded(points)


def _listed(file: Item) -> str:
    """The data sets of a file with their shapes, in words."""
    texts = [
        f"{one.name.lstrip('/')} {'x'.join(map(str, one.shape or ())) or 'scalar'}"
        for one in data_sets(file)
    ]
    return cut(", ".join(texts), 1000) or "no data sets"


def _quantities(group: Item) -> dict[str, Item]:
    """The data set of each quantity in a group; the first of several names counts."""
    items = {last(key): group.get(key) for key in group}
    found = {}
    for quantity, names in QUANTITIES.items():
        for name in names:
            item = items.get(name)
            if item is not None and is_data_set(item) and item.shape is not None:
                found[quantity] = item
                break
    return found


def _groups(group: Item, depth: int) -> list[Item]:
    """A group and all groups below it."""
    found = [group]
    for key in group if depth else ():
        item = group.get(key)
        if is_group(item):
            found += _groups(item, depth - 1)
    return found


def _scans(path: Path, file: Item) -> list[_Scan]:
    """The maps of a file, one for each group with angles, and for each plane of a volume."""
    scans: list[_Scan] = []
    for group in _groups(file, BOUNDS.groups):
        sets = _quantities(group)
        if "euler" in sets and (sets["euler"].ndim < 2 or sets["euler"].shape[-1] != 3):
            del sets["euler"]
        if "euler" not in sets and not any(keys <= set(sets) for keys in _ALL):
            continue
        name = group.name.strip("/")
        planes = int(header_of(group).get("planes", 1))
        levels = _levels(sets)
        if planes > 1:
            scans += (_Scan(f"{name} plane {k}", group, sets, {}, k) for k in range(planes))
        elif len(levels) > 1:
            scans += (_Scan(f"{name} z={z:g}", group, sets, {}, level=z) for z in levels)
        else:
            scans.append(_Scan(name, group, sets, {}))
    return scans


def _levels(sets: Mapping[str, Item]) -> list[float]:
    """Different z of the points of a map; none if z is not a number for each point."""
    angles = sets.get("euler", sets.get("phi1"))
    if "z" not in sets or angles is None or sets["z"].size != angles.shape[0]:
        return []
    if 8 * sets["z"].size > LARGEST_ARRAYS:
        return []
    return np.unique(np.asarray(sets["z"][()], dtype=float)).tolist()


def _chosen(path: Path, file: Item, columns: Mapping[str, int | str]) -> list[_Scan]:
    """The map with data sets that the user names; others of its group count by their names."""
    every = {one.name.strip("/"): one for one in data_sets(file)}
    sets, units = {}, {}
    for key, name in columns.items():
        quantity = UNIT.sub("", key)
        if unit := UNIT.search(key):
            units[quantity] = unit[1].lower()
        ends = [one for one in every if f"/{one}".endswith(f"/{str(name).strip('/')}")]
        if len(ends) != 1:
            raise OrientationError(
                f"columns: {quantity}: expected the path of one data set in {path.name}, got "
                f"{shown(name)}, which {'fits several' if ends else 'is not in it'}. It holds "
                f"{_listed(file)}."
            )
        sets[quantity] = every[ends[0]]
    angle = sets.get("euler", sets.get("phi1"))
    if angle is None:
        raise OrientationError(
            f"columns: expected euler, or phi1, Phi and phi2, got {', '.join(columns)}. Name the "
            "data sets of the angles."
        )
    group = angle.parent
    others = _quantities(group)
    if "euler" in sets:
        others = {key: one for key, one in others.items() if key not in _ANGLES}
    else:
        others.pop("euler", None)
    return [_Scan(group.name.strip("/"), group, others | sets, units)]


def _part(path: Path, scans: Sequence[_Scan], part: int | str | None) -> _Scan:
    """The chosen map, or the only one."""
    if part is None and len(scans) == 1:
        return scans[0]
    names = [scan.name for scan in scans]
    if isinstance(part, str) and part in names:
        return scans[names.index(part)]
    if isinstance(part, int) and not isinstance(part, bool) and 0 <= part < len(scans):
        return scans[part]
    listed = cut(", ".join(f"{k}: {name}" for k, name in enumerate(names)), 1000)
    got = f"{len(scans)} maps in {path.name}" if part is None else shown(part)
    raise OrientationError(
        f"slice: expected the number or the name of a map ({listed}), got {got}. "
        "Choose one: slice=0 (--slice 0)."
    )


@dataclass(frozen=True, eq=False)
class _Values:
    """Reader of the data sets of a map, or of one plane of a volume with this many planes."""

    scan: _Scan
    planes: int

    def __call__(self, key: str, width: int = 1) -> np.ndarray:
        """Numbers of a quantity, shape (points, width)."""
        item, plane = self.scan.sets[key], self.scan.plane
        if plane is None:
            found = item[()]
        elif item.ndim > 1 and item.shape[0] == self.planes:
            found = item[plane]
        else:
            count = item.shape[0] // self.planes
            found = item[plane * count : (plane + 1) * count]
        values = np.asarray(found, dtype=float).reshape(-1, width)
        if self.scan.level is not None and key != "z":
            values = values[self("z").ravel() == self.scan.level]
        return values

    def column(self, key: str) -> np.ndarray:
        """One number for each point."""
        return self(key).ravel()


def _points(path: Path, file: Item, scan: _Scan, laue: Mapping[int, str]) -> MapPoints:
    """The points of a map."""
    layout, header = layout_of(file, scan.group), header_of(scan.group)
    planes = 1 if scan.plane is None else int(header["planes"])
    size = sum(8 * prod(one.shape) for one in scan.sets.values()) // planes
    if size > LARGEST_ARRAYS:
        raise LimitError(
            f"{path.name}: expected at most {LARGEST_ARRAYS:,} bytes of angles, positions and "
            f"phases, got {size:,}. Export a part of the map."
        )
    values = _Values(scan, planes)
    euler, unit = _euler(path, scan, layout, values)
    count = len(euler)
    indexed = np.asarray(np.isfinite(euler).all(axis=1))
    euler = unit * np.where(indexed[:, None], euler, 0.0)
    largest = float(np.abs(euler[indexed]).max(initial=0.0))
    if largest > 4 * np.pi + 1e-3:
        raise FileFormatError(
            f"{path.name}: expected Euler angles of at most two turns, got {largest:g} radians. "
            'Give their unit: columns={"euler (deg)": "path"}.'
        )
    # EDAX writes 4 pi, and a confidence of -1, where nothing was indexed.
    if layout.program == "EDAX":
        indexed &= (euler < NOT_INDEXED).all(axis=1)
        if "confidence" in scan.sets:
            indexed &= values.column("confidence") >= 0
    where = f"{path.name}: {scan.name}"
    phases = {
        one.number: described(
            where, one.number, one.name, one.laue, laue, one.lattice, layout.horizontal
        )
        for one in phases_of(scan.group, layout)
    }
    phase = np.where(indexed, 1.0, 0.0)
    if "phase" in scan.sets:
        phase = np.where(indexed, values.column("phase") + layout.offset, 0.0)
    if "inside" in scan.sets:
        phase = np.where(values.column("inside") > 0, phase, 0.0)
    phase = _numbered(path, np.maximum(phase, 0.0), indexed, phases, laue)
    x, y, declared = _places(path, layout, header, count, values)
    # A map that is not a rectangle is padded with NaN.
    there = np.isfinite(x) & np.isfinite(y)
    return MapPoints(
        path.name, path.stat().st_size, x[there], y[there], euler[there],
        whole_phases(path.name, phase[there], phases), phases, declared,
    )  # fmt: skip


def _euler(path: Path, scan: _Scan, layout: Layout, values: _Values) -> tuple[np.ndarray, float]:
    """Angles phi1, Phi, phi2 of each point as stored, and their unit in radians."""
    if "euler" not in scan.sets and {"dictionary", "matches"} <= set(scan.sets):
        # EMsoft stores a dictionary, and the best entries for each point, from 1.
        matches = scan.sets["matches"]
        best = matches[:, 0] if matches.ndim > 1 else matches[()]
        return values("dictionary", 3)[np.asarray(best, dtype=int) - 1], ANGLES["deg"]
    if "euler" in scan.sets:
        euler = values("euler", 3)
    else:
        euler = np.concatenate([values(key) for key in _ANGLES], axis=1)
    return euler, _angle(path, scan, layout, euler[np.isfinite(euler).all(axis=1)])


def _numbered(
    path: Path, phase: np.ndarray, indexed: np.ndarray, phases: dict[int, Phase],
    laue: Mapping[int, str],
) -> np.ndarray:  # fmt: skip
    """Numbers of phases; with one phase, zeros at indexed points mean this phase."""
    if not phase.any():
        phase = np.where(indexed, next(iter(phases), 1), 0)
    if not phases:
        numbers = np.unique(phase[phase > 0]).tolist()
        if len(numbers) > BOUNDS.phases or any(x != int(x) for x in numbers):
            raise FileFormatError(
                f"{path.name}: phase: expected up to {BOUNDS.phases} whole numbers, got "
                f"{len(numbers)} numbers such as {numbers[0]:g}. Name another data set."
            )
        for number in map(int, numbers):
            phases[number] = described(path.name, number, f"phase {number}", None, laue)
    return phase


def _angle(path: Path, scan: _Scan, layout: Layout, euler: np.ndarray) -> float:
    """Unit of the angles: as given, in the file, of the program, or larger than two turns."""
    key = "euler" if "euler" in scan.sets else "phi1"
    attributes = {str(name).lower(): value for name, value in scan.sets[key].attrs.items()}
    words = [scan.units.get(key, ""), *(attributes.get(name, "") for name in ("unit", "units"))]
    for text in map(_decoded, words):
        if text.strip().lower() in _UNITS:
            return _UNITS[text.strip().lower()]
    if layout.angle is not None:
        return layout.angle
    if len(euler) and np.abs(euler).max() > 4 * np.pi:
        return ANGLES["deg"]
    raise OrientationError(
        f"columns: {key}: expected the unit of the angles in {path.name}, got none in a file of an "
        f'unknown program. Write columns={{"{key} (deg)": "..."}} or "{key} (rad)" '
        f'(--columns "{key} (deg)=...").'
    )


def _places(
    path: Path, layout: Layout, header: Mapping[str, Any], count: int, values: _Values
) -> tuple[np.ndarray, np.ndarray, Declared | None]:
    """Positions of the points in um, and the grid in the header."""
    unit = _decoded(header.get("unit", "um"))
    if unit not in UNITS:
        raise FileFormatError(
            f"{path.name}: expected steps in {' or '.join(UNITS)}, got steps in {shown(unit)}. Set "
            "the unit in the program and save the map again, or export it as .ctf or .ang."
        )
    factor = UNITS[unit] / UNITS["um"]
    declared, rows, columns = None, 0, 0
    is_hexagonal = _decoded(header.get("grid", "")).lower().startswith("hex")
    if {"rows", "columns", "dx", "dy"} <= set(header) and not is_hexagonal:
        rows, columns = int(header["rows"]), int(header["columns"])
        steps = factor * float(header["dx"]), factor * float(header["dy"])
        if not 0 < rows * columns <= count or min(steps) <= 0:
            raise FileFormatError(
                f"{path.name}: expected angles and phase of {columns} x {rows} points with steps "
                f"above 0, got {count:,} points and steps {steps[0]:g} and {steps[1]:g}. Export "
                "the map again."
            )
        declared = Declared(np.full(rows, columns), steps)
    if layout.has_y and {"x", "y"} <= set(values.scan.sets):
        x, y = (factor * values.column(key) for key in "xy")
        if len(x) == len(y) == count:
            # EDAX and Bruker may store numbers of pixels.
            if declared is not None and _counts(x, columns) and _counts(y, rows):
                x, y = declared.steps[0] * x, declared.steps[1] * y
            return x, y, declared
    if declared is None:
        raise FileFormatError(
            f"{path.name}: expected positions x and y of {count:,} points, or the numbers of rows "
            'and columns with steps, got none. Name them: columns={"x": "path", "y": "path"}.'
        )
    row, across = np.divmod(np.arange(count), int(declared.counts[0]))
    return declared.steps[0] * across, declared.steps[1] * row, declared


def _counts(places: np.ndarray, count: int) -> bool:
    """Whether places are the numbers of pixels from 0 to count - 1, each of them."""
    return count > 1 and np.array_equal(np.unique(places), np.arange(count))


def _decoded(value: Any) -> str:
    """A text, which HDF5 may hold as bytes."""
    text = value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
    return text.strip("\0 ")
