"""worker pool: processes with limits of time and memory; one that exceeds them is replaced.

Such a process runs `main("MODULE:FUNCTION")`: it calls the function with one JSON request per line
of standard input and writes one JSON reply per line.
"""

from __future__ import annotations

import contextlib
import json
import os
import queue
import threading
from collections.abc import Callable, Iterable, Mapping
from importlib import import_module
from types import TracebackType
from typing import IO, Any

from geomtorsion.errors import LimitError
from geomtorsion.support.workers import LineProcess, end_with_parent, limit_data

# Content of the pipe: a dictionary of JSON types.
Json = Mapping[str, Any]
# Seconds that a process may take to start, however busy the machine is.
STARTING = 120.0
# Bytes of data of one process.
MEMORY = 6 * 2**30
READY = "ready"
# Not by -m: the package imports this module, and runpy would warn that it comes a second time.
_BEGIN = f"import sys; from {__name__} import main; main(sys.argv[1])"
EXCEEDED = "exceeded"


class PoolBusyError(LimitError):
    """No worker became free in time."""


class Worker:
    """One process: `ask` sends a request and waits for the reply, or ends the process."""

    def __init__(self, function: str, *, errors_shown: bool = False) -> None:
        self.process = LineProcess(["-c", _BEGIN, function], errors_shown=errors_shown)
        self._ready = False

    def ask(self, request: Json, seconds: float) -> Json:
        """The reply; the time limit starts when the process is ready.

        Raises
        ------
        TimeoutError
            There is no reply in time; the process has been ended.
        ChildProcessError
            The process has ended.
        """
        line = ""
        try:
            self.process.send(json.dumps(request, default=str))
            if not self._ready:
                self._ready = bool(self.process.receive(STARTING))
            if self._ready:
                line = self.process.receive(seconds)
        except TimeoutError:
            self.end()
            raise
        except (OSError, ValueError):
            # The pipe is broken, or was closed while it was written to: no line came.
            pass
        if not line:
            self.end()
            raise ChildProcessError("the process ran out of memory or was ended")
        return json.loads(line)

    @property
    def lives(self) -> bool:
        """Whether it still accepts requests."""
        return self.process.lives

    def end(self) -> None:
        """End the process, at once."""
        self.process.end()


class WorkerPool:
    """Processes that call one function; any number of threads may send requests.

    Each request waits for a free worker.

    Parameters
    ----------
    function
        The function that a worker calls with each request, as "package.module:name".
    size
        Number of processes; each starts when it is first needed.
    patience
        Seconds that a request waits for a free worker.
    errors_shown
        Whether standard error of the workers is shown.

    Examples
    --------
    >>> with WorkerPool("geomtorsion.teaching.exercises.examiner:reply") as pool:
    ...     pool.ask({"number": "1.1", "seed": 0}, seconds=60)
    {'prepared': True}
    """

    def __init__(
        self, function: str, size: int = 1, patience: float = 60.0, *, errors_shown: bool = False
    ) -> None:
        self.function = function
        self.size = size
        self.patience = patience
        self.errors_shown = errors_shown
        self.workers: set[Worker] = set()
        self._lock = threading.Lock()
        self._free: queue.Queue[Worker | None] = queue.Queue()
        for _ in range(size):
            self._free.put(None)

    def __enter__(self) -> WorkerPool:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def ask(self, request: Json, seconds: float) -> Json:
        """The result of the function; a worker that ends is replaced for the next request.

        Raises
        ------
        PoolBusyError
            No worker became free in time.
        TimeoutError
            The function took longer than `seconds`.
        ChildProcessError
            The worker ended.
        """
        try:
            worker = self._free.get(timeout=self.patience)
        except queue.Empty:
            raise PoolBusyError(
                f"the server was busy with other requests for {self.patience:g} s. Wait a moment, "
                "then try again."
            ) from None
        try:
            worker = self._living(worker)
            return worker.ask(request, seconds)
        finally:
            self._free.put(worker)

    def _living(self, worker: Worker | None) -> Worker:
        """The worker, or a new one if it has ended."""
        if worker is not None and worker.lives:
            return worker
        new = Worker(self.function, errors_shown=self.errors_shown)
        with self._lock:
            if worker is not None:
                worker.end()
                self.workers.discard(worker)
            self.workers.add(new)
        return new

    def warm(
        self,
        requests: Iterable[Json],
        done: Callable[[Json, Json], object],
    ) -> None:
        """Start all workers; then, in the background, let each answer these requests in turn.

        Code compiled for the first request of a kind serves all that follow. All workers but
        the one that warms up stay free. done: is called with each request and its reply.
        """
        for _ in range(self.size):
            self._free.put(self._living(self._free.get()))
        listed = list(requests)

        def rehearse() -> None:
            seen: set[Worker | None] = set()
            # Workers take turns; a worker that is busy all the time is warm without this.
            for _ in range(2 * self.size):
                worker = self._free.get()
                if worker not in seen:
                    seen.add(worker)
                    for request in listed:
                        if worker is None or not worker.lives:
                            break
                        with contextlib.suppress(TimeoutError, ChildProcessError):
                            done(request, worker.ask(request, STARTING))
                self._free.put(worker)

        threading.Thread(target=rehearse, daemon=True).start()

    def close(self) -> None:
        """End all workers; the next request starts new ones."""
        with self._lock:
            for worker in self.workers:
                worker.end()
            self.workers.clear()


def serve(function: Callable[[Json], Json], requests: IO[str], replies: IO[str]) -> None:
    """Report that this process is ready, then answer requests, one per line, until they end.

    A request that needs more memory or depth than is available gets `{"exceeded": which}`.
    """
    replies.write(READY + "\n")
    replies.flush()
    for line in requests:
        reply = answered(function, json.loads(line))
        replies.write(json.dumps(reply) + "\n")
        replies.flush()


def answered(function: Callable[[Json], Json], request: Json) -> Json:
    """The result of a function, or `{"exceeded": which}`."""
    try:
        return function(request)
    except MemoryError:
        return {EXCEEDED: "memory"}
    except RecursionError:
        return {EXCEEDED: "depth"}


def main(function: str) -> None:
    """Serve standard input and output; whatever else prints goes to standard error."""
    limit_data(MEMORY)
    end_with_parent()
    replies = os.fdopen(os.dup(1), "w", encoding="utf-8")
    # A library that prints would otherwise write into the middle of a reply.
    os.dup2(2, 1)
    requests = os.fdopen(os.dup(0), encoding="utf-8")
    module, _, name = function.partition(":")
    serve(getattr(import_module(module), name), requests, replies)
