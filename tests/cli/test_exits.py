"""How commands end, as processes: without Greek, by Ctrl-C, with a closed pipe."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

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
