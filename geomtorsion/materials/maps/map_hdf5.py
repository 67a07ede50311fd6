"""Map HDF5: orientation maps in .h5oina files (Oxford), by h5py, and in files that orix reads."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion.errors import (
    FileFormatError,
    GeomtorsionError,
    MissingExtraError,
)
from geomtorsion.materials.maps.map_phases import (
    LAUE_NUMBERS,
    check_laue,
    described,
    whole_phases,
)
from geomtorsion.materials.maps.map_points import Declared, MapFile, MapPoints, gridded
from geomtorsion.materials.maps.phases import Phase
from geomtorsion.materials.maps.results import UNITS
from geomtorsion.support import checks
from geomtorsion.support.checks import cut, shown
from geomtorsion.support.hdf5 import check_hdf5


def read_h5oina(path: Path, given: Mapping[int, str] | None = None) -> MapFile:
    """Read a map of Oxford Instruments (AZtec), following its published specification.

    Angles are in radians, positions in um. A file holds one acquisition.

    Raises
    ------
    MissingExtraError
        h5py is not installed.
    FileFormatError
        The file is damaged, or does not hold exactly one EBSD map.
    """
    laue = checks.table(given, "laue", FileFormatError)
    try:
        h5py = import_module("h5py")
    except ImportError:
        raise MissingExtraError(
            f"{path.name}: .h5oina files need h5py, which is not installed. Run `pip install "
            "'geomtorsion[files]'`, or export the map as .ctf."
        ) from None
    names = check_hdf5(path, h5py)
    try:
        with h5py.File(path, "r") as file:
            maps = [name for name in names if "EBSD/Data" in file[name]]
            if len(maps) != 1:
                raise FileFormatError(
                    f"{path.name}: expected one EBSD map (group 1/EBSD/Data), got {len(maps)} in "
                    f"{cut(', '.join(names)) or 'an empty file'}. Export each map with its EBSD "
                    "data to a file of its own."
                )
            points = _h5oina(path, file[maps[0]]["EBSD"], laue)
    except GeomtorsionError:
        raise
    except Exception as error:  # noqa: BLE001
        # A group instead of numbers, or a wrong shape, can raise many types of error.
        raise FileFormatError(
            f"{path.name}: expected the data sets of an .h5oina file, got others "
            f"({type(error).__name__}: {cut(str(error))}). Export it again, or as .ctf."
        ) from None
    check_laue(path.name, laue, points.phases)
    return gridded(points)


def _h5oina(path: Path, group: Any, laue: Mapping[int, str]) -> MapPoints:
    """The points of an acquisition."""
    data, header = group["Data"], group["Header"]

    def column(name: str, width: int = 1) -> np.ndarray:
        return np.asarray(data[name][()], dtype=float).reshape(-1, width)

    def first(name: str) -> float:
        return float(np.ravel(header[name][()])[0])

    phases: dict[int, Phase] = {}
    for key in header["Phases"]:
        entry = header["Phases"][key]
        title = np.ravel(entry["Phase Name"][()])[0]
        title = title.decode("utf-8", "replace") if isinstance(title, bytes) else str(title)
        lattice = [np.ravel(entry[f"Lattice {what}"][()]) for what in ("Dimensions", "Angles")]
        group_name = LAUE_NUMBERS.get(float(np.ravel(entry["Laue Group"][()])[0]))
        phases[int(key)] = described(
            f"{path.name}: Phases/{key}", int(key), title, group_name, laue,
            (lattice[0].tolist(), np.degrees(lattice[1]).round(6).tolist()), "y",
        )  # fmt: skip
    euler, phase = column("Euler", 3), column("Phase").ravel()
    count = len(phase)
    rows, columns = int(first("Y Cells")), int(first("X Cells"))
    steps = first("X Step"), first("Y Step")
    if len(euler) != count or not 0 < rows * columns <= count:
        raise FileFormatError(
            f"{path.name}: expected angles and phase of {columns} x {rows} points, got "
            f"{len(euler):,} and {count:,}. Export the map again."
        )
    declared = Declared(np.full(rows, columns), steps)
    row, across = np.divmod(np.arange(count), columns)
    x, y = (
        column(name).ravel() if name in data else step * place
        for name, step, place in (("X", steps[0], across), ("Y", steps[1], row))
    )
    # A map that is not a rectangle is padded with NaN.
    phase = np.where(np.isfinite(euler).all(axis=1), phase, 0)
    there = np.isfinite(x) & np.isfinite(y)
    return MapPoints(
        path.name, path.stat().st_size, x[there], y[there], np.nan_to_num(euler[there]),
        whole_phases(path.name, phase[there], phases), phases, declared,
    )  # fmt: skip


def _check_places(name: str, found: Any, steps: tuple[float, float]) -> None:
    """Refuse points of orix that are not sorted row by row."""
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
                f"{name}: point {k + 1}: expected {axis} = {values[0] + step * place[k]:g} from "
                f"steps of {step:g}, got {values[k]:g}. Sort the points by rows, or export the map "
                "as .ctf or .ang."
            )


def read_orix(path: Path, given: Mapping[int, str] | None = None) -> MapFile:
    """Read a square grid from an HDF5 file that orix supports (orix, kikuchipy, EMsoft, Bruker).

    Phase numbers are one larger than in orix, which counts from 0. Steps are in um.

    given: number of a phase (0: all other phases) -> name of its Laue group, which overrides the
    group in the file.

    Raises
    ------
    MissingExtraError
        orix is not installed.
    FileFormatError
        orix cannot read the file, or the file does not hold a complete square grid.
    """
    laue = checks.table(given, "laue", FileFormatError)
    try:
        # orix is GPL software: it is optional, and only this reader imports it.
        io, h5py = import_module("orix.io"), import_module("h5py")
    except ImportError:
        raise MissingExtraError(
            f"{path.name}: HDF5 files need orix, which is not installed. Run `pip install "
            "'geomtorsion[ebsd]'`, or export the map as .ctf or .ang."
        ) from None
    names = check_hdf5(path, h5py)
    try:
        with warnings.catch_warnings():
            # If a file gives degrees instead of radians, orix reads it and only warns.
            warnings.filterwarnings("error", "Angles are quite high")
            crystal_map = io.load(str(path))
        rows, columns = crystal_map.shape
        euler = crystal_map.rotations.to_euler()
        number = np.where(crystal_map.is_indexed, crystal_map.phase_id + 1, 0)
        steps = float(crystal_map.dx), float(crystal_map.dy)
    except Exception as error:  # noqa: BLE001
        # orix has readers of several formats, which raise different errors. An AttributeError names
        # parts of orix: it has no reader for the manufacturer, or a part of the map is missing.
        reason = cut(str(error)) or type(error).__name__
        if isinstance(error, AttributeError):
            reason = "it has no reader for this manufacturer, or a part of the map is missing"
        raise FileFormatError(
            f"{path.name}: expected a map of rows and columns, got a file that orix cannot read "
            f"({reason}). Its groups are {cut(', '.join(names)) or 'none'}. Export it as .ctf or "
            ".ang."
        ) from None
    euler = np.reshape(euler, (-1, *np.shape(euler)[-1:]))
    if len(euler) != rows * columns or min(steps) <= 0:
        raise FileFormatError(
            f"{path.name}: expected {rows} x {columns} points with steps above 0, got "
            f"{len(euler)} with steps {steps[0]:g} and {steps[1]:g}. Export the map on its full "
            "grid."
        )
    # For Bruker files, orix sorts the points but not their positions.
    if "XSAMPLE" not in crystal_map.prop:
        _check_places(path.name, crystal_map, steps)
    # orix writes px if the step size was not given.
    name = str(crystal_map.scan_unit)
    if name not in UNITS:
        raise FileFormatError(
            f"{path.name}: expected steps in {' or '.join(UNITS)}, got steps in {shown(name)}. Set "
            "steps and scan_unit in orix and save the map again, or export it as .ctf or .ang."
        )
    unit = UNITS[name] / UNITS["um"]
    phases = {}
    for key, phase in crystal_map.phases:
        if key < 0:
            continue
        group = None if phase.point_group is None else phase.point_group.laue.name
        lattice = phase.structure.lattice
        symmetry = laue.get(key + 1, laue.get(0, group))
        if symmetry is None:
            raise FileFormatError(
                f"{path.name}: phase {key + 1} ({phase.name}): its symmetry is not known. Give it, "
                f'for example laue={{{key + 1}: "m-3m"}}.'
            )
        try:
            phases[int(key) + 1] = Phase(
                str(phase.name),
                symmetry,
                (float(lattice.a), float(lattice.b), float(lattice.c)),
                (float(lattice.alpha), float(lattice.beta), float(lattice.gamma)),
            )
        except GeomtorsionError as error:
            raise FileFormatError(f"{path.name}: {error}") from None
    check_laue(path.name, laue, phases)
    return MapFile(
        np.asarray(euler, dtype=float).reshape(rows, columns, 3),
        np.asarray(number).reshape(rows, columns),
        phases,
        (steps[0] * unit, steps[1] * unit),
    )
