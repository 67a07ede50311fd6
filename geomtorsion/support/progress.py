"""Progress: a bar on standard error, if that is a terminal whose lines can change."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol

from geomtorsion.errors import ArgumentError
from geomtorsion.support.outgoing import moving

if TYPE_CHECKING:
    from rich.progress import Progress

# Below this part of a run its beginning (reading, compiling) still decides the time left.
EARLIEST = 0.02
# Functions of the library show progress of work that takes longer than this, in seconds.
PATIENCE = 2.0


class Show(Protocol):
    """Receives the progress, from 0 to the total, and perhaps the name of the current step."""

    def __call__(self, done: float, what: str = "") -> None:
        """Show it."""
        ...


def somebody_watches() -> bool:
    """Whether standard error is a terminal in which lines can change.

    Jupyter gives a command in a cell a terminal in which they cannot: each change is one line more.
    """
    return sys.stderr.isatty() and "JPY_PARENT_PID" not in os.environ


@contextmanager
def bar(
    what: str, total: float = 1.0, *, wanted: bool | None = None, patience: float = 0.0
) -> Iterator[Show | None]:
    """Show a progress bar; return None if nothing is shown.

    total: the value of `done` at the end.
    wanted: None shows it on a terminal; True shows it anywhere, and leaves it there.
    patience: seconds after which it appears.
    """
    if not (somebody_watches() if wanted is None else wanted):
        yield None
        return
    began = time.perf_counter()
    shown = None if patience else _opened(what, total, kept=bool(wanted))
    last = 0.0

    def show(done: float, what: str = what) -> None:
        nonlocal shown, last
        # Some call this at every step; a bar shows no less than a thousandth.
        if done < total and done - last < 0.001 * total:
            return
        last = done
        if shown is None:
            if time.perf_counter() - began < patience:
                return
            shown = _opened(what, total, kept=bool(wanted))
        (task,) = shown.tasks
        elapsed = time.perf_counter() - began
        left = time_left(done / total, elapsed)
        shown.update(task.id, completed=done, description=what, left=left)

    try:
        yield show
    finally:
        if shown is not None:
            shown.stop()


@contextmanager
def reports(
    progress: Callable[[float], object] | bool | None, what: str
) -> Iterator[Callable[[float], object] | None]:
    """The function that receives the finished fraction: of the caller, a bar for True, or None."""
    if progress is True:
        with bar(what, wanted=True) as show:
            yield show
    elif progress in (None, False):
        yield None
    elif callable(progress):
        yield progress
    else:
        raise ArgumentError(
            f"progress: expected a function of the finished fraction, True, False or None, got "
            f"{progress!r:.100}."
        )


def _opened(what: str, total: float, *, kept: bool) -> Progress:
    """A bar that is drawn from now on; kept: it stays when the work is done."""
    # rich takes a tenth of a second to load, and is used only if a bar is shown.
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn

    shown = Progress(
        TextColumn("{task.description} (Ctrl-C stops)"),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %"),
        TextColumn("{task.fields[left]}"),
        console=Console(file=moving(sys.stderr)),
        transient=not kept,
    )
    shown.add_task(what, total=total, left="")
    shown.start()
    return shown


def time_left(done: float, elapsed: float) -> str:
    """The remaining time at the average speed so far; empty at the beginning.

    Examples
    --------
    >>> time_left(0.25, 30.0), time_left(0.5, 3600.0), time_left(0.0, 5.0)
    ('90 s left', '60 min left', '')
    """
    if done < EARLIEST:
        return ""
    seconds = elapsed * (1 - done) / done
    return f"{seconds:.0f} s left" if seconds < 600 else f"{seconds / 60:.0f} min left"
