"""Graders: the commands of nbgrader and otter, run for real."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import geomtorsion


def command(module: str, folder: Path) -> Callable[..., None]:
    """Runs a module's command in a folder; it has to end well."""
    # They start the kernel and alembic by their names, which stand beside the interpreter.
    settings = os.environ | {
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": str(Path(geomtorsion.__file__).parents[1]),
        "JUPYTER_PREFER_ENV_PATH": "1",
    }

    def run(*words: str) -> None:
        done = subprocess.run(
            [sys.executable, "-m", module, *words],
            cwd=folder, env=settings, capture_output=True, text=True, timeout=300, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr[-3000:]

    return run
