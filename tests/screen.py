"""Screen: a terminal that replaces standard error."""

import io
import sys


class Screen(io.StringIO):
    """Standard error that reports a terminal."""

    def isatty(self) -> bool:
        """True: it is a terminal."""
        return True


def watched(monkeypatch) -> Screen:
    """Replace standard error by a terminal until the end of the test."""
    screen = Screen()
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("JPY_PARENT_PID", raising=False)
    monkeypatch.setenv("COLUMNS", "120")
    return screen
