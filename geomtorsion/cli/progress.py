"""progress: what is being computed, on standard error and only where somebody watches."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def working(what: str) -> Iterator[Callable[[str], object]]:
    """Show a line that says what is being computed; call the result with each new step."""
    if not sys.stderr.isatty():
        yield lambda _: None
        return
    from rich.console import Console

    with Console(stderr=True).status(f"{what}: reading (Ctrl-C stops)") as status:
        yield lambda step: status.update(f"{what}: {step} (Ctrl-C stops)")


@contextmanager
def bar(what: str) -> Iterator[Callable[[float], None] | None]:
    """Show a progress bar; call the result, if somebody watches, with the fraction done."""
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = TextColumn("{task.description}"), BarColumn(), TextColumn("{task.percentage:3.0f} %")
    with Progress(
        *columns, TimeRemainingColumn(), console=Console(stderr=True), transient=True
    ) as shown:
        task = shown.add_task(f"{what} (Ctrl-C stops)", total=1.0)
        yield lambda done: shown.update(task, completed=done)
