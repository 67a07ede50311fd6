"""Dense error: how wrong a solution is between its times."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.ode.asked import PARTS
from geomtorsion.ode.error_estimate import SAFETY, difference
from geomtorsion.ode.roots import GOLDEN
from geomtorsion.ode.trajectory import Trajectory

if TYPE_CHECKING:
    from geomtorsion.ode.solution import Solution

# So many places are looked at between each two times, at least.
LEAST = 3
# Where the first of them lies, in units of their distance: at the golden section, off the middle
# and off the ends.
SHIFT = 1 - GOLDEN


def error_between(solution: Solution) -> float:
    """The error of dense output, by the same rule as that at the times."""
    one, two = solution.trajectory, solution.reference
    if two is None:
        return float("inf")
    unit = solution.problem.time_unit
    reached = min(one.reached, two.reached, key=abs)
    knots = np.concatenate(([0.0], solution.times.astype(float) * unit))
    knots = np.unique(knots[np.abs(knots) <= abs(reached)])
    if len(knots) < 2:
        return solution.error
    count = max(LEAST, -(-PARTS // (len(knots) - 1)))
    parts = (np.arange(count) + SHIFT) / count
    times = (knots[:-1, None] + parts * np.diff(knots)[:, None]).ravel()
    gap = difference(solution.problem, _sampled(one, times), _sampled(two, times))
    return max(solution.error, SAFETY * gap)


def _sampled(trajectory: Trajectory, times: np.ndarray) -> Trajectory:
    """A trajectory with its dense output as samples."""
    order = times if trajectory.reached > 0 else times[::-1]
    segments = []
    for segment, states, index in trajectory.at(order):
        segments.append(segment.resampled(order[index], states))
    return Trajectory(trajectory.engine, trajectory.tolerance, tuple(segments), "done")
