"""Grid files: axes and values of a sampled frame, checked, and read from NPZ and NetCDF."""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Callable, Iterable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion.checks import cut, shown
from geomtorsion.errors import FileFormatError, GridError, MissingExtraError
from geomtorsion.loops.fields.grid import Grid
from geomtorsion.npz import ArrayForm, read_npz, text_of

Read = tuple[list[np.ndarray], np.ndarray, tuple[str, ...], bool, dict[str, Any]]
TEXTS = ("unit", "vector_unit", "source")
HDF5 = b"\x89HDF"
FORMS = {
    "names": ArrayForm((None,), "U", optional=True),
    "axis_*": ArrayForm((None,)),
    "coframe": ArrayForm((None, None, ...), optional=True),
    "distortion": ArrayForm((None, None, ...), optional=True),
    "sigma": ArrayForm((None, None, ...), optional=True),
    "periodic": ArrayForm((None,), "b", optional=True),
    "unit": ArrayForm((), "U", optional=True),
    "vector_unit": ArrayForm((), "U", optional=True),
    "source": ArrayForm((), "U", optional=True),
}


def read_grid(path: Path) -> Read:
    """Axes, values, names of the axes, and whether the values are a distortion.

    NPZ: an array `coframe` or `distortion` of shape (rows, d, N_1, ..., N_d), and one array
    `axis_x`, `axis_y`, ... for each axis, in the order in which `names` lists them (or in which
    they stand in the file). NetCDF: a variable `coframe` or `distortion` with dimensions
    (row, column, x, y, ...) and a coordinate variable for each dimension of the grid.

    Raises
    ------
    FileFormatError
        The file is missing, truncated or malformed, or lacks an array.
    """
    if not path.is_file():
        raise FileFormatError(f"{path}: there is no such file.")
    kind = path.suffix.lower()
    if kind == ".npz":
        return _npz(path)
    if kind in (".nc", ".cdf", ".netcdf"):
        return _netcdf(path)
    raise FileFormatError(
        f"{path}: .npz or .nc was needed, but the name ends in {path.suffix!r}. "
        "For arrays in memory use SampledFrame(axes, coframe)."
    )


def save_grid(path: Path, grid: Grid, coframe: np.ndarray, options: Mapping[str, Any]) -> None:
    """Write a grid to a file that `read_grid` reads, under the very name that is given."""
    kind = path.suffix.lower()
    if kind not in (".npz", ""):
        raise GridError(f"{path}: .npz was needed, but the name ends in {path.suffix!r}.")
    content: dict[str, Any] = {"coframe": coframe, "names": np.array(grid.names)}
    for name, axis in zip(grid.names, grid.axes, strict=True):
        content[f"axis_{name}"] = axis
    content |= {
        key: np.asarray(value)
        for key, value in options.items()
        if value is not None and np.size(value) and str(value)
    }
    with path.with_suffix(".npz").open("wb") as stream:
        np.savez_compressed(stream, **content)


def _npz(path: Path) -> Read:
    """A grid from an NPZ file."""
    message = "{path}: it cannot be read, it is truncated or no file of this kind ({reason})."
    arrays = read_npz(path, FORMS, message=message)
    key = _key(path, arrays)
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
    options |= {k: arrays[k] for k in ("sigma", "periodic") if k in arrays}
    return axes, arrays[key], names, key == "distortion", options


def _netcdf(path: Path) -> Read:
    """A grid from a NetCDF file: by xarray if it is installed, classic files by scipy otherwise."""
    try:
        xarray = import_module("xarray")
    except ImportError:
        return _classic(path)

    def load() -> Any:
        with xarray.open_dataset(path) as data:
            return data.load()

    data = _guarded(path, load)
    key = _key(path, data.variables)
    variable = data[key]
    names = tuple(str(name) for name in variable.dims[2:])
    for name in names:
        if name not in data.coords:
            raise FileFormatError(f"{path}: dimension {name} of {key} has no coordinates.")
    return [data[name].values for name in names], variable.values, names, key == "distortion", {}


def _classic(path: Path) -> Read:
    """A grid from a classic NetCDF file, by scipy."""
    from scipy.io import netcdf_file  # 0.2 s, and this format alone needs it

    with path.open("rb") as stream:
        if stream.read(4) == HDF5:
            raise MissingExtraError(
                f"{path}: this is NetCDF 4, which needs xarray with a backend. "
                "Install them: pip install xarray netcdf4."
            )

    def load() -> tuple[dict[str, np.ndarray], dict[str, tuple[str, ...]]]:
        with netcdf_file(path, mmap=False) as data:
            arrays = {name: variable[:].copy() for name, variable in data.variables.items()}
            sizes = {name: variable.dimensions for name, variable in data.variables.items()}
            return arrays, sizes

    arrays, dimensions = _guarded(path, load)
    key = _key(path, arrays)
    names = tuple(dimensions[key][2:])
    for name in names:
        if name not in arrays:
            raise FileFormatError(f"{path}: dimension {name} of {key} has no coordinate variable.")
    return [arrays[name] for name in names], arrays[key], names, key == "distortion", {}


def _guarded(path: Path, load: Callable[[], Any]) -> Any:
    """What a reader returns, with its failures as an error of ours."""
    try:
        return load()
    except (
        OSError, EOFError, ValueError, TypeError, KeyError, IndexError, AssertionError,
        zipfile.BadZipFile, zlib.error,
    ) as error:  # fmt: skip
        raise FileFormatError(
            f"{path}: it cannot be read, it is truncated or no file of this kind "
            f"({type(error).__name__}: {cut(str(error))})."
        ) from None


def _key(path: Path, arrays: Iterable[str]) -> str:
    """Which array holds the values."""
    found = [key for key in ("coframe", "distortion") if key in arrays]
    if len(found) != 1:
        present = cut(", ".join(sorted(map(str, arrays)))) or "nothing"
        raise FileFormatError(
            f"{path}: exactly one of coframe and distortion was needed, but the file has {present}."
        )
    return found[0]
