"""Members: many motions of equal equations, run together from event to event."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from geomtorsion.copies import only_fields
from geomtorsion.ode.batch import Show, run_batch
from geomtorsion.ode.engines import Engine
from geomtorsion.ode.system import System
from geomtorsion.ode.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class Members:
    """Many motions of equal equations in one set of coordinates, up to their next event.

    system: their equations; groups: indices of states that are measured together.
    states, parameters: shapes (number, size) and (number, parameters).
    units: trajectories count time in units of 1/unit, shape (number,).
    pace: how fast they move, shape (number,).
    begin, until: times between which this holds; until None: to the end.
    follow: (states, shape (number, size)) -> the members after that.
    parts: members -> parts that run by equations of their own; None: all run by these.
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
    parts: Callable[[Members], Iterator[Part]] | None = None
    label: str = ""
    varied: Mapping[str, np.ndarray] = field(default_factory=dict)

    def __getstate__(self) -> Mapping[str, object]:
        # What comes after was asked when they were run.
        return only_fields(self) | {"follow": None, "parts": None}

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

    def perturbed(self, part: float) -> Members:
        """The same from starts that are changed by a relative part, up and down in turn."""
        signs = np.where(np.arange(self.states.shape[1]) % 2, -part, part)
        return replace(self, states=self.states * (1 + signs))


@dataclass(frozen=True, eq=False)
class Part:
    """Members that run by equations of their own.

    index: which members; system, states, parameters: as in `Members`.
    lift: states of shape (number, times, size) -> those of the members.
    """

    index: np.ndarray
    system: System
    states: np.ndarray
    parameters: np.ndarray
    lift: Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True, eq=False)
class Rows:
    """States of members at all times of a grid, by one tolerance.

    states: shape (number, times, size), not a number for members that were followed singly.
    finished: shape (number,); trajectories: member -> what it was followed by singly.
    """

    states: np.ndarray
    finished: np.ndarray
    trajectories: Mapping[int, Trajectory] = field(default_factory=dict)
    interrupted: bool = False
    compile_seconds: float = 0.0


def run_members(
    members: Members, grid: np.ndarray, tolerance: float, engine: Engine, show: Show
) -> Rows:
    """All members through a grid of times, from event to event."""
    size, number = members.states.shape[1], len(members)
    states = np.full((number, len(grid), size), np.nan)
    finished, compiling = np.ones(number, dtype=bool), 0.0
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
        run = _run_parts(members, times, tolerance, engine, show)
        compiling += run.compile_seconds
        finished &= run.finished
        place = np.searchsorted(np.abs(times), np.abs(local))
        states[:, inside] = run.states[:, place]
        if run.interrupted or final or members.follow is None:
            states[~finished] = np.nan
            return Rows(states, finished & final, {}, run.interrupted, compiling)
        members = members.follow(run.states[:, -1])


def _run_parts(
    members: Members, times: np.ndarray, tolerance: float, engine: Engine, show: Show
) -> Rows:
    """All members up to their next event, each part by its own equations."""
    if members.parts is None:
        run = run_batch(
            engine, members.system, members.states, members.parameters, members.units,
            members.pace, times, tolerance, show,
        )  # fmt: skip
        return Rows(run.states, run.finished, {}, run.interrupted, run.compile_seconds)
    states = np.full((len(members), len(times), members.states.shape[1]), np.nan)
    finished, compiling, interrupted = np.zeros(len(members), dtype=bool), 0.0, False
    for part in members.parts(members):
        run = run_batch(
            engine, part.system, part.states, part.parameters, members.units[part.index],
            members.pace[part.index], times, tolerance, show,
        )  # fmt: skip
        with np.errstate(all="ignore"):
            states[part.index] = part.lift(run.states)
        finished[part.index] = run.finished
        compiling += run.compile_seconds
        if run.interrupted:
            interrupted = True
            break
    return Rows(states, finished, {}, interrupted, compiling)
