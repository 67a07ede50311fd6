"""Members: many motions of equal equations, run together from event to event."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from geomtorsion.copies import only_fields
from geomtorsion.ode.batch import BatchRun, run_batch
from geomtorsion.ode.engines import Engine
from geomtorsion.ode.engines.stacked import STACKED
from geomtorsion.ode.error_estimate import rounding_on
from geomtorsion.ode.numbers import PARTS, checked_times
from geomtorsion.ode.passed_over import is_long, left_by_members, with_samples_before
from geomtorsion.ode.system import Show, System
from geomtorsion.ode.trajectory import Trajectory
from geomtorsion.precision import GOLDEN


@dataclass(frozen=True, eq=False)
class Members:
    """Many motions of equal equations in one set of coordinates, up to their next event.

    system: their equations; groups: indices of states that are measured together.
    states, parameters: shapes (number, size) and (number, parameters).
    units: trajectories count time in units of 1/unit, shape (number,).
    pace: how fast they move, shape (number,).
    begin, until: times between which this holds; until None: to the end.
    follow: (states, shape (number, size)) -> the members after that.
    label: name of the coordinates.
    varied: parameter -> its value for each member, for those that differ.
    """

    system: System
    groups: tuple[tuple[int, ...], ...]
    states: np.ndarray
    parameters: np.ndarray
    units: np.ndarray
    pace: np.ndarray
    begin: float = 0.0
    until: float | None = None
    follow: Callable[[np.ndarray], Members] | None = None
    label: str = ""
    varied: Mapping[str, np.ndarray] = field(default_factory=dict)

    def __getstate__(self) -> Mapping[str, object]:
        # What comes after was asked when they were run.
        return only_fields(self) | {"follow": None}

    def __len__(self) -> int:
        return len(self.states)

    def of(self, index: np.ndarray) -> Members:
        """Some of the members."""
        after = self.follow

        def follow(states: np.ndarray) -> Members:
            assert after is not None
            every = np.full(self.states.shape, np.nan)
            every[index, : states.shape[1]] = states
            return after(every).of(index)

        return replace(
            self,
            states=self.states[index],
            parameters=self.parameters[index],
            units=self.units[index],
            pace=self.pace[index],
            follow=None if after is None else follow,
            varied={name: value[index] for name, value in self.varied.items()},
        )

    def perturbed(self, parts: np.ndarray) -> Members:
        """Members whose starts are changed by a relative part each, shape (number,).

        Up and down as in `numbers.perturbed`.
        """
        signs = np.where(np.arange(self.states.shape[1]) % 2, -GOLDEN, 1.0)
        return replace(self, states=self.states * (1 + np.multiply.outer(parts, signs)))


@dataclass(frozen=True, eq=False)
class Rows:
    """States of members at all times of a grid.

    states: shape (number, times, size), not a number for members that were followed singly.
    finished: shape (number,); trajectories: member -> what it was followed by singly.
    """

    states: np.ndarray
    finished: np.ndarray
    trajectories: Mapping[int, Trajectory] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class BatchRows:
    """The same of members that stay together, by one tolerance.

    left: shape (number,), errors that a finer run shares: by roundings of the rates, and by what
        steps passed over; infinite where they may have.
    steps: shape (number,), where they were counted.
    """

    states: np.ndarray
    finished: np.ndarray
    left: np.ndarray
    steps: np.ndarray
    interrupted: bool = False
    compile_seconds: float = 0.0

    def of(self, which: np.ndarray) -> BatchRows:
        """Some of the members."""
        rows = self.states[which], self.finished[which], self.left[which], self.steps[which]
        return BatchRows(*rows, self.interrupted, self.compile_seconds)


def run_members(
    members: Members,
    grid: np.ndarray,
    tolerance: float,
    engine: Engine,
    show: Show,
    accuracy: float | None = None,
) -> BatchRows:
    """All members through a grid of times, from event to event.

    accuracy: for which to look for errors that a finer run would share; None: not to look.
    """
    size, number = members.states.shape[1], len(members)
    states = np.full((number, len(grid), size), np.nan)
    finished, compiling = np.ones(number, dtype=bool), 0.0
    left, steps = np.zeros(number), np.zeros(number)
    end = float(grid[-1])
    sign = -1.0 if end < 0 else 1.0
    while True:
        until = members.until
        final = until is None or sign * until >= sign * end
        stop = end if final or until is None else until
        inside = sign * grid >= sign * members.begin
        if not final:
            inside &= sign * grid < sign * stop
        local = grid[inside] - members.begin
        times = np.unique(np.concatenate(([0.0], local, [stop - members.begin])))
        times = times if sign > 0 else times[::-1]
        run = _run_to_event(members, times, tolerance, engine, show, accuracy)
        compiling += run.compile_seconds
        finished &= run.finished
        left += run.left
        steps += run.steps
        place = np.searchsorted(np.abs(times), np.abs(local))
        states[:, inside] = run.states[:, place]
        if run.interrupted or final or members.follow is None:
            states[~finished] = np.nan
            return BatchRows(states, finished & final, left, steps, run.interrupted, compiling)
        members = members.follow(run.states[:, -1])


def _run_to_event(
    members: Members,
    times: np.ndarray,
    tolerance: float,
    engine: Engine,
    show: Show,
    accuracy: float | None,
) -> BatchRows:
    """All members up to their next event."""
    run = run_batch(
        engine, members.system, members.states, members.parameters, members.units, members.pace,
        times, tolerance, show, counted=accuracy is not None,
    )  # fmt: skip
    left, interrupted = np.zeros(len(members)), run.interrupted
    if accuracy is not None and not interrupted:
        errors, interrupted = _left(members, run, times, tolerance, engine, accuracy)
        left = errors + _rounding(members, run, times, engine)
    return BatchRows(run.states, run.finished, left, run.steps, interrupted, run.compile_seconds)


def _left(
    members: Members,
    run: BatchRun,
    times: np.ndarray,
    tolerance: float,
    engine: Engine,
    accuracy: float,
) -> tuple[np.ndarray, bool]:
    """Errors by what steps passed over, infinite where that is not small; whether it was stopped.

    Members with steps that may have are run again, with more samples; those that seem to have, once
    more with samples just before these.
    """
    system, units, last = members.system, members.units, float(times[-1])
    left = np.zeros(len(units))
    if not last:
        return left, False
    seen = times
    if len(times) <= PARTS:
        seen = np.union1d(times, checked_times(last)[1])
        seen = seen if last > 0 else seen[::-1]
    left[run.finished & is_long(run.longest, run.steps)] = np.inf
    share = max(1, STACKED // system.size)
    for grid in (seen, with_samples_before(seen)):
        some = np.flatnonzero(np.isinf(left))
        for index in (some[first : first + share] for first in range(0, len(some), share)):
            own = members.parameters[index]
            again = run_batch(
                engine, system, members.states[index], own, units[index], members.pace[index],
                grid, tolerance,
            )  # fmt: skip
            if again.interrupted:
                return left, True
            columns = _columns(again.states, own)
            clocks = np.multiply.outer(units[index], grid)
            longest = run.longest[index] * np.abs(clocks[:, -1])
            with np.errstate(all="ignore"):
                left[index] = left_by_members(
                    system, columns, clocks, longest, accuracy, before=grid is not seen
                )
    return left, False


def _rounding(members: Members, run: BatchRun, times: np.ndarray, engine: Engine) -> np.ndarray:
    """Errors by roundings of the rates that all runs share."""
    shared = run.finished & (engine.follows_rounding | (run.steps <= 2))
    found = np.zeros(len(members))
    if shared.any():
        lasts = np.abs(times[-1] * members.units[shared])
        columns = _columns(run.states[shared], members.parameters[shared])
        found[shared] = rounding_on(
            members.system, columns, lasts, np.maximum(run.steps[shared], 1), engine
        )
    return found


def _columns(states: np.ndarray, parameters: np.ndarray) -> np.ndarray:
    """States above parameters, shape (size + parameters, number, times)."""
    wide = np.broadcast_to(parameters.T[:, :, None], (parameters.shape[1], *states.shape[:2]))
    return np.concatenate((np.moveaxis(states, 2, 0), wide))
