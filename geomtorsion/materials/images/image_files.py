"""Image files: pixels from TIFF, PNG, NPY, files of microscopes and hyperspy signals."""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion.errors import FileFormatError, ImageError, LimitError, MissingExtraError
from geomtorsion.materials.images.pixels import PixelSize, size_in_tiff, size_of_axes
from geomtorsion.support import checks
from geomtorsion.support.checks import cut
from geomtorsion.support.file_kinds import naming_other_kinds
from geomtorsion.support.files import check_file
from geomtorsion.support.hdf5 import check_hdf5
from geomtorsion.support.outgoing import quiet_libraries

# File ending -> the module that reads such files.
KINDS = {
    ".tif": "tifffile", ".tiff": "tifffile", ".png": "PIL.Image", ".npy": "numpy",
    ".dm3": "rsciio.digitalmicrograph", ".dm4": "rsciio.digitalmicrograph", ".mrc": "rsciio.mrc",
    ".ser": "rsciio.tia", ".emd": "rsciio.emd", ".hspy": "rsciio.hspy",
}  # fmt: skip
# Values of pixels, and the size of a pixel where the file states it.
Read = tuple[np.ndarray, PixelSize | None]
# The endings of HDF5 files among them.
_HDF5 = (".emd", ".hspy")


@dataclass(frozen=True, eq=False)
class Pixels:
    """The content of an image file.

    values: grey values, shape (rows, columns). size: of a pixel; None where the file states none.
    """

    values: np.ndarray
    size: PixelSize | None = None


@naming_other_kinds("an image")
def read_pixels(
    path: Path, page: int = 0, most: int | None = None, *, sized: bool = True
) -> Pixels:
    """Grey values of an image file, and the size of its pixels.

    sized: whether the size of a pixel is needed; otherwise pixels need not be square.
    most: largest allowed number of pixels; by default, memory sets the limit.

    Raises
    ------
    FileFormatError
        The file is missing, damaged, or of another kind.
    LimitError
        The file declares more pixels than the limit.
    MissingExtraError
        The library that reads it is not installed.
    """
    checks.count(page, "page", ImageError)
    if path.suffix.lower() not in KINDS:
        raise FileFormatError(
            f"{path}: expected an image ending in {', '.join(KINDS)}, got {path.suffix!r}. Export "
            "it as .tif, or give an array in memory to LatticeImage(array)."
        )
    check_file(path)
    name = KINDS[path.suffix.lower()]
    try:
        library = import_module(name)
    except ImportError:
        is_microscope = name.startswith("rsciio")
        package = "rosettasciio" if is_microscope else name.partition(".")[0]
        raise MissingExtraError(
            f"{path}: this format requires {package}, which is not installed. Run `pip install "
            f"'geomtorsion[{'files' if is_microscope else 'images'}]'`, or give an array."
        ) from None
    load = {"tifffile": _tiff, "PIL.Image": _png, "numpy": _npy}.get(name, _microscope)
    try:
        with quiet_libraries():
            pixels, size = load(library, path, page, most, sized)
    except (FileFormatError, ImageError, LimitError):
        raise
    except MemoryError:
        raise LimitError(f"{path}: the image does not fit in memory. Cut it into parts.") from None
    # Decoders raise errors of many types for wrong bytes, some of their own types.
    except Exception as reason:  # noqa: BLE001
        raise FileFormatError(
            f"{path}: the file cannot be read: it is truncated or has another format "
            f"({type(reason).__name__}: {checks.cut(str(reason))}). Export it again."
        ) from None
    return Pixels(_grey(pixels, path), size)


def _tiff(library: Any, path: Path, page: int, most: int | None, sized: bool) -> Read:
    """One page of a TIFF file."""
    with library.TiffFile(path) as file:
        _check_page(path, page, len(file.pages))
        image = file.pages[page]
        _check_shape(path, image.shape, image.dtype)
        check_size(path, image.shape, most)
        # A strip or tile may be larger than the image.
        check_size(path, image.chunks, most)
        turned = image.tags.get("Orientation")
        _check_turn(path, 1 if turned is None else turned.value)
        pixels = np.asarray(image.asarray(maxworkers=1))
        # If there is a palette, pixels are indices of its colours.
        colours = getattr(image, "colormap", None)
        pixels = pixels if colours is None else np.moveaxis(colours[:, pixels], 0, -1)
        return pixels, size_in_tiff(path, file, image) if sized else None


def _png(library: Any, path: Path, page: int, most: int | None, sized: bool) -> Read:
    """A PNG file, of any depth."""
    _check_page(path, page, 1)
    with library.open(path, formats=("PNG",)) as file:
        check_size(path, file.size, most)
        tag = import_module("PIL.ExifTags").Base.Orientation
        _check_turn(path, file.getexif().get(tag, 1))
        grey = file.mode in ("1", "L", "I", "I;16", "F")
        return np.asarray(file if grey else file.convert("RGB")), None


def _check_turn(path: Path, orientation: int) -> None:
    """Refuse an image whose orientation tag requires it to be turned or mirrored."""
    if orientation != 1:
        raise FileFormatError(
            f"{path}: expected orientation 1, got {orientation}: viewers turn or mirror this "
            "image, and a mirror changes the sign of b. Save the image as it should be seen, with "
            "orientation 1, or give an array."
        )


def _check_page(path: Path, page: int, count: int) -> None:
    """Refuse a page that is not in the file."""
    if not count:
        raise FileFormatError(
            f"{path}: the file is truncated: it contains no image. Export it again."
        )
    if page >= count:
        raise FileFormatError(
            f"{path}: page: expected a number below {count:,}, the number of pages in the file, "
            f"got {page:,}. The first page is 0."
        )


def _npy(library: Any, path: Path, page: int, most: int | None, sized: bool) -> Read:
    """An array, or one array of a stack, without unpickling."""
    # A memory map gives the size before memory is allocated.
    array = library.load(path, mmap_mode="r", allow_pickle=False)
    stack = array if array.ndim == 3 and array.shape[2] > 4 else array[None]
    _check_page(path, page, len(stack))
    check_size(path, stack[page].shape, most)
    return np.asarray(stack[page]), None


def _microscope(library: Any, path: Path, page: int, most: int | None, sized: bool) -> Read:
    """One image of a file that rosettasciio reads; pages number the images of all its signals.

    Sizes are compared with the file size before any pixel is read.
    """
    length, end = path.stat().st_size, path.suffix.lower()
    if end in _HDF5:
        _check_room(path, import_module("h5py"))
    # The readers of .mrc and .ser allocate memory for each pixel that the header declares.
    declared = {".mrc": _pixels_of_mrc, ".ser": _pixels_of_ser}.get(end, lambda _: 0)(path)
    if declared > length:
        raise LimitError(
            f"{path}: expected at most {length:,} pixels, the number of bytes in the file, got "
            f"{declared:,} in its header. Is the file complete?"
        )
    stacks = []
    # A lazy array has a size without reading data. Lazy HDF5 arrays would leave the file open.
    for signal in library.file_reader(str(path), lazy=end not in _HDF5):
        data = signal["data"]
        if data.ndim < 2 or data.dtype.kind not in "biuf":
            continue
        if data.nbytes > length and end not in _HDF5:
            raise LimitError(
                f"{path}: expected at most {length:,} bytes of pixels, the size of the file, got "
                f"{cut(str(data.shape))} of {data.dtype}. Is the file complete?"
            )
        names = [str(axis.get("name", "")).lower() for axis in signal["axes"]]
        if names[-2:] == ["x", "y"]:
            # The data are stored by columns; reading them as rows would mirror the image.
            data = data.swapaxes(-1, -2)
        axes = () if end == ".mrc" and not _states_size(signal) else signal["axes"]
        stacks.append((data.reshape(-1, *data.shape[-2:]), axes))
    _check_page(path, page, sum(len(stack) for stack, _ in stacks))
    while page >= len(stacks[0][0]):
        page -= len(stacks.pop(0)[0])
    stack, axes = stacks[0]
    check_size(path, stack.shape[1:], most)
    return np.asarray(stack[page]), size_of_axes(path, axes) if sized else None


def _check_room(path: Path, h5py: Any) -> None:
    """Refuse an HDF5 file with wrong sizes, or with more data than can be read at once."""
    check_hdf5(path, h5py)
    sizes: list[int] = []
    with h5py.File(path, "r") as file:
        file.visititems(lambda _, x: sizes.append(int(getattr(x, "nbytes", 0))))
    if sum(sizes) > checks.LARGEST_ARRAYS:
        raise LimitError(
            f"{path}: expected at most {checks.LARGEST_ARRAYS:,} bytes of data, got "
            f"{sum(sizes):,}. Export only the image, as .tif or .npy."
        )


def _pixels_of_mrc(path: Path) -> int:
    """Number of pixels of all images, from the header."""
    with path.open("rb") as file:
        return math.prod(map(abs, struct.unpack("<3i", file.read(12))))


def _states_size(signal: Mapping[str, Any]) -> bool:
    """Whether the header of an .mrc file states the size of its pixels.

    The reader replaces a missing size by 1 nm.
    """
    header = signal["original_metadata"]
    cell = header.get("std_header", {})
    sizes = [cell.get(name, 0) for name in ("MX", "MY", "Xlen", "Ylen")]
    return "fei_header" in header or all(np.min(size) > 0 for size in sizes)


def _pixels_of_ser(path: Path) -> int:
    """Number of pixels of all images, from the header and the first image."""
    with path.open("rb") as file:
        head = file.read(34)
        version, count = struct.unpack_from("<H", head, 4)[0], struct.unpack_from("<I", head, 18)[0]
        # Offsets have eight bytes in the newer version.
        kind = "<I" if version <= 528 else "<Q"
        if count > path.stat().st_size:
            return count
        file.seek(struct.unpack_from(kind, head, 22)[0])
        file.seek(struct.unpack(kind, file.read(struct.calcsize(kind)))[0] + 42)
        return count * math.prod(struct.unpack("<2I", file.read(8)))


def check_size(subject: object, shape: tuple[int, ...], most: int | None = None) -> None:
    """Refuse an image whose phases would need too much memory, before allocating it.

    Raises
    ------
    LimitError
        The image has too many pixels.
    """
    count = math.prod(map(int, shape[:2]))
    if most is not None and count > most:
        raise LimitError(
            f"{subject}: expected at most {most:,} pixels, got an image of {count:,}. Cut it into "
            "parts."
        )
    # Memory for two complex waves, their spectrum, and the image itself.
    checks.check_room(7 * count, f"{subject}: an image of {count:,} pixels", "Cut it into parts.")


def _check_shape(path: Path, shape: tuple[int, ...], dtype: Any) -> None:
    """Refuse an array that is not one value, or one to four colours, for each pixel."""
    if dtype is None or np.dtype(dtype).kind not in "biuf" or len(shape) not in (2, 3):
        colours = 0
    else:
        colours = shape[2] if len(shape) == 3 else 1
    if colours not in (1, 2, 3, 4):
        raise FileFormatError(
            f"{path}: expected grey values of shape (rows, columns), got {dtype} of shape "
            f"{checks.cut(str(shape))}. Choose a page, or give an array."
        )


def _grey(found: np.ndarray, path: Path) -> np.ndarray:
    """One value for each pixel: the mean of the colours, without opacity."""
    _check_shape(path, found.shape, found.dtype)
    if found.ndim == 3:
        colours = found.shape[2] - (found.shape[2] % 2 == 0)
        found = found[:, :, :colours].astype(float).mean(axis=2)
    return found.astype(float)


def pixels_of_signal(signal: Any) -> tuple[np.ndarray, float, str]:
    """Grey values, size of a pixel and its unit, from a hyperspy signal.

    Any object with the same attributes is accepted: `data`, and `axes_manager` with `signal_axes`
    (with `scale` and `units`) and `navigation_size`. hyperspy itself is never imported.

    Raises
    ------
    ImageError
        The signal does not have two axes, its pixels are not square, or an axis decreases.
    """
    try:
        manager = signal.axes_manager
        axes, frames = tuple(manager.signal_axes), manager.navigation_size
        scales = [(axis.scale, axis.units) for axis in axes]
        data = signal.data
    except (AttributeError, TypeError):
        raise ImageError(
            f"signal: expected a hyperspy signal, got {checks.shown(signal)}. Give arrays to "
            "LatticeImage(array)."
        ) from None
    if len(axes) != 2 or checks.count(frames, "navigation_size", ImageError) > 1:
        raise ImageError(
            f"signal: expected one image, got {checks.shown(signal)}. Choose one: signal.inav[0]."
        )
    steps = [checks.number(scale, "scale", ImageError) for scale, _ in scales]
    if min(steps) < 0:
        raise ImageError(
            "signal: expected scales above 0, for axes that increase from pixel to pixel, got "
            f"{steps[0]:.6g} and {steps[1]:.6g}. Flip the data along an axis with a negative "
            "scale: a mirrored image changes the sign of b."
        )
    units = [unit if isinstance(unit, str) else "px" for _, unit in scales]
    if abs(steps[0] - steps[1]) > 1e-3 * steps[0] or units[0] != units[1]:
        raise ImageError(
            f"signal: expected square pixels, got {steps[0]:.6g} {units[0]} by {steps[1]:.6g} "
            f"{units[1]}. Resample it: signal.rebin(...)."
        )
    values = checks.array(data, "signal.data", ImageError)
    return values.reshape(values.shape[-2:]), steps[0], units[0]
