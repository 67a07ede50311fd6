"""Batch: many motions of equal equations at once, by one instruction or one stacked system."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
import scipy  # loads its parts when they are asked for

from geomtorsion.ode.engines import Engine, Taylor
from geomtorsion.ode.engines.stepwise import (
    FLOOR,
    Pace,
    error_scales,
    limited,
    paced_dop853,
)
from geomtorsion.ode.engines.taylor import Ready, heyoka
from geomtorsion.ode.system import STANDSTILL, System, member_units, scaled_system

# Called with the number of members that are done.
Show: TypeAlias = Callable[[float], None] | None
# How members are put together and looked at decides about speed, not about results: systems of at
# most so many states take two registers at a time;
FEW = 4
# after so many steps one looks which members still get anywhere;
MOST_STEPS = 20_000
# and so many states make one stacked Runge-Kutta system: larger ones leave the cache and set BLAS
# threads off.
STACKED = 6144


@dataclass(frozen=True, eq=False)
class BatchRun:
    """What the members of a batch came to.

    states: shape (number, times, size); not a number where a member is not finished.
    finished: shape (number,), which came to the end without meeting the guard.
    steps, longest: shape (number,), how many steps each took, and the longest of them as a part of
        the way; where they were counted.
    """

    states: np.ndarray
    finished: np.ndarray
    steps: np.ndarray
    longest: np.ndarray
    interrupted: bool = False
    compile_seconds: float = 0.0


def run_batch(
    engine: Engine,
    system: System,
    states: np.ndarray,
    parameters: np.ndarray,
    units: np.ndarray,
    pace: np.ndarray,
    times: np.ndarray,
    tolerance: float,
    show: Show = None,
    *,
    counted: bool = False,
    longest: float = math.inf,
) -> BatchRun:
    """All members through times that begin at 0.

    Parameters
    ----------
    states, parameters
        shapes (number, size) and (number, parameters).
    units
        by which the times of each member are multiplied, shape (number,).
    pace
        how fast members move, shape (number,): the like are put together, as those that share
        an instruction wait for the slowest.
    counted
        whether the steps are counted, which takes a microsecond a member.
    longest
        the longest step, in units of the times.
    """
    number, size = states.shape
    own = member_units(system, states, parameters, units * (times[-1] - times[0]))
    if own is not None:
        sizes, clocks = own
        columns = np.concatenate((parameters, sizes, clocks[:, None] / sizes), axis=1)
        found = run_batch(
            engine, scaled_system(system), states / sizes, columns, units / clocks, pace, times,
            tolerance, show, counted=counted, longest=longest,
        )  # fmt: skip
        return replace(found, states=found.states * sizes[:, None, :])
    result = np.full((number, len(times), size), np.nan)
    finished = np.zeros(number, dtype=bool)
    crossed = np.zeros(number, dtype=bool)
    steps = np.zeros((2, number))
    compiling, interrupted = 0.0, False
    try:
        if isinstance(engine, Taylor):
            width = int(heyoka().recommended_simd_size()) * (2 if size <= FEW else 1)
            backward = bool(times[-1] < times[0])
            kept, compiling = engine.compiled(system, tolerance, width=width, backward=backward)
            with kept.ready(parameters) as ready:
                calls = _calls(states, units, pace, times, width)
                watched = crossed if system.guard is not None else None
                noted = steps if counted else None
                limits = longest * units if longest < math.inf else None
                _by_heyoka(ready, calls, result, finished, watched, noted, show, limits)
        else:
            share = max(1, STACKED // size)
            for first in range(0, number, share):
                part = slice(first, min(first + share, number))
                numbers = (states, parameters, units, times, tolerance)
                _stacked(system, *numbers, part, result, crossed, steps, longest)
                finished[part] = np.isfinite(result[part]).all(axis=(1, 2))
                if show is not None:
                    show(part.stop)
    except KeyboardInterrupt:
        interrupted = True
    if system.guard is not None:
        with np.errstate(all="ignore"):
            guard = system.guard_along(np.moveaxis(result, 2, 0), parameters.T[:, :, None])
        crossed |= finished & (np.broadcast_to(guard, result.shape[:2]) < 0).any(axis=1)
    finished &= ~crossed
    result[~finished] = np.nan
    return BatchRun(result, finished, steps[0], steps[1], interrupted, compiling)


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


def _by_heyoka(
    ready: Ready,
    calls: _Calls,
    result: np.ndarray,
    finished: np.ndarray,
    crossed: np.ndarray | None,
    steps: np.ndarray | None,
    show: Show,
    limits: np.ndarray | None,
) -> None:
    """Fill in states of members that come to the end, which those are, and their steps."""
    index, (count, size, width) = calls.index, calls.states.shape
    integrator, chosen = ready.integrator, index.reshape(count, width)
    own, until = integrator.state, integrator.propagate_until
    ends, clocks = calls.times[-1], np.zeros((count, width))
    taken = np.zeros((count, width, 3))
    several = len(calls.times) > 2
    found = np.full((count, len(calls.times) if several else 1, size, width), np.nan)
    done = 0
    # Beyond a guard steps may become as small as they like; without one, motions go on to the end.
    most = MOST_STEPS if crossed is not None else ready.max_steps
    # Members whose guard has fallen in this call, for each output; heyoka keeps copies of its own.
    hits = [event.callback.members for event in integrator.nt_events] if crossed is not None else []
    try:
        for k in range(count):
            own[:] = calls.states[k]
            ready.choose(chosen[k])
            step = {} if limits is None else {"max_delta_t": limits[chosen[k]].tolist()}
            integrator.set_time(0.0)
            if several:
                block = np.ascontiguousarray(calls.times[:, k])
                rows = integrator.propagate_grid(block, max_steps=most, **step)[1]
                found[k, : len(rows)] = rows
            else:
                until(ends[k], max_steps=most, **step)
                if crossed is not None and (integrator.time != ends[k]).any():
                    _go_on(integrator, ends[k], hits, most, step)
                found[k, 0] = own
            # Of the last of several calls, whose members have taken many steps in any case.
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
        # Also after Ctrl-C: what is done is kept.
        arrived = (clocks == ends) & np.isfinite(found).all(axis=(1, 2))
        arrived[done:] = False
        good = arrived.reshape(-1)
        rows = found.transpose(0, 3, 1, 2).reshape(count * width, found.shape[1], -1)
        finished[index[good]] = True
        if steps is not None:
            # heyoka tells of no last step, which ends with the times, so of a single one nothing.
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
    """Go on until all members have arrived, have met the guard or get no further.

    most: steps between two looks; step: heyoka's option for the longest step.
    """
    moved = np.full(len(ends), True)
    while True:
        waiting = [
            member
            for member, result in enumerate(integrator.propagate_res)
            if result[0] == type(result[0]).step_limit
            and not any(member in members for members in crossed)
        ]
        if not moved[waiting].any():
            return
        before = integrator.time.copy()
        integrator.propagate_until(ends, max_steps=most, **step)
        moved = np.abs(integrator.time - before) > STANDSTILL * np.abs(ends)


def _stacked(
    system: System,
    states: np.ndarray,
    parameters: np.ndarray,
    units: np.ndarray,
    times: np.ndarray,
    tolerance: float,
    part: slice,
    result: np.ndarray,
    crossed: np.ndarray,
    steps: np.ndarray,
    longest: float,
) -> None:
    """Some members as one system of scipy's DOP853; time in units of the fastest."""
    y0 = states[part].T
    size, count = y0.shape
    top = float(units[part].max())
    slow = units[part] / top
    numbers = list(parameters[part].T)
    function = system.array_function

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        return (function(*y.reshape(size, count), *numbers) * slow).ravel()

    reached: list[float] = []

    def look(t: float, y: np.ndarray) -> float:
        # scipy calls this after each step; it never sees an event.
        reached.append(t)
        if system.guard is None:
            return 1.0
        guard = system.guard_along(y.reshape(size, count), numbers)
        crossed[part] |= np.broadcast_to(guard, count) < 0
        return 1.0

    with np.errstate(all="ignore"):
        first = rates(0.0, y0.ravel()).reshape(size, count)
        if not np.isfinite(first).all():
            return
        duration = float(times[-1]) * top
        scales = error_scales(system, y0, numbers, first, duration)
        used = max(tolerance, FLOOR)
        options: dict[str, Any] = {"rtol": used, "atol": (used * scales).ravel()}
        span, begin = (0.0, duration), y0.ravel()
        pace = limited(longest * top)
        if tolerance < FLOOR:
            trial = scipy.integrate.solve_ivp(rates, span, begin, "DOP853", **options)
            if trial.status == 0:
                pace = Pace(trial.t.tolist(), tolerance, FLOOR, longest * top)
        found = scipy.integrate.solve_ivp(
            rates, span, begin, paced_dop853(), t_eval=times * top, events=look, longest=pace,
            **options,
        )  # fmt: skip
    if found.status == 0 and np.isfinite(found.y).all():
        result[part] = found.y.reshape(size, count, len(times)).transpose(1, 2, 0)
    sizes = np.abs(np.diff(reached))
    steps[:, part] = [[len(sizes)], [sizes.max(initial=0.0) / abs(duration)]]
