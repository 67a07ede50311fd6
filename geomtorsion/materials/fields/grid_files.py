"""Grid files: sampled frames in NPZ, NetCDF, HDF5, CSV and VTK files."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.errors import FileFormatError, GridError, MissingExtraError
from geomtorsion.materials.fields import tables
from geomtorsion.materials.fields.contents import (
    TEXTS,
    Contents,
    check_distinct,
    check_room,
    guarded,
    key_of,
    module,
    periodic_names,
)
from geomtorsion.materials.fields.data_sets import read_data_sets
from geomtorsion.materials.fields.displacement import FIND
from geomtorsion.materials.fields.point_values import PointValues
from geomtorsion.materials.fields.surfaces import over_two_axes
from geomtorsion.materials.fields.value_tables import (
    holds_values,
    read_points,
    read_values,
    refuse_writing,
)
from geomtorsion.support.checks import cut, shown, unmasked
from geomtorsion.support.file_kinds import naming_other_kinds
from geomtorsion.support.files import check_file, ending
from geomtorsion.support.hdf5 import HDF5, check_hdf5
from geomtorsion.support.npz import ArrayForm, read_npz, text_of, write_npz

FORMS = {
    "names": ArrayForm((None,), "U", optional=True),
    "axis_*": ArrayForm((None,)),
    "coframe": ArrayForm((None, None, ...), optional=True),
    "distortion": ArrayForm((None, None, ...), optional=True),
    "displacement": ArrayForm((None, None, ...), optional=True),
    "branch": ArrayForm((None, None), optional=True),
    "sigma": ArrayForm((None, None, ...), optional=True),
    "covariance": ArrayForm((None, None, None, None, ...), optional=True),
    "mask": ArrayForm((None, None, ...), "biu", optional=True),
    "periodic": ArrayForm((None,), "b", optional=True),
    "unit": ArrayForm((), "U", optional=True),
    "vector_unit": ArrayForm((), "U", optional=True),
    "signature": ArrayForm((), "U", optional=True),
    "source": ArrayForm((), "U", optional=True),
}
# Arrays that may hold the noise of the values.
NOISE = ("sigma", "covariance")
# The array that marks unknown nodes, besides NaN.
MASK = "mask"
# File endings of tables.
TABLES = (".csv", ".txt", ".dat")


@naming_other_kinds("a field")
def read_grid(path: Path, columns: Mapping[str, int | str] | None = None) -> Contents:
    """Read a sampled frame in the format of the file ending.

    columns: of a table, see `value_tables.read_points`.

    .npz: an array `coframe` or `distortion` of shape (rows, d, N_1, ..., N_d), and one array
    `axis_x`, `axis_y`, ... for each axis, in the order of `names` (or of the arrays in the file).
    Instead of the coframe, .npz may hold a `displacement` of shape (rows, N_1, ..., N_d) and the
    vectors of its jumps, `branch` (NaN to search for them).

    .h5, .hdf5: the same names as data sets (extra `files`). The attribute `names` lists the axes;
    it is optional if they are x, y, ...

    .nc: a variable `coframe` or `distortion` with dimensions (row, column, x, y, ...) and a
    coordinate variable for each dimension of the grid.

    .csv, .txt, .dat: see `tables.read_csv`. .vtk, .vtu, .msh, .xdmf, .inp: see
    `tables.read_vtk` (extra `files`).
    These may also hold a displacement: a table of DICe, VIC or DaVis, or a mesh of finite elements;
    a table also strain and rotation, see `value_tables.read_points`.

    All formats may hold sigma, units, periods and a source. .npz, .h5 and .nc may hold a covariance
    instead of sigma, and a mask, which is 1 at unknown nodes.

    Raises
    ------
    FileFormatError
        The file is missing, truncated or malformed, or lacks an array.
    MissingExtraError
        The library for the format is not installed.
    """
    check_file(path)
    kind = ending(path)
    if kind not in FORMATS:
        raise FileFormatError(
            f"{path}: expected a name ending in .npz or .nc (or {', '.join(OTHERS)}), got "
            f"{path.suffix!r}. For arrays in memory use SampledFrame(axes, coframe)."
        )
    if columns:
        if FORMATS[kind].read is not _table:
            raise GridError(
                f"columns: expected a table ({', '.join(TABLES)}), got {path.name}, whose arrays "
                "have names. Omit columns."
            )
        return read_values(path, columns)
    return FORMATS[kind].read(path)


@naming_other_kinds("a field")
def read_scattered(path: Path, columns: Mapping[str, int | str] | None = None) -> PointValues:
    """Read a field at scattered points; points on a surface in space are over two of its axes.

    .csv, .txt, .dat: a table, see `value_tables.read_points`. .vtk, .vtu, .msh (Gmsh), .xdmf, .inp
    (Abaqus): a mesh of finite elements, see `tables.read_mesh` (extra `files`).

    Raises
    ------
    FileFormatError
        The file is missing or damaged, has another ending, or holds no displacement.
    MissingExtraError
        meshio is not installed.
    """
    check_file(path)
    meshes = tuple(tables.MESHES)
    if ending(path) not in (*TABLES, *meshes):
        raise FileFormatError(
            f"{path}: expected a name ending in {', '.join((*TABLES, *meshes))}, got "
            f"{path.suffix!r}. For arrays in memory use ScatteredFrame.from_displacement."
        )
    if ending(path) in meshes and columns:
        raise GridError(
            f"columns: expected a table ({', '.join(TABLES)}), got the mesh {path.name}. Omit "
            "columns."
        )
    points = tables.read_mesh(path) if ending(path) in meshes else read_points(path, columns)
    return over_two_axes(points)


def save_grid(path: Path, contents: Contents) -> None:
    """Write a file that `read_grid` reads, with exactly the given name.

    The format is .npz if the name has no ending.

    Raises
    ------
    GridError
        There is no format with this file ending.
    """
    kind = path.suffix.lower() or ".npz"
    if kind not in FORMATS:
        raise GridError(
            f"{path}: expected a name ending in .npz or .nc (or {', '.join(OTHERS)}), got "
            f"{path.suffix!r}. Rename the file."
        )
    FORMATS[kind].write(path, contents)


def holds_covariance(path: Path) -> bool:
    """Whether the format of a file ending can store covariances, which tables cannot."""
    return (path.suffix.lower() or ".npz") not in (".csv", ".vtk", ".vtu")


def read_arrays(
    path: Path, forms: Mapping[str, ArrayForm]
) -> tuple[list[np.ndarray], tuple[str, ...], dict[str, np.ndarray]]:
    """Axes and their names, and all arrays of an NPZ file of a grid; forms: see `read_npz`."""
    message = (
        "{path}: the file cannot be read: it is truncated or has another format ({reason}). Write "
        "it again."
    )
    arrays = read_npz(path, forms, message=message)
    if "names" in arrays:
        names = tuple(str(name) for name in arrays["names"])
    else:
        names = tuple(name.removeprefix("axis_") for name in arrays if name.startswith("axis_"))
    check_distinct(path, names)
    axes = []
    for name in names:
        if f"axis_{name}" not in arrays:
            raise FileFormatError(
                f"{path}: expected an array axis_{cut(name)}, because names lists {shown(names)}, "
                "got none. Write the file again."
            )
        axes.append(arrays[f"axis_{name}"])
    if not axes:
        raise FileFormatError(
            f"{path}: expected arrays axis_x, axis_y, ..., got "
            f"{cut(', '.join(sorted(arrays)))}. Add the coordinates of each axis."
        )
    return axes, names, arrays


def _npz(path: Path) -> Contents:
    """Read an NPZ file."""
    axes, names, arrays = read_arrays(path, FORMS)
    key = "displacement" if "displacement" in arrays else key_of(path, arrays)
    options: dict[str, Any] = {k: text_of(arrays[k]) for k in TEXTS if k in arrays}
    options |= {k: arrays[k] for k in ("periodic",) if k in arrays} | _known(path, arrays)
    if key == "displacement" and "branch" in arrays:
        # Unknown vectors (NaN) request a search for jumps.
        branch = arrays["branch"]
        options["branch"] = FIND if np.isnan(branch).all() else branch
    values = arrays[key]
    return Contents(axes, values, names, key == "distortion", options, key == "displacement")


def _write_npz(path: Path, contents: Contents) -> None:
    """Write an NPZ file."""
    key = "displacement" if contents.is_displacement else "coframe"
    arrays: dict[str, Any] = {key: contents.values, "names": np.array(contents.names)}
    for name, axis in zip(contents.names, contents.axes, strict=True):
        arrays[f"axis_{name}"] = axis
    arrays |= {key: np.asarray(value) for key, value in contents.options.items()}
    write_npz(path, arrays)


def read_netcdf(path: Path) -> Contents:
    """Read NetCDF by xarray if it is installed; otherwise read classic files by scipy."""
    try:
        xarray = import_module("xarray")
    except ImportError:
        return _classic(path)

    def load() -> Any:
        # Times remain numbers, as in the scipy reader.
        with xarray.open_dataset(path, decode_times=False) as data:
            dimensions = {str(name): each.dims for name, each in data.variables.items()}
            key, names = _axes(path, dimensions)
            keys = [name for name in (key, *names, *NOISE, MASK) if name in dimensions]
            check_room(path, {name: data[name].shape for name in keys})
            # Only the wanted variables are loaded; the size of the others does not matter.
            return key, names, {name: data[name].values for name in keys}, dict(data.attrs)

    if _is_hdf5(path):
        check_hdf5(path, module("h5py", path))
    return _contents(path, *guarded(path, load))


def _is_hdf5(path: Path) -> bool:
    """Whether a NetCDF file is of version 4."""
    with path.open("rb") as stream:
        return stream.read(len(HDF5)) == HDF5


def _axes(path: Path, dimensions: Mapping[str, Sequence[Any]]) -> tuple[str, tuple[str, ...]]:
    """Name of the variable with the values, and its axis names, whose order holds for all."""
    key = key_of(path, dimensions)
    names = tuple(str(name) for name in dimensions[key][2:])
    for name in names:
        if name not in dimensions:
            raise FileFormatError(
                f"{path}: expected a coordinate variable for dimension {name} of {key}, got none. "
                "Write the file with coordinates."
            )
    for name in (key, *NOISE, MASK):
        came = [str(each) for each in dimensions.get(name, ())]
        along = [each for each in came if each in names]
        if came[:2] == ["column", "row"] or along != [each for each in names if each in along]:
            raise FileFormatError(
                f"{path}: expected dimensions of {name} in the order row, column, "
                f"{', '.join(names)}, got {', '.join(came)}. Transpose the variable."
            )
    return key, names


def _contents(
    path: Path,
    key: str,
    names: tuple[str, ...],
    arrays: Mapping[str, np.ndarray],
    said: Mapping[str, Any],
) -> Contents:
    """Contents from the arrays and the texts of a file."""
    axes = [arrays[name] for name in names]
    return Contents(axes, arrays[key], names, key == "distortion", grid_options(path, arrays, said))


def _classic(path: Path) -> Contents:
    """Read a classic file by scipy."""
    if _is_hdf5(path):
        raise MissingExtraError(
            f"{path}: NetCDF 4 requires xarray with a backend, which is not installed. "
            "Run `pip install 'geomtorsion[files]'`."
        )

    def load() -> tuple[dict[str, np.ndarray], dict[str, tuple[str, ...]], dict[str, Any]]:
        # Missing values and scales follow the attributes, as in xarray.
        with scipy.io.netcdf_file(path, mmap=False, maskandscale=True) as data:
            for name, variable in data.variables.items():
                # scipy supports only one missing value.
                if (count := np.size(getattr(variable, "missing_value", 0))) != 1:
                    raise FileFormatError(
                        f"{path}: missing_value of {name}: expected one number, got {count}. Mark "
                        "missing values by one number, or install xarray: "
                        "pip install 'geomtorsion[files]'."
                    )
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
    key, names = _axes(path, dimensions)
    return _contents(path, key, names, arrays, texts)


def grid_options(path: Path, arrays: Mapping[str, np.ndarray], texts: Any) -> dict[str, Any]:
    """Options of the contents: noise, holes, periods and texts."""
    options: dict[str, Any] = {key: texts[key] for key in TEXTS if key in texts}
    options |= _known(path, arrays)
    if "periodic" in texts:
        options["periodic"] = periodic_names(texts["periodic"], path)
    return options


def _known(path: Path, arrays: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Noise, and the mask of unknown nodes: True, or 1 in formats without truth values."""
    extras = {name: arrays[name] for name in NOISE if name in arrays}
    if MASK in arrays:
        if not np.isin(arrays[MASK], (0, 1)).all():
            raise FileFormatError(
                f"{path}: {MASK}: expected 1 at unknown nodes and 0 elsewhere, got other numbers. "
                "Correct the mask."
            )
        extras[MASK] = arrays[MASK] == 1
    return extras


def write_netcdf(path: Path, contents: Contents) -> None:
    """Write a classic NetCDF file, which all libraries read."""
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
    """Texts of the contents, for the attributes of a file."""
    texts = {key: contents.options[key] for key in TEXTS if contents.options.get(key)}
    if "periodic" in contents.options:
        pairs = zip(contents.names, contents.options["periodic"], strict=True)
        texts["periodic"] = " ".join(name for name, wraps in pairs if wraps)
    return texts


# -- HDF5 -----------------------------------------------------------------------------------------


def read_hdf5(path: Path) -> Contents:
    """Read data sets coframe (or distortion), axis_x, ... and sigma; texts are attributes."""
    axes, names, arrays, texts = read_data_sets(path, lambda x: [key_of(path, x), *NOISE, MASK])
    key, options = key_of(path, arrays), grid_options(path, arrays, texts)
    return Contents(axes, arrays[key], names, key == "distortion", options)


def write_hdf5(path: Path, contents: Contents) -> None:
    """Write an HDF5 file with the names of an NPZ file."""
    h5py = module("h5py", path)
    # In memory first: on a full disk HDF5 raises an error of its own and cannot close its file.
    with h5py.File(path.name, "w", driver="core", backing_store=False) as file:
        file["coframe"] = contents.values
        for name, axis in zip(contents.names, contents.axes, strict=True):
            file[f"axis_{name}"] = axis
        for key in NOISE:
            if key in contents.options:
                file[key] = contents.options[key]
        for name, text in {"names": " ".join(contents.names), **_texts(contents)}.items():
            file.attrs[name] = text
        file.flush()
        path.write_bytes(file.id.get_file_image())


@dataclass(frozen=True)
class GridFormat:
    """A format of sampled frames.

    read, write: functions of a path (and contents). begins: first bytes of files; none for text.
    """

    read: Callable[[Path], Contents]
    write: Callable[[Path, Contents], None]
    begins: tuple[bytes, ...] = ()


def _table(path: Path) -> Contents:
    """Read a coframe, a distortion, a displacement or a strain, depending on the row of names."""
    own = tables.holds_coframe(path) or (ending(path) == ".csv" and not holds_values(path))
    return tables.read_csv(path) if own else read_values(path)


_NETCDF = GridFormat(read_netcdf, write_netcdf, (b"CDF\x01", b"CDF\x02", HDF5))
# File ending -> format. To add a format, add a line here.
FORMATS: dict[str, GridFormat] = {
    ".npz": GridFormat(_npz, _write_npz, (b"PK\x03\x04",)),
    ".nc": _NETCDF, ".cdf": _NETCDF, ".netcdf": _NETCDF,
    ".h5": GridFormat(read_hdf5, write_hdf5, (HDF5,)),
    ".hdf5": GridFormat(read_hdf5, write_hdf5, (HDF5,)),
    ".csv": GridFormat(_table, tables.write_csv),
    **dict.fromkeys((".txt", ".dat"), GridFormat(_table, refuse_writing)),
    ".vtk": GridFormat(tables.read_vtk, tables.write_vtk, (b"# vtk DataFile",)),
    ".vtu": GridFormat(tables.read_vtk, tables.write_vtk),
    **dict.fromkeys((".msh", ".xdmf", ".xmf", ".inp"), GridFormat(tables.read_vtk, refuse_writing)),
}  # fmt: skip
OTHERS = [end for end in FORMATS if end not in (".npz", ".nc", ".cdf", ".netcdf")]
