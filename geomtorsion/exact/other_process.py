"""Other process: answers requests of one line each, and can be ended while it works."""

from __future__ import annotations

import atexit
import contextlib
import threading

from geomtorsion.support.allowance import check_limits
from geomtorsion.support.workers import LineProcess


class OtherProcess:
    """A script that answers lines; it is started when it is first needed, and again when it ended.

    script: reads requests from standard input until they end, and writes an answer to each.
    """

    def __init__(self, script: str) -> None:
        self._script = script
        self._lock = threading.Lock()
        self._process: LineProcess | None = None
        atexit.register(self.end)

    def ask(self, request: str) -> str:
        """The answer to a line; nothing where the process gives none.

        A limit that is met (see `geomtorsion.support.allowance`), and Ctrl-C, end the process.
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
        if self._process is None or not self._process.lives:
            self._process = LineProcess([self._script])
        self._process.send(request)
        while True:
            check_limits()
            with contextlib.suppress(TimeoutError):
                return self._process.receive(0.05)

    def end(self) -> None:
        """End the process, at once; the next one who asks starts another."""
        process, self._process = self._process, None
        if process is not None:
            process.end()
