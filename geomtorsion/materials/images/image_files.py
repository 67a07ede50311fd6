"""Image files: pixels from TIFF, PNG, NPY, files of microscopes and hyperspy signals."""

from __future__ import annotations

import lzma
import math
import struct
import zlib
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion import checks
from geomtorsion.checks import cut
from geomtorsion.errors import FileFormatError, ImageError, LimitError, MissingExtraError
from geomtorsion.hdf5 import check_hdf5
from geomtorsion.npz import unpacked_size

# How TIFF numbers ways to pack -> what unpacks in portions. Libraries bound all the others.
UNPACKERS = {8: zlib.decompressobj, 32946: zlib.decompressobj, 34925: lzma.LZMADecompressor}
# End of a name -> the module that reads such files.
KINDS = {
    ".tif": "tifffile", ".tiff": "tifffile", ".png": "PIL.Image", ".npy": "numpy",
    ".dm3": "rsciio.digitalmicrograph", ".dm4": "rsciio.digitalmicrograph", ".mrc": "rsciio.mrc",
    ".ser": "rsciio.tia", ".emd": "rsciio.emd", ".hspy": "rsciio.hspy",
}  # fmt: skip
# Of these the ones that are HDF5.
_HDF5 = (".emd", ".hspy")


def read_pixels(path: Path, page: int = 0, most: int | None = None) -> np.ndarray:
    """Grey values of an image file, shape (rows, columns).

    most: pixels that it may have; without it as many as there is room for.

    Raises
    ------
    FileFormatError
        The file is missing, damaged, or of another kind.
    LimitError
        It claims to hold more pixels than there is room for.
    MissingExtraError
        The library that reads it is not installed.
    """
    checks.count(page, "page", ImageError)
    if path.suffix.lower() not in KINDS:
        raise FileFormatError(
            f"{path}: expected an image ending in {', '.join(KINDS)}, got {path.suffix!r}. Export "
            "it as .tif, or give an array in memory to LatticeImage(array)."
        )
    if not path.is_file():
        raise FileFormatError(f"{path}: there is no such file.")
    name = KINDS[path.suffix.lower()]
    try:
        library = import_module(name)
    except ImportError:
        is_microscope = name.startswith("rsciio")
        package = "rosettasciio" if is_microscope else name.partition(".")[0]
        raise MissingExtraError(
            f"{path}: reading it needs {package}, which is not installed. Run `pip install "
            f"'geomtorsion[{'files' if is_microscope else 'images'}]'`; arrays need nothing."
        ) from None
    load = {"tifffile": _tiff, "PIL.Image": _png, "numpy": _npy}.get(name, _microscope)
    try:
        found = load(library, path, page, most)
    except (FileFormatError, LimitError):
        raise
    except MemoryError:
        raise LimitError(
            f"{path}: the image takes more memory than there is. Cut it into parts."
        ) from None
    # Decoders fail in all the ways there are when bytes are wrong, some with errors of their own.
    except Exception as reason:  # noqa: BLE001
        raise FileFormatError(
            f"{path}: it cannot be read, it is truncated or no file of this kind "
            f"({type(reason).__name__}: {checks.cut(str(reason))})."
        ) from None
    return _grey(found, path)


def _tiff(library: Any, path: Path, page: int, most: int | None) -> np.ndarray:
    """One page of a TIFF file."""
    with library.TiffFile(path) as file:
        count = len(file.pages)
        if not count:
            raise FileFormatError(f"{path}: it holds no image; it is truncated. Export it again.")
        if page >= count:
            raise FileFormatError(
                f"{path}: page {page} was asked for, but the file has {count}, counted from 0."
            )
        found = file.pages[page]
        _check_shape(path, found.shape, found.dtype)
        check_size(path, found.shape, most)
        _check_segments(path, file.filehandle, found, most)
        turned = found.tags.get("Orientation")
        _check_turn(path, 1 if turned is None else turned.value)
        pixels = np.asarray(found.asarray(maxworkers=1))
        # Where there is a palette pixels are numbers of its colours.
        colours = getattr(found, "colormap", None)
        return pixels if colours is None else np.moveaxis(colours[:, pixels], 0, -1)


def _check_segments(path: Path, stream: Any, page: Any, most: int | None) -> None:
    """Refuse strips and tiles that are larger than an image, or unpack to more than they say.

    tifffile unpacks a whole one before it compares sizes.
    """
    check_size(path, page.chunks, most)
    open_one = UNPACKERS.get(int(page.compression))
    if open_one is None:
        return
    size = math.prod(page.chunks) * page.dtype.itemsize
    for number, (offset, count) in enumerate(
        zip(page.dataoffsets, page.databytecounts, strict=False)
    ):
        stream.seek(offset)
        if unpacked_size(open_one(), stream.read(count), size) > size:
            raise LimitError(
                f"{path}: expected strips or tiles of at most {size:,} bytes, as the header says, "
                f"got more from number {number + 1}. Export the image again."
            )


def _png(library: Any, path: Path, page: int, most: int | None) -> np.ndarray:
    """A PNG file, of any depth."""
    if page:
        raise FileFormatError(f"{path}: page {page} was asked for, but a PNG file has one, page 0.")
    with library.open(path, formats=("PNG",)) as file:
        check_size(path, file.size, most)
        tag = import_module("PIL.ExifTags").Base.Orientation
        _check_turn(path, file.getexif().get(tag, 1))
        grey = file.mode in ("1", "L", "I", "I;16", "F")
        return np.asarray(file if grey else file.convert("RGB"))


def _check_turn(path: Path, orientation: int) -> None:
    """Refuse an image that is said to be seen otherwise than its rows are written."""
    if orientation != 1:
        raise FileFormatError(
            f"{path}: the file says that it is to be turned or mirrored (orientation "
            f"{orientation}), and in a mirror b has another sign. Save it as it is meant to be "
            "seen, with orientation 1, or give an array."
        )


def _npy(library: Any, path: Path, page: int, most: int | None) -> np.ndarray:
    """An array, or one of a stack; nothing in the file is unpickled."""
    # Mapped: its size is known before memory is taken.
    found = library.load(path, mmap_mode="r", allow_pickle=False)
    stack = found if found.ndim == 3 and found.shape[2] > 4 else found[None]
    if page >= len(stack):
        raise FileFormatError(
            f"{path}: page {page} was asked for, but the file has {len(stack)}, counted from 0."
        )
    check_size(path, stack[page].shape, most)
    return np.asarray(stack[page])


def _microscope(library: Any, path: Path, page: int, most: int | None) -> np.ndarray:
    """One image of a file that rosettasciio reads: pages are counted through all its signals.

    Sizes are compared with the file before a pixel is read.
    """
    length, end = path.stat().st_size, path.suffix.lower()
    if end in _HDF5:
        check_hdf5(path, import_module("h5py"))
    # Their readers take memory, or a part, for each pixel that the header says.
    declared = {".mrc": _pixels_of_mrc, ".ser": _pixels_of_ser}.get(end, lambda _: 0)(path)
    if declared > length:
        raise LimitError(
            f"{path}: expected at most {length:,} pixels, as many as the file has bytes, got "
            f"{declared:,} in its header. Is the file complete?"
        )
    stacks = []
    # Lazy: an array says its size and reads nothing.
    for signal in library.file_reader(str(path), lazy=True):
        data = signal["data"]
        if data.ndim < 2 or data.dtype.kind not in "biuf":
            continue
        if data.nbytes > length and end not in _HDF5:
            raise LimitError(
                f"{path}: expected at most {length:,} bytes of pixels, as many as the file has, "
                f"got {cut(str(data.shape))} of {data.dtype}. Is the file complete?"
            )
        names = [str(axis.get("name", "")).lower() for axis in signal["axes"]]
        if names[-2:] == ["x", "y"]:
            # Stored by columns: as rows it would be a mirror image.
            data = data.swapaxes(-1, -2)
        stacks.append(data.reshape(-1, *data.shape[-2:]))
    count = sum(len(stack) for stack in stacks)
    if page >= count:
        raise FileFormatError(
            f"{path}: expected an image number {page}, counted from 0, got a file of {count}. "
            "Choose another page."
        )
    for stack in stacks:
        if page < len(stack):
            check_size(path, stack.shape[1:], most)
            return np.asarray(stack[page].compute(scheduler="synchronous"))
        page -= len(stack)
    raise FileFormatError(f"{path}: it holds no image.")


def _pixels_of_mrc(path: Path) -> int:
    """Pixels of all images, as the header says."""
    with path.open("rb") as file:
        return math.prod(map(abs, struct.unpack("<3i", file.read(12))))


def _pixels_of_ser(path: Path) -> int:
    """Pixels of all images, as the header and the first image say."""
    with path.open("rb") as file:
        head = file.read(34)
        version, count = struct.unpack_from("<H", head, 4)[0], struct.unpack_from("<I", head, 18)[0]
        # Of the newer version offsets have eight bytes.
        kind = "<I" if version <= 528 else "<Q"
        if count > path.stat().st_size:
            return count
        file.seek(struct.unpack_from(kind, head, 22)[0])
        file.seek(struct.unpack(kind, file.read(struct.calcsize(kind)))[0] + 42)
        return count * math.prod(struct.unpack("<2I", file.read(8)))


def check_size(subject: object, shape: tuple[int, ...], most: int | None = None) -> None:
    """Refuse, before memory is taken, an image whose phases would need too much of it.

    Raises
    ------
    LimitError
        It has too many pixels.
    """
    count = math.prod(map(int, shape[:2]))
    if most is not None and count > most:
        raise LimitError(
            f"{subject}: the image has {count:,} pixels; up to {most:,} are taken. Cut it into "
            "parts."
        )
    # Two complex waves, the spectrum that they come from, and the image itself.
    checks.check_room(7 * count, f"{subject}: an image of {count:,} pixels", "Cut it into parts.")


def _check_shape(path: Path, shape: tuple[int, ...], dtype: Any) -> None:
    """Refuse what has not one value, or one to four colours, for each pixel."""
    if dtype is None or np.dtype(dtype).kind not in "biuf" or len(shape) not in (2, 3):
        colours = 0
    else:
        colours = shape[2] if len(shape) == 3 else 1
    if colours not in (1, 2, 3, 4):
        raise FileFormatError(
            f"{path}: grey values of shape (rows, columns) were needed, but {dtype} of shape "
            f"{checks.cut(str(shape))} came. Choose a page, or give an array."
        )


def _grey(found: np.ndarray, path: Path) -> np.ndarray:
    """One value for each pixel: the mean of colours, without opacity."""
    _check_shape(path, found.shape, found.dtype)
    if found.ndim == 3:
        colours = found.shape[2] - (found.shape[2] % 2 == 0)
        found = found[:, :, :colours].astype(float).mean(axis=2)
    return found.astype(float)


def pixels_of_signal(signal: Any) -> tuple[np.ndarray, float, str]:
    """Grey values, size of a pixel and its unit, of a hyperspy signal.

    Anything with the same attributes will do: `data`, and `axes_manager` with `signal_axes` (of
    `scale` and `units`) and `navigation_size`. hyperspy itself is never imported.

    Raises
    ------
    ImageError
        It is no signal of two axes, its pixels are not square, or an axis decreases.
    """
    try:
        manager = signal.axes_manager
        axes, frames = tuple(manager.signal_axes), manager.navigation_size
        given = [(axis.scale, axis.units) for axis in axes]
        data = signal.data
    except (AttributeError, TypeError):
        raise ImageError(
            f"signal: a hyperspy signal was needed, but {checks.shown(signal)} came. Give arrays "
            "to LatticeImage(array)."
        ) from None
    if len(axes) != 2 or checks.count(frames, "navigation_size", ImageError) > 1:
        raise ImageError(
            f"signal: one image was needed, but {checks.shown(signal)} came. Choose one: "
            "signal.inav[0]."
        )
    steps = [checks.number(scale, "scale", ImageError) for scale, _ in given]
    if min(steps) < 0:
        raise ImageError(
            f"signal: axes that increase from pixel to pixel were needed, but the scales are "
            f"{steps[0]:.6g} and {steps[1]:.6g}. What is seen in a mirror has b of another sign: "
            "turn the data round, and give scales above 0."
        )
    units = [unit if isinstance(unit, str) else "px" for _, unit in given]
    if abs(steps[0] - steps[1]) > 1e-3 * steps[0] or units[0] != units[1]:
        raise ImageError(
            f"signal: square pixels were needed, but they are {steps[0]:.6g} {units[0]} by "
            f"{steps[1]:.6g} {units[1]}. Resample it: signal.rebin(...)."
        )
    values = checks.array(data, "signal.data", ImageError)
    return values.reshape(values.shape[-2:]), steps[0], units[0]
