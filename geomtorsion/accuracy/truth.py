"""Truth: what an error is measured against, a closed form or many more digits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from geomtorsion.motion.closed import closed_form
from geomtorsion.motion.compare import difference
from geomtorsion.motion.engines import RungeKutta, Taylor
from geomtorsion.motion.engines.taylor import is_available
from geomtorsion.motion.journey import travel
from geomtorsion.motion.solving import SAMPLES

if TYPE_CHECKING:
    from geomtorsion.motion import Problem, Solution

# Far below anything that double precision can show.
QUADRUPLE_TOLERANCE = 1e-28


@dataclass(frozen=True)
class Truth:
    """The best that is known about a motion.

    name: what it is; error: largest error of a solution over the same times, relative to the
    size of each block, as `solve` measures it.
    """

    name: str
    error: Callable[[Solution], float]


def truth_of(problem: Problem, t: float) -> Truth:
    """A closed form if there is one, else quadruple precision, else the finest Runge-Kutta."""
    import numpy as np

    grid = np.linspace(0.0, t, SAMPLES)
    known = closed_form(problem)
    if known is not None:
        chart, states = known
        exact = states(grid)
        return Truth("the closed form", lambda solution: _against(solution, chart, exact))
    engine, tolerance, name = RungeKutta(), 2.3e-14, "the finest Runge-Kutta solution"
    if is_available():
        engine, tolerance, name = Taylor(113), QUADRUPLE_TOLERANCE, "quadruple precision"
    journey = travel(problem, engine, tolerance, grid * problem.speed)
    return Truth(name, lambda solution: difference(solution.journey, journey)[0])


def _against(solution: Solution, chart: str, exact: Any) -> float:
    """Largest relative difference to exact states."""
    import numpy as np

    (segment,) = solution.journey.segments
    assert segment.chart == chart
    states = segment.states
    gaps = np.array(
        [
            [float(abs(_number(x) - y)) for x, y in zip(row, line, strict=True)]
            for row, line in zip(states, exact, strict=True)
        ]
    )
    worst = 0.0
    for block in segment.equations.system.blocks:
        index = slice(block[0], block[-1] + 1)
        size, gap = float(np.abs(states[:, index]).max()), float(gaps[:, index].max())
        worst = max(worst, gap / size if size else gap)
    return worst


def _number(value: Any) -> Any:
    """A state as mpmath number, all its digits kept."""
    import mpmath

    if isinstance(value, float):
        return mpmath.mpf(value)
    with mpmath.workprec(160):
        return mpmath.mpf(str(value))
