"""Stacked: members of a batch as one system, stepped by scipy's DOP853."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from geomtorsion.ode.ends import Ends
from geomtorsion.ode.engines.stepwise import (
    FLOOR,
    Pace,
    counted,
    error_scales,
    limited,
    paced_dop853,
)
from geomtorsion.ode.roots import bisected
from geomtorsion.ode.system import PER_STEP, Batch, System, WorkLimitError

# So many states make one system: larger ones leave the cache and set BLAS threads off. This decides
# about speed, not about results.
STACKED = 6144


def run_stacked(batch: Batch, tolerance: float, most: int) -> None:
    """Fill in the states at the end, which members reach it, and their steps.

    most: evaluations of the rates of one system; one that needs more has no members at the end.
    """
    number, size = batch.states.shape
    share = max(1, STACKED // size)
    for first in range(0, number, share):
        part = slice(first, min(first + share, number))
        with suppress(WorkLimitError):
            _run_part(batch, tolerance, part, most)
        arrived = np.isfinite(batch.result[part]).all(axis=(1, 2))
        batch.finished[part] = (arrived & ~batch.crossed[part]) | batch.ends.stopped[part]
        if batch.show is not None:
            batch.show(part.stop)


def _run_part(batch: Batch, tolerance: float, part: slice, most: int) -> None:
    """Some members as one system of scipy's DOP853; time in units of the fastest.

    Raises
    ------
    WorkLimitError
        It takes more evaluations of the rates than the limit.
    """
    system, times = batch.system, batch.times
    y0 = batch.states[part].T
    size, count = y0.shape
    top = float(batch.units[part].max())
    walk = _Walk(system, batch.units[part] / top, list(batch.parameters[part].T), y0)
    with np.errstate(all="ignore"):
        first = walk.rates(0.0, y0.ravel()).reshape(size, count)
        if not np.isfinite(first).all():
            return
        duration = float(times[-1]) * top
        scales = error_scales(system, y0, walk.numbers, first, duration)
        used = max(tolerance, FLOOR)
        options: dict[str, Any] = {"rtol": used, "atol": (used * scales).ravel()}
        longest: Callable[[float], float] = limited(batch.longest * top)
        if tolerance < FLOOR:
            trial = replace(walk)
            passed = trial.run(duration, most, limited(np.inf), options)
            if trial.complete:
                longest = Pace(passed, tolerance, FLOOR, batch.longest * top)
        samples = np.full((len(times), size, count), np.nan)
        passed = walk.run(duration, most, longest, options, times * top, samples)
    batch.crossed[part] |= walk.crossed
    if walk.complete:
        batch.result[part] = samples.transpose(2, 0, 1)
        batch.ends.put(part, replace(walk.ends, times=walk.ends.times / top))
    sizes = np.abs(np.diff(passed))
    batch.steps[:, part] = [[len(sizes)], [sizes.max(initial=0.0) / abs(duration)]]


@dataclass(eq=False)
class _Walk:
    """Members as one system from their starts on; a member rests where its guard has fallen.

    slow: rates of each member are multiplied by this, shape (count,). numbers: the parameters, each
    of shape (count,). start: shape (size, count). complete: whether the last time was reached.
    """

    system: System
    slow: np.ndarray
    numbers: list[np.ndarray]
    start: np.ndarray
    crossed: np.ndarray = field(init=False)
    ends: Ends = field(init=False)
    complete: bool = field(init=False, default=False)

    def __post_init__(self) -> None:
        size, count = self.start.shape
        self._moving = self.slow
        self.crossed, self.ends = np.zeros(count, dtype=bool), Ends.none(count, size)

    def rates(self, _: float, y: np.ndarray) -> np.ndarray:
        """Rates of all members in a row, in units of the fastest."""
        rates = self.system.array_function(*y.reshape(self.start.shape), *self.numbers)
        return (rates * self._moving).ravel()

    def run(
        self,
        duration: float,
        most: int,
        longest: Callable[[float], float],
        options: Mapping[str, Any],
        times: np.ndarray | None = None,
        samples: np.ndarray | None = None,
    ) -> list[float]:
        """Times of all steps; samples: filled in at the times, shape (m, size, count)."""
        solver = paced_dop853()(
            counted(self.rates, most, abs(duration)), 0.0, self.start.ravel(), duration,
            longest=longest, **options,
        )  # fmt: skip
        passed, done, sign = [0.0], 0, 1.0 if duration >= 0 else -1.0
        shape = self.start.shape
        if samples is not None:
            samples[0], done = self.start, 1
        while solver.status == "running":
            solver.step()
            if solver.status == "failed" or not np.isfinite(solver.y).all():
                return passed
            passed.append(float(solver.t))
            last = done
            if samples is not None and times is not None:
                last = int(np.searchsorted(sign * times, sign * solver.t, "right"))
            # Worked out before members are put to rest, which changes the state after the step.
            dense = solver.dense_output() if last > done or self.system.stops else None
            if self.system.guard is not None:
                self._watch(solver, dense)
            if samples is not None and times is not None and dense is not None and last > done:
                rows = dense(times[done:last]).T.reshape(-1, *shape)
                over = sign * times[done:last, None] > sign * self.ends.times
                samples[done:last] = np.where(over[:, None, :], np.nan, rows)
                done = last
        self.complete = True
        return passed

    def _watch(self, solver: Any, dense: Any) -> None:
        """Let members rest whose guard has fallen in the last step."""
        live = np.flatnonzero(~(self.crossed | self.ends.stopped))
        numbers = np.array([x[live] for x in self.numbers])
        guard = self.system.guard_along(solver.y.reshape(self.start.shape)[:, live], numbers)
        fell = np.broadcast_to(guard, live.shape) < 0
        rests = np.zeros(len(self.crossed), dtype=bool)
        if self.system.stops and len(live):
            self._stop(_Step(dense, self.start.shape), live, rests)
        # Members at an edge wait before it, where their rates have values.
        edges = live[fell & ~rests[live]]
        self.crossed[edges] = rests[edges] = True
        if rests.any():
            y = solver.y.reshape(self.start.shape).copy()
            y[:, edges] = solver.y_old.reshape(self.start.shape)[:, edges]
            stopped = rests & self.ends.stopped
            y[:, stopped] = self.ends.states[stopped].T
            self._moving = np.where(rests, 0.0, self._moving)
            solver.y = y.ravel()
            solver.f = solver.fun(solver.t, solver.y)

    def _stop(self, step: _Step, live: np.ndarray, rests: np.ndarray) -> None:
        """Find the first stop of each member within a step."""

        def room(member: np.ndarray, at: np.ndarray) -> np.ndarray:
            values = np.array([x[member] for x in self.numbers])
            return self.system.stops_along(step.at(member, at), values)

        places = step.begin + (step.end - step.begin) * np.arange(1, PER_STEP + 1) / PER_STEP
        below = np.array([room(live, np.full(len(live), at)) < 0 for at in places])
        first = np.where(below.any(axis=0), below.argmax(axis=0), PER_STEP)
        nearest = first.min(axis=0)
        some = np.flatnonzero(nearest < PER_STEP)
        if not len(some):
            return
        member, high = live[some], places[nearest[some]]
        low = np.concatenate(([step.begin], places))[nearest[some]]
        # If two conditions fall between two places, the earlier one counts.
        times = np.full((len(self.system.stops), len(some)), np.nan)
        for k in range(len(times)):
            now = first[k, some] == nearest[some]
            one = member[now]
            times[k, now] = bisected(
                lambda at, k=k, one=one: room(one, at)[k], low[now], high[now], np.ones(len(one))
            )
        sign = 1.0 if step.end >= step.begin else -1.0
        which = np.nanargmin(sign * times, axis=0)
        at = times[which, np.arange(len(some))]
        self.ends.put(member, Ends(which, at, step.at(member, at).T))
        rests[member] = True


class _Step:
    """Dense output of the last step of DOP853 for some members at a time each."""

    def __init__(self, dense: Any, shape: tuple[int, ...]) -> None:
        self.begin, self.end = float(dense.t_old), float(dense.t)
        self.before: np.ndarray = dense.y_old.reshape(shape)
        self._rows: np.ndarray = dense.F.reshape(-1, *shape)

    def at(self, member: np.ndarray, times: np.ndarray) -> np.ndarray:
        """States of members at a time each, shape (size, k)."""
        x = (times - self.begin) / (self.end - self.begin)
        total = np.zeros((self.before.shape[0], len(member)))
        for k, row in enumerate(self._rows[::-1]):
            total = (total + row[:, member]) * (x if k % 2 == 0 else 1 - x)
        return total + self.before[:, member]
