"""Grid files: sampled frames in NPZ, NetCDF, HDF5, CSV and VTK, each by the library that has it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import scipy  # loads its parts when they are asked for

from geomtorsion.checks import cut, shown, unmasked
from geomtorsion.errors import FileFormatError, GridError, MissingExtraError
from geomtorsion.loops.fields import tables
from geomtorsion.loops.fields.contents import (
    TEXTS,
    Contents,
    check_room,
    guarded,
    key_of,
    module,
    periodic_names,
)
from geomtorsion.npz import ArrayForm, read_npz, text_of

FORMS = {
    "names": ArrayForm((None,), "U", optional=True),
    "axis_*": ArrayForm((None,)),
    "coframe": ArrayForm((None, None, ...), optional=True),
    "distortion": ArrayForm((None, None, ...), optional=True),
    "sigma": ArrayForm((None, None, ...), optional=True),
    "covariance": ArrayForm((None, None, None, None, ...), optional=True),
    "mask": ArrayForm((None, None, ...), "biu", optional=True),
    "periodic": ArrayForm((None,), "b", optional=True),
    "unit": ArrayForm((), "U", optional=True),
    "vector_unit": ArrayForm((), "U", optional=True),
    "source": ArrayForm((), "U", optional=True),
}
HDF5 = b"\x89HDF"
# What may say how the values scatter.
NOISE = ("sigma", "covariance")
# What says where nothing is known, beside NaN.
MASK = "mask"


def read_grid(path: Path) -> Contents:
    """What a file holds, by the end of its name.

    .npz: an array `coframe` or `distortion` of shape (rows, d, N_1, ..., N_d), and one array
    `axis_x`, `axis_y`, ... for each axis, in the order in which `names` lists them (or in which
    they stand in the file). .h5, .hdf5: the same as data sets (extra `files`). .nc: a variable
    `coframe` or `distortion` with dimensions (row, column, x, y, ...) and a coordinate variable for
    each dimension of the grid. .csv: see `tables.read_csv`. .vtk, .vtu: see `tables.read_vtk`
    (extra `files`). All may hold sigma, units, periods and a source; .npz, .h5 and
    .nc a covariance in its place, and a mask, 1 at each node where nothing is known.

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
    options |= {k: arrays[k] for k in ("periodic",) if k in arrays} | _known(path, arrays)
    return Contents(axes, arrays[key], names, key == "distortion", options)


def _write_npz(path: Path, contents: Contents) -> None:
    """A grid as an NPZ file."""
    arrays: dict[str, Any] = {"coframe": contents.values, "names": np.array(contents.names)}
    for name, axis in zip(contents.names, contents.axes, strict=True):
        arrays[f"axis_{name}"] = axis
    arrays |= {key: np.asarray(value) for key, value in contents.options.items()}
    with path.open("wb") as stream:
        np.savez_compressed(stream, **arrays)


def read_netcdf(path: Path) -> Contents:
    """By xarray if it is installed; classic files by scipy otherwise."""
    try:
        xarray = import_module("xarray")
    except ImportError:
        return _classic(path)

    def load() -> Any:
        # Times stay the numbers that they are, as the other reader has them.
        with xarray.open_dataset(path, decode_times=False) as data:
            for name, variable in data.variables.items():
                check_room(path, str(name), variable.shape)
            return data.load()

    data = guarded(path, load)
    key = key_of(path, data.variables)
    variable = data[key]
    names = tuple(str(name) for name in variable.dims[2:])
    for name in names:
        if name not in data.coords:
            raise FileFormatError(f"{path}: dimension {name} of {key} has no coordinates.")
    more = {name: data[name].values for name in (*NOISE, MASK) if name in data.variables}
    axes = [data[name].values for name in names]
    return Contents(
        axes, variable.values, names, key == "distortion", _options(path, more, data.attrs)
    )


def _classic(path: Path) -> Contents:
    """A classic file, by scipy."""
    with path.open("rb") as stream:
        if stream.read(4) == HDF5:
            raise MissingExtraError(
                f"{path}: this is NetCDF 4, which needs xarray with a backend. "
                "Install them: pip install 'geomtorsion[files]'."
            )

    def load() -> tuple[dict[str, np.ndarray], dict[str, tuple[str, ...]], dict[str, Any]]:
        # Values that mark what is missing, and scales, are those of the attributes, as in xarray.
        with scipy.io.netcdf_file(path, mmap=False, maskandscale=True) as data:
            arrays = {
                name: unmasked(variable[...]).copy() for name, variable in data.variables.items()
            }
            sizes = {name: variable.dimensions for name, variable in data.variables.items()}
            texts = {
                name: value.decode() if isinstance(value, bytes) else value
                for name, value in data._attributes.items()
            }
            return arrays, sizes, texts

    arrays, dimensions, texts = guarded(path, load)
    key = key_of(path, arrays)
    names = tuple(dimensions[key][2:])
    for name in names:
        if name not in arrays:
            raise FileFormatError(f"{path}: dimension {name} of {key} has no coordinate variable.")
    options = _options(path, arrays, texts)
    axes = [arrays[name] for name in names]
    return Contents(axes, arrays[key], names, key == "distortion", options)


def _options(path: Path, arrays: Mapping[str, np.ndarray], texts: Any) -> dict[str, Any]:
    """Noise, holes, periods and texts."""
    found: dict[str, Any] = {key: texts[key] for key in TEXTS if key in texts}
    found |= _known(path, arrays)
    if "periodic" in texts:
        found["periodic"] = periodic_names(texts["periodic"], path)
    return found


def _known(path: Path, arrays: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Noise, and where nothing is known: True, or 1 where a format has no truth values."""
    found = {name: arrays[name] for name in NOISE if name in arrays}
    if MASK in arrays:
        if not np.isin(arrays[MASK], (0, 1)).all():
            raise FileFormatError(
                f"{path}: {MASK}: 1 where nothing is known and 0 elsewhere were needed, but other "
                "numbers came."
            )
        found[MASK] = arrays[MASK] == 1
    return found


def write_netcdf(path: Path, contents: Contents) -> None:
    """A classic file, which every library reads."""
    with scipy.io.netcdf_file(path, "w") as data:
        for name, axis in zip(contents.names, contents.axes, strict=True):
            data.createDimension(name, len(axis))
            data.createVariable(name, "d", (name,))[:] = axis
        for name, length in zip(("row", "column"), contents.values.shape[:2], strict=True):
            data.createDimension(name, length)
        dims = ("row", "column", *contents.names)
        data.createVariable("coframe", "d", dims)[:] = contents.values
        for key in NOISE:
            if key not in contents.options:
                continue
            values = contents.options[key]
            inner = [f"{key}_axis_{k}" for k in range(values.ndim)]
            for name, length in zip(inner, values.shape, strict=True):
                data.createDimension(name, length)
            data.createVariable(key, "d", inner)[:] = values
        for name, text in _texts(contents).items():
            setattr(data, name, text.encode())


def _texts(contents: Contents) -> dict[str, str]:
    """What is said in attributes."""
    found = {key: contents.options[key] for key in TEXTS if contents.options.get(key)}
    if "periodic" in contents.options:
        pairs = zip(contents.names, contents.options["periodic"], strict=True)
        found["periodic"] = " ".join(name for name, wraps in pairs if wraps)
    return found


# -- HDF5 -----------------------------------------------------------------------------------------


def read_hdf5(path: Path) -> Contents:
    """Data sets coframe (or distortion), axis_x, ... and sigma; texts as attributes."""
    h5py = module("h5py", path)

    def load() -> Contents:
        with h5py.File(path, "r") as file:
            names = [str(name) for name in file]
            key = key_of(path, names)
            said = dict(file.attrs)
            axes = [name.removeprefix("axis_") for name in names if name.startswith("axis_")]
            if "names" in said:
                axes = str(said["names"]).split()
            for name in axes:
                if f"axis_{name}" not in names:
                    raise FileFormatError(f"{path}: the data set axis_{name} is missing.")
            arrays = {
                name: _data_set(h5py, file, name, path)
                for name in (key, *NOISE, MASK, *(f"axis_{name}" for name in axes))
                if name in names
            }
        options = _options(path, arrays, {k: str(v) for k, v in said.items()})
        lines = [arrays[f"axis_{name}"] for name in axes]
        return Contents(lines, arrays[key], tuple(axes), key == "distortion", options)

    return guarded(path, load)


def _data_set(h5py: Any, file: Any, name: str, path: Path) -> np.ndarray:
    """An array that lies in the file itself: links and other files are not followed."""
    link = file.get(name, getlink=True)
    if not isinstance(link, h5py.HardLink) or not isinstance(file[name], h5py.Dataset):
        raise FileFormatError(f"{path}: {name} is no data set of this file, but a link or a group.")
    found = file[name]
    if found.is_virtual or found.external or found.dtype.kind not in "fiub":
        raise FileFormatError(f"{path}: {name}: numbers in this file itself were needed.")
    check_room(path, name, found.shape)
    return found[...]


def write_hdf5(path: Path, contents: Contents) -> None:
    """The same names as in an NPZ file."""
    h5py = module("h5py", path)
    with h5py.File(path, "w") as file:
        file["coframe"] = contents.values
        for name, axis in zip(contents.names, contents.axes, strict=True):
            file[f"axis_{name}"] = axis
        for key in NOISE:
            if key in contents.options:
                file[key] = contents.options[key]
        for name, text in {"names": " ".join(contents.names), **_texts(contents)}.items():
            file.attrs[name] = text


# How each format is read and written.
FORMATS: dict[str, tuple[Callable[[Path], Contents], Callable[[Path, Contents], None]]] = {
    ".npz": (_npz, _write_npz),
    **dict.fromkeys((".nc", ".cdf", ".netcdf"), (read_netcdf, write_netcdf)),
    **dict.fromkeys((".h5", ".hdf5"), (read_hdf5, write_hdf5)),
    ".csv": (tables.read_csv, tables.write_csv),
    **dict.fromkeys((".vtk", ".vtu"), (tables.read_vtk, tables.write_vtk)),
}
OTHERS = [end for end in FORMATS if end not in (".npz", ".nc", ".cdf", ".netcdf")]
