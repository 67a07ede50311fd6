"""Batch: many motions of equal equations at once, by one call of an engine."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from geomtorsion.ode.system import Batch, Engine, Show, System, member_units, scaled_system


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
        scaled = run_batch(
            engine, scaled_system(system), states / sizes, columns, units / clocks, pace, times,
            tolerance, show, counted=counted, longest=longest,
        )  # fmt: skip
        return replace(scaled, states=scaled.states * sizes[:, None, :])
    run = batch_method(engine)
    assert run is not None
    result = np.full((number, len(times), size), np.nan)
    finished, crossed = np.zeros((2, number), dtype=bool)
    batch = Batch(
        system, states, parameters, units, pace, times, show, counted, longest, result, finished,
        crossed, np.zeros((2, number)),
    )  # fmt: skip
    compiling, interrupted = 0.0, False
    try:
        compiling = run(batch, tolerance)
    except KeyboardInterrupt:
        interrupted = True
    if system.guard is not None:
        with np.errstate(all="ignore"):
            guard = system.guard_along(np.moveaxis(result, 2, 0), parameters.T[:, :, None])
        crossed |= finished & (np.broadcast_to(guard, result.shape[:2]) < 0).any(axis=1)
    finished &= ~crossed
    result[~finished] = np.nan
    taken, longest_taken = batch.steps
    return BatchRun(result, finished, taken, longest_taken, interrupted, compiling)
