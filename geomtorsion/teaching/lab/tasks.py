"""tasks: the requests that the page may send, each with its time limit; no other code is run."""

from __future__ import annotations

import atexit
import base64
import hashlib
import json
import os
import threading
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import Any, Protocol

from geomtorsion.errors import GeomtorsionError, LimitError, UnknownNameError
from geomtorsion.support.exclusive import exclusive
from geomtorsion.teaching.exercises.worker_pool import EXCEEDED, Json, WorkerPool
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.messages import in_language
from geomtorsion.teaching.texts import ENGLISH, languages

# The messages of a reply.
_MESSAGES = ("problem", "refused")
BROKEN = (
    "the process that computed this request ended unexpectedly. Your other input is not lost. "
    "Change this input and try again."
)


def too_long(seconds: str) -> str:
    """Message about a request that was stopped."""
    return (
        f"expected a result within {seconds} s, got none, so the page stopped the computation. "
        "Choose a smaller case, or use the command line, which has no time limit."
    )


def too_much(reply: Json) -> str:
    """Message about a request that needed more memory or depth than is available.

    Examples
    --------
    >>> too_much({"exceeded": "memory"})
    'this case needs more memory than the page may use. Choose a smaller case.'
    """
    return f"this case needs more {reply[EXCEEDED]} than the page may use. Choose a smaller case."


@dataclass(frozen=True)
class Task:
    """A task of a worker: module and function, and its time limit in seconds."""

    module: str
    function: str
    seconds: float

    def __call__(self, **arguments: Any) -> Json:
        """Run the task in this process, without a time limit."""
        done: Callable[..., Json] = getattr(import_module(self.module), self.function)
        return done(**arguments)


def _task(module: str, function: str, seconds: float) -> Task:
    return Task(f"geomtorsion.teaching.lab.{module}", function, seconds)


TASKS: Mapping[str, Task] = {
    "space_info": _task("space_info", "space_info", 10),
    "space_form": _task("space_info", "space_form", 10),
    "tetrad": _task("tetrad", "tetrad", 10),
    "loop": _task("closure_failure", "closure_failure", 8),
    "atoms": _task("atoms", "atoms", 10),
    "map_facts": _task("map_circuits", "map_facts", 20),
    "map_circuit": _task("map_circuits", "map_circuit", 20),
    "compass": _task("compass", "compass", 10),
    "paths": _task("paths", "paths", 12),
    "top": _task("top", "top", 15),
    "costs": _task("costs", "costs", 40),
    "exercise": _task("problems", "statement", 15),
    "hints": _task("problems", "hints", 15),
    "answer": _task("problems", "answer", 15),
    "listing": _task("problems", "listing", 15),
}


def task(name: str) -> Task:
    """The task of this name.

    Raises
    ------
    UnknownNameError
        There is no such task.

    Examples
    --------
    >>> task("tetrad").seconds
    10
    """
    if name not in TASKS:
        raise UnknownNameError(
            f"expected the name of a task, got {name!r}. Choose one of: {', '.join(TASKS)}."
        )
    return TASKS[name]


def checked_length(text: str) -> str:
    """A request as text, if its length is within the limit.

    Raises
    ------
    LimitError
        It is longer than any request of the page.
    """
    if len(text) > PAGE.request:
        raise LimitError(
            f"expected at most {PAGE.request:,} characters of input, got {len(text):,}. Write "
            "shorter expressions, or use a tetrad file: `geomtorsion report FILE.toml`."
        )
    return text


def checked_file(content: bytes) -> bytes:
    """The bytes of a file, if their number is within the limit.

    Raises
    ------
    LimitError
        There are more bytes than the page accepts.
    """
    if len(content) > PAGE.upload:
        raise LimitError(
            f"expected a file of at most {PAGE.upload:,} bytes, got {len(content):,}. Cut out a "
            "smaller map, or read the file in Python, where only the memory limits its size."
        )
    return content


def answer(request: Json) -> Json:
    """The result of a task, or ``{"problem": message}``: the function that a worker calls.

    Examples
    --------
    >>> answer({"task": "space_info", "arguments": {"space": "s2"}})["coordinates"]
    ['theta', 'phi']
    >>> answer({"task": "dance", "arguments": {}})["problem"].split(".")[0]
    "expected the name of a task, got 'dance'"
    """
    arguments = dict(request["arguments"])
    if "attached" in request:
        arguments["content"] = base64.b64decode(request["attached"])
    try:
        reply = task(request["task"])(**arguments)
    except GeomtorsionError as error:
        reply = {"problem": str(error)}
    return _in_language(reply, arguments)


def _in_language(reply: Json, arguments: Mapping[str, Any]) -> Json:
    """A reply whose messages are in the language of the request."""
    language = arguments.get("language", ENGLISH)
    if language not in languages():
        return reply
    own: dict[str, Any] = {
        key: in_language(reply[key], language) for key in _MESSAGES if key in reply
    }
    if errors := reply.get("errors"):
        own["errors"] = {place: in_language(text, language) for place, text in errors.items()}
    return {**reply, **own}


class Runner(Protocol):
    """Interface of an object that runs tasks."""

    def ask(self, name: str, attached: bytes | None = None, /, **arguments: Any) -> Json:
        """The result of a task, or ``{"problem": message}``."""
        ...


class TaskRunner:
    """Sends the requests of all sessions to a pool of workers, and caches the replies.

    limits: seconds by task, where they differ from the list of tasks.
    Equal requests are carried out once: the second gets the cached reply.
    """

    def __init__(
        self, workers: int = 2, patience: float = 60.0, limits: Mapping[str, float] | None = None
    ) -> None:
        self.limits = dict(limits or {})
        self.pool = WorkerPool(f"{__name__}:answer", workers, patience, errors_shown=True)
        self.replies: OrderedDict[str, Json] = OrderedDict()
        self._characters = 0
        self._lock = threading.Lock()

    def ask(self, name: str, attached: bytes | None = None, /, **arguments: Any) -> Json:
        """The result of a task, or ``{"problem": message}``; never an error of this package.

        A task that exceeds its time limit is ended, with its process. attached: the bytes of a
        file, which only the task reads; it gets them as `content`.
        """
        request: dict[str, Any] = {"task": name, "arguments": arguments}
        sent: Json = request
        seconds = 0.0
        try:
            if attached is not None:
                # The cached reply identifies the file by its digest only.
                request["digest"] = hashlib.sha256(checked_file(attached)).hexdigest()
                sent = request | {"attached": base64.b64encode(attached).decode()}
            # The text of a request is its key: equal sliders, equal reply.
            key = checked_length(json.dumps(request))
            seconds = self.limits.get(name, task(name).seconds)
            with self._lock:
                if key in self.replies:
                    self.replies.move_to_end(key)
                    return self.replies[key]
            reply = self.pool.ask(sent, seconds)
        except (LimitError, UnknownNameError) as error:
            return _in_language({"problem": str(error)}, arguments)
        except TimeoutError:
            return _in_language({"problem": too_long(f"{seconds:g}")}, arguments)
        except ChildProcessError:
            return _in_language({"problem": BROKEN}, arguments)
        if EXCEEDED in reply:
            reply = _in_language({"problem": too_much(reply)}, arguments)
        self._keep(request, reply)
        return reply

    def _keep(self, request: Json, reply: Json) -> None:
        """Cache a reply; the oldest replies are dropped when the cache is full."""
        if "problem" in reply or EXCEEDED in reply:
            return
        key = json.dumps(request)
        with self._lock:
            if key in self.replies:
                # A thread with an equal request was faster; its reply is counted once.
                return
            self.replies[key] = reply
            self._characters += _length(key, reply)
            while self._characters > PAGE.kept:
                self._characters -= _length(*self.replies.popitem(last=False))

    def warm(self, requests: Sequence[tuple[str, Json]] = ()) -> None:
        """Start all workers and let each run these tasks, in the background."""
        self.pool.warm(({"task": n, "arguments": a} for n, a in requests), self._keep)

    def close(self) -> None:
        """End all workers."""
        self.pool.close()


def _length(key: str, reply: Json) -> int:
    """Approximate number of characters of a cached reply."""
    return len(key) + sum(len(str(value)) for value in reply.values())


@exclusive
@cache
def common_runner() -> TaskRunner:
    """The runner that all sessions of this process share; it ends with the process."""
    runner = TaskRunner(max(2, min(4, os.cpu_count() or 2)))
    atexit.register(runner.close)
    return runner
