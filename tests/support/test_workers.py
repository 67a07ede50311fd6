"""Workers: a limit ends the work whatever it does, with all processes that it started."""

import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from geomtorsion.errors import AllowanceError
from geomtorsion.support.workers import (
    Bounds,
    LineProcess,
    end_family,
    family,
    resident,
    work_within,
)

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="these workers are forks")
SLEEPS = "import time; time.sleep(1000)"


def deaf():
    """Ignore every signal that can be ignored, as one long call of a C library does."""
    for number in (signal.SIGINT, signal.SIGUSR1, signal.SIGXCPU):
        signal.signal(number, signal.SIG_IGN)


def sleeps(begun):
    """Work without end that looks at no signal."""
    deaf()
    begun()
    time.sleep(1000)


def grows(begun):
    """Work that takes more and more memory, and looks at no signal."""
    deaf()
    begun()
    blocks = []
    while len(blocks) < 400:
        blocks.append(np.ones(10**6))
        time.sleep(0.005)


@pytest.mark.parametrize(
    ("bounds", "work", "words"),
    [
        (Bounds(seconds=0.2), sleeps, "0.2 s"),
        (Bounds(megabytes=100), grows, "100 MB"),
        (Bounds(seconds=100, megabytes=100), grows, "100 MB"),
    ],
)
def test_a_limit_ends_deaf_work(bounds, work, words):
    """The worker is ended although it reacts to nothing, and the error names the limit."""
    with pytest.raises(AllowanceError, match=f"^the work takes more than {words}$"):
        work_within(bounds, work, 2)


@pytest.mark.parametrize("code", [0, 1, 2, 130])
def test_the_exit_code_of_the_work_is_returned(code):
    """The exit code of work within its limits is returned."""
    assert work_within(Bounds(seconds=100, megabytes=1000), lambda _: sys.exit(code), 2) == code


def test_errors_of_the_work_are_reported_once():
    """Work that ends with the agreed code after the signal has reported the limit."""

    def reports(begun):
        signal.signal(signal.SIGXCPU, lambda *_: sys.exit(2))
        begun()
        time.sleep(1000)

    assert work_within(Bounds(seconds=0.1), reports, 2) == 2


def test_a_worker_that_dies_has_the_code_of_its_signal():
    """The exit code is 128 and the number of the signal, as in shells."""
    assert work_within(Bounds(), lambda _: os.kill(os.getpid(), signal.SIGKILL), 2) == 137


def test_a_family_is_ended_whole():
    """A process ends with the processes below it, also those in sessions of their own."""
    code = f"import subprocess, sys\nsubprocess.Popen([sys.executable, '-c', {SLEEPS!r}], "
    code += f"start_new_session=True)\nprint(flush=True)\n{SLEEPS}"
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE) as parent:
        assert parent.stdout is not None
        parent.stdout.readline()
        members = family(parent.pid)
        assert len(members) == 2
        assert resident(parent.pid)
        end_family(parent.pid)
    [below] = set(members) - {parent.pid}
    # Whoever inherits it takes note of its end.
    for _ in range(1000):
        if not family(below):
            break
        time.sleep(0.01)
    assert not family(below)


def test_a_process_answers_lines():
    """Each line gets its answer; silence is a TimeoutError, the end an empty line."""
    echo = LineProcess(["-c", "import sys\nfor line in sys.stdin: print(line, end='', flush=True)"])
    echo.send("ä")
    assert echo.receive(60) == "ä\n"
    with pytest.raises(TimeoutError, match="expected a reply within 0.01 s, got none"):
        echo.receive(0.01)
    echo.end()
    assert not echo.lives
    assert echo.receive(60) == ""
