"""Graders: the real commands of nbgrader."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import geomtorsion

# Loads a program once, because loading takes longer than most commands, and forks per command.
SERVES = """
import json, os, signal, sys, tempfile
from importlib import import_module
module, name = sys.argv[1:]
main = getattr(import_module(module), name)
for line in sys.stdin:
    with tempfile.TemporaryFile("w+") as output:
        child = os.fork()
        if not child:
            signal.alarm(300)
            os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
            os.dup2(output.fileno(), 1)
            os.dup2(output.fileno(), 2)
            sys.argv = [module, *json.loads(line)]
            sys.exit(main())
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        output.seek(0)
        print(json.dumps([code, output.read()]), flush=True)
"""


@contextmanager
def command(module: str, name: str, folder: Path) -> Iterator[Callable[..., None]]:
    """Yield a function that runs commands of a program in a folder; each must end with code 0.

    module, name: the module and the name of the program's main function.
    """
    # The commands start the kernel and alembic by name; both are beside the interpreter.
    settings = os.environ | {
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": str(Path(geomtorsion.__file__).parents[1]),
        "JUPYTER_PREFER_ENV_PATH": "1",
    }
    with subprocess.Popen(
        [sys.executable, "-c", SERVES, module, name],
        cwd=folder, env=settings, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    ) as process:  # fmt: skip
        assert process.stdin is not None
        assert process.stdout is not None
        asked, replies = process.stdin, process.stdout

        def run(*words: str) -> None:
            print(json.dumps(words), file=asked, flush=True)
            code, output = json.loads(replies.readline())
            assert code == 0, output[-3000:]

        yield run
