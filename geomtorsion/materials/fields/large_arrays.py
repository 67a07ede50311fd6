"""Large arrays: fields that are read in parts, from NPY and Zarr files or dask arrays."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from math import prod
from operator import lt
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion.errors import FileFormatError, GridError, LimitError
from geomtorsion.loops.quadrature import PIECE
from geomtorsion.materials.fields.contents import guarded, module
from geomtorsion.materials.fields.grid import Grid
from geomtorsion.materials.fields.noise import SMOOTH, estimated_from_parts
from geomtorsion.support import checks
from geomtorsion.support.files import digest_of, read_json_text, read_text
from geomtorsion.support.npz import LARGEST_ARRAYS, mapped_npy

# Zarr codecs that only compress. Other codecs might execute code from the file.
HARMLESS = frozenset(
    "blosc zstd gzip zlib lz4 bz2 lzma bytes crc32c transpose sharding_indexed endian".split()
)

# Number of nodes in the sample for the noise, about ten megabytes, and in each window of a larger
# field. The median over a sample has an error of half a per cent.
SAMPLE, WINDOW = 8 * PIECE, PIECE // 8
_CHUNK = re.compile(r"(c[/.])?[0-9]{1,18}([/.][0-9]{1,18})*")
# Name of the array of a field in a Zarr group.
INNER = "coframe"


@dataclass(frozen=True, eq=False)
class LargeArray:
    """Values of shape (rows, columns, grid...) that are read part by part.

    given: the path of an .npy file or a Zarr array, or an array of NumPy, Zarr or dask, which can
    be sliced.
    """

    given: Any
    shape: tuple[int, ...]

    @classmethod
    def of(cls, given: Any) -> LargeArray:
        """An array with the shape of a field."""
        array = opened(str(given) if isinstance(given, str | Path) else given)
        sizes = tuple(int(n) for n in array.shape)
        if len(sizes) < 4 or sizes[1] < len(sizes) - 2:
            raise GridError(
                f"source: expected the shape (rows, columns, N_1, N_2, ...), got {sizes}. Give the "
                "coframe at each node."
            )
        # A thin sheet has one column more than its grid has axes.
        if sizes[1] > max(3, len(sizes) - 2):
            raise GridError(
                f"source: expected {len(sizes) - 2} columns, one for each axis of the grid, got "
                f"{sizes[1]} in the shape {sizes}. The axes of the grid are the last ones: "
                "numpy.moveaxis puts them there."
            )
        if 0 in sizes:
            raise GridError(f"source: expected one node or more along each axis, got {sizes}.")
        # Keep the path and open it again for each read; a mapped array would be copied to workers.
        return cls(str(given) if isinstance(given, str | Path) else array, sizes)

    @property
    def digest(self) -> str | None:
        """SHA-256 of all values or their files; None for arrays that may be slow to read."""
        if isinstance(self.given, str):
            return digest_of(Path(self.given))
        if not isinstance(self.given, np.ndarray):
            return None
        return digest_of_arrays(np.asarray(self.given[:, :, k]) for k in range(self.shape[2]))

    def read(self, low: Sequence[int], high: Sequence[int]) -> np.ndarray:
        """The values of nodes from low to high; indices beyond the ends of an axis wrap around."""
        shape = (*self.shape[:2], *(b - a for a, b in zip(low, high, strict=True)))
        if 8 * prod(shape) > LARGEST_ARRAYS:
            raise LimitError(
                f"source: expected parts of at most {LARGEST_ARRAYS:,} bytes, got "
                f"{8 * prod(shape):,} bytes for {shape}. Give smaller blocks."
            )
        pieces = [_pieces(a, b, n) for a, b, n in zip(low, high, self.shape[2:], strict=True)]
        values = np.empty(shape)
        array = opened(self.given, again=True)
        for parts in product(*pieces):
            there = tuple(slice(start, stop) for _, start, stop in parts)
            here = tuple(slice(place, place + stop - start) for place, start, stop in parts)
            place = values[(slice(None), slice(None), *here)]
            place[...] = self._part(array, (slice(None), slice(None), *there), place.shape)
        return values

    def _part(self, array: Any, index: tuple[slice, ...], shape: tuple[int, ...]) -> np.ndarray:
        """The values of a slice, checked: dask may give another shape or type than it declares."""
        if isinstance(self.given, str):
            # A damaged chunk is detected only when it is decompressed.
            part = guarded(Path(self.given), lambda: np.asarray(array[index]))
        else:
            part = array[index]
        if hasattr(part, "compute"):
            # This runs inside a task, where another thread pool would multiply the memory.
            part = part.compute(scheduler="synchronous")
        part = np.asarray(part)
        if part.shape != shape or part.dtype.kind not in "fiu":
            raise GridError(
                f"source: expected real numbers of shape {shape}, got {part.dtype} of shape "
                f"{part.shape}. Give an array whose parts have the shape that it declares."
            )
        return part


def digest_of_arrays(parts: Iterable[np.ndarray]) -> str:
    """SHA-256 of the concatenated bytes of arrays."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(np.ascontiguousarray(part).data)
    return digest.hexdigest()


def _pieces(low: int, high: int, points: int) -> list[tuple[int, int, int]]:
    """Pieces of a periodic axis: position in the result, first and last node."""
    ends = [low, *range((low // points + 1) * points, high, points), high]
    return [(a - low, a % points, a % points + b - a) for a, b in pairwise(ends)]


def opened(given: Any, *, again: bool = False) -> Any:
    """An array in memory or on disk, whose parts are read on request.

    again: whether it was opened before; if so, its chunks are not counted again.
    """
    if not isinstance(given, str):
        array = given
        if not hasattr(array, "shape") or not hasattr(array, "dtype"):
            array = checks.array(given, "source", GridError, infinite=None)
        elif isinstance(array, np.ma.MaskedArray):
            array = checks.unmasked(array)
    else:
        path = Path(given)
        if not path.exists():
            raise FileFormatError(f"{path}: there is no such file.")
        array = guarded(path, lambda: mapped_npy(path) if path.is_file() else _zarr(path, again))
    if np.dtype(array.dtype).kind not in "fiu":
        raise GridError(f"source: expected real numbers, got {array.dtype}.")
    return array


def _zarr(path: Path, again: bool) -> Any:
    """A Zarr array, or an array in a group, if its codecs are harmless and it is complete."""
    for inner in (path, path / INNER):
        for name in (".zarray", "zarr.json"):
            if (inner / name).is_file():
                header = read_json_text(read_text(inner / name), str(inner / name))
                if not isinstance(header, dict):
                    raise FileFormatError(
                        f"{inner / name}: expected a table, got {checks.shown(header)}. Write the "
                        "array again."
                    )
                if name == ".zarray" or header.get("node_type") == "array":
                    _check_packing(inner, header)
                    array = module("zarr", path).open_array(str(inner), mode="r")
                    if not again:
                        _check_chunks(inner, array)
                    return array
    raise FileFormatError(
        f"{path}: expected an .npy file, a Zarr array, or a folder with a Zarr array {INNER}, got "
        "none of them. Name another path."
    )


def _check_packing(path: Path, said: dict[str, Any]) -> None:
    """Refuse codecs that do more than compress."""
    listed = [said.get("compressor"), *(said.get("filters") or []), *(said.get("codecs") or [])]
    while listed:
        entry = listed.pop()
        if entry is None:
            continue
        codec = entry if isinstance(entry, dict) else {}
        name = codec.get("id") or codec.get("name")
        if name not in HARMLESS:
            raise FileFormatError(
                f"{path}: expected a supported codec such as zstd or gzip, got "
                f"{checks.shown(name)}. Write the array again with one of them."
            )
        inner = codec.get("configuration") or {}
        listed += [*(inner.get("codecs") or []), *(inner.get("index_codecs") or [])]


def _check_chunks(path: Path, array: Any) -> None:
    """Refuse an array with empty, too large or missing chunks.

    A missing chunk is read as the fill value of the array. This is correct if the value is NaN (a
    hole). Any other value would be used like a measured value.
    """
    # If chunks are packed into shards, each shard is a file.
    sizes = getattr(array, "shards", None) or array.chunks
    if not all(array.shape) or not all(sizes):
        raise FileFormatError(
            f"{path}: expected lengths of 1 or more, got the shape {tuple(array.shape)} in chunks "
            f"of {tuple(sizes)}. Write the array again."
        )
    largest = prod(array.chunks) * array.dtype.itemsize
    if largest > LARGEST_ARRAYS:
        raise LimitError(
            f"{path}: expected chunks of at most {LARGEST_ARRAYS:,} bytes, got {largest:,} bytes "
            f"for {tuple(array.chunks)}. Write the array in smaller chunks."
        )
    fill = array.fill_value
    if isinstance(fill, float | np.floating) and np.isnan(fill):
        return
    counts = [-(-n // m) for n, m in zip(array.shape, sizes, strict=True)]
    needed = prod(counts)
    there = sum(_is_chunk(one.relative_to(path).as_posix(), counts) for one in path.rglob("*"))
    if there < needed:
        raise FileFormatError(
            f"{path}: expected {needed:,} chunks, got {there:,}; missing chunks would be read as "
            f"{fill}. Copy the whole array, or write it again with the fill value NaN (which is a "
            "hole), or with write_empty_chunks=True."
        )


def _is_chunk(key: str, counts: Sequence[int]) -> bool:
    """Whether the name of a file is the key of a chunk: c/0/1 or, in format 2, 0.1 or 0/1."""
    if not _CHUNK.fullmatch(key):
        return False
    numbers = [int(word) for word in re.findall("[0-9]+", key)]
    return len(numbers) == len(counts) and all(map(lt, numbers, counts))


def estimated_sigma(source: LargeArray) -> np.ndarray:
    """Noise of each component, shape (rows, columns along the grid), from a sample of the field.

    The method is the same as in `SampledFrame(sigma="estimate")`. It uses all nodes of a small
    field, and evenly distributed windows of a large field.
    """
    shape = source.shape[2:]
    d = len(shape)
    windows = [[(0, n)] for n in shape]
    if prod(shape) > SAMPLE:
        # Windows are at least as wide as sixth differences require.
        side = max(SMOOTH + 1, round(WINDOW ** (1 / d)))
        count = max(2, round((SAMPLE / WINDOW) ** (1 / d)))
        sides = [min(n, side) for n in shape]
        windows = [
            [(int(k), int(k) + m) for k in np.unique(np.linspace(0, n - m, count).astype(int))]
            for n, m in zip(shape, sides, strict=True)
        ]
    parts = []
    for window in product(*windows):
        low, high = zip(*window, strict=True)
        values = source.read(low, high)[:, :d]
        check_finite(values, low)
        parts.append((values, grid_of(values, (1.0,) * d)))
    return estimated_from_parts(parts).reshape(source.shape[0], d)


def grid_of(values: np.ndarray, steps: tuple[float, ...]) -> Grid:
    """The grid of a block with its holes."""
    shape = values.shape[2:]
    holes = np.asarray(np.isnan(values).any(axis=(0, 1)))
    axes = tuple(np.arange(float(n)) for n in shape)
    return Grid(axes, tuple("xyzuvw"[: len(shape)]), (False,) * len(shape), holes, steps)


def check_finite(values: np.ndarray, low: Sequence[int]) -> None:
    """Refuse infinite values in a block whose first node is low."""
    if np.isinf(values).any():
        place = np.argwhere(np.isinf(values))[0, 2:] + low
        raise GridError(
            "source: expected finite values, got infinity at node "
            f"{tuple(place.tolist())}. Write NaN at unknown nodes."
        )
