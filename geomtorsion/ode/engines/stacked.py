"""Stacked: members of a batch as one system, stepped by scipy's DOP853."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.ode.engines.stepwise import (
    FLOOR,
    Pace,
    counted,
    error_scales,
    limited,
    paced_dop853,
)
from geomtorsion.ode.system import Batch, WorkLimitError

# So many states make one system: larger ones leave the cache and set BLAS threads off. This decides
# about speed, not about results.
STACKED = 6144


def run_stacked(batch: Batch, tolerance: float, most: int) -> None:
    """Fill in states of members that come to the end, which those are, and their steps.

    most: evaluations of the rates of one system; one that needs more has no members at the end.
    """
    number, size = batch.states.shape
    share = max(1, STACKED // size)
    for first in range(0, number, share):
        part = slice(first, min(first + share, number))
        with suppress(WorkLimitError):
            _run_part(batch, tolerance, part, most)
        batch.finished[part] = np.isfinite(batch.result[part]).all(axis=(1, 2))
        if batch.show is not None:
            batch.show(part.stop)


def _run_part(batch: Batch, tolerance: float, part: slice, most: int) -> None:
    """Some members as one system of scipy's DOP853; time in units of the fastest.

    Raises
    ------
    WorkLimitError
        It takes more than so many evaluations of the rates.
    """
    system, units, times, crossed = batch.system, batch.units, batch.times, batch.crossed
    y0 = batch.states[part].T
    size, count = y0.shape
    top = float(units[part].max())
    slow = units[part] / top
    numbers = list(batch.parameters[part].T)
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
        longest = limited(batch.longest * top)
        if tolerance < FLOOR:
            trial = scipy.integrate.solve_ivp(
                counted(rates, most, abs(duration)), span, begin, "DOP853", **options
            )
            if trial.status == 0:
                longest = Pace(trial.t.tolist(), tolerance, FLOOR, batch.longest * top)
        solution = scipy.integrate.solve_ivp(
            counted(rates, most, abs(duration)), span, begin, paced_dop853(), t_eval=times * top,
            events=look, longest=longest,
            **options,
        )  # fmt: skip
    if solution.status == 0 and np.isfinite(solution.y).all():
        batch.result[part] = solution.y.reshape(size, count, len(times)).transpose(1, 2, 0)
    sizes = np.abs(np.diff(reached))
    batch.steps[:, part] = [[len(sizes)], [sizes.max(initial=0.0) / abs(duration)]]
