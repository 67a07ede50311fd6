"""workers: who carries requests out: processes where a machine has them, this process where not.

One interface, two implementations: `worker_pool` keeps processes with limits of time and memory; in
a browser Python itself runs in a worker which the page ends when its time is over, and there is
nothing to start.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterable
from importlib import import_module
from typing import Protocol

from geomtorsion.exercises.worker_pool import Json, WorkerPool, answered


class Workers(Protocol):
    """Those who carry requests out."""

    def ask(self, request: Json, seconds: float) -> Json:
        """The reply; TimeoutError, ChildProcessError or a `PoolBusyError` where there is none."""
        ...

    def warm(self, requests: Iterable[Json], done: Callable[[Json, Json], object]) -> None:
        """Let these requests be answered before anybody asks."""
        ...

    def close(self) -> None:
        """End all workers."""
        ...


class InPlace:
    """Carries requests out here and now; whoever runs this process bounds its time and memory.

    Examples
    --------
    >>> InPlace("geomtorsion.exercises.examiner:reply").ask({"number": "1.1", "seed": 0}, 60)
    {'prepared': True}
    """

    def __init__(self, function: str) -> None:
        module, _, name = function.partition(":")
        self.function: Callable[[Json], Json] = getattr(import_module(module), name)

    def ask(self, request: Json, seconds: float) -> Json:
        """The reply, however long it takes; as JSON has it, like that of a process."""
        return json.loads(json.dumps(answered(self.function, request)))

    def warm(self, requests: Iterable[Json], done: Callable[[Json, Json], object]) -> None:
        """Answer these requests now."""
        for request in requests:
            done(request, self.ask(request, 0.0))

    def close(self) -> None:
        """There is nothing to end."""


def has_processes(platform: str = sys.platform) -> bool:
    """Whether a process can start another one.

    Examples
    --------
    >>> has_processes("linux"), has_processes("emscripten")
    (True, False)
    """
    return platform not in ("emscripten", "wasi")


def workers(
    function: str,
    size: int = 1,
    patience: float = 60.0,
    *,
    errors_shown: bool = False,
    platform: str = sys.platform,
) -> Workers:
    """Workers for a function, given as "package.module:name", as this platform has them."""
    if not has_processes(platform):
        return InPlace(function)
    return WorkerPool(function, size, patience, errors_shown=errors_shown)
