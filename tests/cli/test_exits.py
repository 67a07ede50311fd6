"""How commands end, as processes: without Greek, by Ctrl-C, with a closed pipe."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import typer

from geomtorsion import errors
from geomtorsion.cli.exits import clean_exits

ROOT = Path(__file__).parent.parent.parent


def process(*arguments: str, **options) -> subprocess.Popen:
    """The command in a process of its own."""
    return subprocess.Popen(
        [sys.executable, "-m", "geomtorsion", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=ROOT,
        **options,
    )


def test_a_process_without_greek():
    """Where output is ASCII nothing breaks and check marks are words."""
    with process("check", "s2", env={**os.environ, "PYTHONIOENCODING": "ascii"}) as running:
        out, error = running.communicate(timeout=60)
    assert running.returncode == 0, error
    assert out.isascii()
    assert "ok   metricity" in out


def test_ctrl_c_ends_quietly(tmp_path):
    """A long computation stops at once, with code 130 and one line."""
    file = tmp_path / "long.toml"
    terms = "+".join(f"x**{k % 251}*y**{k // 251 % 251}" for k in range(100_000))
    file.write_text(f'coordinates = ["x", "y"]\ncoframe = [["{terms}", 0], [0, 1]]\n')
    with process("geometry", str(file)) as running:
        time.sleep(3)
        assert running.poll() is None, "this was meant to take long"
        running.send_signal(signal.SIGINT)
        _, error = running.communicate(timeout=60)
    assert running.returncode == 130
    assert error == "geomtorsion: stopped\n"


def test_a_closed_pipe_ends_quietly():
    """`geomtorsion ... | head -1` shows no traceback."""
    with process("geometry", "kerr") as running:
        assert running.stdout is not None
        assert running.stderr is not None
        running.stdout.readline()
        running.stdout.close()
        assert "Traceback" not in running.stderr.read()


@pytest.mark.parametrize(
    ("option", "said"), [(("--seconds", "1"), "1 s"), (("--megabytes", "50"), "50 MB")]
)
def test_limits_end_a_command(option, said, tmp_path):
    """A limit of time or memory ends it with code 2 and one line that names what took so long."""
    file = tmp_path / "long.toml"
    terms = "+".join(f"x**{k % 251}*y**{k // 251 % 251}" for k in range(100_000))
    file.write_text(f'coordinates = ["x", "y"]\ncoframe = [["{terms}", 0], [0, 1]]\n')
    with process("geometry", str(file), *option) as running:
        _, error = running.communicate(timeout=60)
    assert running.returncode == 2
    assert f"takes more than {said}" in error
    assert error.startswith("geomtorsion: ")
    assert "Traceback" not in error


def test_limits_that_are_none():
    """A limit below zero is refused."""
    with process("geometry", "s2", "--seconds", "-1") as running:
        _, error = running.communicate(timeout=60)
    assert running.returncode == 2
    assert "seconds: a positive number was needed, but -1" in error


@pytest.mark.parametrize(
    ("kind", "page"),
    [
        pytest.param(errors.LoopError, "tutorials/", id="its own"),
        pytest.param(errors.GeomtorsionError, "errors", id="the general one"),
    ],
)
def test_an_error_names_the_page_that_helps(kind, page, capsys):
    """Below the message, for every error of the package."""
    with pytest.raises(typer.Exit), clean_exits():
        raise kind("no")
    message, more = capsys.readouterr().err.splitlines()
    assert message == "geomtorsion: no"
    assert more.startswith(f"(More on this: page {page}")
