"""Event times: when something read off a solved motion crosses zero."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.codegen.arrays import BLOCK
from geomtorsion.errors import ExpressionError
from geomtorsion.ode.roots import crossings
from geomtorsion.ode.trajectory import close_times

if TYPE_CHECKING:
    from geomtorsion.ode.solution import Solution


def event_times(solution: Solution, term: object, direction: int = 0) -> np.ndarray:
    """Times at which a term crosses zero; see `Solution.event_times`."""
    read = solution.problem.term(term)

    def function(times: np.ndarray) -> np.ndarray:
        return np.broadcast_to(read(solution.at(times)), len(times))

    found = [np.zeros(0)]
    for times in _stretches(solution):
        blocks = range(0, len(times), BLOCK)
        values = np.concatenate([function(times[k : k + BLOCK]) for k in blocks])
        if not np.isfinite(values).all():
            raise ExpressionError(
                f"{term!r} has no finite value at {solution.problem.time_name} = "
                f"{times[~np.isfinite(values)][0]:.6g}."
            )
        found.append(crossings(function, times, values, direction))
    return np.concatenate(found)


def _stretches(solution: Solution) -> list[np.ndarray]:
    """Times close enough to see each crossing, for each stretch in which nothing jumps."""
    unit, breaks = solution.problem.time_unit, solution.problem.breaks()
    stretches: list[list[np.ndarray]] = []
    for segment in solution.trajectory.segments:
        begin, end = float(segment.stage.begin), float(segment.run.reached)
        if begin == end:
            continue
        times = close_times(begin, end, segment.run) / unit
        if stretches and begin / unit not in breaks:
            stretches[-1].append(times[1:])
        else:
            if stretches:
                # What is at the very time of a jump belongs to what comes after it.
                stretches[-1][-1][-1] = np.nextafter(times[0], stretches[-1][-1][-2])
            stretches.append([times])
    return [np.concatenate(parts) for parts in stretches]
