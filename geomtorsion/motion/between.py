"""Between: how wrong a solution is between its times."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from geomtorsion.motion.reading import dense_pieces

if TYPE_CHECKING:
    from geomtorsion.motion.solution import Solution

# So many places are looked at in all, and so many at least between each two times.
PLACES, LEAST = 96, 3
# Where the first of them lies, in units of their distance: off the middle and off the ends.
SHIFT = 0.382


def error_between(solution: Solution) -> float:
    """The error of dense output, told by that of the other run as the error at the times is."""
    import numpy as np

    if solution.witness is None:
        return float("inf")
    sign = -1.0 if float(solution.times[-1]) < 0 else 1.0
    last = min(solution.journey.reached, sign * abs(solution.witness.reached), key=abs)
    knots = np.concatenate(([0.0], solution.times.astype(float)))
    knots = np.unique(knots[np.abs(knots) <= abs(last) / solution.problem.speed])
    if len(knots) < 2:
        return solution.error
    count = max(LEAST, -(-PLACES // (len(knots) - 1)))
    parts = (np.arange(count) + SHIFT) / count
    times = (knots[:-1, None] + parts * np.diff(knots)[:, None]).ravel()
    other = replace(solution, journey=solution.witness, against=None)
    one, two = (dense_pieces(x, times) for x in (solution, other))
    charts = {segment.chart for segment, _, _ in (*one, *two)}
    if len(charts) == len(one) == len(two) == 1:
        segment, states, _ = one[0]
        pairs = [(states, two[0][1], segment.equations.system.blocks)]
    else:
        pairs = _at_home(solution, other, times)
    worst = solution.error
    for first, second, blocks in pairs:
        first, second = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
        for block in blocks:
            index = list(block)
            size = float(np.abs(first[:, index]).max())
            gap = float(np.abs(first[:, index] - second[:, index]).max())
            if gap > 0:
                worst = max(worst, solution.share * gap / size if size else float("inf"))
    return worst


def _at_home(one: Solution, two: Solution, times: Any) -> list[tuple[Any, Any, Any]]:
    """Coordinates, velocities and passengers in the chart of the problem, whole turns taken out."""
    import numpy as np

    first, second = one.at(times), two.at(times)
    found = []
    for name in ("coordinates", "frame_velocity", "passengers"):
        x, y = getattr(first, name).astype(float), getattr(second, name).astype(float)
        if name == "coordinates":
            turns = np.round((y - x) / (2 * np.pi))
            y = np.where(turns != 0, y - 2 * np.pi * turns, y)
        if x.shape[1]:
            found.append((x, y, [range(x.shape[1])]))
    return found
