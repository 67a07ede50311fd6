"""Examiner: checks answers in a process of its own, which is ended where an answer would not end.

`python -m geomtorsion.exercises.examiner` is that process: one JSON request per line of standard
input, one JSON reply per line of standard output.
"""

from __future__ import annotations

import contextlib
import json
import os
import queue
import subprocess
import sys
import threading
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import IO, Any

from geomtorsion.exercises.registry import load
from geomtorsion.exercises.verdict import QuestionVerdict, Verdict

SECONDS = 10.0
# For a process to start, and for the solution of an exercise: neither depends on an answer.
PATIENCE = 120.0
LARGEST_MEMORY = 4 * 2**30


class Examiner:
    """Checks answers within a time; a context manager.

    seconds: how long the answers to one exercise may take. Then the process is ended, the answers
    count as too large, and the next ones get a new process.

    Examples
    --------
    >>> with Examiner() as examiner:
    ...     examiner.check("3.2", {"christoffel": "1/tan(phi2)"}).right
    True
    """

    def __init__(self, seconds: float = SECONDS) -> None:
        self.seconds = seconds
        self._process: subprocess.Popen[str] | None = None
        self._replies: queue.Queue[str] = queue.Queue()
        self._prepared: set[tuple[str, int]] = set()

    def __enter__(self) -> Examiner:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def check(self, number: str, answers: Mapping[str, Any] | str, seed: int = 0) -> Verdict:
        """What is said about the answers to an exercise, within the time; see `Exercise.check`.

        Raises
        ------
        UnknownNameError
            There is no such exercise or seed.
        """
        exercise = load(number, seed)
        given = answers if isinstance(answers, Mapping) else {exercise.questions[0].name: answers}
        if (number, seed) not in self._prepared:
            # What the library needs for its own solution is not charged to the student.
            if self._asked({"number": number, "seed": seed}, PATIENCE) is None:
                return _ended(
                    number, seed, given, "the exercise itself could not be solved in time"
                )
            self._prepared.add((number, seed))
        request = {"number": number, "seed": seed, "answers": given}
        reply = self._asked(request, self.seconds)
        if reply is None:
            return _ended(number, seed, given, f"checking took longer than {self.seconds:g} s")
        if "verdict" not in reply:
            return _ended(number, seed, given, str(reply.get("error", "the process ended")))
        return Verdict.from_json(reply["verdict"])

    def close(self) -> None:
        """End the process."""
        process, self._process = self._process, None
        self._prepared.clear()
        if process is None:
            return
        process.kill()
        process.wait()
        for stream in (process.stdin, process.stdout):
            if stream is not None:
                with contextlib.suppress(OSError):
                    stream.close()

    def _asked(self, request: Mapping[str, Any], seconds: float) -> dict[str, Any] | None:
        """The reply to a request; None where it does not come in time."""
        process = self._running()
        try:
            assert process.stdin is not None
            process.stdin.write(json.dumps(request, default=str) + "\n")
            process.stdin.flush()
            line = self._replies.get(timeout=seconds)
        except (OSError, queue.Empty):
            self.close()
            return None
        if not line:
            self.close()
            return {"error": "the process ran out of memory or was ended"}
        return json.loads(line)

    def _running(self) -> subprocess.Popen[str]:
        """The process, started if there is none."""
        if self._process is not None and self._process.poll() is None:
            return self._process
        self.close()
        home = str(Path(__file__).parents[2])
        paths = [home, *filter(None, [os.environ.get("PYTHONPATH")])]
        self._process = subprocess.Popen(
            # -P: a file sympy.py among the answers that are graded is never imported.
            [sys.executable, "-P", "-m", "geomtorsion.exercises.examiner"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            encoding="utf-8",
            env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
            # Ctrl-C is for the one who asked; this process ends when its input does.
            start_new_session=True,
        )
        self._replies = queue.Queue()
        assert self._process.stdout is not None
        listener = threading.Thread(
            target=_listen, args=(self._process.stdout, self._replies), daemon=True
        )
        listener.start()
        with contextlib.suppress(queue.Empty):
            self._replies.get(timeout=PATIENCE)
        return self._process


def _listen(stream: IO[str], replies: queue.Queue[str]) -> None:
    """Put every line of a process into a queue; an empty text when it ends."""
    with contextlib.suppress(ValueError, OSError):
        for line in stream:
            replies.put(line)
    replies.put("")


def _ended(number: str, seed: int, answers: Mapping[str, Any], reason: str) -> Verdict:
    """The verdict on answers that could not be checked."""
    found = []
    for question in load(number, seed).questions:
        given = question.name in answers
        text = f"The answer could not be checked: {reason}. Write it shorter."
        code = "too large" if given else "empty"
        said = text if given else "No answer was given."
        found.append(QuestionVerdict(question.name, False, 0.0, said, code, (), question.points))
    return Verdict(number, seed, tuple(found))


def serve(requests: IO[str], replies: IO[str]) -> None:
    """Answer requests until they end."""
    replies.write("ready\n")
    replies.flush()
    for line in requests:
        try:
            reply = _reply(json.loads(line))
        except (MemoryError, RecursionError) as error:
            reply = {"error": f"it needs too much memory ({type(error).__name__})"}
        replies.write(json.dumps(reply) + "\n")
        replies.flush()


def _reply(request: Mapping[str, Any]) -> dict[str, Any]:
    """The reply to one request: a verdict, or that the solution is known now."""
    exercise = load(request["number"], request["seed"])
    if "answers" not in request:
        _ = exercise.solution()
        return {"prepared": True}
    return {"verdict": exercise.check(request["answers"]).to_json()}


def _limit_memory() -> None:
    """Keep a process from filling the machine, where the system can."""
    try:
        import resource
    except ImportError:
        return
    hard = resource.getrlimit(resource.RLIMIT_AS)[1]
    limit = LARGEST_MEMORY if hard == resource.RLIM_INFINITY else min(hard, LARGEST_MEMORY)
    with contextlib.suppress(ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_AS, (limit, hard))


if __name__ == "__main__":
    _limit_memory()
    serve(sys.stdin, sys.stdout)
