"""Passed over: parts of the right side that all steps of a solution missed."""

from __future__ import annotations

import numpy as np

from geomtorsion.errors import GeomtorsionError
from geomtorsion.ode import Solution
from geomtorsion.prices.effects.effect_choice import ORDER

# Number of samples of the right side: the shortest pulse that is seen is such a part of the motion.
SAMPLES = 2**17


def passed_over(solution: Solution, accuracy: float) -> float | None:
    """Time of a pulse that the steps of a solution passed over; None if no sample shows one.

    Engines evaluate the right side at their steps. `solve` finds pulses of functions such as exp
    whose argument is linear in the time. Another pulse between two steps leaves no trace in the
    solution or in its error estimate. Here the right side is sampled evenly along the
    solution, and its integral over two samples (Simpson) is compared with the change of the states.
    Only equations that depend on time are sampled.

    accuracy: a difference counts above this part of the size of a group of states.

    Examples
    --------
    >>> from geomtorsion.ode import ODE, solve
    >>> kick = ODE.of({"v": "1000*exp(16777216*log(sin(pi*t/40)**2))"}, [1.0])
    >>> round(passed_over(solve(kick, 40.0), 1e-3), 2)
    20.0
    """
    trajectory, unit = solution.trajectory, solution.problem.time_unit
    if all(segment.stage.system.clock is None for segment in trajectory.segments):
        return None
    times = np.linspace(0.0, trajectory.reached, SAMPLES + 1)
    try:
        parts = trajectory.at(times)
    except GeomtorsionError:
        # An engine of a user that has no dense output.
        return None
    worst, place = accuracy, None
    for segment, dense, index in parts:
        if len(index) < 3:
            continue
        system, states = segment.stage.system, np.asarray(dense, dtype=float).T
        numbers = [float(x) for x in segment.stage.parameters]
        with np.errstate(all="ignore"):
            rates = np.asarray(system.array_function(*states, *numbers), dtype=float)
        step = times[1] - times[0]
        whole = states[:, 2::2] - states[:, :-2:2]
        sums = (rates[:, :-2:2] + 4 * rates[:, 1:-1:2] + rates[:, 2::2]) * (step / 3)
        for group in map(list, system.groups_but_clock):
            size = float(np.abs(states[group]).max())
            # Where states change by an order in two samples these do not resolve the motion itself.
            smooth = np.abs(whole[group]).max(axis=0) <= ORDER * size
            gaps = np.where(smooth, np.abs(whole[group] - sums[group]).max(axis=0), 0.0)
            gaps = np.nan_to_num(gaps) / (size or 1.0)
            k = int(gaps.argmax())
            if gaps[k] > worst:
                worst, place = float(gaps[k]), float(times[index[2 * k + 1]]) / unit
    return place
