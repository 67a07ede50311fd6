"""Changes: when conditions changed a motion, and by how much two motions differ in that."""

from __future__ import annotations

import numpy as np

from geomtorsion.ode.trajectory import Trajectory


def time_gaps(one: Trajectory, two: Trajectory) -> float:
    """Largest difference of the times at which conditions changed two motions, of all its time.

    A change that happened in one of them only counts up to the end of the other.
    """
    first, second = change_times(one), change_times(two)
    if not (first or second):
        return 0.0
    number = max(len(first), len(second))
    first += [one.reached] * (number - len(first))
    second += [two.reached] * (number - len(second))
    return max(map(abs, map(float.__sub__, first, second))) / abs(one.reached)


def change_times(one: Trajectory) -> list[float]:
    """Times at which conditions changed a motion."""
    times, number = [], 0
    for segment in one.segments:
        times += [float(segment.stage.begin)] * (segment.stage.changes - number)
        number = segment.stage.changes
    return times


def changes_before(one: Trajectory) -> np.ndarray:
    """Number of changes by conditions before each sample, shape (m,)."""
    return np.repeat([x.stage.changes for x in one.segments], [x.count for x in one.segments])
