"""Contestants: the packages that take part, their requirements, and how each is timed."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec

from tests.benchmarks import baseline, maxima, rivals
from tests.benchmarks.cases import Case, sphere
from tests.benchmarks.outcome import Outcome, Reached

# A measurement ends after ROUNDS runs, or after the run that ends past ENOUGH seconds.
ROUNDS, ENOUGH = 20, 3.0

# Reports of a measurement: "stage", its name, seconds; or "run", CPU seconds, seconds.
Report = Callable[[str, str | float, float], None]
Work = Callable[[Case, Reached], Outcome]


@dataclass(frozen=True)
class Contestant:
    """name: on the command line; title: in tables; module: the package that it requires.

    measure       runs the rounds, reports its progress and returns the last outcome
    takes_coframe False for contestants that receive only the metric
    """

    name: str
    title: str
    module: str
    measure: Callable[[Case, Report], Outcome]
    takes_coframe: bool = False

    @property
    def is_installed(self) -> bool:
        if self.module == "maxima":
            return maxima.environment() is not None
        return find_spec(self.module) is not None


def _in_python(work: Work, case: Case, report: Report) -> Outcome:
    """Time rounds with fresh objects in a process that has first computed a 2-sphere."""
    work(sphere(), lambda _: None)
    spent, turn = 0.0, 0
    while True:
        # With a CPU limit the clock of the process advances in steps, unlike the thread's.
        start, cpu = time.perf_counter(), time.thread_time()

        def reached(stage: str, start: float = start, loud: bool = turn == 0) -> None:
            if loud:
                report("stage", stage, time.perf_counter() - start)

        outcome = work(case, reached)
        seconds = time.perf_counter() - start
        report("run", time.thread_time() - cpu, seconds)
        spent, turn = spent + seconds, turn + 1
        if turn == ROUNDS or spent > ENOUGH:
            return outcome


def _in_maxima(frame: bool, case: Case, report: Report) -> Outcome:
    """Run one session, and a second one with more rounds if the first shows that they are short."""
    outcome, total = _maxima_session(frame, case, report, rounds=1)
    if total * ROUNDS < 2 * ENOUGH:
        outcome, _ = _maxima_session(frame, case, report, rounds=ROUNDS)
    return outcome


def _maxima_session(frame: bool, case: Case, report: Report, rounds: int) -> tuple[Outcome, float]:
    empty, scalar, total, warm = False, "", 0.0, False
    for stage, rest in maxima.run(case, frame, rounds):
        if stage == "warm":
            warm = True
        elif stage == "empty":
            empty = rest == "true"
        elif stage == "scalar":
            scalar = rest
        elif warm:
            cpu, total = map(float, rest.split())
            report("stage", stage, total)
            if stage == "kretschmann":
                report("run", cpu, total)
    if not scalar:
        raise TimeoutError("Maxima ended without an answer")
    return Outcome(maxima.to_sympy(scalar, case), () if empty else (1,)), total


def _geomtorsion(case: Case, reached: Reached) -> Outcome:
    """All tensors by geomtorsion, imported here because no rival's process should load it."""
    from tests.benchmarks.geometry import whole_geometry

    return whole_geometry(case, reached)


def _of_metric(case: Case, reached: Reached) -> Outcome:
    """The same tensors as the rivals: no Cartan connection, no torsion."""
    from tests.benchmarks.geometry import OF_METRIC, whole_geometry

    return whole_geometry(case, reached, OF_METRIC)


def _python(name: str, title: str, module: str, work: Work, coframe: bool = False) -> Contestant:
    return Contestant(name, title, module, partial(_in_python, work), coframe)


ALL: tuple[Contestant, ...] = (
    _python("geomtorsion", "geomtorsion", "geomtorsion", _geomtorsion, coframe=True),
    _python("of_metric", "metric only", "geomtorsion", _of_metric, coframe=True),
    Contestant("maxima_frame", "Maxima, frame", "maxima", partial(_in_maxima, True), True),
    Contestant("maxima", "Maxima, metric", "maxima", partial(_in_maxima, False)),
    _python("sympy", "sympy, simplify", "sympy", baseline.sympy_with_simplify, coframe=True),
    _python("einsteinpy", "EinsteinPy", "einsteinpy", rivals.einsteinpy),
    _python("gravipy", "GraviPy", "gravipy", rivals.gravipy),
    _python("pytearcat", "Pytearcat", "pytearcat", rivals.pytearcat),
    _python("ogrepy", "OGRePy", "OGRePy", rivals.ogrepy),
    _python("lyra_geometry", "lyra-geometry", "lyra_geometry", rivals.lyra_geometry),
)


def find(name: str) -> Contestant:
    """The contestant with the given name."""
    for contestant in ALL:
        if contestant.name == name:
            return contestant
    raise LookupError(f"no contestant {name!r}; there are {', '.join(c.name for c in ALL)}")
