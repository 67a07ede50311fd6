"""Other process: answers requests of one line each, and can be ended while it works."""

from __future__ import annotations

import atexit
import contextlib
import os
import queue
import subprocess
import sys
import threading
from pathlib import Path

from geomtorsion.allowance import check_limits


class OtherProcess:
    """A script that answers lines; it is started when it is first needed, and again when it ended.

    script: reads requests from standard input until they end, and writes an answer to each.
    """

    def __init__(self, script: str) -> None:
        self._script = script
        self._lock = threading.Lock()
        self._process: subprocess.Popen[str] | None = None
        self._replies: queue.Queue[str] = queue.Queue()
        self._owner = 0
        atexit.register(self.end)

    def ask(self, request: str) -> str:
        """The answer to a line; nothing where the process gives none.

        A limit that is met (see `geomtorsion.allowance`), and Ctrl-C, end the process.
        """
        # One request at a time; whoever interrupts ends the process.
        with self._lock:
            try:
                line = self._answer(request)
            except (OSError, ValueError):
                line = ""
            except BaseException:
                self.end()
                raise
            if not line:
                self.end()
            return line

    def _answer(self, request: str) -> str:
        process = self._process
        # A fork of this process has the pipes of its parent.
        if process is None or process.poll() is not None or self._owner != os.getpid():
            process = self._start()
        assert process.stdin is not None
        process.stdin.write(request + "\n")
        process.stdin.flush()
        while True:
            check_limits()
            with contextlib.suppress(queue.Empty):
                return self._replies.get(timeout=0.05)

    def _start(self) -> subprocess.Popen[str]:
        paths = [str(Path(__file__).parents[2]), os.environ.get("PYTHONPATH", "")]
        self._process = process = subprocess.Popen(
            [sys.executable, "-P", self._script],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            # Ctrl-C is for the one who asked.
            start_new_session=True,
            env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, paths))},
        )
        self._owner, self._replies = os.getpid(), queue.Queue()
        threading.Thread(target=_listen, args=(process, self._replies), daemon=True).start()
        return process

    def end(self) -> None:
        """End the process, at once; the next one who asks starts another."""
        process, self._process = self._process, None
        if process is None or self._owner != os.getpid():
            return
        process.kill()
        process.wait()
        for stream in (process.stdin, process.stdout):
            if stream is not None:
                # Pending output has no reader any more.
                with contextlib.suppress(OSError, ValueError):
                    stream.close()


def _listen(process: subprocess.Popen[str], replies: queue.Queue[str]) -> None:
    """Pass on the lines of a process, and one that is empty at its end."""
    assert process.stdout is not None
    with contextlib.suppress(ValueError, OSError):
        for line in process.stdout:
            replies.put(line)
    replies.put("")
