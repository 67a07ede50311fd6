"""Grid files: sampled frames read and written, each format by the library that has it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion.checks import cut, shown
from geomtorsion.errors import FileFormatError, GridError
from geomtorsion.loops.fields import netcdf, tables
from geomtorsion.loops.fields.contents import TEXTS, Contents, key_of
from geomtorsion.npz import ArrayForm, read_npz, text_of

FORMS = {
    "names": ArrayForm((None,), "U", optional=True),
    "axis_*": ArrayForm((None,)),
    "coframe": ArrayForm((None, None, ...), optional=True),
    "distortion": ArrayForm((None, None, ...), optional=True),
    "sigma": ArrayForm((None, None, ...), optional=True),
    "covariance": ArrayForm((None, None, None, None, ...), optional=True),
    "periodic": ArrayForm((None,), "b", optional=True),
    "unit": ArrayForm((), "U", optional=True),
    "vector_unit": ArrayForm((), "U", optional=True),
    "source": ArrayForm((), "U", optional=True),
}


def read_grid(path: Path) -> Contents:
    """What a file holds, by the end of its name.

    .npz: an array `coframe` or `distortion` of shape (rows, d, N_1, ..., N_d), and one array
    `axis_x`, `axis_y`, ... for each axis, in the order in which `names` lists them (or in which
    they stand in the file). .h5, .hdf5: the same as data sets (extra `files`). .nc: a variable
    `coframe` or `distortion` with dimensions (row, column, x, y, ...) and a coordinate variable for
    each dimension of the grid. .csv: see `tables.read_csv`. .vtk, .vtu: see `tables.read_vtk`
    (extra `files`). All may hold sigma, units, periods and a source; .npz, .h5 and
    .nc a covariance in its place.

    Raises
    ------
    FileFormatError
        The file is missing, truncated or malformed, or lacks an array.
    MissingExtraError
        The library for the format is not installed.
    """
    if not path.is_file():
        raise FileFormatError(f"{path}: there is no such file.")
    kind = path.suffix.lower()
    if kind not in FORMATS:
        raise FileFormatError(
            f"{path}: .npz or .nc (or {', '.join(OTHERS)}) was needed, but the name ends in "
            f"{path.suffix!r}. For arrays in memory use SampledFrame(axes, coframe)."
        )
    return FORMATS[kind][0](path)


def save_grid(path: Path, contents: Contents) -> None:
    """Write a file that `read_grid` reads, under the very name that is given.

    Without an end of its name it becomes .npz.

    Raises
    ------
    GridError
        No format is known by the end of the name.
    """
    kind = path.suffix.lower() or ".npz"
    if kind not in FORMATS:
        raise GridError(
            f"{path}: .npz or .nc (or {', '.join(OTHERS)}) was needed, but the name ends in "
            f"{path.suffix!r}."
        )
    FORMATS[kind][1](path if path.suffix else path.with_suffix(".npz"), contents)


def holds_covariance(path: Path) -> bool:
    """Whether the format that a name ends in has room for covariances: tables have none."""
    return (path.suffix.lower() or ".npz") not in (".csv", ".vtk", ".vtu")


def _npz(path: Path) -> Contents:
    """A grid from an NPZ file."""
    message = "{path}: it cannot be read, it is truncated or no file of this kind ({reason})."
    arrays = read_npz(path, FORMS, message=message)
    key = key_of(path, arrays)
    if "names" in arrays:
        names = tuple(str(name) for name in arrays["names"])
    else:
        names = tuple(name.removeprefix("axis_") for name in arrays if name.startswith("axis_"))
    axes = []
    for name in names:
        if f"axis_{name}" not in arrays:
            raise FileFormatError(
                f"{path}: the array axis_{cut(name)} is missing; names lists {shown(names)}."
            )
        axes.append(arrays[f"axis_{name}"])
    if not axes:
        raise FileFormatError(
            f"{path}: no axes; arrays axis_x, axis_y, ... were needed, but the file has "
            f"{cut(', '.join(sorted(arrays)))}."
        )
    options: dict[str, Any] = {k: text_of(arrays[k]) for k in TEXTS if k in arrays}
    options |= {k: arrays[k] for k in ("sigma", "covariance", "periodic") if k in arrays}
    return Contents(axes, arrays[key], names, key == "distortion", options)


def _write_npz(path: Path, contents: Contents) -> None:
    """A grid as an NPZ file."""
    arrays: dict[str, Any] = {"coframe": contents.values, "names": np.array(contents.names)}
    for name, axis in zip(contents.names, contents.axes, strict=True):
        arrays[f"axis_{name}"] = axis
    arrays |= {key: np.asarray(value) for key, value in contents.options.items()}
    with path.open("wb") as stream:
        np.savez_compressed(stream, **arrays)


# How each format is read and written.
FORMATS: dict[str, tuple[Callable[[Path], Contents], Callable[[Path, Contents], None]]] = {
    ".npz": (_npz, _write_npz),
    **dict.fromkeys((".nc", ".cdf", ".netcdf"), (netcdf.read_netcdf, netcdf.write_netcdf)),
    **dict.fromkeys((".h5", ".hdf5"), (netcdf.read_hdf5, netcdf.write_hdf5)),
    ".csv": (tables.read_csv, tables.write_csv),
    **dict.fromkeys((".vtk", ".vtu"), (tables.read_vtk, tables.write_vtk)),
}
OTHERS = [end for end in FORMATS if end not in (".npz", ".nc", ".cdf", ".netcdf")]
