"""A served page for tests: a process of its own, which ends with its fixture."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from tests.processes import interruptible

ROOT = Path(__file__).parents[3]
# Seconds within which a server on a loaded machine must print its address.
STARTING = 60


@contextmanager
def served(*options: str, errors: IO[str] | None = None) -> Iterator[str]:
    """The address of a page that is served by the command line.

    errors: the file that gets what the server writes to standard error.
    """
    environment = os.environ | {"PYTHONPATH": str(ROOT), "PYTHONUNBUFFERED": "1"}
    process = interruptible(
        [sys.executable, "-m", "geomtorsion", "lab", "--port", "0", *options],
        stdout=subprocess.PIPE,
        stderr=errors or subprocess.STDOUT,
        text=True,
        env=environment,
        cwd=ROOT,
    )
    try:
        assert process.stdout is not None
        line = process.stdout.readline()
        found = re.search(r"http://\S+", line)
        assert found, f"the server printed {line!r} instead of its address"
        yield found.group()
    finally:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(timeout=20)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        process.stdout.close()  # type: ignore[union-attr]
