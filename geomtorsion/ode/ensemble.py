"""Ensemble: one problem from many starts at once, each member with its own error."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from geomtorsion.copies import only_fields
from geomtorsion.displays import drawn_by
from geomtorsion.errors import AccuracyError, GeomtorsionError, StartError, TimeError
from geomtorsion.ode.batch import Show
from geomtorsion.ode.engines import Engine, RungeKutta, Taylor
from geomtorsion.ode.engines.taylor import is_available
from geomtorsion.ode.error_estimate import (
    AIM,
    SAFETY,
    difference,
    next_tolerance,
    rounding,
)
from geomtorsion.ode.members import Members, Rows, run_members
from geomtorsion.ode.numbers import (
    check_memory,
    checked_accuracy,
    checked_engine,
    checked_times,
    one_time_only,
)
from geomtorsion.ode.trajectory import Trajectory, integrate
from geomtorsion.progress import PATIENCE, bar


@dataclass(frozen=True, eq=False)
class Ensemble:
    """Many solved motions of one problem.

    problem: what was solved, from many starts.
    times: shape (m,).
    errors: shape (number,), estimate of the largest relative error of each member, as in
        `Solution.error`; not a number for members that were not verified or not finished.
    finished: shape (number,), which members reached the last time.
    interrupted: whether it was stopped by Ctrl-C.
    engine, reason, tolerance: what solved them; the finest tolerance that was needed.
    compile_seconds, run_seconds, check_seconds: what it cost.

    Arrays by name, as `ensemble["x"]`, have shape (number, m) or (number, m, k); they are not a
    number where a member is not finished.

    Examples
    --------
    >>> import numpy as np
    >>> from geomtorsion.ode import ODE, solve_many
    >>> decay = ODE.of({"x": "-k*x"}, [1], parameters={"k": 1}, outputs={"half": "x/2"})
    >>> many = solve_many(decay, {"k": np.array([1.0, 2.0])}, 1.0)
    >>> many["half"][:, -1].round(6).tolist(), bool(many.error < 1e-10)
    ([0.18394, 0.067668], True)
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
        known = self.errors[np.isfinite(self.errors)]
        return float(known.max()) if len(known) else float("inf")

    @property
    def checked(self) -> int:
        """How many members were verified."""
        return int(np.isfinite(self.errors).sum())

    @property
    def unfinished(self) -> tuple[int, ...]:
        """Numbers of the members that did not reach the last time."""
        return tuple(np.flatnonzero(~self.finished).tolist())

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
        return self.values[name]

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
        """Member -> trajectory, for those that were followed singly, through other charts."""
        return self.rows.trajectories

    def __str__(self) -> str:
        done = int(self.finished.sum())
        rate = done / self.run_seconds if self.run_seconds else 0.0
        lost = "; " + _listed(self.unfinished, "not finished:") if self.unfinished else ""
        return (
            f"{done} of {len(self)} motions by {self.engine} ({self.reason}), "
            f"error below {self.error:.2g} in the {self.checked} of them that were verified; "
            f"{self.run_seconds:.3g} s ({rate:.3g} per second), "
            f"compiled in {self.compile_seconds:.3g} s, checked in {self.check_seconds:.3g} s{lost}"
        )

    __repr__ = __str__
    _repr_html_ = drawn_by("notebook_pictures", "solution_html")


def solve_many(
    problem: Any,
    starts: Any = None,
    t: Any = None,
    accuracy: float = 1e-10,
    engine: Engine | None = None,
    *,
    velocities: Any = None,
    frame_velocities: Any = None,
    check: int | None = None,
    progress: bool | None = None,
) -> Ensemble:
    """Solve one problem from many starts at once.

    Parameters
    ----------
    problem
        gives the equations and whatever the lists below leave out.
    starts
        q^mu, shape (number, n); for first-order equations all states, shape (number, size), or a
        mapping from states and parameters to lists of numbers.
    t
        last time (only the end is kept), or times.
    accuracy
        as in `solve`, for every member that is verified.
    engine
        Taylor() or RungeKutta(); None chooses.
    velocities, frame_velocities
        (of curves) q'^mu or u^i, shape (number, n); None: all with that of the problem.
    check
        how many members, evenly spread, are verified by a second, finer run; None: all.
    progress
        show a bar; None: on a terminal, for long work.

    Ctrl-C returns what is finished. Unlike `solve` this does not look for walls far ahead that
    steps pass over: where there may be some, solve a few members one by one.

    Raises
    ------
    StartError, ShapeError, UnknownNameError
        lists of different length or shape, numbers that are not finite, or unknown names.
    AccuracyError
        the accuracy is not reached by all members that are verified; its `ensemble` has those
        that reach it, and the others as unfinished.

    Examples
    --------
    >>> from geomtorsion.ode import ODE
    >>> swing = ODE.of({"x": "v", "v": "-k*x"}, [1, 0], parameters={"k": 1})
    >>> solve_many(swing, {"k": [1.0, 4.0]}, 1.0)["x"][:, -1].round(6).tolist()
    [0.540302, -0.416147]
    """
    checked_engine(engine)
    accuracy = checked_accuracy(accuracy)
    if t is None:
        raise TimeError("t was not given; give the last time, or a list of times.")
    times, grid = one_time_only(t, *checked_times(t))
    solver, reason = _engine(engine)
    members = problem.members(starts, velocities, frame_velocities)
    number = len(members)
    some = np.unique(np.linspace(0, number - 1, min(check or number, number)).astype(int))
    job = _Job(problem, members, grid, solver, accuracy)
    patience = 0.0 if progress else PATIENCE
    with bar(f"{number} members", number, wanted=progress, patience=patience) as show:
        errors, rows, tolerance, lacking = job.run(some, show)
    found = Ensemble(
        problem,
        times,
        errors,
        rows.finished,
        rows.interrupted,
        solver.name,
        reason,
        tolerance,
        job.compile_seconds,
        job.run_seconds,
        job.check_seconds,
        members,
        rows,
    )
    if lacking:
        raise AccuracyError(lacking, found)
    return found


def _engine(engine: Engine | None) -> tuple[Engine, str]:
    """The engine asked for, or the fastest at hand."""
    if engine is not None:
        if engine.precision != 53 or not isinstance(engine, Taylor | RungeKutta):
            raise AccuracyError(
                f"batches run in double precision by Taylor() or RungeKutta(); {engine.name} came."
            )
        return engine, "as asked"
    if is_available():
        return Taylor(), "heyoka is installed: several motions in one instruction"
    return RungeKutta(), "heyoka is not installed: motions stacked into one system"


class _Job:
    """All members, with finer tolerances for those that need them."""

    def __init__(
        self, problem: Any, members: Members, grid: np.ndarray, engine: Engine, accuracy: float
    ) -> None:
        self.problem, self.members, self.grid = problem, members, grid
        self.engine, self.accuracy = engine, accuracy
        self.compile_seconds = self.run_seconds = self.check_seconds = 0.0

    def run(self, some: np.ndarray, show: Show) -> tuple[np.ndarray, Rows, float, str]:
        """Errors, states, the finest tolerance, and what is said where accuracy is lacking.

        Members that are not verified run at the finest tolerance that those needed which are.
        """
        number = len(self.members)
        check_memory(len(self.grid), self.members.states.shape[1], number)
        errors = np.full(number, np.nan)
        states = np.full((number, len(self.grid), self.members.states.shape[1]), np.nan)
        finished = np.zeros(number, dtype=bool)
        trajectories: dict[int, Trajectory] = {}
        part = SAFETY * 2.0 ** (1 - self.engine.precision)
        pending, used, best, interrupted = some, 0.0, np.inf, False
        tolerance: float | None = self.engine.first(AIM * self.accuracy)
        while tolerance is not None and (finer := self.engine.finer(tolerance)) is not None:
            answer = self._timed("run_seconds", pending, tolerance, 0.0, show)
            reference = self._timed("check_seconds", pending, finer, part, None)
            used = tolerance
            found = self._errors(pending, answer, reference)
            interrupted = answer.interrupted or reference.interrupted
            done = answer.finished & (interrupted | ~(found > self.accuracy))
            # A member that does not reach the end has no error to wait for.
            lost = ~answer.finished & ~reference.finished
            place = pending[done]
            states[place], finished[place] = answer.states[done], True
            errors[place] = found[done]
            trajectories |= {k: x for k, x in answer.trajectories.items() if finished[k]}
            if interrupted:
                break
            pending = pending[~done & ~lost]
            if not len(pending):
                break
            best = float(np.nanmax(found[~done & ~lost]))
            tolerance = next_tolerance(self.engine, tolerance, self.accuracy / best)
        if len(some) == number and not finished.any() and not interrupted and not len(pending):
            raise StartError("none of the motions that were checked reaches the last time.")
        lacking = ""
        if len(pending) and not interrupted:
            got = f"gets to {best:.2g}" if np.isfinite(best) else "gives no two runs to compare"
            lacking = (
                f"accuracy {self.accuracy:.3g} was asked for; {self.engine.name} {got} in double "
                f"precision. {_listed(pending)} Ask for less, or solve one by one with "
                "Taylor(precision=113)."
            )
        rest = np.setdiff1d(np.arange(number), some)
        if len(rest) and not (interrupted or lacking):
            answer = self._timed("run_seconds", rest, used, 0.0, show)
            states[rest], finished[rest] = answer.states, answer.finished
            trajectories |= answer.trajectories
            interrupted = answer.interrupted
        rows = Rows(states, finished, trajectories, interrupted, self.compile_seconds)
        return errors, rows, used, lacking

    def _timed(
        self, account: str, index: np.ndarray, tolerance: float, part: float, show: Show
    ) -> Rows:
        began = time.perf_counter()
        found = self._attempt(index, tolerance, part, show)
        self.compile_seconds += found.compile_seconds
        spent = time.perf_counter() - began - found.compile_seconds
        setattr(self, account, getattr(self, account) + spent)
        return found

    def _attempt(self, index: np.ndarray, tolerance: float, part: float, show: Show) -> Rows:
        """Some members at one tolerance; those that leave the batch are followed singly."""
        members = self.members if len(index) == len(self.members) else self.members.of(index)
        if part:
            members = members.perturbed(part)
        rows = run_members(members, self.grid, tolerance, self.engine, show)
        trajectories: dict[int, Trajectory] = {}
        states, finished, seconds = rows.states, rows.finished.copy(), rows.compile_seconds
        interrupted = rows.interrupted
        try:
            for k in [] if interrupted else np.flatnonzero(~finished).tolist():
                own = int(index[k])
                try:
                    trajectory = self._single(own, tolerance, part)
                except GeomtorsionError:
                    continue
                seconds += trajectory.compile_seconds
                if trajectory.outcome != "done":
                    continue
                finished[k] = True
                if set(trajectory.labels) == {members.label}:
                    parts = [segment.states for segment in trajectory.segments]
                    states[k] = np.concatenate(parts)[:, : states.shape[2]]
                else:
                    trajectories[own] = trajectory
        except KeyboardInterrupt:
            interrupted = True
        return Rows(states, finished, trajectories, interrupted, seconds)

    def _single(self, k: int, tolerance: float, part: float) -> Trajectory:
        problem = self.problem.member(self.members, k)
        stage = problem.first_stage(self.engine.precision, part)
        return integrate(stage, self.grid * problem.time_unit, tolerance, self.engine)

    def _errors(self, index: np.ndarray, answer: Rows, reference: Rows) -> np.ndarray:
        """The error of each member, group of states by group; infinite where it is not known."""
        found = np.full(len(index), np.inf)
        worst = np.zeros(len(index))
        with np.errstate(all="ignore"):
            for group in self.members.groups:
                one, two = (x.states[..., list(group)] for x in (answer, reference))
                size, gap = (np.abs(x).max(axis=(1, 2)) for x in (one, one - two))
                worst = np.fmax(worst, np.where(gap > 0, gap / size, gap))
        both = answer.finished & reference.finished
        least = rounding(self.engine, 1)
        found[both] = SAFETY * np.maximum(worst[both], least)
        for k, own in enumerate(index.tolist()):
            one, two = (x.trajectories.get(own) for x in (answer, reference))
            if one is not None and two is not None:
                problem = self.problem.member(self.members, own)
                found[k] = SAFETY * max(difference(problem, one, two), least)
            elif one is not None or two is not None:
                # Only one of them went on in other coordinates, as they begin near an edge.
                found[k] = np.inf
        return found


def _listed(index: Sequence[int] | np.ndarray, what: str = "That is so for") -> str:
    """Which members these are, in a few words."""
    first = ", ".join(str(int(k)) for k in index[:5])
    more = f" and {len(index) - 5} more" if len(index) > 5 else ""
    return f"{what} member{'s' if len(index) > 1 else ''} {first}{more}."
