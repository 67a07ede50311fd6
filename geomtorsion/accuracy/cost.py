"""Cost: engines against accuracies, with the errors that were really made against the truth."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from geomtorsion.curves import CurveProblem, closed_form
from geomtorsion.errors import AccuracyError, GeomtorsionError, ProofError
from geomtorsion.ode import (
    ODE,
    Engine,
    Run,
    RungeKutta,
    Segment,
    Solution,
    Stage,
    Taylor,
    Trajectory,
    WorkLimitError,
    integrate,
    solve,
)
from geomtorsion.ode.engines.stepwise import FLOOR
from geomtorsion.ode.engines.taylor import is_available
from geomtorsion.ode.error_estimate import difference
from geomtorsion.ode.numbers import checked_accuracy, checked_times
from geomtorsion.outgoing import size_text
from geomtorsion.precision import EPS
from geomtorsion.proofs import prove

ACCURACIES = (1e-3, 1e-6, 1e-9, 1e-12)
# Each solution is repeated for at least this long, in seconds, and the fastest counts.
LONG_ENOUGH = 0.02


@dataclass(frozen=True)
class CostRow:
    """One engine at one accuracy.

    asked: requested accuracy. achieved: error against the reference. estimated: the estimate of
    `solve`.
    seconds: integration of the answer.
    total_seconds: `solve` with its error estimate.
    compile_seconds: compilation on the first call.
    note: why there is no answer; empty otherwise.
    """

    engine: str
    asked: float
    achieved: float | None
    estimated: float | None
    seconds: float | None
    total_seconds: float | None
    compile_seconds: float
    steps: int
    evaluations: int
    note: str = ""

    @property
    def holds(self) -> bool:
        """Whether the answer is as accurate as requested."""
        return self.achieved is not None and self.achieved <= self.asked


@dataclass(frozen=True)
class ProofCost:
    """Cost of a proof of the same motion.

    digits: requested; seconds: of only the proof; bits, steps: used by the proof.
    holds: whether the error that was estimated for the finest row holds; None: not decided.
    note: why there is no proof, or nothing.
    """

    digits: int
    seconds: float | None = None
    bits: int = 0
    steps: int = 0
    holds: bool | None = None
    note: str = ""

    def __str__(self) -> str:
        if self.seconds is None:
            return f"{'proved':<14}{10.0**-self.digits:>9.0e}   {self.note}"
        verdict = {True: "estimate holds", False: "estimate does NOT hold", None: "undecided"}
        return (
            f"{'proved':<14}{10.0**-self.digits:>9.0e}   {self.digits} digits in "
            f"{_time(self.seconds)}, {self.steps} steps of {self.bits} bits; finest "
            f"{verdict[self.holds]}"
        )


@dataclass(frozen=True)
class CostTable:
    """Cost of accuracy for one problem.

    problem: its name; t: end time; truth: the reference for errors.
    rows: one per engine and accuracy.
    proof: cost of a proof, where requested.
    """

    problem: str
    t: float
    truth: str
    rows: tuple[CostRow, ...]
    proof: ProofCost | None = None

    def __str__(self) -> str:
        columns = ("asked", 9), ("achieved", 10), ("estimate", 10), ("solve", 11)
        columns = *columns, ("+ check", 11), ("compile", 10), ("steps", 8)
        head = "engine".ljust(14) + "".join(name.rjust(width) for name, width in columns)
        lines = [f"{self.problem}, to t = {self.t:g}; errors against {self.truth}", head]
        for row in self.rows:
            if row.seconds is None or row.total_seconds is None:
                lines.append(f"{row.engine:<14}{row.asked:>9.0e}   {row.note}")
                continue
            lines.append(
                f"{row.engine:<14}{row.asked:>9.0e}{size_text(row.achieved or 0.0):>10}"
                f"{size_text(row.estimated or 0.0):>10}"
                f"{_time(row.seconds):>11}{_time(row.total_seconds):>11}"
                f"{_time(row.compile_seconds):>10}{row.steps:>8}"
            )
        if self.proof is not None:
            lines.append(str(self.proof))
        return "\n".join([*lines, self.recommendation])

    __repr__ = __str__

    @property
    def recommendation(self) -> str:
        """One line: which engine, how fast, and how much faster than the next."""
        # From the finest on: the first accuracy that an engine reaches is recommended.
        finest = sorted({row.asked for row in self.rows})
        for asked in finest:
            good = [r for r in self.rows if r.asked == asked and r.holds and r.total_seconds]
            if not good:
                continue
            good.sort(key=lambda row: row.total_seconds or 0.0)
            best = good[0]
            line = f"Take {best.engine}: {asked:.0e} in {_time(best.total_seconds or 0.0)}"
            if len(good) > 1:
                ratio = (good[1].total_seconds or 0.0) / (best.total_seconds or 1.0)
                line += f", {ratio:.3g} times faster than {good[1].engine}"
            elif len({row.engine for row in self.rows}) > 1:
                line += "; no other engine gets there"
            return line + "."
        return "No engine reaches any of these accuracies; ask for less."

    def to_json(self) -> dict[str, Any]:
        """The table as a JSON-ready mapping."""
        return asdict(self) | {"recommendation": self.recommendation}

    def plot(self) -> Any:
        """Work against precision, log-log, as a matplotlib figure.

        Raises
        ------
        MissingExtraError
            matplotlib is not installed.
        """
        # Users of only the tables need no matplotlib.
        from geomtorsion.pictures.costs import work_precision_picture

        return work_precision_picture(self)


def _time(seconds: float) -> str:
    """Seconds as a person reads them."""
    for unit, size in (("s", 1.0), ("ms", 1e-3)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds * 1e6:.3g} us" if seconds else "-"


def accuracy_cost(
    problem: CurveProblem | ODE,
    t: float | np.ndarray = 10.0,
    engines: Sequence[Engine] | None = None,
    accuracies: Sequence[float] = ACCURACIES,
    *,
    exact: States | None = None,
    progress: Callable[[float], object] = lambda _: None,
    proved: bool = False,
) -> CostTable:
    """Measure the cost of each accuracy with each engine.

    Parameters
    ----------
    problem
        a curve, or any first-order equations.
    t
        how far to follow it, or times.
    engines
        Taylor() (if installed) and RungeKutta() if not given.
    accuracies
        accuracies to request from `solve`.
    exact
        function of times that gives the true states, where a closed form is known.
    progress
        called with the part that is done, from 0 to 1.
    proved
        whether a row gives the cost of a proof of 15 digits; see `prove`.

    Returns
    -------
    CostTable; errors are measured against a closed form where the problem has one, else against
    quadruple precision, else (without heyoka) against the most accurate Runge-Kutta solution.

    Raises
    ------
    AccuracyError
        an accuracy is not a positive number, or none is given.

    Examples
    --------
    >>> from geomtorsion.curves import geodesic
    >>> from geomtorsion.spaces import load
    >>> p = geodesic(load("so3").frame, frame_velocity=[1, 2, 3], metric=[1, 2, 3])
    >>> table = accuracy_cost(p, 1.0, engines=[RungeKutta()], accuracies=[1e-6])
    >>> table.rows[0].holds
    True
    """
    asked = [checked_accuracy(accuracy) for accuracy in accuracies]
    if not asked:
        raise AccuracyError(
            "accuracies: expected at least one, got none. Give some, such as [1e-6, 1e-9]."
        )
    solvers = list(engines or ([Taylor()] if is_available() else []) + [RungeKutta()])
    times, grid = checked_times(t)
    truth = truth_of(problem, grid, exact)
    rows: list[CostRow] = []
    for solver in solvers:
        for accuracy in asked:
            rows.append(_row(problem, times, solver, accuracy, truth))
            progress(len(rows) / (len(solvers) * len(asked)))
    proof = _proof(problem, times, solvers, asked) if proved else None
    return CostTable(str(problem), float(times[-1]), truth.name, tuple(rows), proof)


def _proof(
    problem: CurveProblem | ODE,
    times: np.ndarray,
    engines: Sequence[Engine],
    accuracies: Sequence[float],
) -> ProofCost:
    """The price of a proof of the finest solution that there is."""
    digits = 15
    for accuracy in sorted(accuracies):
        for engine in engines:
            try:
                proof = prove(solve(problem, times, accuracy, engine), digits)
            except ProofError as error:
                return ProofCost(digits, note=str(error).split(". ")[0])
            except GeomtorsionError:
                # This row has no solution, as its note reports.
                continue
            return ProofCost(digits, proof.seconds, proof.bits, proof.steps, proof.holds)
    return ProofCost(digits, note="there is no solution to prove")


def _row(
    problem: CurveProblem | ODE, times: np.ndarray, engine: Engine, accuracy: float, truth: Truth
) -> CostRow:
    """Solve, repeat for the clock, measure the error."""
    try:
        first = solve(problem, times, accuracy, engine)
    except GeomtorsionError as error:
        note = str(error).split(". ")[0]
        return CostRow(engine.name, accuracy, None, None, None, None, 0.0, 0, 0, note)
    # The first solve may have compiled: its time is not representative.
    best: Solution = first
    total = float("inf")
    began = time.perf_counter()
    while total == float("inf") or time.perf_counter() - began < LONG_ENOUGH:
        start = time.perf_counter()
        found = solve(problem, times, accuracy, engine)
        total = min(total, time.perf_counter() - start)
        if found.cost.run_seconds < best.cost.run_seconds:
            best = found
    return CostRow(
        engine.name,
        accuracy,
        truth.error(best),
        best.error,
        best.cost.run_seconds,
        total,
        first.cost.compile_seconds,
        best.cost.steps,
        best.cost.evaluations,
    )


# The square of double rounding, which is above the rounding of quadruple numbers.
QUADRUPLE_TOLERANCE = EPS * EPS
# Function of times that gives exact states, one row for each time.
States = Callable[[np.ndarray], Any]


@dataclass(frozen=True)
class Truth:
    """Best known solution of a motion.

    name: its source; trajectory: states at the times of the requested solutions.
    """

    name: str
    problem: CurveProblem | ODE
    trajectory: Trajectory

    def error(self, solution: Solution) -> float:
        """Largest error of a solution, each group of states against its own size."""
        return difference(self.problem, solution.trajectory, self.trajectory, solution.accuracy)


def truth_of(problem: CurveProblem | ODE, grid: np.ndarray, exact: States | None = None) -> Truth:
    """A closed form if there is one, else quadruple precision, else the finest Runge-Kutta.

    grid: times from 0 on; exact: the closed form, where the problem does not know it itself.
    """
    known = closed_form(problem) if exact is None and isinstance(problem, CurveProblem) else None
    if exact is not None or known is not None:
        label, states = known if known is not None else ("", exact)
        assert states is not None
        return Truth("the closed form", problem, _tabulated(problem, grid, label, states))
    engine: Engine = RungeKutta()
    tolerance, name = FLOOR, "the finest Runge-Kutta solution"
    if is_available():
        engine, tolerance, name = Taylor(113), QUADRUPLE_TOLERANCE, "quadruple precision"
    stage = problem.first_stage(engine.precision, 0.0)
    try:
        run = integrate(stage, grid * problem.time_unit, tolerance, engine)
    except WorkLimitError as limit:
        raise limit.counted(1 / problem.time_unit, problem.time_name) from None
    return Truth(name, problem, run)


def _tabulated(
    problem: CurveProblem | ODE, grid: np.ndarray, label: str, states: States
) -> Trajectory:
    """A trajectory of exact states."""
    stage: Stage = problem.first_stage(53, 0.0)
    assert stage.label == label
    rows = np.array([list(row) for row in states(grid)])
    times = grid * problem.time_unit
    run = Run(times, rows, float(times[-1]), rows[-1], "done", 0, 0, 0.0, 0.0)
    return Trajectory(RungeKutta(), 0.0, (Segment(stage, run, 0, len(grid)),), "done")
