"""Race: one contestant on one case in a process of its own, ended at a limit of CPU seconds.

`python -m tests.benchmarks.race CONTESTANT CASE LIMIT` is that process. It prints one JSON list
per line: ["stage", name, seconds], ["run", cpu, seconds], ["checked", ...].
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
# CPU seconds for the check of the answer, which does not count as work.
CHECK = 30.0
# A race also ends when its wall time exceeds its CPU limit by this factor, on a busy machine.
BUSY = 6.0


@dataclass
class Result:
    """Result of one race.

    rounds, cpu     wall and CPU seconds of each run of the whole work
    reached         last finished stage, with the time at which it was reached
    ricci_is_zero   Ricci came out as 0 without further simplification by a reader
    agrees          the Kretschmann scalar has the right value at a point; None: not checked
    failure         last line of an error, if any
    """

    contestant: str
    case: str
    limit: float
    rounds: list[float] = field(default_factory=list)
    cpu: list[float] = field(default_factory=list)
    reached: tuple[str, float] | None = None
    ricci_is_zero: bool | None = None
    agrees: bool | None = None
    memory_mb: float | None = None
    failure: str = ""

    @property
    def best(self) -> float | None:
        """CPU seconds of the best run; wall time would depend on the load of the machine."""
        return min(self.cpu, default=None)


def race(contestant: str, case: str, limit: float = 60.0) -> Result:
    """Run the race in a process of its own, which ends after `limit` CPU seconds in total."""
    result = Result(contestant, case, limit)
    errors: list[str] = []
    with subprocess.Popen(
        [sys.executable, "-m", "tests.benchmarks.race", contestant, case, str(limit)],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        reader = threading.Thread(target=lambda: errors.extend(process.stderr or ()), daemon=True)
        reader.start()
        try:
            _follow(process, result)
            process.wait()
        finally:  # Ctrl-C does not reach a session of its own
            _end(process)
        reader.join()
    if process.returncode > 0 and errors:
        result.failure = errors[-1].strip()
    return result


def _follow(process: subprocess.Popen[str], result: Result) -> None:
    """Record the reports of the process until it ends or is stopped."""
    stopper = threading.Timer(BUSY * (result.limit + CHECK), _end, (process,))
    stopper.start()
    for line in process.stdout or ():
        kind, name, value = json.loads(line)
        if kind == "stage":
            result.reached = (name, value)
        elif kind == "run":
            result.cpu.append(name)
            result.rounds.append(value)
        elif kind == "done":
            result.ricci_is_zero, result.memory_mb = bool(name), value
        elif kind == "checked":
            result.agrees = bool(value)
    stopper.cancel()


def _end(process: subprocess.Popen[str]) -> None:
    """End the process and its children."""
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGKILL)


def _emit(kind: str, name: str | float, value: float) -> None:
    # The original standard output: the output of some packages is captured.
    print(json.dumps([kind, name, value]), file=sys.__stdout__, flush=True)


def main(name: str, case_name: str, limit: str) -> None:
    """The process of one race; its children have the same limit."""
    import resource

    from tests.benchmarks.point import at_point, kretschmann_at_point

    case = load(case_name)
    assert case.metric is not None
    soft = int(float(limit)) + 1
    resource.setrlimit(resource.RLIMIT_CPU, (soft, resource.RLIM_INFINITY))
    try:
        outcome = find(name).measure(case, _emit)
    except TimeoutError:
        return
    resource.setrlimit(resource.RLIMIT_CPU, (int(soft + CHECK), resource.RLIM_INFINITY))
    who = resource.RUSAGE_CHILDREN if name.startswith("maxima") else resource.RUSAGE_SELF
    _emit("done", outcome.ricci_is_zero, resource.getrusage(who).ru_maxrss / 1024)
    expected = kretschmann_at_point(case)
    difference = abs(at_point(outcome.kretschmann) - expected)
    _emit("checked", "", float(bool(difference < 1e-18 * abs(expected))))


def to_json(result: Result) -> str:
    """One line for a file of results."""
    return json.dumps(asdict(result))


if __name__ == "__main__":
    main(*sys.argv[1:])
