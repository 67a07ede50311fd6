"""Sources: large arrays of which parts are read: NumPy's, files of NPY and Zarr, and functions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion import checks
from geomtorsion.blocks import digest_of, digest_of_arrays
from geomtorsion.errors import FileFormatError, GridError, LimitError
from geomtorsion.files import read_json_text, read_text
from geomtorsion.loops.fields.contents import guarded, module
from geomtorsion.loops.fields.packed_chunks import check_packed
from geomtorsion.npz import LARGEST_ARRAYS

# Packings of Zarr that only pack: any other one might run what it finds.
HARMLESS = frozenset(
    "blosc zstd gzip zlib lz4 bz2 lzma bytes crc32c transpose sharding_indexed endian".split()
)


@dataclass(frozen=True, eq=False)
class Source:
    """Values of shape (rows, columns, grid...) that are read part by part.

    given: an array; the path of an .npy file or of a Zarr array; or a function that takes slices of
    the grid and returns the values there.
    """

    given: Any
    shape: tuple[int, ...]

    @classmethod
    def of(cls, given: Any, shape: Sequence[int] | None) -> Source:
        """A source of known shape; a function needs to be told its own."""
        if callable(given):
            if shape is None:
                raise GridError("shape: (rows, columns, grid...) is needed with a function.")
            rows = checks.numbers(shape, None, "shape", GridError)
            sizes = tuple(checks.count(n, "shape", GridError, 1) for n in rows)
        else:
            given = str(given) if isinstance(given, str | Path) else given
            sizes = tuple(int(n) for n in np.shape(opened(given)))
        if len(sizes) < 4 or sizes[1] < len(sizes) - 2:
            raise GridError(
                f"source: shape (rows, columns, N_1, N_2, ...) was needed, but {sizes} came."
            )
        if 0 in sizes:
            raise GridError(f"source: expected one node or more along each axis, got {sizes}.")
        return cls(given, sizes)

    @property
    def digest(self) -> str | None:
        """Of all values or their files; None of a function, all of which may take long."""
        if callable(self.given):
            return None
        if isinstance(self.given, str):
            return digest_of(Path(self.given))
        array = opened(self.given)
        return digest_of_arrays(np.asarray(array[:, :, k]) for k in range(self.shape[2]))

    def read(self, low: Sequence[int], high: Sequence[int]) -> np.ndarray:
        """The values of nodes from low to high; beyond the ends of an axis it begins again."""
        shape = (*self.shape[:2], *(b - a for a, b in zip(low, high, strict=True)))
        if 8 * math.prod(shape) > LARGEST_ARRAYS:
            raise LimitError(
                f"source: expected parts of at most {LARGEST_ARRAYS:,} bytes, got "
                f"{8 * math.prod(shape):,} bytes for {shape}. Give smaller blocks."
            )
        pieces = [_pieces(a, b, n) for a, b, n in zip(low, high, self.shape[2:], strict=True)]
        found = np.empty(shape)
        is_function = callable(self.given)
        array = self.given if is_function else opened(self.given, again=True)
        for parts in product(*pieces):
            there = tuple(slice(start, stop) for _, start, stop in parts)
            here = tuple(slice(place, place + stop - start) for place, start, stop in parts)
            whole = (slice(None), slice(None))
            if is_function:
                values = _checked(array(there), found[(*whole, *here)].shape, there)
            else:
                values = array[(*whole, *there)]
            found[(*whole, *here)] = values
        return found


def _checked(values: object, shape: tuple[int, ...], there: tuple[slice, ...]) -> np.ndarray:
    """What a function gave: of another shape it would be spread without a word."""
    found = checks.array(values, "source", GridError, infinite=None)
    if found.shape != shape:
        nodes = ", ".join(f"{part.start}:{part.stop}" for part in there)
        raise GridError(
            f"source: values of shape {shape} were needed at the nodes {nodes}, but {found.shape} "
            "came. Give (rows, columns, grid...) there."
        )
    return found


def _pieces(low: int, high: int, points: int) -> list[tuple[int, int, int]]:
    """Stretches of an axis that begins again: place in the result, first and last node."""
    ends = [low, *range((low // points + 1) * points, high, points), high]
    return [(a - low, a % points, a % points + b - a) for a, b in pairwise(ends)]


def opened(given: Any, inner: str = "coframe", *, again: bool = False) -> Any:
    """An array in memory or on disk, of which parts are read when they are asked for.

    inner: what the array is called in a Zarr group. again: whether it was opened before, so that
    its chunks need not be counted.
    """
    if not isinstance(given, str):
        found = given
        if not hasattr(found, "shape") or not hasattr(found, "dtype"):
            found = checks.array(given, "source", GridError, infinite=None)
        elif isinstance(found, np.ma.MaskedArray):
            found = checks.unmasked(found)
    else:
        path = Path(given)
        if not path.exists():
            raise FileFormatError(f"{path}: there is no such file.")
        found = guarded(path, lambda: _npy(path) if path.is_file() else _zarr(path, inner, again))
    if np.dtype(found.dtype).kind not in "fiu":
        raise GridError(f"source: real numbers were needed, but {found.dtype} came.")
    return found


def _npy(path: Path) -> np.ndarray:
    """An NPY file, mapped; nothing in it is unpickled."""
    return np.load(path, mmap_mode="r", allow_pickle=False)


@dataclass(frozen=True, eq=False)
class ZarrArray:
    """A Zarr array on disk, of which parts are read; damaged chunks are errors of ours."""

    path: Path
    array: Any

    @property
    def shape(self) -> tuple[int, ...]:
        """Length along each axis."""
        return tuple(self.array.shape)

    @property
    def dtype(self) -> Any:
        """Kind of the numbers."""
        return self.array.dtype

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, index: Any) -> np.ndarray:
        """A part, in memory."""
        return guarded(self.path, lambda: np.asarray(self.array[index]))


def _zarr(path: Path, called: str, again: bool) -> ZarrArray:
    """A Zarr array, or one in a group, if it is only packed and all of it is there."""
    for inner in (path, path / called):
        for name in (".zarray", "zarr.json"):
            if (inner / name).is_file():
                said = read_json_text(read_text(inner / name), str(inner / name))
                if not isinstance(said, dict):
                    raise FileFormatError(
                        f"{inner / name}: expected a table, got {checks.shown(said)}. Write the "
                        "array again."
                    )
                if name == ".zarray" or said.get("node_type") == "array":
                    _check_packing(inner, said)
                    array = module("zarr", path).open_array(str(inner), mode="r")
                    if not again:
                        _check_chunks(inner, array)
                        shard = getattr(array, "shards", None) or array.chunks
                        count = math.prod(shard) // math.prod(array.chunks)
                        size = math.prod(array.chunks) * array.dtype.itemsize
                        check_packed(inner, said, size, count)
                    return ZarrArray(inner, array)
    raise FileFormatError(
        f"{path}: neither an .npy file nor a Zarr array, nor one called {called}."
    )


def _check_packing(path: Path, said: dict[str, Any]) -> None:
    """Refuse packings that do more than pack."""
    listed = [said.get("compressor"), *(said.get("filters") or []), *(said.get("codecs") or [])]
    while listed:
        one = listed.pop()
        if one is None:
            continue
        known = one if isinstance(one, dict) else {}
        name = known.get("id") or known.get("name")
        if name not in HARMLESS:
            raise FileFormatError(f"{path}: packed by {checks.shown(name)}, which is not read.")
        inner = known.get("configuration") or {}
        listed += [*(inner.get("codecs") or []), *(inner.get("index_codecs") or [])]


def _check_chunks(path: Path, array: Any) -> None:
    """Refuse an array whose chunks are none, too large, or missing.

    A missing chunk is read as the fill value of the array. That is right where it is NaN, a hole;
    any other value would be taken for a measured one.
    """
    # Where chunks are packed into shards, a shard is a file.
    sizes = getattr(array, "shards", None) or array.chunks
    if not all(array.shape) or not all(sizes):
        raise FileFormatError(
            f"{path}: expected lengths of 1 or more, got the shape {tuple(array.shape)} in chunks "
            f"of {tuple(sizes)}. Write the array again."
        )
    largest = math.prod(array.chunks) * array.dtype.itemsize
    if largest > LARGEST_ARRAYS:
        raise LimitError(
            f"{path}: expected chunks of at most {LARGEST_ARRAYS:,} bytes, got {largest:,} bytes "
            f"for {tuple(array.chunks)}. Write the array in smaller chunks."
        )
    fill = array.fill_value
    if isinstance(fill, float | np.floating) and np.isnan(fill):
        return
    needed = math.prod(-(-n // m) for n, m in zip(array.shape, sizes, strict=True))
    files = sum(1 for one in path.rglob("*") if one.is_file())
    # Counting goes through all chunks that are declared, which may be more than ever end.
    there = files if files < needed else array.nchunks_initialized * math.prod(array.chunks)
    there = there if files < needed else there // math.prod(sizes)
    if there < needed:
        raise FileFormatError(
            f"{path}: expected {needed:,} chunks, got at most {there:,}; the others would be read "
            f"as {fill}. Copy the whole array, or write it again with the fill value NaN (which "
            "is a hole), or with write_empty_chunks=True."
        )
