"""Batch: many motions of equal equations at once, by one call of an engine."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from geomtorsion.errors import WorkerError
from geomtorsion.ode.ends import Ends
from geomtorsion.ode.engines.stacked import STACKED
from geomtorsion.ode.poles import may_be_at_poles
from geomtorsion.ode.system import (
    Batch,
    Engine,
    Show,
    System,
    columns,
    member_units,
    scaled_system,
)
from geomtorsion.support.executors import Executor, each_done


@dataclass(frozen=True, eq=False)
class BatchRun:
    """Result of a batch.

    states: shape (number, times, size); not a number where a member is not finished, and after its
        stop.
    finished: shape (number,), which came to the last time or a stop without leaving the batch.
    ends: of members that were stopped, in units of the times.
    steps, longest: shape (number,), how many steps each took, and the longest of them as a part of
        the way; where they were counted.
    """

    states: np.ndarray
    finished: np.ndarray
    ends: Ends
    steps: np.ndarray
    longest: np.ndarray
    interrupted: bool = False
    compile_seconds: float = 0.0
    failure: Failure | None = None


@dataclass(frozen=True, eq=False)
class Failure:
    """Why a worker gave no result, and the members of which: shape (k,)."""

    reason: str
    members: np.ndarray


def batch_method(engine: Engine) -> Callable[[Batch, float], float] | None:
    """How an engine runs many motions at once; None where it runs them one by one.

    Engines of users need not have the method.
    """
    return getattr(engine, "batch", None)


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
    executor: Executor | None = None,
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
    executor
        takes the members in parts of a size that does not depend on the number of its workers.
    """
    number, size = states.shape
    own = member_units(system, states, parameters, units * (times[-1] - times[0]))
    if own is not None:
        sizes, clocks = own
        columns = np.concatenate((parameters, sizes, clocks[:, None] / sizes), axis=1)
        scaled = run_batch(
            engine, scaled_system(system), states / sizes, columns, units / clocks, pace, times,
            tolerance, show, counted=counted, longest=longest, executor=executor,
        )  # fmt: skip
        ends = replace(scaled.ends, states=scaled.ends.states * sizes)
        return replace(scaled, states=scaled.states * sizes[:, None, :], ends=ends)
    ends = Ends.none(number, size)
    result = np.full((number, len(times), size), np.nan)
    finished, crossed = np.zeros((2, number), dtype=bool)
    steps, compiling, interrupted, failure = np.zeros((2, number)), 0.0, False, None
    # Members of one part share the steps of a method that stacks them.
    share = number if executor is None else max(1, STACKED // size)
    parts = [slice(first, min(first + share, number)) for first in range(0, number, share)]
    common = times, tolerance, counted, longest
    # Only this process has a bar.
    own = (show,) if executor is None else ()
    work = [
        (engine, system, states[x], parameters[x], units[x], pace[x], *common, *own) for x in parts
    ]
    done = 0
    try:
        for k, part in each_done(executor, _filled, work):
            place = parts[k]
            result[place], finished[place], crossed[place] = (
                part.states,
                part.finished,
                part.crossed,
            )
            steps[:, place] = part.steps
            ends.put(place, part.ends)
            compiling, interrupted = (
                max(compiling, part.compile_seconds),
                interrupted or part.interrupted,
            )
            done += place.stop - place.start
            if show is not None and executor is not None:
                show(done)
    except KeyboardInterrupt:
        interrupted = True
    except WorkerError as error:
        failure = Failure(str(error), np.arange(number)[parts[error.part]])
    if system.guard is not None:
        with np.errstate(all="ignore"):
            guard = system.guard_along(np.moveaxis(result, 2, 0), parameters.T[:, :, None])
        beyond = np.broadcast_to(guard, result.shape[:2]) < 0
        crossed |= finished & (beyond & np.isfinite(result).all(axis=2)).any(axis=1)
        crossed |= _stopped_early(system, states, parameters, ends, tolerance)
    # Members that end at a pole are followed one by one, as others that may not continue.
    last = np.where(ends.stopped, ends.times, times[-1])
    until = np.where(np.abs(times) < np.abs(last[:, None]), times, last[:, None])
    looked = np.where(np.isnan(result), ends.states[:, None, :], result)
    crossed |= finished & _meet_poles(system, looked, parameters, units[:, None] * until, steps[0])
    finished &= ~crossed
    result[~finished] = np.nan
    ends.put(~finished, Ends.none(int((~finished).sum()), size))
    taken, longest_taken = steps
    return BatchRun(result, finished, ends, taken, longest_taken, interrupted, compiling, failure)


def _stopped_early(
    system: System, starts: np.ndarray, parameters: np.ndarray, ends: Ends, tolerance: float
) -> np.ndarray:
    """Which members were stopped where their condition is far from zero, shape (number,).

    Truncated series that do not converge, such as of roots in long steps, can vanish anywhere.
    """
    early = np.zeros(len(starts), dtype=bool)
    index = np.flatnonzero(ends.stopped)
    if system.guard_is_entire or not len(index):
        return early
    here, before = (
        system.stops_along(rows[index].T, parameters[index].T) for rows in (ends.states, starts)
    )
    some = ends.stops[index], np.arange(len(index))
    early[index] = ~(np.abs(here[some]) <= tolerance * np.abs(before[some]))
    return early


def _meet_poles(
    system: System, states: np.ndarray, parameters: np.ndarray, elapsed: np.ndarray,
    steps: np.ndarray,
) -> np.ndarray:  # fmt: skip
    """Which members have a sample that may be at a pole of their rates, shape (number,).

    elapsed: time of each sample, shape (number, times).
    """
    number, count, size = states.shape
    elapsed = np.abs(elapsed).ravel()
    rows = columns([states.reshape(-1, size)], [])
    rows = np.concatenate((rows, np.repeat(parameters.T, count, axis=1)))
    near = may_be_at_poles(system, rows, elapsed, np.repeat(steps, count))
    return np.asarray(near.reshape(number, count).any(axis=1))


@dataclass(frozen=True, eq=False)
class _Part:
    """What an engine made of some members; interrupted: by Ctrl-C."""

    states: np.ndarray
    finished: np.ndarray
    crossed: np.ndarray
    steps: np.ndarray
    ends: Ends
    compile_seconds: float
    interrupted: bool


def _filled(
    engine: Engine,
    system: System,
    states: np.ndarray,
    parameters: np.ndarray,
    units: np.ndarray,
    pace: np.ndarray,
    times: np.ndarray,
    tolerance: float,
    counted: bool,
    longest: float,
    show: Show = None,
) -> _Part:
    """Some members, in this process; what Ctrl-C leaves is kept."""
    run = batch_method(engine)
    assert run is not None
    number, size = states.shape
    result = np.full((number, len(times), size), np.nan)
    finished, crossed = np.zeros((2, number), dtype=bool)
    batch = Batch(
        system, states, parameters, units, pace, times, show, counted, longest, result, finished,
        crossed, np.zeros((2, number)), Ends.none(number, size),
    )  # fmt: skip
    compiling, interrupted = 0.0, False
    try:
        compiling = run(batch, tolerance)
    except KeyboardInterrupt:
        interrupted = True
    return _Part(result, finished, crossed, batch.steps, batch.ends, compiling, interrupted)
