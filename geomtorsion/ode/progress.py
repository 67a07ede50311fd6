"""Progress: how far long work is, and a bar on the terminal."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

# Progress is shown for work that takes longer than this, in seconds.
PATIENCE = 2.0


class Report:
    """How much of a solution is done, told from the times that its runs have reached.

    Two runs are needed at least; each takes half of what is left.
    """

    def __init__(self, progress: Callable[[float], object], end: float) -> None:
        self.progress = progress
        self.end = end
        self.left = 2.0
        self.told = 0.0

    def next_run(self) -> Callable[[float], None]:
        """What is to be called with the times that the next run reaches."""
        self.left = left = self.left / 2

        def watch(time: float) -> None:
            part = 1 - left + 0.5 * left * min(time / self.end, 1.0)
            # Engines call this at every step; a bar shows no less than a thousandth.
            if part - self.told >= 0.001:
                self.told = part
                self.progress(part)

        return watch


class Bar:
    """A bar on the terminal, shown for long work only."""

    def __init__(self, number: int, wanted: bool | None) -> None:
        self.number = number
        self.shown = False
        self.wanted = sys.stderr.isatty() if wanted is None else wanted
        self.began = self.last = time.perf_counter()
        self.patience = 0.0 if wanted else PATIENCE

    def __call__(self, done: int) -> None:
        """Show how many are done."""
        now = time.perf_counter()
        if self.wanted and now - self.began >= self.patience and now - self.last > 0.2:
            part = int(40 * done / self.number)
            sys.stderr.write(f"\r[{'=' * part}{' ' * (40 - part)}] {done} of {self.number}")
            sys.stderr.flush()
            self.shown, self.last = True, now

    def close(self) -> None:
        """End the line."""
        if self.shown:
            sys.stderr.write("\n")
