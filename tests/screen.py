"""Screen: a terminal in the place of standard error."""

import io
import sys


class Screen(io.StringIO):
    """Standard error that somebody watches."""

    def isatty(self) -> bool:
        """It is a terminal."""
        return True


def watched(monkeypatch) -> Screen:
    """A terminal in the place of standard error, from now to the end of the test."""
    screen = Screen()
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("JPY_PARENT_PID", raising=False)
    monkeypatch.setenv("COLUMNS", "120")
    return screen
