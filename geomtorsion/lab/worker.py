"""worker: a process that does one task after the other, and can be ended at any moment."""

from __future__ import annotations

import json
import os
import sys
import threading
import time
from typing import Any, TextIO

from geomtorsion.errors import GeomtorsionError
from geomtorsion.lab.tasks import task

# Address space of one worker, in bytes; compiled integrators reserve far more than they use.
MOST_MEMORY = 6 * 2**30
READY = '"ready"'


def answer(request: dict[str, Any]) -> dict[str, Any]:
    """What a task gives, or ``{"problem": message}``.

    Examples
    --------
    >>> answer({"task": "facts", "arguments": {"space": "s2"}})["coordinates"]
    ['theta', 'phi']
    >>> answer({"task": "dance", "arguments": {}})["problem"].split(".")[0]
    "no task is called 'dance'"
    """
    try:
        return task(request["task"])(**request["arguments"])
    except GeomtorsionError as error:
        return {"problem": str(error)}
    except (MemoryError, RecursionError) as error:
        limit = "memory" if isinstance(error, MemoryError) else "depth"
        return {"problem": f"this needs more {limit} than the page may use. Ask for less."}


def serve(requests: TextIO, replies: TextIO) -> None:
    """Say that it is ready, then answer requests, one JSON document a line, until they end."""
    replies.write(READY + "\n")
    replies.flush()
    for line in requests:
        replies.write(json.dumps(answer(json.loads(line))) + "\n")
        replies.flush()


def limit_memory() -> None:
    """Bound the memory of this process, where the system can do that."""
    try:
        import resource
    except ImportError:
        return
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    most = MOST_MEMORY if hard == resource.RLIM_INFINITY else min(MOST_MEMORY, hard)
    resource.setrlimit(resource.RLIMIT_AS, (most, hard))


def watch_parent() -> None:
    """End this process, in the midst of whatever it does, when its parent is gone."""
    parent = os.getppid()
    while os.getppid() == parent:
        time.sleep(1.0)
    os._exit(1)


def main() -> None:
    """Serve standard input and output; whatever else prints goes to standard error."""
    limit_memory()
    threading.Thread(target=watch_parent, daemon=True).start()
    replies = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    # Typed as any text stream; here it is the real standard input, which can.
    sys.stdin.reconfigure(encoding="utf-8")  # type: ignore[union-attr]
    serve(sys.stdin, replies)


if __name__ == "__main__":
    main()
