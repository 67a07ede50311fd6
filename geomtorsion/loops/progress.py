"""Progress: how far a long calculation is, on standard error and only where somebody watches."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def counted(what: str, total: int) -> Iterator[Callable[[int], object]]:
    """Show a bar; call the result with the number of things just finished."""
    if not sys.stderr.isatty():
        yield lambda _: None
        return
    # Nobody who reads no bar should wait for its library.
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task(f"{what} (Ctrl-C stops and keeps what is done)", total=total)
        yield lambda done: progress.advance(task, done)
