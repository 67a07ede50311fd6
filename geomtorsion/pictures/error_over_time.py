"""error over time: how the error estimate grows along a solved motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.ode.error_estimate import SAFETY, difference_over_samples

if TYPE_CHECKING:
    from geomtorsion.ode import Solution


def error_over_time(solution: Solution) -> np.ndarray | None:
    """Error estimate at each time, shape (m,): its largest value is `Solution.error`, if that is
    not the rounding of the engine. None if the solution came without a reference run.

    Examples
    --------
    >>> from geomtorsion.curves import geodesic
    >>> from geomtorsion.ode import RungeKutta, solve
    >>> from geomtorsion.spaces import load
    >>> p = geodesic(load("s2").frame, [1.0, 0.0], [0.0, 1.0], parameters={"R": 1})
    >>> sol = solve(p, 1.0, engine=RungeKutta())
    >>> bool(abs(error_over_time(sol).max() - sol.error) < 1e-16)
    True
    """
    if solution.reference is None:
        return None
    found = difference_over_samples(solution.problem, solution.trajectory, solution.reference)
    return SAFETY * found[len(found) - len(solution.times) :]
