"""Ensemble: one problem from many starts at once, each member with its own error."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, KeysView, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from geomtorsion.errors import AccuracyError, StartError, TimeError, WorkerError
from geomtorsion.ode.batch import Failure, batch_method
from geomtorsion.ode.ends import Ends
from geomtorsion.ode.engines import Engine
from geomtorsion.ode.error_estimate import (
    AIM,
    NOISE,
    SAFETY,
    change_by_rounding,
    next_tolerance,
    rounding,
    roundings_matter,
)
from geomtorsion.ode.members import BatchRows, Members, Rows, run_members
from geomtorsion.ode.moment import Moment
from geomtorsion.ode.numbers import (
    PARTS,
    check_memory,
    checked_accuracy,
    checked_times,
    one_time_only,
)
from geomtorsion.ode.singles import followed, listed, unfinished_text
from geomtorsion.ode.solve import STOP, batch_engine
from geomtorsion.ode.system import Show, checked_engine
from geomtorsion.ode.trajectory import Trajectory
from geomtorsion.ode.writing import pandas_table
from geomtorsion.support import checks
from geomtorsion.support.arguments import Starts, Times
from geomtorsion.support.caching import cached_property
from geomtorsion.support.copies import only_fields
from geomtorsion.support.csv_table import write_csv
from geomtorsion.support.displays import Plot, drawn_by, figure_by, key_completions
from geomtorsion.support.executors import Executor, checked_executor, each_done
from geomtorsion.support.hints import argument_hints, attribute_hints
from geomtorsion.support.precision import GOLDEN
from geomtorsion.support.progress import PATIENCE, bar

# Names of vectors whose components have names of their own.
WHOLE = ("states", "coordinates", "frame_velocity")


@attribute_hints(t="ensemble.times")
@dataclass(frozen=True, eq=False)
class Ensemble:
    """Solutions of one problem from many starts.

    problem: the solved problem.
    times: shape (m,).
    errors: shape (number,), estimate of the largest relative error of each member, as in
        `Solution.error`; NaN for members that were not verified or not finished.
    finished: shape (number,), True for members that reached the last time or were stopped.
    interrupted: whether it was stopped by Ctrl-C.
    engine, reason, tolerance: the engine, why it was chosen, and its finest tolerance.
    compile_seconds, run_seconds, check_seconds: as in `Cost`.

    Arrays by name, as `ensemble["x"]`, have shape (number, m) or (number, m, k); they are NaN
    where a member is not finished and after its stop. `end` has the last values of each member.

    Examples
    --------
    >>> import numpy as np
    >>> from geomtorsion.ode import ODE, solve_many
    >>> decay = ODE.of({"x": "-k*x"}, [1], parameters={"k": 1}, outputs={"half": "x/2"})
    >>> many = solve_many(decay, {"k": np.array([1.0, 2.0])}, 1.0)
    >>> many["half"][:, -1].round(6).tolist(), bool(many.error < 1e-10)
    ([0.18394, 0.067668], True)

    Each stone lands at its own time:

    >>> from geomtorsion.ode import When
    >>> fall = ODE.of({"z": "v", "v": "-10"}, [20, 0], events=[When("z")])
    >>> stones = solve_many(fall, {"z": [5.0, 20.0, 80.0]}, 3.0)
    >>> stones.times_at_stop.round(9).tolist(), stones.stopped_by.tolist()
    ([1.0, 2.0, nan], ['z', 'z', ''])
    >>> stones.end["v"].round(9).tolist()
    [-10.0, -20.0, -30.0]
    """

    problem: Any  # a Problem; users know which one they posed
    times: np.ndarray
    errors: np.ndarray
    finished: np.ndarray
    interrupted: bool
    engine: str
    reason: str
    tolerance: float
    compile_seconds: float
    run_seconds: float
    check_seconds: float
    members: Members
    rows: Rows

    def __getstate__(self) -> dict[str, object]:
        return only_fields(self)

    def __len__(self) -> int:
        return len(self.finished)

    @property
    def error(self) -> float:
        """The largest error of all members that were verified."""
        finite = self.errors[np.isfinite(self.errors)]
        return float(finite.max()) if len(finite) else float("inf")

    @property
    def checked(self) -> int:
        """How many members were verified."""
        return int(np.isfinite(self.errors).sum())

    @property
    def unfinished(self) -> tuple[int, ...]:
        """Numbers of the members that were neither stopped nor reached the last time."""
        return tuple(np.flatnonzero(~self.finished).tolist())

    @property
    def times_at_stop(self) -> np.ndarray:
        """Time at which a condition stopped each member, shape (number,); NaN if none did."""
        return self.rows.ends.times

    @property
    def stopped_by(self) -> np.ndarray:
        """Condition that stopped each member, as text, shape (number,); empty if none did."""
        texts = np.array([*self.problem.stop_texts, ""])
        return texts[self.rows.ends.stops]

    @cached_property
    def end(self) -> Moment:
        """Everything at the end of each member, its stop or the last time: shapes (number, ...)."""
        ends = self.rows.ends
        states = np.where(ends.stopped[:, None], ends.states, self.rows.states[:, -1])
        times = np.where(ends.stopped, ends.times, self.times[-1])
        lasts = {k: path.ending() for k, path in self.rows.trajectories.items()}
        rows = Rows(states[:, None, :], self.finished, ends, lasts)
        values = self.problem.read_members(self.members, rows, times[:, None])
        whole = tuple(name for name in WHOLE if name in values)
        return Moment(times, {name: x[:, 0] for name, x in values.items()}, whole)

    @cached_property
    def values(self) -> Mapping[str, np.ndarray]:
        """Everything by name, shapes (number, m) or (number, m, k)."""
        return self.problem.read_members(self.members, self.rows, self.times)

    def __getitem__(self, name: str) -> np.ndarray:
        """A state, coordinate, velocity or output by name.

        Raises
        ------
        UnknownNameError
            nothing has this name.
        """
        return Moment(self.times, self.values)[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.values)

    def __contains__(self, name: object) -> bool:
        return name in self.values

    def keys(self) -> KeysView[str]:
        """Names of the states, coordinates, velocities and outputs."""
        return self.values.keys()

    @property
    def states(self) -> np.ndarray:
        """All states of first-order equations, shape (number, m, size)."""
        return self["states"]

    @property
    def coordinates(self) -> np.ndarray:
        """q^mu of curves in the chart of the problem, shape (number, m, n).

        Not a number for a member that went where this chart does not reach; see `trajectories`.
        """
        return self["coordinates"]

    @property
    def frame_velocity(self) -> np.ndarray:
        """u^i of curves, shape (number, m, n)."""
        return self["frame_velocity"]

    @property
    def trajectories(self) -> Mapping[int, Trajectory]:
        """Member -> trajectory, for the members solved one by one through other charts."""
        return self.rows.trajectories

    def at_accuracy(self, accuracy: float, engine: Engine | None = None) -> Ensemble:
        """The same motions at another accuracy or by another engine, all of them verified.

        Raises
        ------
        AccuracyError
            As `solve_many`.

        Examples
        --------
        >>> from geomtorsion.ode import ODE, solve_many
        >>> many = solve_many(ODE.of({"x": "-x"}, [1]), [[1.0], [2.0]], 1.0, 1e-4)
        >>> bool(many.at_accuracy(1e-12).error < 1e-12)
        True
        """
        checked_engine(engine)
        when = self.times, checked_times(self.times)[1]
        every = np.arange(len(self))
        accuracy = checked_accuracy(accuracy)
        return _ensemble(self.problem, self.members, when, accuracy, engine, every, False)

    def to_pandas(self) -> Any:  # pandas is not a dependency
        """A pandas table of the ends, a row for each member: its error, its stop, all names.

        Raises
        ------
        MissingExtraError
            pandas is not installed.
        """
        return pandas_table(self._columns())

    def to_csv(self, path: str | Path) -> None:
        """Write the table of `to_pandas`, every digit kept.

        Examples
        --------
        >>> import tempfile
        >>> from geomtorsion.ode import ODE, solve_many
        >>> file = Path(tempfile.mkdtemp(), "ends.csv")
        >>> solve_many(ODE.of({"x": "1"}, [0]), [[1.0], [2.0]], 1.0).to_csv(file)
        >>> file.read_text().splitlines()[0]
        'member,finished,error,stopped_by,t,x'
        """
        write_csv(checks.file_name(path), self._columns())

    def _columns(self) -> dict[str, np.ndarray]:
        """The end of each member, by name; components of vectors by their own."""
        head = {
            "member": np.arange(len(self)),
            "finished": self.finished.astype(int),
            "error": self.errors,
            "stopped_by": self.stopped_by,
            self.problem.time_name: self.end.time,
        }
        columns = {name: x for name, x in self.end.items() if x.ndim == 1}
        for name in self.end:
            if self.end[name].ndim > 1:
                columns |= {f"{name}[{k}]": x for k, x in enumerate(self.end[name].T)}
        return head | columns

    def __str__(self) -> str:
        done = int(self.finished.sum())
        stopped = int(self.rows.ends.stopped.sum())
        halted = f"{stopped} of them stopped; " if stopped else ""
        rate = done / self.run_seconds if self.run_seconds else 0.0
        lost = "; " + listed(self.unfinished, "not finished:") if self.unfinished else ""
        return (
            f"{done} of {len(self)} motions by {self.engine} ({self.reason}), "
            f"error below {self.error:.2g} in the {self.checked} of them that were verified; "
            f"{halted}"
            f"{self.run_seconds:.3g} s ({rate:.3g} per second), "
            f"compiled in {self.compile_seconds:.3g} s, checked in {self.check_seconds:.3g} s{lost}"
        )

    __repr__ = __str__
    _repr_html_ = drawn_by("notebook_pictures", "solution_html")
    plot: ClassVar[Plot] = figure_by("solutions", "draw_solution")
    _ipython_key_completions_ = key_completions


@argument_hints(
    method="engine=RungeKutta()",
    rtol="accuracy=1e-8",
    atol="accuracy=1e-8",
    tol="accuracy=1e-8",
    stop=STOP,
)
def solve_many(
    problem: Any,
    starts: Starts | None = None,
    t: Times | None = None,
    accuracy: float = 1e-10,
    engine: Engine | None = None,
    *,
    velocities: Starts | None = None,
    frame_velocities: Starts | None = None,
    check: int | None = None,
    progress: bool | None = None,
    executor: Executor | None = None,
) -> Ensemble:
    """Solve one problem from many starts at once.

    Members that leave their chart, and members with long steps whose finer run disagrees
    completely, are solved one by one, as by `solve`. The others run in optimised code: with
    Taylor() they differ from results of `solve` by rounding errors. Ctrl-C returns the finished
    members.

    Members with `stop=` or `When` end each at its own time: see `Ensemble.end`. A member whose
    answer and finer run are stopped by different conditions lacks accuracy.

    Parameters
    ----------
    problem
        the equations, and the defaults of the lists below.
    starts
        q^mu, shape (number, n); for first-order equations all states, shape (number, size), or a
        mapping from states and parameters to lists of numbers.
    t
        last time (only the end is kept), or times.
    accuracy
        as in `solve`, for every member that is verified.
    engine
        in double precision; None chooses Taylor() or RungeKutta(). Any other engine runs the
        motions one by one.
    velocities, frame_velocities
        (of curves) q'^mu or u^i, shape (number, n); None: the velocity of the problem for all.
    check
        number of members, evenly spread and at least one, that a second, finer run with the same
        steps verifies; None: all.
    progress
        show a bar; None: on a terminal, for long work.
    executor
        runs the members: a pool of `concurrent.futures`, or a `dask.distributed.Client`. The result
        has the same bits for any number of workers.

    Raises
    ------
    StartError, ShapeError, UnknownNameError
        lists of different length or shape, numbers that are not finite, unknown names, or a check
        of no members.
    AccuracyError
        the accuracy is not reached by all members that are verified; its `ensemble` has those
        that reach it, and the others as unfinished.
    WorkerError
        a worker ended without a result; its `partial` has the members that others finished.

    Examples
    --------
    >>> from geomtorsion.ode import ODE
    >>> swing = ODE.of({"x": "v", "v": "-k*x"}, [1, 0], parameters={"k": 1})
    >>> solve_many(swing, {"k": [1.0, 4.0]}, 1.0)["x"][:, -1].round(6).tolist()
    [0.540302, -0.416147]
    """
    checked_engine(engine)
    pool = checked_executor(executor)
    accuracy = checked_accuracy(accuracy)
    if t is None:
        raise TimeError("t: expected the last time or a list of times, got none.")
    times, grid = one_time_only(t, *checked_times(t))
    members = problem.members(starts, velocities, frame_velocities)
    number = len(members)
    sampled = number if check is None else checks.count(check, "check", StartError, 1)
    some = np.unique(np.linspace(0, number - 1, min(sampled, number)).astype(int))
    return _ensemble(problem, members, (times, grid), accuracy, engine, some, progress, pool)


def _ensemble(
    problem: Any,
    members: Members,
    when: tuple[np.ndarray, np.ndarray],
    accuracy: float,
    engine: Engine | None,
    some: np.ndarray,
    progress: bool | None,
    pool: Executor | None = None,
) -> Ensemble:
    """Members from their starts to their ends; when: times to report, and the grid from 0."""
    solver, reason = batch_engine(engine, problem.member(members, 0))
    times, grid = when
    number = len(members)
    job = _Job(problem, members, grid, solver, accuracy, pool)
    patience = 0.0 if progress else PATIENCE
    with bar(f"{number} members", number, wanted=progress, patience=patience) as show:
        lacking = job.run(some, show)
    ensemble = Ensemble(
        problem,
        times,
        job.errors,
        job.finished,
        job.interrupted,
        solver.name,
        reason,
        job.tolerance,
        job.compile_seconds,
        job.run_seconds,
        job.check_seconds,
        members,
        job.rows,
    )
    if job.failure is not None:
        raise WorkerError(unfinished_text(job.failure), partial=ensemble)
    if lacking:
        raise AccuracyError(lacking, ensemble)
    return ensemble


class _Job:
    """All members, with finer tolerances for those that need them.

    errors, states, finished, trajectories: of all members, as far as they are done.
    lacking, best: those whose error is not small enough, and the largest of these errors.
    reason: why the first member that does not reach the end does not.
    """

    def __init__(
        self,
        problem: Any,
        members: Members,
        grid: np.ndarray,
        engine: Engine,
        accuracy: float,
        executor: Executor | None = None,
    ) -> None:
        number, size = members.states.shape
        check_memory(len(grid), size, number)
        self.problem, self.members, self.grid = problem, members, grid
        self.engine, self.accuracy, self.executor = engine, accuracy, executor
        self.failure: Failure | None = None
        self.errors = np.full(number, np.nan)
        self.states = np.full((number, len(grid), size), np.nan)
        self.ends = Ends.none(number, size)
        self.finished = np.zeros(number, dtype=bool)
        self.trajectories: dict[int, Trajectory] = {}
        self.lacking: list[int] = []
        self.best, self.tolerance, self.interrupted, self.reason = 0.0, 0.0, False, ""
        self.compile_seconds = self.run_seconds = self.check_seconds = 0.0

    @property
    def rows(self) -> Rows:
        """The states of finished members."""
        return Rows(self.states, self.finished, self.ends, self.trajectories)

    def run(self, some: np.ndarray, show: Show) -> str:
        """Run all members and verify some of them; report the members that lack accuracy.

        Members that are not verified run at the finest tolerance that those needed which are.
        """
        try:
            if batch_method(self.engine) is None or self.members.are_separate:
                # One by one all members are verified.
                some = np.arange(len(self.members))
                self.tolerance = self.engine.first(AIM * self.accuracy)
                self._one_by_one(some, show)
            else:
                self._verify(some, show)
            rest = np.setdiff1d(np.arange(len(self.members)), some)
            if len(rest) and not (self.interrupted or self.lacking):
                answer = self._batch("run_seconds", rest, self.tolerance, show)
                self._keep(rest, answer, answer.finished, np.nan)
                if not self.interrupted:
                    self._one_by_one(rest[~answer.finished])
        except KeyboardInterrupt:
            self.interrupted = True
        if not (self.interrupted or self.lacking or self.finished.any()):
            raise StartError(
                "expected at least one of the checked motions to reach the last time, got none. "
                f"{self.reason}"
            )
        if not self.lacking or self.interrupted:
            return ""
        best = self.best
        got = f"gets to {best:.2g}" if np.isfinite(best) else "gives no two runs to compare"
        return (
            f"expected accuracy {self.accuracy:.3g}; {self.engine.name} {got} in double "
            f"precision. {listed(sorted(self.lacking))} Request less, or solve one by one with "
            "Taylor(precision=113)."
        )

    def _verify(self, pending: np.ndarray, show: Show) -> None:
        """Members with their errors: those that stay in the batch, then the others one by one."""
        grain = SAFETY * 2.0 ** (1 - self.engine.precision)
        limit = GOLDEN * abs(float(self.grid[-1])) / PARTS or math.inf
        separate, long, best = pending[:0], np.zeros(len(pending), dtype=bool), 0.0
        tolerance: float | None = self.engine.first(AIM * self.accuracy)
        first = tolerance
        while tolerance is not None and (finer := self.engine.finer(tolerance)) is not None:
            self.tolerance = tolerance
            answer = self._batch("run_seconds", pending, tolerance, show, counted=True)
            reference = self._batch(
                "check_seconds", pending, finer, None, np.full(len(pending), grain), limit
            )
            estimates = self._errors(pending, answer, reference)
            failed = tolerance != first
            self._add_roundings(pending, answer, tolerance, estimates, failed=failed)
            if self.interrupted:
                self._keep(pending, answer, answer.finished, estimates)
                return
            both = answer.finished & reference.finished
            done = both & (estimates <= self.accuracy)
            self._keep(pending, answer, done, estimates)
            separate = np.concatenate((separate, pending[~both]))
            left = both & ~done
            pending, estimates, long = pending[left], estimates[left], answer.longest[left] > limit
            # Only of those that are still too far off, for the message.
            best = float(estimates.max(initial=0.0))
            if not len(pending):
                break
            tolerance = next_tolerance(self.engine, tolerance, self.accuracy / best)
        # The finer run may see more than a long step: `verified_motion` cuts such a motion.
        self.lacking, self.best = pending[~long].tolist(), best
        self._one_by_one(np.concatenate((separate, pending[long])))

    def _batch(
        self,
        account: str,
        index: np.ndarray,
        tolerance: float,
        show: Show,
        parts: np.ndarray | None = None,
        longest: float = math.inf,
        *,
        counted: bool = False,
    ) -> BatchRows:
        """Some members at one tolerance, from starts that are changed by a part each."""
        began = time.perf_counter()
        members = self.members if len(index) == len(self.members) else self.members.of(index)
        if parts is not None:
            members = members.perturbed(parts)
        result = run_members(
            members, self.grid, tolerance, self.engine, show, longest, counted=counted,
            executor=self.executor,
        )  # fmt: skip
        self.compile_seconds += result.compile_seconds
        self.interrupted |= result.interrupted
        if result.failure is not None:
            self._fail(result.failure.reason, index[result.failure.members])
        spent = time.perf_counter() - began - result.compile_seconds
        setattr(self, account, getattr(self, account) + spent)
        return result

    def _add_roundings(
        self,
        pending: np.ndarray,
        answer: BatchRows,
        tolerance: float,
        errors: np.ndarray,
        *,
        failed: bool,
    ) -> None:
        """Raise errors to what roundings of all steps may add up to, as `verified` does."""
        engine = self.engine
        steps = answer.steps.astype(int).tolist()
        some = np.array([failed or roundings_matter(engine, n, tolerance, NOISE**2) for n in steps])
        some &= errors <= self.accuracy
        if not some.any():
            return
        parts = np.array([change_by_rounding(engine, steps[k]) for k in np.flatnonzero(some)])
        moved = self._batch("check_seconds", pending[some], tolerance, None, parts)
        errors[some] = np.fmax(
            errors[some], self._errors(pending[some], answer.of(some), moved) / SAFETY
        )

    def _keep(
        self, index: np.ndarray, answer: BatchRows, done: np.ndarray, errors: np.ndarray | float
    ) -> None:
        """Members of a batch that are done."""
        place = index[done]
        self.states[place], self.finished[place] = answer.states[done], True
        self.ends.put(place, answer.ends.of(done))
        self.errors[place] = np.broadcast_to(errors, done.shape)[done]

    def _fail(self, reason: str, members: np.ndarray) -> None:
        """A worker gave no result for some members: the others that are done are kept."""
        self.failure, self.interrupted = Failure(reason, members), True

    def _one_by_one(self, index: np.ndarray, show: Show = None) -> None:
        """Members that leave the batch, for another chart or for what steps passed over."""
        singles = (self.problem.member(self.members, k) for k in index.tolist())
        work = ((one, self.engine, self.accuracy, self.grid * one.time_unit) for one in singles)
        reasons = {}
        try:
            for done, (place, single) in enumerate(each_done(self.executor, followed, work), 1):
                if show is not None:
                    show(done)
                k = int(index[place])
                self.compile_seconds += single.compile_seconds
                self.check_seconds += single.check_seconds
                answer = single.answer
                if answer is not None:
                    self.run_seconds += answer.run_seconds
                    self.tolerance = min(self.tolerance, answer.tolerance)
                if answer is None or answer.outcome not in ("done", "stopped"):
                    # It does not reach the end, and has no error to wait for.
                    reasons[k] = f"Member {k}: {single.reason}"
                elif single.error > self.accuracy:
                    self.lacking.append(k)
                    self.best = max(self.best, single.error)
                else:
                    self._keep_single(k, answer, single.error)
        except WorkerError as error:
            self._fail(str(error), index[[error.part]])
        if reasons:
            self.reason = self.reason or reasons[min(reasons)]

    def _keep_single(self, k: int, answer: Trajectory, error: float) -> None:
        """A member that was followed singly."""
        self.finished[k], self.errors[k] = True, error
        unit = self.problem.member(self.members, k).time_unit
        if answer.outcome == "stopped":
            self.ends.stops[k] = self.problem.stop_texts.index(answer.reason)
            self.ends.times[k] = answer.reached / unit
        if set(answer.labels) == {self.members.label} and unit == self.members.units[k]:
            size = self.states.shape[2]
            blocks = [segment.states for segment in answer.segments]
            width = min(size, *(block.shape[1] for block in blocks))
            states = np.concatenate([block[:, :width] for block in blocks])
            self.states[k, : len(states), :width] = states
            if answer.outcome == "stopped":
                self.ends.states[k, :width] = answer.segments[-1].last[:width]
        else:
            self.trajectories[k] = answer

    def _errors(self, index: np.ndarray, answer: BatchRows, reference: BatchRows) -> np.ndarray:
        """The error of each member, group by group; not a number where it is not known."""
        worst = np.full(len(answer.finished), rounding(self.engine, 1))
        both = answer.finished & reference.finished
        # The end of each member is one more sample.
        here, there = (_with_ends(x) for x in (answer, reference))
        pairs = [(here[..., list(group)], there[..., list(group)]) for group in self.members.groups]
        pairs += self.problem.member_gaps(
            self.members.of(index),
            *(Rows(x, both, answer.ends) for x in (here, there)),
            self.accuracy,
        )
        with np.errstate(all="ignore"):
            for one, two in pairs:
                # A sample between the two stops of a member is in one of the runs only.
                seen = np.isfinite(one) & np.isfinite(two)
                size = np.abs(np.where(np.isfinite(one), one, 0.0)).max(axis=(1, 2))
                gap = np.abs(np.where(seen, one - two, 0.0)).max(axis=(1, 2))
                worst = np.fmax(worst, np.where(gap > 0, gap / size, gap))
            late = np.abs(answer.ends.times - reference.ends.times)
            worst = np.fmax(worst, np.where(late > 0, late / np.abs(answer.ends.times), 0.0))
        worst[answer.ends.stops != reference.ends.stops] = math.inf
        return np.where(both, SAFETY * worst, np.nan)


def _with_ends(run: BatchRows) -> np.ndarray:
    """States at all times, and at the stops of members that have one: (number, m + 1, size)."""
    lasts = np.where(run.ends.stopped[:, None], run.ends.states, run.states[:, -1])
    return np.concatenate((run.states, lasts[:, None, :]), axis=1)
