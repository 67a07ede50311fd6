"""Data sets: axes, arrays and texts of an HDF5 file of a grid."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion.errors import FileFormatError
from geomtorsion.materials.fields.contents import check_distinct, check_room, guarded, module
from geomtorsion.support import checks
from geomtorsion.support.checks import cut
from geomtorsion.support.hdf5 import check_hdf5

# NetCDF attributes that mark packed numbers or missing values.
PACKED = ("scale_factor", "add_offset", "_FillValue", "missing_value")


def read_data_sets(
    path: Path, wanted: Callable[[Sequence[str]], Sequence[str]]
) -> tuple[list[np.ndarray], tuple[str, ...], dict[str, np.ndarray], dict[str, Any]]:
    """Axes and their names, data sets and attributes of an HDF5 file of a grid.

    wanted: the names of the data sets to read, from all names in the file; absent ones are omitted.
    """
    h5py = module("h5py", path)

    def load() -> tuple[list[str], dict[str, np.ndarray], dict[str, Any]]:
        names = check_hdf5(path, h5py)
        chosen = wanted(names)
        with h5py.File(path, "r") as file:
            texts = {str(name): _text(value) for name, value in file.attrs.items()}
            axes = [name.removeprefix("axis_") for name in names if name.startswith("axis_")]
            if "names" in texts:
                axes = checks.text(texts["names"], f"{path}: names", FileFormatError).split()
            elif axes != list("xyz")[: len(axes)]:
                # HDF5 lists data sets alphabetically, not in the order of the axes.
                raise FileFormatError(
                    f"{path}: names: expected the order of the axes {', '.join(axes)}, got none. "
                    f"Add it as an attribute of the file, such as names = {' '.join(axes)!r}."
                )
            check_distinct(path, axes)
            for name in axes:
                if f"axis_{name}" not in names:
                    raise FileFormatError(
                        f"{path}: expected a data set axis_{cut(name)}, got none. Write the file "
                        "again."
                    )
            keys = (*chosen, *(f"axis_{name}" for name in axes))
            sets = {name: _data_set(h5py, file, name, path) for name in keys if name in names}
            check_room(path, {name: data_set.shape for name, data_set in sets.items()})
            return axes, {name: data_set[...] for name, data_set in sets.items()}, texts

    axes, arrays, texts = guarded(path, load)
    return [arrays[f"axis_{name}"] for name in axes], tuple(axes), arrays, texts


def _text(value: Any) -> Any:
    """A text, which HDF5 may hold as bytes or as a list of words; other values unchanged."""
    if isinstance(value, np.ndarray) and value.ndim == 1 and value.dtype.kind in "OSU":
        words = [_text(word) for word in value.tolist()]
        return " ".join(words) if all(isinstance(word, str) for word in words) else value
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else value


def _data_set(h5py: Any, file: Any, name: str, path: Path) -> Any:
    """A data set of numbers, without links, missing parts or packed values."""
    link = file.get(name, getlink=True)
    if not isinstance(link, h5py.HardLink) or not isinstance(file[name], h5py.Dataset):
        raise FileFormatError(
            f"{path}: {name}: expected a data set of this file, got a link or a group. Copy the "
            "data set into the file."
        )
    array = file[name]
    if array.shape is None or array.dtype.kind not in "fiub":
        raise FileFormatError(
            f"{path}: {name}: expected real numbers, got "
            f"{'nothing' if array.shape is None else array.dtype}."
        )
    # Parts that were never written would be read as zeros.
    parts = math.prod(-(-n // m) for n, m in zip(array.shape, array.chunks or (), strict=False))
    written = array.id.get_num_chunks() if array.chunks else bool(array.id.get_storage_size())
    if written < parts and array.size:
        raise FileFormatError(
            f"{path}: {name}: expected {parts:,} written parts, got {int(written):,}. Write the "
            "file again."
        )
    packed = [key for key in PACKED if key in array.attrs and not np.isnan(array.attrs[key]).all()]
    if packed:
        raise FileFormatError(
            f"{path}: {name}: expected plain numbers, got {', '.join(packed)}, which only NetCDF "
            "files define. Write the numbers unpacked with nan for missing ones, or save as .nc."
        )
    return array
