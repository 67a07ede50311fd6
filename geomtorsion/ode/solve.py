"""Solve: a motion to the requested accuracy, or an error that names the best accuracy."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import TypeAlias

import numpy as np

from geomtorsion.errors import (
    AccuracyError,
    ArgumentError,
    GeomtorsionError,
    StartError,
    TimeError,
)
from geomtorsion.ode.checkpoint import Checkpoint, fingerprint
from geomtorsion.ode.engines import Engine, RungeKutta, Taylor
from geomtorsion.ode.engines.taylor import is_available
from geomtorsion.ode.error_estimate import MAGNIFIED, SAFETY, Verified, verified
from geomtorsion.ode.numbers import PARTS, check_memory, checked_accuracy, checked_times
from geomtorsion.ode.poles import AT_A_POLE, ended_at_poles
from geomtorsion.ode.roundings import PLACES, Roundings, change_by_rounding, rounding
from geomtorsion.ode.solution import DOUBLE, Cost, Problem, Solution
from geomtorsion.ode.system import WorkLimitError, checked_engine
from geomtorsion.ode.trajectory import Trajectory, integrate
from geomtorsion.support import checks
from geomtorsion.support.arguments import Times
from geomtorsion.support.budget import affordable
from geomtorsion.support.hints import argument_hints
from geomtorsion.support.precision import GOLDEN
from geomtorsion.support.progress import reports

Progress: TypeAlias = Callable[[float], object]
# Accuracy of a solution for which none is requested.
ACCURACY = 1e-10
# If an engine with more digits does not reduce the error below this part, steps may pass over
# narrow changes of the rates. The way is then cut into FINE times more parts.
NO_HELP = 0.1
FINE = (8, 64)
# Where a condition that ends a motion belongs, for messages to users who give it to a solver.
STOP = "stop= of gt.geodesic or gt.autoparallel, or events=[gt.When(...)] of gt.ODE.of"


@argument_hints(
    method="engine=RungeKutta()",
    rtol="accuracy=1e-8",
    atol="accuracy=1e-8",
    tol="accuracy=1e-8",
    stop=STOP,
    t_span="t",
    t_eval="t",
)
def solve(
    problem: Problem,
    t: Times,
    accuracy: float = ACCURACY,
    engine: Engine | None = None,
    checkpoint: str | Path | None = None,
    progress: Progress | bool | None = None,
    *,
    seconds: float | None = None,
    overwrite: bool = False,
    derivatives: Sequence[str] = (),
) -> Solution:
    """Solve a motion so that the result, not only each step, has the requested accuracy.

    Each solution has an error estimate: its difference from a second run with a hundred times
    smaller tolerance and a start perturbed by one rounding error (see `error_estimate`). The
    tolerance is reduced until the error is below the accuracy.

    Parameters
    ----------
    problem
        from `autoparallel`, `geodesic`, ...; or any first-order equations, from `ODE.of`.
    t
        last time, or increasing (or decreasing) times from 0 on; the motion starts at t = 0.
    accuracy
        largest error, relative to the size of the solution (see `Solution.error`).
    engine
        Taylor(), RungeKutta() or Stiff(); None chooses one of the first two and records why. Both
        refuse stiff equations on which they would take too many steps.
    checkpoint
        a file to which the run is written in parts; a later call with the same problem, times,
        accuracy and engine resumes it, with the same result.
    progress
        called with the finished fraction, from 0 to 1; True shows a bar.
    seconds
        processor time instead of an accuracy: trials, from coarse to fine, determine the smallest
        error from 1e-2 to 1e-12 that this time buys. The result names the accuracy that was chosen:
        `solve(problem, t, solution.accuracy)` gives equal bits, and takes no longer than `seconds`.
    overwrite
        whether to replace the checkpoint of another run.
    derivatives
        names of parameters, and of numbers at the start (states; coordinates q^mu, and u1, u2, ...
        or r', ... , whichever velocity was given). The derivative of r by M is `solution["dr_dM"]`,
        and `solution.error_of("dr_dM")` its error. They follow from the exact variational equations
        and are as accurate as the motion. A curve with derivatives stays in its home chart.

    Raises
    ------
    AccuracyError
        accuracy <= 0, or finer than this engine reaches; or even 1e-2 takes longer than `seconds`.
    ArgumentError
        seconds together with an accuracy or a checkpoint.
    TimeError
        times are empty, repeated, unsorted, not finite or on both sides of 0.
    ChartEdgeError, StuckError
        the motion left its last chart, or cannot continue; the error holds the computed part.
    CheckpointError
        the file is the checkpoint of another run.

    Examples
    --------
    >>> from geomtorsion.ode import ODE, RungeKutta
    >>> solution = solve(ODE.of({"x": "-x"}, [1]), 1.0, accuracy=1e-8, engine=RungeKutta())
    >>> round(float(solution["x"][-1]), 8)
    0.36787944

    How the end depends on a parameter:

    >>> growth = ODE.of({"x": "k*x"}, [1], parameters={"k": 2})
    >>> solution = solve(growth, 1.0, engine=RungeKutta(), derivatives=["k"])
    >>> round(float(solution["dx_dk"][-1] / solution["x"][-1]), 9)
    1.0
    """
    checked_engine(engine)
    if not callable(getattr(problem, "first_stage", None)):
        raise StartError(
            "solve: expected a problem (autoparallel, geodesic, ...) or an ODE, "
            f"got {checks.shown(problem)}. Equations are made by ODE.of(rates, start); a scene has "
            "run()."
        )
    if checks.entries(derivatives, "derivatives", StartError):
        problem = problem.with_derivatives(derivatives)
    if seconds is not None:
        if accuracy != ACCURACY or checkpoint is not None:
            raise ArgumentError(
                "seconds: expected no accuracy and no checkpoint, because seconds choose the "
                f"accuracy; got accuracy={checks.shown(accuracy)}, "
                f"checkpoint={checks.shown(checkpoint)}. Give one of them."
            )
        accuracy = affordable(partial(solve, problem, t, engine=engine), seconds, "a shorter time")
    accuracy = checked_accuracy(accuracy)
    times, grid = checked_times(t)
    problem.check_start()
    unit = problem.time_unit
    # What nobody may write to need not be copied.
    scaled = grid if unit == 1.0 and not grid.flags.writeable else grid * unit
    if unit != 1.0 and not (np.isfinite(scaled[-1]) and np.diff(scaled).all()):
        raise TimeError(
            "t: expected a motion whose length fits into floats, got one to t = "
            f"{checks.shown(float(times[-1]))} that is {unit:.3g} times as fast. Use other units "
            "of time."
        )
    store = None
    if checkpoint is not None:
        key = fingerprint(problem, times, accuracy, engine)
        store = Checkpoint(checkpoint, key, overwrite=overwrite)
    with reports(progress, "motion") as show:
        report = None if show is None else Report(show, float(scaled[-1]))
        try:
            pulses = problem.pulses(float(scaled[-1]))
            request = _Request(problem, times, scaled, accuracy, engine, store, report, pulses)
            solution = _Attempts(request).solution()
        finally:
            if store is not None:
                store.write()
        if show is not None:
            show(1.0)
    return solution


@dataclass(frozen=True, eq=False)
class _Request:
    """A motion with the times and the accuracy that its solution is to have.

    times: in the units of the motion; grid: of the samples, in the time of the stages.
    engine: None chooses. kept: the file of the parts of a run. report: of the finished fraction.
    pulses: times at which all runs end and continue.
    """

    problem: Problem
    times: np.ndarray
    grid: np.ndarray
    accuracy: float
    engine: Engine | None
    kept: Checkpoint | None
    report: Report | None
    pulses: tuple[float, ...]

    def runs_of(self, engine: Engine, *, last: bool = True) -> _Runs:
        """What the runs of one engine have in common."""
        end = float(self.grid[-1])
        cuts = () if self.kept is None else tuple(end * k / PARTS for k in range(1, PARTS))
        return _Runs(
            self.problem, engine, self.accuracy, self.grid, cuts, self.kept, self.report, last,
            pulses=self.pulses,
        )  # fmt: skip

    def solution(self, reason: str, result: Verified, runs: Sequence[Trajectory]) -> Solution:
        """The answer with its error and cost."""
        answer, times, error = result.answer, self.times, result.error
        if answer.outcome != "done":
            skip = len(self.grid) - len(times)
            times = times[: max(answer.count - skip, 0)]
            reached = answer.reached / self.problem.time_unit
            if answer.outcome == "stopped" and (not len(times) or times[-1] != reached):
                times = np.concatenate((times, [reached]))
        if self.accuracy >= DOUBLE and answer.engine.precision > 53:
            # The returned numbers are doubles, whatever the internal precision.
            error = max(error, DOUBLE)
        return Solution(
            self.problem, times, self.accuracy, error, answer.engine.name, reason,
            Cost.of(answer, runs), answer, result.comparisons,
        )  # fmt: skip


class _Attempts:
    """Attempts of one engine after another at a request, with what they leave for the next."""

    def __init__(self, request: _Request) -> None:
        self.request = request
        self.runs: list[Trajectory] = []
        self.names: list[str] = []
        self.best, self.growth, self.amplified = math.inf, 0.0, math.nan

    def solution(self) -> Solution:
        """The answer of the first engine that is good enough."""
        request, ended = self.request, None
        for engine, reason in engines(request.problem, request.accuracy, request.engine):
            stage = request.problem.first_stage(engine.precision, 0.0)
            check_memory(len(request.grid), len(stage.start))
            last = request.engine is not None or engine.precision > 113
            if not last and self.amplified * rounding(engine.precision, 1) > request.accuracy:
                # Its roundings would be too much.
                continue
            result = self._result(engine, last)
            if result.answer.reason == AT_A_POLE and not last:
                # More digits may separate the state from the pole.
                ended = request.solution(reason, result, self.runs)
            elif result.error <= request.accuracy or result.answer.outcome == "stuck":
                solution = request.solution(reason, result, self.runs)
                return solution if solution.complete else self._beyond(solution, engine)
        if ended is not None and not math.isfinite(self.best):
            raise _stuck_error(request.problem, ended)
        raise self._too_coarse()

    def _result(self, engine: Engine, last: bool) -> Verified:
        """The answer of one engine."""
        request = self.request
        asked = request.runs_of(engine, last=last)
        result = _followed(asked, self.runs, self.growth, self.amplified)
        self.growth, self.amplified = result.growth, result.amplified
        self.names.append(engine.name)
        if max(request.accuracy, NO_HELP * self.best) < result.error < math.inf:
            result = _in_short_steps(asked, self.runs) or result
        self.best = min(self.best, result.error)
        return result

    def _beyond(self, solution: Solution, engine: Engine) -> Solution:
        """The answer in steps, which may leave the place behind where a series has no value."""
        request, result = self.request, None
        if request.engine is None and engine != RungeKutta() and is_coarse(request.accuracy):
            result = _complete(request.runs_of(RungeKutta()), self.runs)
        if result is None:
            raise _stuck_error(request.problem, solution)
        return request.solution("a series has no value on the way", result, self.runs)

    def _too_coarse(self) -> AccuracyError:
        """The error where no engine has the accuracy."""
        got = f"gives {'no ' if self.names else ''}two runs to compare"
        got = f"gets to {self.best:.2g}" if math.isfinite(self.best) else got
        names = ", then ".join(self.names) or "no available engine"
        expected = f"expected accuracy {self.request.accuracy:.3g}"
        return AccuracyError(f"{expected}; {names} {got}. " + _remedy(self.request.engine))


def _stuck_error(problem: Problem, solution: Solution) -> GeomtorsionError:
    """The error of a motion that cannot continue, with its computed part."""
    error = problem.stuck_error(solution.trajectory)
    error.solution = solution  # type: ignore[attr-defined]  # all these errors have it
    return error


@dataclass(frozen=True)
class _Runs:
    """What runs of one engine have in common.

    grid: the times of the samples; cuts: times at which runs end and continue.
    last: whether no more precise engine follows. fineness: of the parts of the way that the finer
        run does not pass over in one step. pulses: times at which all runs end and continue.
    """

    problem: Problem
    engine: Engine
    accuracy: float
    grid: np.ndarray
    cuts: tuple[float, ...]
    kept: Checkpoint | None
    report: Report | None
    last: bool = True
    fineness: int = 1
    pulses: tuple[float, ...] = ()

    @property
    def limit(self) -> float:
        """The longest step of a run that has to see ahead; not commensurate with the cuts.

        A comparison of the answer with an integral of its rates would need fewer operations, but in
        NumPy it takes longer than so many short steps in compiled code.
        """
        return GOLDEN * abs(float(self.grid[-1])) / (PARTS * self.fineness) or math.inf

    def verified(self, runs: list[Trajectory], growth: float, amplified: float) -> Verified:
        """The answer with its error; all runs are added to those given."""
        result = verified(
            self.problem, self.engine, self.accuracy, self.run, growth=growth,
            amplified=amplified, last=self.last,
        )  # fmt: skip
        runs += result.runs
        # Within a pulse the roundings of the time count; one difference of them may be small.
        return result._replace(error=SAFETY**3 * result.error) if self.pulses else result

    @property
    def parts(self) -> tuple[float, ...]:
        """Times at which the way is divided into equal parts."""
        number = PARTS * self.fineness
        return tuple(float(self.grid[-1]) * (k / number) for k in range(1, number))

    def run(
        self,
        engine: Engine,
        tolerance: float,
        answer: Trajectory | None = None,
        pattern: int = 0,
    ) -> Trajectory:
        # A run to compare starts a rounding away; cut where the answer is cut, it would pass over
        # the same.
        moved, roundings, longest, grid = 0.0, None, math.inf, self.grid
        if answer is not None:
            moved, longest = SAFETY * 2.0 ** (1 - engine.precision), self.limit
            if answer.outcome == "stuck":
                # A changed run may pass where the answer ends, and need any number of steps there.
                grid = grid[: max(answer.count, 2)]
        if answer is not None and pattern:
            longest = math.inf
            if getattr(engine, "changes_on_the_way", False):
                part = MAGNIFIED * change_by_rounding(engine.precision, answer.steps / PLACES)
                roundings = Roundings(part, max(answer.steps, 1), float(self.grid[-1]), pattern)
            else:
                moved = MAGNIFIED * change_by_rounding(engine.precision, answer.steps)
        cuts = () if answer and self.kept is None and not pattern else self.cuts
        pulses = self.pulses
        if answer is not None:
            # Cut elsewhere, it rounds the time in another way.
            pulses = tuple((a + b) / 2 for a, b in pairwise(pulses))
        try:
            return integrate(
                self.problem.first_stage(engine.precision, moved),
                grid,
                tolerance,
                engine,
                cuts=sorted({*cuts, *pulses}, key=abs) if pulses else cuts,
                roundings=roundings,
                longest=longest,
                runner=self.kept
                and self.kept.runner(engine, tolerance, moved, longest, roundings, self.fineness),
                watch=self.report and self.report.next_run(),
            )
        except WorkLimitError as limit:
            raise limit.counted(1 / self.problem.time_unit, self.problem.time_name) from None


def _complete(asked: _Runs, runs: list[Trajectory]) -> Verified | None:
    """The answer if it comes to the end, and is good enough."""
    try:
        result = _followed(asked, runs)
    except WorkLimitError:
        return None
    ended = result.answer.outcome in ("done", "stopped")
    return result if ended and result.error <= asked.accuracy else None


def verified_motion(
    problem: Problem, engine: Engine, accuracy: float, grid: np.ndarray
) -> Verified:
    """One motion by one engine, with its error, whether or not that is small enough.

    grid: times in the time of the stages.
    """
    pulses = problem.pulses(float(grid[-1]))
    return _followed(_Runs(problem, engine, accuracy, grid, (), None, None, pulses=pulses), [])


def _followed(
    asked: _Runs, runs: list[Trajectory], growth: float = 0.0, amplified: float = math.nan
) -> Verified:
    """The answer with its error.

    Where it fails and a step was long, the answer may not have seen what the finer run saw: it is
    cut into short parts.
    """
    result = asked.verified(runs, growth, amplified)
    long = result.answer.longest_step > asked.limit
    if result.error > asked.accuracy and long and not asked.cuts:
        result = replace(asked, cuts=asked.parts).verified(runs, growth, result.amplified)
    answer = ended_at_poles(result.answer)
    return result if answer is result.answer else result._replace(answer=answer, error=math.inf)


def _in_short_steps(asked: _Runs, runs: list[Trajectory]) -> Verified | None:
    """The answer in short steps, if it is good enough; more digits only make steps longer."""
    for fineness in FINE:
        short = replace(asked, fineness=fineness)
        result = replace(short, cuts=short.parts).verified(runs, 0.0, math.nan)
        if result.error <= asked.accuracy:
            return result
    return None


def engines(
    problem: Problem, accuracy: float, engine: Engine | None
) -> Iterator[tuple[Engine, str]]:
    """Engines in the order in which to try them, each with the reason."""
    if engine is not None:
        yield engine, "as requested"
        return
    has_series = problem.first_stage(53, 0.0).system.has_series
    if not (is_available() and has_series):
        reason = "heyoka is not installed" if has_series else "a function has no Taylor series"
        if is_coarse(accuracy):
            yield RungeKutta(), reason
        return
    if accuracy > 4e-16:
        yield Taylor(), "heyoka is installed: the fastest"
    if accuracy > 4e-19:
        yield Taylor(64), "double precision does not give this accuracy"
    if accuracy > 2.0**-108:
        yield Taylor(113), "long double precision does not give this accuracy"
    yield Taylor(300), "quadruple precision does not give this accuracy"


def batch_engine(engine: Engine | None, problem: Problem) -> tuple[Engine, str]:
    """The requested engine, or the fastest available."""
    if engine is not None:
        if engine.precision != 53:
            raise AccuracyError(
                f"solve_many: expected an engine in double precision, got {engine.name} with "
                f"{engine.precision} bits. Solve the motions one by one."
            )
        return engine, "as requested"
    if not problem.first_stage(53, 0.0).system.has_series:
        return RungeKutta(), "a function has no Taylor series: motions stacked into one system"
    if is_available():
        return Taylor(), "heyoka is installed: several motions in one instruction"
    return RungeKutta(), "heyoka is not installed: motions stacked into one system"


def is_coarse(accuracy: float) -> bool:
    """Whether RungeKutta is worth a try: its steps round to about as much."""
    return accuracy > 1e-13


def _remedy(engine: Engine | None) -> str:
    """What to do where an accuracy is not reached."""
    if engine is None and not is_available():
        return "Install heyoka (the extra fast) for more digits, or request fewer."
    return "Request less accuracy or a shorter time, or use Taylor(precision=113) or more."


class Report:
    """Finished fraction of a solution, from the times that its runs have reached.

    At least two runs are necessary; each counts as half of the rest.
    """

    def __init__(self, progress: Callable[[float], object], end: float) -> None:
        self.progress = progress
        self.end = end
        self.left: float = 2.0
        self.reported: float = 0.0

    def next_run(self) -> Callable[[float], None]:
        """The function to call with the times that the next run reaches."""
        self.left = left = self.left / 2

        def watch(time: float) -> None:
            part = 1 - left + 0.5 * left * min(time / self.end, 1.0)
            # Engines call this at every step; a bar shows no less than a thousandth.
            if part - self.reported >= 0.001:
                self.reported = part
                self.progress(part)

        return watch
