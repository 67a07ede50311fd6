"""tasks: what the page may ask for, each with its limit of time; nothing else is ever run."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from geomtorsion.errors import LimitError, UnknownNameError

# Longest request, in characters of JSON: the largest tetrad of the page has 36 entries.
LONGEST_REQUEST = 24_000


@dataclass(frozen=True)
class Task:
    """Something a worker can do: module and function, and the seconds it may take."""

    module: str
    function: str
    seconds: float

    def __call__(self, **arguments: Any) -> dict[str, Any]:
        """Do it here and now, without a limit of time."""
        done: Callable[..., dict[str, Any]] = getattr(import_module(self.module), self.function)
        return done(**arguments)


def _task(module: str, function: str, seconds: float) -> Task:
    return Task(f"geomtorsion.lab.{module}", function, seconds)


TASKS: Mapping[str, Task] = {
    "facts": _task("facts", "facts", 10),
    "tetrad": _task("tetrad", "tetrad", 10),
    "loop": _task("closing", "closing", 8),
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
        There is none.

    Examples
    --------
    >>> task("tetrad").seconds
    10
    """
    if name not in TASKS:
        raise UnknownNameError(f"no task is called {name!r}. There are: {', '.join(TASKS)}.")
    return TASKS[name]


def checked_length(text: str) -> str:
    """A request as text, unless it is too long.

    Raises
    ------
    LimitError
        It is longer than any request of the page.
    """
    if len(text) > LONGEST_REQUEST:
        raise LimitError(
            f"what was typed has {len(text):,} characters in all; the page reads up to "
            f"{LONGEST_REQUEST:,}. Write shorter expressions, or use a tetrad file."
        )
    return text
