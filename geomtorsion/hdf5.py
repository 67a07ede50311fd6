"""HDF5: whether a file from outside is whole, and holds itself what its names stand for."""

from __future__ import annotations

from math import prod
from pathlib import Path
from typing import Any

from geomtorsion.checks import LARGEST_ARRAYS, cut
from geomtorsion.errors import FileFormatError, GeomtorsionError, LimitError
from geomtorsion.npz import DENSEST


def check_hdf5(path: Path, h5py: Any) -> list[str]:
    """The names in the first group of a file that may be given to any reader.

    Readers follow links, also into other files, and take the memory that a data set asks for.

    h5py: the library, which is optional.

    Raises
    ------
    FileFormatError
        The file is damaged, or a name in it stands for something in another file.
    LimitError
        A data set says that it is larger than what is stored of it can be.
    """
    try:
        with h5py.File(path, "r") as file:
            # An error inside of a walk would not come out of it as it is.
            links: list[tuple[str, Any]] = []
            file.visititems_links(lambda name, link: links.append((name, link)))
            for name, link in links:
                _check_link(path, name, link, h5py)
            things: list[tuple[str, Any]] = []
            file.visititems(lambda name, found: things.append((name, found)))
            for name, found in things:
                _check_data_set(path, name, found, h5py)
            return [str(name) for name in file]
    except GeomtorsionError:
        raise
    except Exception as error:  # noqa: BLE001
        # A damaged file makes HDF5 fail anywhere, and h5py by errors of any class.
        raise FileFormatError(
            f"{path}: it cannot be read, it is truncated or no HDF5 file "
            f"({type(error).__name__}: {cut(str(error))}). Copy or export it again."
        ) from None


def _check_link(path: Path, name: str, link: Any, h5py: Any) -> None:
    """Refuse a link that leaves the file."""
    if isinstance(link, h5py.ExternalLink):
        raise FileFormatError(
            f"{path}: {cut(name)} is a link to {cut(str(link.filename))}; data in this file itself "
            "were needed. Copy them into it."
        )


def _check_data_set(path: Path, name: str, found: Any, h5py: Any) -> None:
    """Refuse a data set that lies in other files, or whose size cannot be."""
    if not isinstance(found, h5py.Dataset):
        return
    if found.is_virtual or found.external:
        raise FileFormatError(
            f"{path}: {cut(name)} lies in other files; data in this file itself were needed. Copy "
            "them into it."
        )
    size = prod(found.shape or ()) * found.dtype.itemsize
    if size > LARGEST_ARRAYS and size > DENSEST * found.id.get_storage_size():
        raise LimitError(
            f"{path}: {cut(name)} would take {size:,} bytes, more than what is stored of it can "
            "hold. Write the file again."
        )
