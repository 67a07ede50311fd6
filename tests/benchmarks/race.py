"""Race: one contestant on one case in a process of its own, ended at a time limit.

As a module (`python -m tests.benchmarks.race CONTESTANT CASE`) it is that process, and prints
one JSON list a line: ["stage", name, seconds], ["round", "", seconds], ["checked", ...].
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
from dataclasses import asdict, dataclass, field
from pathlib import Path

from tests.benchmarks.cases import load
from tests.benchmarks.contestants import find

ROOT = Path(__file__).resolve().parents[2]
# Imports and the warm-up before the clock, and the check of the answer after it.
GRACE = 30.0


@dataclass
class Result:
    """What one race showed; seconds are of the whole work, best and first round.

    reached         stage that was done last, with the seconds it took to get there
    ricci_is_zero   Ricci came out as 0 without further simplification by a reader
    agrees          the Kretschmann scalar has the right value at a point; None: not checked
    failure         last line of an error, where there was one
    """

    contestant: str
    case: str
    rounds: list[float] = field(default_factory=list)
    reached: tuple[str, float] | None = None
    ricci_is_zero: bool | None = None
    agrees: bool | None = None
    memory_mb: float | None = None
    failure: str = ""

    @property
    def best(self) -> float | None:
        return min(self.rounds, default=None)

    @property
    def first(self) -> float | None:
        return self.rounds[0] if self.rounds else None


def race(contestant: str, case: str, limit: float = 60.0) -> Result:
    """Run the race in a process of its own; end it `limit` seconds after the warm-up began."""
    result = Result(contestant, case)
    errors: list[str] = []
    with subprocess.Popen(
        [sys.executable, "-m", "tests.benchmarks.race", contestant, case],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        reader = threading.Thread(target=lambda: errors.extend(process.stderr or ()), daemon=True)
        reader.start()
        _follow(process, result, limit)
        process.wait()
        reader.join()
    if process.returncode > 0 and errors:
        result.failure = errors[-1].strip()
    return result


def _follow(process: subprocess.Popen[str], result: Result, limit: float) -> None:
    """Write down what the process says until it ends or is ended."""
    stopper = threading.Timer(limit, _end, (process,))
    stopper.start()
    for line in process.stdout or ():
        kind, name, value = json.loads(line)
        if kind == "stage":
            result.reached = (name, value)
        elif kind == "round":
            result.rounds.append(value)
        elif kind == "done":
            # The work is over: what is left is the check, which has a limit of its own.
            result.ricci_is_zero, result.memory_mb = bool(name), value
            stopper.cancel()
            stopper = threading.Timer(GRACE, _end, (process,))
            stopper.start()
        elif kind == "checked":
            result.agrees = bool(value)
    stopper.cancel()


def _end(process: subprocess.Popen[str]) -> None:
    """End the process and what it started."""
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGKILL)


def _say(kind: str, name: str | bool, value: float) -> None:
    # The real one: some packages print, and their printing is caught.
    print(json.dumps([kind, name, value]), file=sys.__stdout__, flush=True)


def main(name: str, case_name: str) -> None:
    """The process of one race."""
    import resource

    from tests.benchmarks.point import at_point, kretschmann_at_point

    case = load(case_name)
    assert case.metric is not None
    outcome = find(name).measure(case, _say)
    who = resource.RUSAGE_CHILDREN if name.startswith("maxima") else resource.RUSAGE_SELF
    _say("done", outcome.ricci_is_zero, resource.getrusage(who).ru_maxrss / 1024)
    expected = kretschmann_at_point(case)
    difference = abs(at_point(outcome.kretschmann) - expected)
    _say("checked", "", float(bool(difference < 1e-18 * abs(expected))))


def to_json(result: Result) -> str:
    """One line for a file of results."""
    return json.dumps(asdict(result))


if __name__ == "__main__":
    main(*sys.argv[1:])
