"""Progress: a terminal shows a bar with the remaining time."""

import pytest

from geomtorsion.cli.terminal import working
from geomtorsion.support.progress import PATIENCE, bar, somebody_watches, time_left
from tests.screen import watched


@pytest.mark.parametrize(
    ("done", "elapsed", "words"),
    [(0.25, 20.0, "60 s left"), (0.5, 1800.0, "30 min left"), (1.0, 9.0, "0 s left")],
)
def test_time_left(done, elapsed, words):
    """The remaining time is proportional to the time used so far."""
    assert time_left(done, elapsed) == words


def test_no_time_is_shown_at_first():
    """No remaining time is shown at the beginning, when only compilation has run."""
    assert time_left(0.019, 5.0) == ""
    assert time_left(0.021, 1.0) != ""


def test_a_slow_start_counts(monkeypatch):
    """The time until the first report counts: 30.1 s for a quarter leave 90 s for the rest."""
    screen, clock = watched(monkeypatch), [0.0]
    monkeypatch.setattr("time.perf_counter", lambda: clock[0])
    with bar("top") as show:
        assert show is not None
        clock[0] = 30.0
        show(0.20)
        clock[0] = 30.1
        show(0.25)
    assert "top (Ctrl-C stops)" in screen.getvalue()
    assert "90 s left" in screen.getvalue()


def test_in_a_cell_of_a_notebook_nothing_moves(monkeypatch):
    """In Jupyter, which shows each update as a new line, no bar is shown."""
    screen = watched(monkeypatch)
    assert somebody_watches()
    monkeypatch.setenv("JPY_PARENT_PID", "1")
    assert not somebody_watches()
    with bar("top") as show, working("so3") as progress:
        assert show is None
        progress("solving")
    assert screen.getvalue() == ""


@pytest.mark.parametrize("waited", [1.8, 2.2])
def test_short_work_shows_no_bar(monkeypatch, waited):
    """Functions of the library show a bar only after two seconds."""
    screen, clock = watched(monkeypatch), [0.0]
    monkeypatch.setattr("time.perf_counter", lambda: clock[0])
    with bar("9 members", 9, patience=PATIENCE) as show:
        assert show is not None
        clock[0] = waited
        show(3)
    assert ("9 members" in screen.getvalue()) == (waited > 2)


def test_a_bar_that_is_wanted_is_shown_anywhere(capsys):
    """With progress=True the bar is also written into a file or a pipe, once."""
    with bar("9 members", 9, wanted=True) as show:
        assert show is not None
        for done in range(10):
            show(done)
    assert "9 members" in capsys.readouterr().err


def test_without_a_terminal_nothing_is_shown(capsys):
    """A pipe receives only results."""
    with bar("top") as show:
        assert show is None
    assert capsys.readouterr().err == ""
