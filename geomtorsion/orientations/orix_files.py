"""Orix files: orientation maps in HDF5, through orix, which is an optional extra."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path

import numpy as np

from geomtorsion.checks import cut
from geomtorsion.errors import FileFormatError, GeomtorsionError, MissingExtraError
from geomtorsion.orientations.map_files import MapFile
from geomtorsion.orientations.phases import Phase

SUFFIXES = (".h5", ".hdf5")


def read_orix(path: Path, laue: Mapping[int, str]) -> MapFile:
    """A square grid of an HDF5 file that orix knows (its own, kikuchipy's, EMsoft's, Bruker's).

    Numbers of phases are those of orix and one more: its phases begin with 0.

    Raises
    ------
    MissingExtraError
        orix is not installed.
    FileFormatError
        orix cannot read the file, or it holds no whole square grid.
    """
    try:
        # GPL: imported where it is installed, and never needed for anything else.
        io = import_module("orix.io")
    except ImportError:
        raise MissingExtraError(
            f"{path.name}: HDF5 files need orix, which is not installed. Run `pip install "
            "geomtorsion[ebsd]`, or export the map as .ctf or .ang."
        ) from None
    try:
        found = io.load(str(path))
        rows, columns = found.shape
        euler = found.rotations.to_euler()
        number = np.where(found.is_indexed, found.phase_id + 1, 0)
        steps = float(found.dx), float(found.dy)
    except Exception as error:  # noqa: BLE001
        # Readers of several formats, each with errors of its own.
        reason = cut(str(error)) or type(error).__name__
        raise FileFormatError(
            f"{path.name}: orix cannot read a map of rows and columns from it ({reason}). Export "
            "it as .ctf or .ang."
        ) from None
    euler = np.reshape(euler, (-1, *np.shape(euler)[-1:]))
    if len(euler) != rows * columns or min(steps) <= 0:
        raise FileFormatError(
            f"{path.name}: {rows} x {columns} points were needed, but {len(euler)} points "
            f"with steps {steps[0]:g} and {steps[1]:g} came. Export the map on its full grid."
        )
    phases = {}
    for key, phase in found.phases:
        if key < 0:
            continue
        group = None if phase.point_group is None else phase.point_group.laue.name
        lattice = phase.structure.lattice
        known = laue.get(key + 1, group)
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
    return MapFile(
        np.asarray(euler, dtype=float).reshape(rows, columns, 3),
        np.asarray(number).reshape(rows, columns),
        phases,
        steps,
    )
