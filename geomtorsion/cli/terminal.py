"""terminal: what it can show, lines that fit, and progress where somebody watches."""

from __future__ import annotations

import sys
import textwrap
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Protocol

WIDTH = 88
# Below this part of a run its beginning (reading, compiling) still decides the time left.
EARLIEST = 0.02


def shows_greek() -> bool:
    """Whether Greek letters, bars and check marks can be written to standard output."""
    try:
        "Γ\u0304θ✓".encode(sys.stdout.encoding or "ascii")
    except (UnicodeEncodeError, LookupError):
        return False
    return True


def wrapped(text: str, taken: int = 0) -> str:
    """Text in lines that fit, the first after so many columns; formulas (indented) stay."""
    lines = []
    for line in text.splitlines():
        if line.startswith("    ") or len(line) + taken <= WIDTH:
            lines.append(line)
        else:
            lines.append(textwrap.fill(" " * taken + line, WIDTH)[taken:])
        taken = 0
    return "\n".join(lines)


@contextmanager
def working(what: str) -> Iterator[Callable[[str], object]]:
    """Show a line that says what is being computed; call the result with each new step."""
    if not sys.stderr.isatty():
        yield lambda _: None
        return
    # rich takes a tenth of a second to load, and is used only where somebody watches.
    from rich.console import Console

    with Console(stderr=True).status(f"{what}: reading (Ctrl-C stops)") as status:
        yield lambda step: status.update(f"{what}: {step} (Ctrl-C stops)")


class Show(Protocol):
    """Takes the part that is done, from 0 to 1, and perhaps what is being done."""

    def __call__(self, done: float, what: str = "") -> None:
        """Show it."""
        ...


@contextmanager
def bar(what: str) -> Iterator[Show | None]:
    """Show a progress bar; the result, called with the part done, is None if nobody watches."""
    if not sys.stderr.isatty():
        yield None
        return
    # As above: only where somebody watches.
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn

    columns = (
        "{task.description} (Ctrl-C stops)",
        "{task.percentage:3.0f} %",
        "{task.fields[left]}",
    )
    first, *others = map(TextColumn, columns)
    with Progress(
        first, BarColumn(), *others, console=Console(stderr=True), transient=True
    ) as shown:
        number = shown.add_task(what, total=1.0, left="")
        (task,) = shown.tasks

        def show(done: float, what: str = what) -> None:
            left = time_left(done, task.elapsed or 0.0)
            shown.update(number, completed=done, description=what, left=left)

        yield show


def time_left(done: float, elapsed: float) -> str:
    """The time that the rest takes if it goes on as it went on average, or nothing at first.

    Examples
    --------
    >>> time_left(0.25, 30.0), time_left(0.5, 3600.0), time_left(0.0, 5.0)
    ('90 s left', '60 min left', '')
    """
    if done < EARLIEST:
        return ""
    seconds = elapsed * (1 - done) / done
    return f"{seconds:.0f} s left" if seconds < 600 else f"{seconds / 60:.0f} min left"
