"""desk: takes requests of many sessions, hands them to workers, and keeps what was answered."""

from __future__ import annotations

import atexit
import json
import os
import queue
import subprocess
import sys
import threading
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import IO, Any

from geomtorsion.errors import LimitError
from geomtorsion.lab.tasks import checked_length, task

# Seconds that a request waits for a free worker before it is told to come back.
PATIENCE = 60.0
# Seconds that a worker may take to start, however busy the machine is.
STARTING = 60.0
# Answers that are kept, by number and by characters in all.
MOST_KEPT, MOST_CHARACTERS = 512, 64_000_000
_BROKEN = (
    "this request could not be carried out: the worker ended. Nothing else is lost; "
    "change the input and go on."
)


class Worker:
    """One worker process: `ask` sends a request and waits for the reply, or ends the process."""

    def __init__(self) -> None:
        # -P: nothing that lies about in the folder of a server is imported; but this very package
        # is, wherever it was imported from here.
        found = [str(Path(__file__).parents[2]), os.environ.get("PYTHONPATH", "")]
        self.process = subprocess.Popen(
            [sys.executable, "-P", "-m", "geomtorsion.lab.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            encoding="utf-8",
            env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, found))},
        )
        self._replies: queue.Queue[str] = queue.Queue()
        self._ready = False
        threading.Thread(target=self._listen, args=(self.process.stdout,), daemon=True).start()

    def _listen(self, stream: IO[str]) -> None:
        # The lines come in here and not in `ask`, since pipes have no time-out everywhere.
        for line in stream:
            self._replies.put(line)
        self._replies.put("")

    def ask(self, text: str, seconds: float) -> dict[str, Any] | None:
        """The reply, or None if the process ended; the time counts from when it is ready.

        Raises
        ------
        TimeoutError
            There is no reply in time; the process has been ended.
        """
        assert self.process.stdin is not None
        try:
            self.process.stdin.write(text + "\n")
            self.process.stdin.flush()
            if not self._ready:
                self._ready = bool(self._replies.get(timeout=STARTING))
            line = self._replies.get(timeout=seconds) if self._ready else ""
        except (OSError, ValueError):
            # The pipe is broken, or was closed while it was written to.
            line = ""
        except queue.Empty:
            self.end()
            raise TimeoutError from None
        if not line:
            self.end()
            return None
        return json.loads(line)

    @property
    def lives(self) -> bool:
        """Whether it can still be asked."""
        return self.process.poll() is None

    def end(self) -> None:
        """End the process, at once."""
        self.process.kill()
        self.process.wait()
        for stream in (self.process.stdin, self.process.stdout):
            if stream is not None:
                try:
                    stream.close()
                except OSError:
                    # What was still to be written has no reader any more.
                    continue


class Desk:
    """Workers behind one counter: any number of threads may ask, each waits its turn.

    Equal requests are carried out once: whoever asks second gets what is kept.
    """

    def __init__(
        self,
        workers: int = 2,
        patience: float = PATIENCE,
        limits: Mapping[str, float] | None = None,
    ) -> None:
        self.patience = patience
        # Seconds by task, where they shall differ from those of the list of tasks.
        self.limits = dict(limits or {})
        self._free: queue.Queue[Worker | None] = queue.Queue()
        for _ in range(workers):
            # Workers start when they are first needed.
            self._free.put(None)
        self._kept: OrderedDict[str, dict[str, Any]] = OrderedDict()
        self._sizes: dict[str, int] = {}
        self._lock = threading.Lock()
        self._all: set[Worker] = set()

    def ask(self, name: str, /, **arguments: Any) -> dict[str, Any]:
        """What a task gives, or ``{"problem": message}``; never an error of this package.

        A task that takes longer than it may is ended, with its process.
        """
        try:
            text = checked_length(_text(name, arguments))
            seconds = self.limits.get(name, task(name).seconds)
        except (LimitError, LookupError) as error:
            return {"problem": str(error)}
        with self._lock:
            if text in self._kept:
                self._kept.move_to_end(text)
                return self._kept[text]
        reply = self._carried_out(text, seconds)
        if "problem" not in reply:
            self._keep(text, reply)
        return reply

    def _carried_out(self, text: str, seconds: float) -> dict[str, Any]:
        """Hand a request to the next free worker."""
        try:
            worker = self._free.get(timeout=self.patience)
        except queue.Empty:
            return {
                "problem": f"everybody asks at once, and after {self.patience:g} s it was still "
                "not your turn. Wait a moment, then change something."
            }
        try:
            if worker is None or not worker.lives:
                worker = self._new(worker)
            reply = worker.ask(text, seconds)
        except TimeoutError:
            return {
                "problem": f"this takes longer than the {seconds:g} s that a request on this page "
                "may take, so it was stopped. Ask for something smaller, or use the command line, "
                "which waits as long as you do."
            }
        finally:
            self._free.put(worker)
        return {"problem": _BROKEN} if reply is None else reply

    def _new(self, old: Worker | None) -> Worker:
        worker = Worker()
        with self._lock:
            if old is not None:
                old.end()
                self._all.discard(old)
            self._all.add(worker)
        return worker

    def _keep(self, text: str, reply: dict[str, Any]) -> None:
        with self._lock:
            self._kept[text] = reply
            self._sizes[text] = len(text) + sum(len(str(value)) for value in reply.values())
            while len(self._kept) > MOST_KEPT or sum(self._sizes.values()) > MOST_CHARACTERS:
                oldest, _ = self._kept.popitem(last=False)
                del self._sizes[oldest]

    def warm(self, requests: Sequence[tuple[str, Mapping[str, Any]]] = ()) -> None:
        """Start all workers; then, in the background, let each do these tasks, one after the other.

        What is compiled for the first request of a kind serves all that follow. All workers but
        the one that warms up stay free for whoever asks.
        """
        count = self._free.qsize()
        for _ in range(count):
            worker = self._free.get()
            self._free.put(worker or self._new(None))
        threading.Thread(target=self._warmed, args=(requests, count), daemon=True).start()

    def _warmed(self, requests: Sequence[tuple[str, Mapping[str, Any]]], count: int) -> None:
        done: set[Worker | None] = set()
        # Workers come round in turn; whoever is busy all the time is warm without this.
        for _ in range(2 * count):
            worker = self._free.get()
            if worker not in done:
                done.add(worker)
                self._practise(worker, requests)
            self._free.put(worker)

    def _practise(
        self, worker: Worker | None, requests: Sequence[tuple[str, Mapping[str, Any]]]
    ) -> None:
        """Let a worker do some tasks, as long as it lives."""
        for name, arguments in requests:
            if worker is None or not worker.lives:
                return
            text = _text(name, arguments)
            try:
                reply = worker.ask(text, STARTING)
            except TimeoutError:
                return
            if reply is not None and "problem" not in reply:
                self._keep(text, reply)

    def close(self) -> None:
        """End all workers."""
        with self._lock:
            for worker in self._all:
                worker.end()
            self._all.clear()


def _text(name: str, arguments: Mapping[str, Any]) -> str:
    """A request as one line."""
    return json.dumps({"task": name, "arguments": arguments})


@cache
def common_desk() -> Desk:
    """The desk that all sessions of this process share; it ends with the process."""
    desk = Desk(max(2, min(4, os.cpu_count() or 2)))
    atexit.register(desk.close)
    return desk
