"""Readers: the formats of measured files, recognized by file ending and first bytes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any

from geomtorsion.errors import (
    FileFormatError,
    GeomtorsionError,
    GridError,
    ImageError,
    OrientationError,
)
from geomtorsion.materials.columns import UNIT
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.fields.blocked_fields import (
    BlockedField,
    array_in_blocks,
    frame_in_blocks,
)
from geomtorsion.materials.fields.grid_files import FORMATS as GRIDS
from geomtorsion.materials.fields.quantities import quantity
from geomtorsion.materials.images import LatticeImage, LatticePhases
from geomtorsion.materials.images.image_files import KINDS as IMAGES
from geomtorsion.materials.maps import OrientationMap
from geomtorsion.materials.maps.map_formats import FORMATS as MAPS
from geomtorsion.materials.maps.map_tables import map_quantity
from geomtorsion.materials.source import Source
from geomtorsion.support import checks
from geomtorsion.support.checks import shown
from geomtorsion.support.file_kinds import other_kinds
from geomtorsion.support.files import BOUNDS, ending, opened
from geomtorsion.support.hdf5 import HDF5, check_hdf5
from geomtorsion.support.npz import mapped_npy

__all__ = ["READERS", "Kind", "Reader", "is_source", "open_in_blocks", "open_source"]


@dataclass(frozen=True)
class Kind:
    """A kind of data that a measured file can hold.

    name, plural: its names in messages. options: the options of `open_source` that apply to it.
    error: class of errors about these options. read: makes the source from a path and the options.
    """

    name: str
    plural: str
    options: tuple[str, ...]
    error: type[GeomtorsionError]
    read: Callable[..., Source]


@dataclass(frozen=True)
class Reader:
    """A format of measured files.

    suffix: file ending. kind: of the data in the file. begins: possible first bytes; none for text
    files, which may begin with anything. seems: whether bytes look like such a text file.
    """

    suffix: str
    kind: Kind
    begins: tuple[bytes, ...] = ()
    seems: Callable[[bytes], bool] | None = None


def _read_grid(
    path: Path,
    sigma: float | str | None = None,
    order: int = 4,
    missing: object = None,
    columns: Mapping[str, int | str] | None = None,
) -> SampledFrame:
    """A sampled frame; its noise is estimated unless the file or the caller states it."""
    frame = SampledFrame.read(path, order, missing=missing, columns=columns)
    if sigma is None and frame.sigma is None:
        sigma = "estimate"
    return frame if sigma is None else replace(frame, sigma=sigma)


def _read_map(path: Path, **options: Any) -> OrientationMap:
    """An orientation map."""
    if isinstance(options.get("sigma"), str):
        checks.choice(options.pop("sigma"), ["estimate"], "sigma", OrientationError)
    return OrientationMap.read(path, **options)


def _read_image(
    path: Path,
    pixel: tuple[float, str] | None = None,
    spots: Sequence[Sequence[float]] | None = None,
    resolution: float | None = None,
) -> LatticePhases:
    """The geometric phases of a lattice image."""
    size = () if pixel is None else checks.entries(pixel, "pixel", ImageError)
    if len(size) not in (0, 2):
        raise ImageError(
            f"pixel: expected a size and its unit, got {shown(pixel)}. Write it like (0.02, 'nm')."
        )
    return LatticeImage.read(path, *size).phases(spots, resolution)


GRID = Kind(
    "a sampled frame",
    "sampled frames",
    ("sigma", "order", "missing", "columns"),
    GridError,
    _read_grid,
)
MAP = Kind(
    "an orientation map",
    f"orientation maps ({', '.join(end for end in MAPS if end not in GRIDS)})",
    ("threshold", "laue", "sigma", "slip", "columns", "slice"), OrientationError, _read_map,
)  # fmt: skip
IMAGE = Kind(
    "an image", f"lattice images ({', '.join(IMAGES)})", ("pixel", "spots", "resolution"),
    ImageError, _read_image,
)  # fmt: skip
# First bytes of image files.
_PIXELS = {
    ".png": (b"\x89PNG",),
    **dict.fromkeys((".tif", ".tiff"), (b"II*\x00", b"MM\x00*")),
    ".npy": (b"\x93NUMPY",),
    **dict.fromkeys((".emd", ".hspy"), (HDF5,)),
}
# To add a format, add a line to FORMATS in grid_files or map_formats, or to KINDS in image_files.
READERS = (
    *(Reader(end, GRID, form.begins) for end, form in GRIDS.items()),
    *(Reader(end, MAP, form.begins, form.seems) for end, form in MAPS.items()),
    *(Reader(end, IMAGE, _PIXELS.get(end, ())) for end in IMAGES),
)
# Endings of chunked arrays, which `open_in_blocks` reads part by part.
ARRAYS = (".zarr",)
SUFFIXES = (*dict.fromkeys(reader.suffix for reader in READERS), *ARRAYS)
_LONGEST = max(len(mark) for reader in READERS for mark in reader.begins)


def is_source(source: str | Path) -> bool:
    """Whether a path has the ending or the first bytes of a measured file.

    Examples
    --------
    >>> is_source("map.CTF"), is_source("field.npz"), is_source("so3"), is_source("a.toml")
    (True, True, False, False)
    """
    path = Path(source)
    return ending(path) in SUFFIXES or bool(_suffixes(path))


def is_array(path: Path) -> bool:
    """Whether a file is an array that is read in blocks: Zarr, or .npy with four or more axes."""
    if path.suffix.lower() in ARRAYS:
        return True
    if path.suffix.lower() != ".npy" or not path.is_file():
        return False
    try:
        return mapped_npy(path).ndim > 3
    except (OSError, ValueError, EOFError):
        return False


def open_source(
    path: str | Path,
    *,
    sigma: float | str | None = None,
    threshold: float | None = None,
    order: int | None = None,
    laue: Mapping[int, str] | None = None,
    slip: str | None = None,
    pixel: tuple[float, str] | None = None,
    spots: Sequence[Sequence[float]] | None = None,
    resolution: float | None = None,
    missing: object = None,
    columns: Mapping[str, int | str] | None = None,
    slice: int | str | None = None,
) -> Source:
    """Read the sampled frame, orientation map or lattice image in a file.

    Parameters
    ----------
    sigma
        Standard deviation of the noise: of each value of a sampled frame, or of an orientation in
        degrees. Without it, the noise given in the file, or otherwise "estimate", from the data.
    threshold
        Orientation maps: neighbours that differ by less, in degrees, belong to one grain.
    order
        Sampled frames: order of the interpolation.
    laue
        Orientation maps: number of a phase -> name of its Laue group.
    slip
        Orientation maps: the structure whose slip systems make up b, see `slip_families`.
    pixel
        Images: size of a pixel, and its unit; by default the size in the file.
    spots, resolution
        Images: see `LatticeImage.phases`.
    missing
        Sampled frames: values that mean "no data", see `SampledFrame.read`.
    columns
        Tables: quantity -> name or number of its column, see `SampledFrame.read` and
        `OrientationMap.read`. Columns of angles (phi1) make it an orientation map.
    slice
        Orientation maps in HDF5: number or name of one of several maps.

    Raises
    ------
    FileFormatError
        The file is missing or damaged, or its content does not match its file ending.
    GridError, OrientationError, ImageError
        An option does not apply to this kind of file, or its value is invalid.
    """
    path = checks.file_name(path)
    suffix, ends = ending(path), _suffixes(path)
    if ends and suffix not in ends:
        raise FileFormatError(
            f"{path.name}: expected a name ending in {' or '.join(ends)}, to match the content, "
            f"got {shown(path.suffix)}. Rename it."
        )
    if suffix not in SUFFIXES:
        with other_kinds(path, "a field, a map or an image"):
            raise FileFormatError(
                f"{path.name}: expected a name ending in {', '.join(SUFFIXES)}, got "
                f"{shown(path.suffix)}. Rename the file, or export it in one of these formats."
            )
    if is_array(path):
        raise GridError(
            f"{path.name}: expected a file that is read as a whole, got an array, which is mapped "
            "in blocks: geomtorsion map FILE -o DIR. For single circuits, save the array by "
            "SampledFrame.save."
        )
    kind = kind_of(path, columns)
    options = {
        "sigma": sigma, "threshold": threshold, "order": order, "laue": laue or None, "slip": slip,
        "pixel": pixel, "spots": spots, "resolution": resolution, "missing": missing,
        "columns": columns, "slice": slice,
    }  # fmt: skip
    arguments = {name: value for name, value in options.items() if value is not None}
    for name in arguments:
        if name not in kind.options:
            owner = next(one for one in (GRID, MAP, IMAGE) if name in one.options)
            raise kind.error(
                f"{name}: expected a file of {owner.plural}, got {kind.name} in {path.name}. Omit "
                "the option."
            )
    return kind.read(path, **arguments)


def open_in_blocks(
    path: Path,
    *,
    steps: Sequence[float] | None = None,
    unit: str = "",
    sigma: float | str | None = None,
    order: int | None = None,
) -> BlockedField:
    """Open an .npy or Zarr array, or any file of a sampled frame, for maps in blocks.

    steps, unit: of the axes; only for array files, which do not contain them.

    Raises
    ------
    FileFormatError
        The file is missing or damaged.
    GridError
        The data are not a grid, or their noise is not the same everywhere.
    """
    if is_array(path):
        return array_in_blocks(path, steps, unit, sigma, order)
    if steps is not None:
        raise GridError(
            f"steps: expected no option, because {path.name} contains the axes, got "
            f"{shown(steps)}. Omit the option."
        )
    source = open_source(path, sigma=sigma, order=order)
    if not isinstance(source, SampledFrame):
        raise GridError(
            f"blocks: expected a sampled frame in {path.name}, got data of another kind, which "
            "are mapped without blocks. Omit blocks and resume."
        )
    return frame_in_blocks(source, path.name)


def kind_of(path: Path, columns: Mapping[str, int | str] | None = None) -> Kind:
    """Kind of data in a file, by its ending; by its content where kinds share an ending.

    columns: columns of a table, as named by the user.
    """
    readers = [reader for reader in READERS if reader.suffix == ending(path)]
    kinds = [reader.kind for reader in readers]
    if columns and GRID in kinds and MAP in kinds:
        names = [UNIT.sub("", key) for key in columns if isinstance(key, str)]
        if any(map_quantity(name) == "phi1" for name in names):
            return MAP
        if any(quantity(name) not in (None, *"xyz") for name in names):
            return GRID
    if GRID in kinds and MAP in kinds and path.is_file():
        tests = [reader.seems for reader in readers if reader.seems is not None]
        kinds.remove(GRID if _seems(path, tests) else MAP)
    return kinds[0]


def _seems(path: Path, tests: Sequence[Callable[[bytes], bool]]) -> bool:
    """Whether a file is a map, if its ending is used by both fields and maps."""
    if not tests:
        return not _has_grid(path)
    with opened(path) as file:
        content = file.read(BOUNDS.beginning)
    return any(seems(content) for seems in tests)


def _has_grid(path: Path) -> bool:
    """Whether an HDF5 file may hold a sampled frame; true without h5py: the reader then raises."""
    try:
        h5py = import_module("h5py")
    except ImportError:
        return True
    return not {"coframe", "distortion"}.isdisjoint(check_hdf5(path, h5py))


def suffixes_of(content: bytes) -> tuple[str, ...]:
    """File endings of the formats with these first bytes; none if there is no such format."""
    every = (reader.suffix for reader in READERS if content.startswith(reader.begins))
    return tuple(dict.fromkeys(every))


def _suffixes(path: Path) -> tuple[str, ...]:
    """File endings of the formats that fit the first bytes of a file."""
    if not path.is_file():
        return ()
    with opened(path) as file:
        return suffixes_of(file.read(_LONGEST))
