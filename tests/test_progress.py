"""Progress: a bar that says how long the rest takes, where somebody watches."""

import pytest

from geomtorsion.cli.terminal import working
from geomtorsion.progress import PATIENCE, bar, somebody_watches, time_left
from tests.screen import watched


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


def test_a_slow_start_counts(monkeypatch):
    """30 s until the first report, a tenth more at once: the rest takes 90 s, not one."""
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
    """What Jupyter takes for a terminal shows each change as a line of its own."""
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
    """progress=True writes into a file or a pipe as well, once."""
    with bar("9 members", 9, wanted=True) as show:
        assert show is not None
        for done in range(10):
            show(done)
    assert "9 members" in capsys.readouterr().err


def test_without_a_terminal_nothing_is_shown(capsys):
    """A pipe gets results alone."""
    with bar("top") as show:
        assert show is None
    assert capsys.readouterr().err == ""
