"""Contents: the data in a file of a sampled frame, and the errors of its readers."""

from __future__ import annotations

import sys
import zipfile
import zlib
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion.errors import FileFormatError, LimitError, MissingExtraError
from geomtorsion.support import checks
from geomtorsion.support.checks import cut
from geomtorsion.support.npz import LARGEST_ARRAYS

# Texts that belong to a frame.
TEXTS = ("unit", "vector_unit", "source", "signature")


@dataclass(frozen=True, eq=False)
class Contents:
    """Axes and values of a frame.

    values: the coframe, or a distortion, shape (rows, columns, grid...), or a displacement, shape
    (rows, grid...).
    options: sigma, periodic and texts, if present; branch, for a displacement.
    """

    axes: list[np.ndarray]
    values: np.ndarray
    names: tuple[str, ...]
    is_distortion: bool
    options: Mapping[str, Any]
    is_displacement: bool = False


def key_of(path: Path, arrays: Iterable[str]) -> str:
    """Name of the array that holds the values."""
    keys = [key for key in ("coframe", "distortion") if key in arrays]
    if len(keys) != 1:
        present = cut(", ".join(sorted(map(str, arrays)))) or "nothing"
        raise FileFormatError(
            f"{path}: expected exactly one of coframe and distortion, got {present}. Save the "
            "file again with one of them."
        )
    return keys[0]


def guarded(path: Path, load: Callable[[], Any]) -> Any:
    """Result of a reader; its exceptions become errors of this package."""
    try:
        return load()
    except (
        OSError, EOFError, ValueError, TypeError, KeyError, IndexError, AssertionError,
        AttributeError, RuntimeError, ArithmeticError, MemoryError, RecursionError,
        zipfile.BadZipFile, zlib.error,
    ) as error:  # fmt: skip
        if isinstance(error, FileFormatError | LimitError):
            raise
        _finish_tasks()
        raise FileFormatError(
            f"{path}: the file cannot be read: it is truncated or has another format "
            f"({type(error).__name__}: {cut(str(error))}). Write it again."
        ) from None


# Name of a task that waits for all others.
_WAITING = "geomtorsion waits"


def _finish_tasks() -> None:
    """Let the tasks end that Zarr leaves after an error; asyncio would print each of them."""
    tasks = sys.modules.get("zarr.core.sync")
    if tasks is not None:
        # Zarr 2 has none of them, and a later version may name them otherwise.
        with suppress(Exception):
            tasks.sync(_all_tasks())


async def _all_tasks() -> None:
    # Zarr has loaded it; without Zarr nobody needs it.
    import asyncio

    own = asyncio.current_task()
    assert own is not None
    own.set_name(_WAITING)
    # Threads whose chunks are damaged at once would wait for each other's tasks.
    tasks = [one for one in asyncio.all_tasks() if one.get_name() != _WAITING]
    await asyncio.gather(*tasks, return_exceptions=True)


def module(name: str, path: Path) -> Any:
    """An optional library that reads and writes a format."""
    try:
        return import_module(name)
    except ImportError:
        in_parts = name in ("zarr", "dask", "dask.callbacks")
        extra = "cluster" if in_parts else "files"
        others = "" if in_parts else ", or use .npz, .nc or .csv"
        raise MissingExtraError(
            f"{path}: this requires {name}, which is not installed. "
            f"Run `pip install 'geomtorsion[{extra}]'`{others}."
        ) from None


def check_room(path: Path, shapes: Mapping[str, Iterable[int]], size: int = 8) -> None:
    """Refuse arrays whose declared total size is too large to read."""
    total = 0
    for what, shape in shapes.items():
        total += size * prod(map(int, shape))
        if total > LARGEST_ARRAYS:
            raise LimitError(
                f"{path}: expected at most {LARGEST_ARRAYS:,} bytes of arrays, got {total:,} for "
                f"the arrays up to {what}. Give a part of the field."
            )


def check_distinct(path: Path, names: Sequence[str]) -> None:
    """Refuse two axes with one name."""
    twice = next((name for name, count in Counter(names).items() if count > 1), None)
    if twice is not None:
        raise FileFormatError(
            f"{path}: names: expected a different name for each axis, got {cut(twice, 60)!r} "
            f"{names.count(twice):,} times. Rename the axes."
        )


def periodic_names(given: object, path: Path) -> list[str]:
    """Names of periodic axes, from a text with names separated by blanks."""
    return checks.text(given, f"{path}: periodic", FileFormatError).split()
