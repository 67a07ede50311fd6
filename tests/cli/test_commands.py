"""The other commands: what they print, how they end, and that errors are one clean message."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

from geomtorsion.cli.app import app
from geomtorsion.spaces import names

ROOT = Path(__file__).parent.parent.parent
DATA = ROOT / "tests" / "data"
COMMANDS = ("spaces", "geometry", "check", "plan", "report", "paper", "curve", "accuracy")


def run(*arguments: str, code: int = 0):
    """The result of a command that has to end with a code."""
    result = CliRunner().invoke(app, list(arguments))
    assert result.exit_code == code, result.output
    return result


def test_version_is_that_of_the_package():
    """--version says one line."""
    assert run("--version").stdout.startswith("geomtorsion ")


@pytest.mark.parametrize("command", COMMANDS)
def test_help_has_an_example(command):
    """Every command explains itself, with an example that names it."""
    text = run(command, "--help").stdout
    assert f"geomtorsion {command}" in text
    assert "Example" in text


def test_help_lists_the_commands():
    """No command is missing from the overview."""
    text = run("--help").stdout
    for command in COMMANDS:
        assert f"\n  {command}" in text


def test_spaces_lists_all():
    """One line for each space, its name first."""
    lines = run("spaces").stdout.splitlines()
    assert [line.split()[0] for line in lines] == list(names())


def test_check_of_a_shipped_space():
    """Identities of both connections and the known answers hold."""
    text = run("check", "so3").stdout
    for title in ("Cartan connection", "Levi-Civita connection", "Known answers"):
        assert f"{title}\n" in text
    assert "✗" not in text
    assert text.splitlines()[-1] == f"so3: {text.count('✓')} of {text.count('✓')} checks hold."


def test_check_of_a_file_with_its_own_connection():
    """The connection of the file is checked too."""
    text = run("check", str(DATA / "twisted.toml")).stdout
    assert "The space's own connection" in text
    assert text.count("second Bianchi") == 3


def test_nonmetricity_is_no_failure(tmp_path):
    """A connection that does not keep lengths is allowed to: metricity is no identity for it."""
    file = tmp_path / "bent.toml"
    file.write_text(
        'coordinates = ["x", "y"]\ncoframe = [[1, 0], [0, 1]]\nconnection = {"0,0,0" = "y"}\n'
    )
    text = run("check", str(file)).stdout
    assert "– metricity" in text
    assert "checks hold" in text


def test_check_ends_with_1_when_something_fails(monkeypatch):
    """A known answer that is wrong is found, named and counted."""
    from dataclasses import replace

    from geomtorsion.spaces import load
    from geomtorsion.spaces.space import KnownAnswer

    space = replace(load("s2"), known=(KnownAnswer("scalar_curvature", 7),))
    monkeypatch.setattr("geomtorsion.cli.check.open_space", lambda _: space)
    text = run("check", "s2", code=1).stdout
    assert "✗ Scalar curvature" in text
    assert "expected 7" in text
    assert "1 FAILED" in text


def test_plan_shows_what_is_left_out():
    """The plan of the Ricci tensor has no torsion in it; --dot is a graph."""
    text = run("plan", "so3", "ricci").stdout
    assert "christoffel" in text
    assert text.index("christoffel") < text.index("ricci", text.index("christoffel"))
    dot = run("plan", "so3", "ricci", "--dot").stdout
    assert dot.startswith("digraph")
    assert "torsion" not in dot
    assert "Did you mean ricci" in run("plan", "so3", "rici", code=2).stderr


def test_report_of_a_space_and_of_a_file(tmp_path, monkeypatch):
    """Page and data are written; the directory is made, and named after the space by default."""
    monkeypatch.chdir(tmp_path)
    assert "so3: wrote" in run("report", "so3", "-o", "deep/so3").stdout
    assert json.loads((tmp_path / "deep/so3/geometry.json").read_text("utf-8"))["name"] == "so3"
    run("report", str(DATA / "rindler.toml"))
    assert "rocket" in (tmp_path / "rindler-report" / "index.html").read_text("utf-8")


def test_report_where_it_cannot_be_written(tmp_path):
    """A file in the way of the directory is named."""
    (tmp_path / "taken").write_text("")
    error = run("report", "s2", "-o", str(tmp_path / "taken"), code=2).stderr
    assert "taken" in error
    assert "Traceback" not in error


def test_an_attempt_at_code_does_nothing(tmp_path):
    """The file is refused and its code is not run."""
    trace = tmp_path / "trace"
    file = tmp_path / "evil.toml"
    entry = f"__import__('pathlib').Path('{trace}').touch()"
    file.write_text(f'coordinates = ["x"]\ncoframe = [["{entry}"]]\n')
    error = run("check", str(file), code=2).stderr
    assert "expressions are not code" in error
    assert "coframe[0, 0]" in error
    assert not trace.exists()


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
