"""Grid files: axes and values of a sampled frame, checked, and read from NPZ and NetCDF."""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Callable, Iterable, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion import checks
from geomtorsion.checks import cut, shown
from geomtorsion.errors import FileFormatError, GridError, MissingExtraError
from geomtorsion.npz import ArrayForm, read_npz

# Steps of an axis may differ by this share: coordinates are often stored as 32-bit floats.
REGULAR = 1e-4


def numbers(values: object, where: str) -> np.ndarray:
    """An array of real numbers."""
    message = "{subject}: an array of real numbers was needed, but {value} came."
    return checks.array(values, where, GridError, message=message, infinite=None)


def regular_axis(values: object, name: str) -> np.ndarray:
    """A regular axis."""
    axis = numbers(values, f"axis {name}")
    if axis.ndim != 1 or len(axis) < 2:
        raise GridError(f"axis {name}: a list of coordinates was needed, shape {axis.shape} came.")
    if not np.isfinite(axis).all():
        raise GridError(
            f"axis {name}: finite numbers were needed; entry "
            f"{int(np.flatnonzero(~np.isfinite(axis))[0])} is none."
        )
    step = (axis[-1] - axis[0]) / (len(axis) - 1)
    worst = int(np.abs(np.diff(axis) - step).argmax())
    if step == 0 or abs(axis[worst + 1] - axis[worst] - step) > REGULAR * abs(step):
        raise GridError(
            f"axis {name}: equal steps were needed, but step {worst} is "
            f"{axis[worst + 1] - axis[worst]:.6g} where the mean is {step:.6g}. Resample the data."
        )
    return axis


def check_shape(
    values: np.ndarray, axes: Sequence[np.ndarray], names: Sequence[str], needed: int, order: int
) -> None:
    """Refuse values that do not fit the axes, and axes too short for the order."""
    shape = tuple(len(axis) for axis in axes)
    if values.shape[1:] != (len(axes), *shape) or not len(values):
        raise GridError(
            f"coframe: shape (rows, {len(axes)}, {', '.join(map(str, shape))}) was needed "
            f"(frame index, coordinate index, grid), but {values.shape} came."
        )
    for name, count in zip(names, shape, strict=True):
        if count < needed:
            raise GridError(
                f"axis {name}: {needed} points or more are needed for order {order} with its error "
                f"estimate, but there are {count}. Choose a lower order."
            )


def check_finite(values: np.ndarray, axes: Sequence[np.ndarray], names: Sequence[str]) -> None:
    """Refuse values that are not finite; the message names the first."""
    bad = np.argwhere(~np.isfinite(values))
    if len(bad):
        i, mu, *place = bad[0].tolist()
        where = ", ".join(
            f"{name} = {axis[k]:.6g}" for name, axis, k in zip(names, axes, place, strict=True)
        )
        raise GridError(
            f"coframe[{i}, {mu}] is not finite at {where} (and at {len(bad) - 1} more entries). "
            "Cut those nodes out or fill them; a singular line must lie between nodes."
        )


def check_names(axes: Sequence[object], names: Sequence[str]) -> None:
    """Refuse a grid with less than two axes, or without a name for each."""
    if len(names) != len(axes) or len(axes) < 2:
        raise GridError(
            f"a grid needs two axes or more, and a name for each, but {len(axes)} axes "
            f"and {len(names)} names came."
        )


Grid = tuple[list[np.ndarray], np.ndarray, tuple[str, ...], bool]
HDF5 = b"\x89HDF"
FORMS = {
    "names": ArrayForm((None,), "U", optional=True),
    "axis_*": ArrayForm((None,)),
    "coframe": ArrayForm((None, None, ...), optional=True),
    "distortion": ArrayForm((None, None, ...), optional=True),
}


def read_grid(path: Path) -> Grid:
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


def _npz(path: Path) -> Grid:
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
    return axes, arrays[key], names, key == "distortion"


def _netcdf(path: Path) -> Grid:
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
    return [data[name].values for name in names], variable.values, names, key == "distortion"


def _classic(path: Path) -> Grid:
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
    return [arrays[name] for name in names], arrays[key], names, key == "distortion"


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
