"""Blocks: work in parts, one file each in a folder, with a ledger of what they are parts of.

A part is computed from what was given alone, and its file is there whole or not at all: a run that
was killed goes on with what is missing, here, in processes or on a cluster, to the same bits.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion.allowance import check_limits
from geomtorsion.errors import CheckpointError, FileFormatError, LimitError
from geomtorsion.files import read_json_text, read_text, write_text, written
from geomtorsion.progress import PATIENCE, bar, ignore_interrupts

LEDGER = "ledger.json"
# Zeros that are written at once.
ZEROS = bytes(2**20)


def open_ledger(folder: Path, described: Mapping[str, Any]) -> bool:
    """Begin a folder, or take up what is in it; whether there was anything.

    described: what a run must have in common with the one that it takes up, as JSON has it.

    Raises
    ------
    CheckpointError
        The folder holds blocks of another run.
    """
    ledger = folder / LEDGER
    folder.mkdir(parents=True, exist_ok=True)
    if not ledger.is_file():
        write_text(ledger, json.dumps(described))
        return False
    try:
        known = read_json_text(read_text(ledger), str(ledger))
    except FileFormatError as error:
        raise CheckpointError(f"{error} Take an empty folder.") from None
    if known != described:
        keys = known if isinstance(known, dict) else {}
        differ = [key for key, value in described.items() if keys.get(key) != value]
        raise CheckpointError(
            f"{folder}: it holds blocks of another run: {', '.join(differ)} differ. Take an empty "
            "folder, or give the same arguments."
        )
    return True


def digest_of(path: Path) -> str:
    """Of the bytes of a file; of a folder, of its files with their names.

    A file of the same name and size may hold something else, such as the next frame.

    Raises
    ------
    FileFormatError
        There is no such file.
    """
    if path.is_dir():
        files = sorted(one for one in path.rglob("*") if one.is_file())
        listed = [f"{one.relative_to(path).as_posix()} {digest_of(one)}" for one in files]
        return hashlib.sha256("\n".join(listed).encode()).hexdigest()
    if not path.is_file():
        raise FileFormatError(f"{path}: there is no such file.")
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def digest_of_arrays(parts: Iterable[np.ndarray]) -> str:
    """Of the bytes of arrays, one after another."""
    found = hashlib.sha256()
    for part in parts:
        found.update(np.ascontiguousarray(part).data)
    return found.hexdigest()


def write_array(path: Path, values: np.ndarray) -> None:
    """An NPY file that is there whole or not at all."""
    with written(path) as part, part.open("wb") as stream:
        np.save(stream, values)


@contextmanager
def array_on_disk(path: Path, shape: Sequence[int]) -> Iterator[np.ndarray]:
    """A new NPY file of doubles, as a mapped array that is filled within the block.

    Zeros are written first: a full disk then ends in an error of the system, where a mapped page
    that finds no room would kill the process.

    Raises
    ------
    FileFormatError
        There is no room for it.
    """
    with written(path) as part:
        whole = np.lib.format.open_memmap(part, "w+", float, tuple(shape))
        with part.open("r+b") as stream:
            stream.seek(whole.nbytes and part.stat().st_size - whole.nbytes)
            for first in range(0, whole.nbytes, len(ZEROS)):
                stream.write(ZEROS[: whole.nbytes - first])
        yield whole
        whole.flush()


def read_array(path: Path, shape: Sequence[int | None], dtype: Any = float) -> np.ndarray | None:
    """An array that a block has left, mapped; None where there is none, or it is not whole.

    shape: one length for each axis, None for any.
    """
    try:
        found = np.load(path, mmap_mode="r", allow_pickle=False)
    except (OSError, ValueError, EOFError):
        return None
    fits = found.ndim == len(shape) and all(
        wanted in (None, came) for wanted, came in zip(shape, found.shape, strict=True)
    )
    return found if fits and found.dtype == np.dtype(dtype) else None


def run_blocks(
    compute: Callable[[Any], Any],
    left: Sequence[Any],
    workers: int = 1,
    client: Any = None,
    what: str = "blocks",
) -> None:
    """Do blocks here, in processes, or on a cluster (`dask.distributed.Client`).

    Raises
    ------
    LimitError
        A process ended before its work was done.
    """
    with bar(f"{len(left)} {what}", len(left), patience=PATIENCE) as show:
        for done, _ in enumerate(_run(compute, left, workers, client), 1):
            check_limits()
            if show is not None:
                show(done)


def _run(
    compute: Callable[[Any], Any], left: Sequence[Any], workers: int, client: Any
) -> Iterator[Any]:
    """Results in the order in which they come."""
    if client is not None:
        # The same task twice gives the same file: it may be repeated wherever a worker is lost.
        for future in client.map(compute, left, pure=False):
            yield future.result()
    elif workers == 1:
        yield from map(compute, left)
    else:
        try:
            with ProcessPoolExecutor(workers, initializer=ignore_interrupts) as pool:
                try:
                    for future in as_completed([pool.submit(compute, number) for number in left]):
                        yield future.result()
                except BaseException:
                    # Else all that is left would be done before the block ends.
                    pool.shutdown(wait=False, cancel_futures=True)
                    raise
        except BrokenProcessPool:
            # Since Python 3.14 new processes read the script again on Linux, too.
            raise LimitError(
                "a process ended before its work was done. Mostly memory ran out: take fewer "
                "workers or smaller blocks; the same call goes on with what is missing. In a "
                'script, whatever uses workers stands below `if __name__ == "__main__":`.'
            ) from None
