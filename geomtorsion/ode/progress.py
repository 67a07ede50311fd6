"""Progress: a bar on the terminal for long work."""

from __future__ import annotations

import sys
import time

# Progress is shown for work that takes longer than this, in seconds.
PATIENCE = 2.0


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
