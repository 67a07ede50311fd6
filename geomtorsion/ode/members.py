"""Members: many motions of equal equations, run together from event to event."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from geomtorsion.ode.batch import Failure, run_batch
from geomtorsion.ode.ends import Ends
from geomtorsion.ode.engines import Engine
from geomtorsion.ode.system import Show, System
from geomtorsion.ode.trajectory import Trajectory
from geomtorsion.support.copies import only_fields
from geomtorsion.support.executors import Executor
from geomtorsion.support.precision import GOLDEN


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
    are_separate: whether they have to be followed one by one.
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
    are_separate: bool = False

    def __getstate__(self) -> Mapping[str, object]:
        # The next stage was determined when they were run.
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

    states: shape (number, times, size), not a number for members that were followed singly, and
        after the stop of a member.
    ends: of members that were stopped.
    finished: shape (number,); trajectories: member -> what it was followed by singly.
    """

    states: np.ndarray
    finished: np.ndarray
    ends: Ends
    trajectories: Mapping[int, Trajectory] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class BatchRows:
    """Rows of members that stay together, by one tolerance.

    steps, longest: shape (number,), how many steps each took and the longest of them in time, where
        they were counted.
    """

    states: np.ndarray
    finished: np.ndarray
    ends: Ends
    steps: np.ndarray
    longest: np.ndarray
    interrupted: bool = False
    compile_seconds: float = 0.0
    failure: Failure | None = None

    def of(self, which: np.ndarray) -> BatchRows:
        """Some of the members."""
        rows = self.states[which], self.finished[which], self.ends.of(which)
        steps = self.steps[which], self.longest[which]
        return BatchRows(*rows, *steps, self.interrupted, self.compile_seconds, self.failure)


def run_members(
    members: Members,
    grid: np.ndarray,
    tolerance: float,
    engine: Engine,
    show: Show,
    longest: float = math.inf,
    *,
    counted: bool = False,
    executor: Executor | None = None,
) -> BatchRows:
    """All members through a grid of times, from event to event.

    longest, counted, executor: see `run_batch`.
    """
    size, number = members.states.shape[1], len(members)
    states = np.full((number, len(grid), size), np.nan)
    finished, compiling = np.zeros(number, dtype=bool), 0.0
    ends = Ends.none(number, size)
    steps, longest_steps = np.zeros(number), np.zeros(number)
    end = float(grid[-1])
    sign = -1.0 if end < 0 else 1.0
    # The members that are still on their way.
    left = np.arange(number)
    while True:
        until = members.until
        # A motion backwards never comes to a change at a later time.
        final = until is None or not sign * members.begin <= sign * until < sign * end
        stop = end if final or until is None else until
        inside = sign * grid >= sign * members.begin
        if not final:
            inside &= sign * grid < sign * stop
        local = grid[inside] - members.begin
        times = np.unique(np.concatenate(([0.0], local, [stop - members.begin])))
        times = times if sign > 0 else times[::-1]
        run = run_batch(
            engine, members.system, members.states, members.parameters, members.units,
            members.pace, times, tolerance, show, counted=counted, longest=longest,
            executor=executor,
        )  # fmt: skip
        compiling += run.compile_seconds
        steps[left] += run.steps
        longest_steps[left] = np.maximum(longest_steps[left], run.longest * abs(times[-1]))
        place = np.searchsorted(np.abs(times), np.abs(local))
        states[np.ix_(left, inside)] = run.states[:, place]
        ended = run.ends.stopped
        later = replace(run.ends.of(ended), times=run.ends.times[ended] + members.begin)
        ends.put(left[ended], later)
        finished[left[ended]] = True
        failure = run.failure
        if failure is not None:
            failure = replace(failure, members=left[failure.members])
        if run.interrupted or failure or final or members.follow is None:
            finished[left] |= run.finished & final
            break
        on = np.flatnonzero(run.finished & ~ended)
        lasts = run.states[:, -1]
        members, left, lasts = members.follow(lasts).of(on), left[on], lasts[on]
        ended = _stopped_by_a_change(members)
        if ended.any():
            times = np.full(int(ended.sum()), members.begin)
            ends.put(left[ended], Ends(np.zeros(len(times), dtype=int), times, lasts[ended]))
            finished[left[ended]] = True
            members, left = members.of(np.flatnonzero(~ended)), left[~ended]
        if not len(left):
            break
    states[~finished] = np.nan
    ends.put(~finished, Ends.none(int((~finished).sum()), size))
    return BatchRows(
        states, finished, ends, steps, longest_steps, run.interrupted, compiling, failure
    )


def _stopped_by_a_change(members: Members) -> np.ndarray:
    """Which members a change at a time has carried beyond their stop, shape (number,)."""
    system = members.system
    if not (system.stops and len(members)):
        return np.zeros(len(members), dtype=bool)
    return np.any(system.stops_along(members.states.T, members.parameters.T) < 0, axis=0)
