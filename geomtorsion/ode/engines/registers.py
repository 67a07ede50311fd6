"""Registers: members of a batch by heyoka, several in one instruction."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from geomtorsion.ode.system import STANDSTILL, Batch

# How members are put together and looked at decides about speed, not about results: systems of at
# most so many states take two registers at a time;
FEW = 4
# after so many steps one looks which members still get anywhere.
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
    """Fill in states of members that come to the end, which those are, and their steps.

    integrator: heyoka's, for batches of `width`; choose: sets the numbers of some members in it.
    max_steps: of one run.
    """
    result, finished, show = batch.result, batch.finished, batch.show
    crossed = batch.crossed if batch.system.guard is not None else None
    steps = batch.steps if batch.counted else None
    calls = _calls(batch.states, batch.units, batch.pace, batch.times, width)
    index, (count, size, width) = calls.index, calls.states.shape
    chosen = index.reshape(count, width)
    own, until = integrator.state, integrator.propagate_until
    ends, clocks = calls.times[-1], np.zeros((count, width))
    taken = np.zeros((count, width, 3))
    several = len(calls.times) > 2
    samples = np.full((count, len(calls.times) if several else 1, size, width), np.nan)
    limits = batch.longest * batch.units if batch.longest < math.inf else None
    done = 0
    # Members whose guard has fallen in this call, for each output; heyoka keeps copies of its own.
    hits = [event.callback.members for event in integrator.nt_events] if crossed is not None else []
    try:
        for k in range(count):
            choose(chosen[k])
            own[:] = calls.states[k]
            integrator.set_time(0.0)
            step = {} if limits is None else {"max_delta_t": limits[chosen[k]].tolist()}
            if several:
                block = np.ascontiguousarray(calls.times[:, k])
                rows = integrator.propagate_grid(block, max_steps=MOST_STEPS, **step)[1]
                # Beyond a guard steps may become as small as they like. Without one, motions that
                # have got anywhere begin again and run to the end.
                if crossed is None and _moving(integrator, np.zeros(width), ends[k], []):
                    own[:] = calls.states[k]
                    integrator.set_time(0.0)
                    rows = integrator.propagate_grid(block, max_steps=max_steps, **step)[1]
                samples[k, : len(rows)] = rows
            else:
                until(ends[k], max_steps=MOST_STEPS, **step)
                _go_on(integrator, ends[k], hits, max_steps, step)
                samples[k, 0] = own
            # Only from the last of several calls, whose members have taken many steps anyway.
            if steps is not None:
                taken[k] = [one[1:4] for one in integrator.propagate_res]
            clocks[k] = integrator.time
            for members in hits:
                if members and crossed is not None:
                    crossed[index[k * width + np.array(sorted(members))]] = True
                    members.clear()
            done = k + 1
            if show is not None:
                show(min(done * width, len(result)))
    finally:
        # Also after Ctrl-C: finished members are kept.
        arrived = (clocks == ends) & np.isfinite(samples).all(axis=(1, 2))
        arrived[done:] = False
        good = arrived.reshape(-1)
        rows = samples.transpose(0, 3, 1, 2).reshape(count * width, samples.shape[1], -1)
        finished[index[good]] = True
        if steps is not None:
            # heyoka does not report the last step, and so nothing about a single step.
            least, longest, counts = np.abs(taken.reshape(-1, 3)[good]).T
            typical = np.sqrt(least, out=np.zeros(len(least)), where=counts > 1) * np.sqrt(longest)
            way = np.abs(ends.reshape(-1)[good])
            longest = np.maximum(longest, way - (counts - 1) * typical)
            steps[:, index[good]] = counts, np.divide(longest, way, out=way, where=way > 0)
        if several:
            result[index[good]] = rows[good]
        else:
            result[index[good], 0] = calls.starts[index[good]]
            result[index[good], -1] = rows[good, 0]


def _go_on(
    integrator: Any,
    ends: np.ndarray,
    crossed: list[set[int]],
    most: int,
    step: Mapping[str, object],
) -> None:
    """Go on until all members have arrived, have met the guard, get no further or took most steps.

    There is a look after each MOST_STEPS, of which some have been taken. step: heyoka's option for
    the longest step.
    """
    before = np.zeros(len(ends))
    for _ in range(most // MOST_STEPS):
        if not _moving(integrator, before, ends, crossed):
            return
        before = integrator.time.copy()
        integrator.propagate_until(ends, max_steps=MOST_STEPS, **step)


def _moving(integrator: Any, before: np.ndarray, ends: np.ndarray, crossed: list[set[int]]) -> bool:
    """Whether a member that ran out of steps has not met the guard and got further than before."""
    moved = np.abs(integrator.time - before) > STANDSTILL * np.abs(ends)
    return any(
        result[0] == type(result[0]).step_limit and moved[member]
        for member, result in enumerate(integrator.propagate_res)
        if not any(member in members for members in crossed)
    )
