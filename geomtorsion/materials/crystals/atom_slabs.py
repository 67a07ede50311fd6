"""Atom slabs: positions of more atoms than memory holds, one stretch of their numbers at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any, cast
from zipfile import ZipFile

import numpy as np

from geomtorsion import checks
from geomtorsion.errors import CrystalError, FileFormatError
from geomtorsion.materials.blocks import digest_of_arrays
from geomtorsion.materials.crystals.given import POSITIONS, positions_of
from geomtorsion.materials.crystals.method import METHOD
from geomtorsion.materials.fields.contents import guarded
from geomtorsion.materials.fields.sources import opened

# Atoms that are read at once: some hundred megabytes while they are sorted.
SLAB = 16 * METHOD.together


@dataclass(frozen=True, eq=False)
class AtomSlabs:
    """Positions that are read slab by slab, always in the same order.

    given: an array of shape (atoms, 3), also a mapped one; the path of an .npy file, of a Zarr
    array, or of an .npz file with the array `positions`; a list of these, one after another; or a
    function that gives an iterator of arrays.
    """

    given: Any

    @property
    def name(self) -> str:
        """What a ledger calls it."""
        given = self.given
        if isinstance(given, str | Path):
            path = Path(given)
            return f"{path}, {path.stat().st_size} bytes" if path.is_file() else str(path)
        if isinstance(given, list | tuple):
            return ", ".join(AtomSlabs(one).name for one in given)
        shape = getattr(given, "shape", None)
        return type(given).__name__ if shape is None else f"array {tuple(shape)}"

    @property
    def digest(self) -> str:
        """Of all atoms; of those that a function gives, which may take long, of the first slab."""
        return digest_of_arrays(islice(self, 1) if callable(self.given) else self)

    def __iter__(self) -> Iterator[np.ndarray]:
        """Slabs of shape (k, 3), each of at most SLAB atoms; small arrays become one of them."""
        waiting: list[np.ndarray] = []
        for found in _parts(self.given):
            for start in range(0, found.shape[0], SLAB):
                part = positions_of(np.asarray(found[start : start + SLAB]))
                if sum(map(len, waiting)) + len(part) > SLAB:
                    yield np.concatenate(waiting)
                    waiting = []
                waiting.append(part)
        if waiting:
            yield np.concatenate(waiting)


def _parts(given: Any) -> Iterator[Any]:
    """Arrays, of which parts are read when they are asked for, one after another."""
    if callable(given):
        found = cast("Callable[[], object]", given)()
        if not isinstance(found, Iterable):
            raise CrystalError(
                "source: a function that gives an iterator of arrays was needed, but it gave "
                f"{checks.shown(found)}."
            )
        for part in found:
            yield checks.array(part, POSITIONS, CrystalError, shape=(None, 3))
    elif isinstance(given, list | tuple) and not _are_rows(given):
        for one in given:
            yield from _parts(one)
    elif isinstance(given, str | Path) and Path(given).suffix == ".npz":
        yield from _packed(Path(given))
    elif isinstance(given, Iterator):
        raise CrystalError(
            f"source: what can be read again was needed, but {type(given).__name__} came, which "
            "is used up once. Give a function that makes it."
        )
    else:
        if isinstance(given, str | Path):
            found = opened(str(given), POSITIONS)
        elif hasattr(given, "shape") and hasattr(given, "dtype"):
            found = opened(given)
        else:
            found = checks.array(given, "source", CrystalError)
        shape = tuple(found.shape)
        if len(shape) != 2 or shape[1] != 3:
            raise CrystalError(
                f"source: positions of shape (atoms, 3) were needed, but {shape} came."
            )
        yield found


def _are_rows(given: Sequence[Any]) -> bool:
    """Whether a list is one of positions, not of files or arrays."""
    first = given[0] if given else 0
    if isinstance(first, list | tuple):
        return all(isinstance(x, int | float | np.number) for x in first)
    return not isinstance(first, str | Path) and np.ndim(first) < 2


def _packed(path: Path) -> Iterator[np.ndarray]:
    """The positions in an NPZ file, unpacked as they are read."""
    if not path.is_file():
        raise FileFormatError(f"{path}: there is no such file.")
    stretches = _unpacked(path)
    while (part := guarded(path, lambda: next(stretches, None))) is not None:
        yield part


def _unpacked(path: Path) -> Iterator[np.ndarray]:
    """Stretches of the array; any error of a damaged file."""
    form = np.lib.format
    with ZipFile(path) as archive, archive.open(f"{POSITIONS}.npy") as stream:
        reading: Callable[..., Any] = (
            form.read_array_header_1_0
            if form.read_magic(stream) == (1, 0)
            else form.read_array_header_2_0
        )
        shape, by_columns, dtype = reading(stream)
        if len(shape) != 2 or shape[1] != 3 or by_columns or dtype.kind not in "fiu":
            raise FileFormatError(
                f"{path}: {POSITIONS}: numbers of shape (atoms, 3), atom by atom, were needed, but "
                f"{dtype} of shape {shape} came. Write it again by np.savez."
            )
        for start in range(0, shape[0], SLAB):
            count = min(SLAB, shape[0] - start)
            content = stream.read(3 * count * dtype.itemsize)
            yield np.frombuffer(content, dtype).reshape(count, 3).astype(float)
