"""HDF5: checks that a file is whole and holds all of its data itself."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from importlib import import_module
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeGuard

from geomtorsion.errors import FileFormatError, GeomtorsionError, LimitError
from geomtorsion.support.checks import LARGEST_ARRAYS, cut
from geomtorsion.support.files import BOUNDS

if TYPE_CHECKING:
    import numpy as np

# zlib packs a byte into at least an eighth of a bit: a larger declared size is wrong.
DENSEST = 1032
# First bytes of a file.
HDF5 = b"\x89HDF\r\n\x1a\n"


class Item(Protocol):
    """A group or a data set of h5py, which is optional."""

    name: str
    parent: Item
    attrs: Mapping[str, object]
    shape: tuple[int, ...]
    ndim: int
    size: int
    dtype: np.dtype

    def __getitem__(self, key: object) -> Any: ...

    def __iter__(self) -> Iterator[str]: ...

    def get(self, name: str) -> Item | None:
        """The item of this name."""
        ...

    def items(self) -> Iterable[tuple[str, Item]]:
        """Names and items."""
        ...


def is_group(item: object) -> TypeGuard[Item]:
    """Whether an item of an HDF5 file is a group."""
    return isinstance(item, import_module("h5py").Group)


def is_data_set(item: object) -> TypeGuard[Item]:
    """Whether an item of an HDF5 file is a data set with values."""
    found: Any = item
    return isinstance(found, import_module("h5py").Dataset) and found.shape is not None


def check_hdf5(path: Path, h5py: Any) -> list[str]:
    """The names in the first group of a file that may be given to any reader.

    Readers follow links, also into other files, and allocate the memory that a data set declares.

    h5py: the library, which is optional.

    Raises
    ------
    FileFormatError
        The file is damaged, or a name in it refers to another file.
    LimitError
        A data set declares a size that its stored bytes cannot hold.
    """
    try:
        with h5py.File(path, "r") as file:
            _walk(path, file, h5py)
            return [str(name) for name in file]
    except GeomtorsionError:
        raise
    except Exception as error:  # noqa: BLE001
        # A damaged file makes HDF5 fail anywhere, and h5py by errors of any class.
        raise FileFormatError(
            f"{path}: the file cannot be read: it is truncated or not an HDF5 file "
            f"({type(error).__name__}: {cut(str(error))}). Copy or export it again."
        ) from None


def _walk(path: Path, file: Any, h5py: Any) -> None:
    """Check each link and each data set; h5py's own walk writes the whole path of each thing."""
    seen: set[int] = set()
    open_groups = [(file, 0)]
    while open_groups:
        group, depth = open_groups.pop()
        if depth > BOUNDS.groups:
            raise LimitError(
                f"{path}: expected groups at most {BOUNDS.groups} deep, got "
                f"{cut(group.name, 60)}. Copy the data into a separate file."
            )
        for key in group:
            link, name = group.get(key, getlink=True), f"{group.name}/{key}".lstrip("/")
            _check_link(path, name, link, h5py)
            # The target of a soft link has a hard link, or does not exist.
            if not isinstance(link, h5py.HardLink):
                continue
            found = group[key]
            address = h5py.h5o.get_info(found.id).addr
            if address in seen:
                continue
            seen.add(address)
            if isinstance(found, h5py.Group):
                open_groups.append((found, depth + 1))
            elif isinstance(found, h5py.Dataset):
                _check_data_set(path, name, found)


def _check_link(path: Path, name: str, link: Any, h5py: Any) -> None:
    """Refuse a link that leaves the file."""
    if isinstance(link, h5py.ExternalLink):
        raise FileFormatError(
            f"{path}: {cut(name)}: expected data in this file, got a link to "
            f"{cut(str(link.filename))}. Copy the data into this file."
        )


def _check_data_set(path: Path, name: str, found: Any) -> None:
    """Refuse a data set that refers to other files, or whose size is impossible."""
    if found.is_virtual or found.external:
        raise FileFormatError(
            f"{path}: {cut(name)}: expected data in this file, got a reference to other files. "
            "Copy the data into this file."
        )
    size = prod(found.shape or ()) * found.dtype.itemsize
    if size > LARGEST_ARRAYS and size > DENSEST * found.id.get_storage_size():
        raise LimitError(
            f"{path}: {cut(name)} would take {size:,} bytes, more than its stored bytes can "
            "hold. Write the file again."
        )
    chunk = prod(found.chunks or ()) * found.dtype.itemsize
    if chunk > max(size, BOUNDS.unpacked):
        raise LimitError(
            f"{path}: {cut(name)}: expected chunks no larger than the data, {size:,} bytes, got "
            f"chunks of {chunk:,} bytes. Write the file again with smaller chunks."
        )
