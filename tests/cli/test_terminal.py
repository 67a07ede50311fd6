"""The terminal: wrapped lines, the current step, and rows of a table."""

import time

from geomtorsion.cli.terminal import some_rows, working, wrapped
from tests.screen import watched


def test_lines_fit():
    """Long lines of text are wrapped, indented formulas are not."""
    text = wrapped("word " * 40 + "\n    " + "x" * 120, taken=10)
    first, *_, last = text.splitlines()
    assert len(first) <= 78
    assert last == "    " + "x" * 120


def test_steps_are_shown(monkeypatch):
    """The line names the current step and the key that stops it."""
    screen = watched(monkeypatch)
    with working("so3") as progress:
        progress("solving")
        # A thread draws the line several times a second.
        for _ in range(10_000):
            if "so3: solving (Ctrl-C stops)" in screen.getvalue():
                break
            time.sleep(0.01)
        assert "so3: solving (Ctrl-C stops)" in screen.getvalue()


def test_without_a_terminal_nothing_is_shown(capsys):
    """Without a terminal, standard error is empty."""
    with working("so3") as progress:
        progress("solving")
    assert capsys.readouterr().err == ""


def test_how_many_rows_are_shown():
    """Nine rows at most, including the last."""
    assert len(some_rows(9)) == len(some_rows(10)) == len(some_rows(1000)) == 9
    assert some_rows(1000)[-1] == 999
