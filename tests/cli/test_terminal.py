"""The terminal: lines that fit, and progress that says how long it takes."""

import io
import sys
import time

import pytest

from geomtorsion.cli.terminal import bar, time_left, working, wrapped


def test_lines_fit():
    """Long lines are folded, formulas that stand alone are not."""
    text = wrapped("word " * 40 + "\n    " + "x" * 120, taken=10)
    first, *_, last = text.splitlines()
    assert len(first) <= 78
    assert last == "    " + "x" * 120


@pytest.mark.parametrize(
    ("done", "elapsed", "says"),
    [(0.25, 20.0, "60 s left"), (0.5, 1800.0, "30 min left"), (1.0, 9.0, "0 s left")],
)
def test_time_left(done, elapsed, says):
    """What is left takes as long as what is done took, in proportion."""
    assert time_left(done, elapsed) == says


def test_at_first_nothing_is_said():
    """A beginning that only compiled says nothing of the rest."""
    assert time_left(0.019, 5.0) == ""
    assert time_left(0.021, 1.0) != ""


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
    monkeypatch.setenv("COLUMNS", "120")
    return screen


def test_a_slow_start_counts(monkeypatch):
    """30 s until the first report, a tenth more at once: the rest takes 90 s, not one."""
    screen, clock = watched(monkeypatch), [0.0]
    monkeypatch.setattr("rich.console.monotonic", lambda: clock[0])
    with bar("top") as show:
        assert show is not None
        clock[0] = 30.0
        show(0.20)
        clock[0] = 30.1
        show(0.25)
    assert "top (Ctrl-C stops)" in screen.getvalue()
    assert "90 s left" in screen.getvalue()


def test_steps_are_shown(monkeypatch):
    """What is being computed, and how to stop it."""
    screen = watched(monkeypatch)
    with working("so3") as progress:
        progress("solving")
        deadline = time.monotonic() + 20
        # The line is drawn some times a second, by a thread.
        while "so3: solving (Ctrl-C stops)" not in screen.getvalue():
            assert time.monotonic() < deadline
            time.sleep(0.01)


def test_without_a_terminal_nothing_is_shown(capsys):
    """A pipe gets results alone."""
    with bar("top") as show, working("so3") as progress:
        progress("solving")
    assert show is None
    assert capsys.readouterr().err == ""
