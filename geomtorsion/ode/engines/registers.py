"""Registers: members of a batch by heyoka, several in one instruction."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from geomtorsion.ode.ends import Ends
from geomtorsion.ode.system import STANDSTILL, Batch

# The grouping of members changes speed, not results. Systems of at most this number of states use
# two registers at a time;
FEW = 4
# after this number of steps, members that no longer advance are searched.
MOST_STEPS = 20_000


@dataclass(frozen=True, eq=False)
class _Calls:
    """Members in calls of the integrator.

    index: shape (calls * width,); all others are blocks with the members last.
    """

    index: np.ndarray
    starts: np.ndarray
    states: np.ndarray
    times: np.ndarray


def _calls(
    states: np.ndarray,
    units: np.ndarray,
    pace: np.ndarray,
    times: np.ndarray,
    width: int,
) -> _Calls:
    """Members of like pace together, the last call filled up with the last member."""
    number = len(states)
    order = np.argsort(pace, kind="stable")
    count = -(-number // width)
    index = order[np.minimum(np.arange(count * width), number - 1)]
    blocks = _blocks(states[index], width)
    scaled = np.multiply.outer(times, units[index]).reshape(len(times), count, width)
    return _Calls(index, states, blocks, scaled)


def _blocks(array: np.ndarray, width: int) -> np.ndarray:
    """Rows of members as one contiguous block per call, members last."""
    blocks = array.reshape(len(array) // width, width, array.shape[1])
    return np.ascontiguousarray(blocks.swapaxes(1, 2))


def run_in_registers(
    integrator: Any,
    choose: Callable[[np.ndarray], object],
    batch: Batch,
    width: int,
    max_steps: int,
) -> None:
    """Fill in the states at the end, which members reach it, and their steps.

    integrator: heyoka's, for batches of `width`; choose: sets the numbers of some members in it.
    max_steps: of one run.
    """
    result, finished, show = batch.result, batch.finished, batch.show
    guarded = batch.system.guard is not None
    calls = _calls(batch.states, batch.units, batch.pace, batch.times, width)
    index, (count, size, width) = calls.index, calls.states.shape
    chosen = index.reshape(count, width)
    own, until = integrator.state, integrator.propagate_until
    ends, clocks = calls.times[-1], np.zeros((count, width))
    taken = np.zeros((count, width, 3))
    several = len(calls.times) > 2
    samples = np.full((count, len(calls.times) if several else 1, size, width), np.nan)
    limits = batch.longest * batch.units if batch.longest < math.inf else None
    met, lasts = np.full((count, width), -1), np.full((count, size, width), np.nan)
    done = 0
    try:
        for k in range(count):
            choose(chosen[k])
            own[:] = calls.states[k]
            integrator.set_time(0.0)
            step = {} if limits is None else {"max_delta_t": limits[chosen[k]].tolist()}
            if guarded:
                block = calls.times[:, k] if several else ends[k : k + 1]
                walk = _Walk(integrator, block, samples[k], met[k], lasts[k], taken[k])
                walk.run(max_steps, step)
            elif several:
                block = np.ascontiguousarray(calls.times[:, k])
                rows = integrator.propagate_grid(block, max_steps=MOST_STEPS, **step)[1]
                # Motions that have got anywhere begin again and run to the end.
                if _moving(integrator, np.zeros(width), ends[k]):
                    own[:] = calls.states[k]
                    integrator.set_time(0.0)
                    rows = integrator.propagate_grid(block, max_steps=max_steps, **step)[1]
                samples[k, : len(rows)] = rows
            else:
                until(ends[k], max_steps=MOST_STEPS, **step)
                _go_on(integrator, ends[k], max_steps, step)
                samples[k, 0] = own
            if batch.counted and not guarded:
                # Only from the last of several calls, whose members have taken many steps anyway.
                taken[k] = [one[1:4] for one in integrator.propagate_res]
            clocks[k] = integrator.time
            done = k + 1
            if show is not None:
                show(min(done * width, len(result)))
    finally:
        # Also after Ctrl-C: finished members are kept.
        arrived = (met < 0) & (clocks == ends) & np.isfinite(samples).all(axis=(1, 2))
        stops = np.isin(met, batch.system.stops)
        arrived[done:], stops[done:], met[done:] = False, False, -1
        rows = samples.transpose(0, 3, 1, 2).reshape(count * width, samples.shape[1], -1)
        last_rows, flat = lasts.transpose(0, 2, 1).reshape(count * width, size), met.reshape(-1)
        stopped = stops.reshape(-1) & np.isfinite(last_rows).all(axis=1)
        batch.crossed[index[(flat >= 0) & ~stopped]] = True
        good = arrived.reshape(-1) | stopped
        finished[index[good]] = True
        way, reached = np.abs(ends.reshape(-1)[good]), clocks.reshape(-1)
        if batch.counted:
            # heyoka does not report the last step, and so nothing about a single step.
            least, longest, counts = np.abs(taken.reshape(-1, 3)[good]).T
            typical = np.sqrt(least, out=np.zeros(len(least)), where=counts > 1) * np.sqrt(longest)
            longest = np.maximum(longest, np.abs(reached[good]) - (counts - 1) * typical)
            part = np.divide(longest, way, out=np.zeros(len(way)), where=way > 0)
            batch.steps[:, index[good]] = counts, part
        if several:
            result[index[good]] = rows[good]
        else:
            result[index[good], 0] = calls.starts[index[good]]
            result[index[good], -1] = rows[good, 0]
        if stopped.any():
            places = index[stopped]
            conditions = np.searchsorted(batch.system.stops, flat[stopped])
            times = reached[stopped] / batch.units[places]
            batch.ends.put(places, Ends(conditions, times, last_rows[stopped]))


@dataclass(frozen=True, eq=False)
class _Walk:
    """One call of an integrator whose members end, each by itself, where their guard falls.

    times: of each member, shape (m, width).
    samples, met, lasts, taken: filled in: states at the times, shape (m, size, width); which output
        of the guard a member has met, or -1; the state there; least and longest step and their
        number.
    """

    integrator: Any
    times: np.ndarray
    samples: np.ndarray
    met: np.ndarray
    lasts: np.ndarray
    taken: np.ndarray

    def run(self, most: int, step: Mapping[str, object]) -> None:
        """Run all members to their last time or their guard; step: heyoka's option."""
        integrator, several = self.integrator, len(self.times) > 1
        integrator.reset_cooldowns()
        goals, start = self.times[-1].copy(), integrator.state.copy()
        if several:
            # At the start, which no step contains.
            self.samples[0] = start
        looked = np.zeros(len(goals))
        left = most // MOST_STEPS
        while True:
            before = integrator.time.copy()
            out = integrator.propagate_until(goals, max_steps=MOST_STEPS, c_output=several, **step)
            self._count()
            lost = self._rest(goals, start)
            now = integrator.time
            if several and out[0] is not None:
                self._sample(out[0], before)
            codes = [int(one[0]) for one in integrator.propagate_res]
            fell = [m for m, code in enumerate(codes) if -(2**32) < code < 0 and self.met[m] < 0]
            for member in fell:
                self.met[member] = -1 - codes[member]
                self.lasts[:, member] = integrator.state[:, member]
                goals[member] = now[member]
            if fell or lost:
                continue
            left -= 1
            if left <= 0 or not _moving(integrator, looked, goals):
                break
            looked = now.copy()
        if not several:
            self.samples[0] = np.where(self.met < 0, integrator.state, np.nan)

    def _rest(self, goals: np.ndarray, start: np.ndarray) -> bool:
        """Put members without numbers back to their start, where they rest; whether there are any.

        Else they would end the call for all others.
        """
        integrator = self.integrator
        bad = ~(np.isfinite(integrator.time) & np.isfinite(integrator.state).all(axis=0))
        bad &= goals != 0
        if bad.any():
            integrator.set_time(np.where(bad, 0.0, integrator.time))
            integrator.state[:, bad] = start[:, bad]
            goals[bad] = 0.0
        return bool(bad.any())

    def _count(self) -> None:
        """Add the steps of one call."""
        rows = np.array([one[1:4] for one in self.integrator.propagate_res])
        least, longest, counts = np.abs(rows).T
        here = counts > 0
        own = self.taken
        first = here & (own[:, 2] == 0)
        own[:, 0] = np.where(first, least, np.where(here, np.minimum(own[:, 0], least), own[:, 0]))
        own[:, 1] = np.where(here, np.maximum(own[:, 1], longest), own[:, 1])
        own[:, 2] += counts

    def _sample(self, dense: Any, before: np.ndarray) -> None:
        """States at the times that one call has passed."""
        now = self.integrator.time
        low, high = np.minimum(before, now), np.maximum(before, now)
        inside = (self.times >= low) & (self.times <= high) & (self.times != before)
        rows = np.flatnonzero(inside.any(axis=1))
        if not len(rows):
            return
        states = dense(np.ascontiguousarray(np.clip(self.times[rows], low, high)))
        states = np.where((self.times[rows] == now)[:, None, :], self.integrator.state, states)
        self.samples[rows] = np.where(inside[rows][:, None, :], states, self.samples[rows])


def _go_on(
    integrator: Any,
    ends: np.ndarray,
    most: int,
    step: Mapping[str, object],
) -> None:
    """Continue until each member has arrived, no longer advances or took the most steps.

    Members are checked after each MOST_STEPS; steps taken before count. step: heyoka's option for
    the longest step.
    """
    before = np.zeros(len(ends))
    for _ in range(most // MOST_STEPS):
        if not _moving(integrator, before, ends):
            return
        before = integrator.time.copy()
        integrator.propagate_until(ends, max_steps=MOST_STEPS, **step)


def _moving(integrator: Any, before: np.ndarray, ends: np.ndarray) -> bool:
    """Whether a member that ran out of steps got further than before."""
    moved = np.abs(integrator.time - before) > STANDSTILL * np.abs(ends)
    return any(
        result[0] == type(result[0]).step_limit and moved[member]
        for member, result in enumerate(integrator.propagate_res)
    )
