"""Truth: what errors are measured against, a closed form or many more digits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from geomtorsion.curves import CurveProblem
from geomtorsion.curves.linear import closed_form
from geomtorsion.ode import ODE, Engine, RungeKutta, Solution, Taylor
from geomtorsion.ode.engines import Run
from geomtorsion.ode.engines.protocol import WorkLimitError
from geomtorsion.ode.engines.stepwise import FLOOR
from geomtorsion.ode.engines.taylor import is_available
from geomtorsion.ode.error_estimate import difference
from geomtorsion.ode.trajectory import Segment, Stage, Trajectory, integrate
from geomtorsion.precision import EPS

# As far below the rounding of doubles as that is below 1, and above that of quadruple numbers.
QUADRUPLE_TOLERANCE = EPS * EPS
# Function of times that gives exact states, one row for each time.
States = Callable[[np.ndarray], Any]


@dataclass(frozen=True)
class Truth:
    """The best that is known about a motion.

    name: what it is; trajectory: states at the times at which solutions are asked for.
    """

    name: str
    problem: CurveProblem | ODE
    trajectory: Trajectory

    def error(self, solution: Solution) -> float:
        """Largest error of a solution, each group of states against its own size."""
        return difference(self.problem, solution.trajectory, self.trajectory)


def truth_of(problem: CurveProblem | ODE, grid: np.ndarray, exact: States | None = None) -> Truth:
    """A closed form if there is one, else quadruple precision, else the finest Runge-Kutta.

    grid: times from 0 on; exact: the closed form, where the problem does not know it itself.
    """
    known = closed_form(problem) if exact is None and isinstance(problem, CurveProblem) else None
    if exact is not None or known is not None:
        label, states = known if known is not None else ("", exact)
        assert states is not None
        return Truth("the closed form", problem, _tabulated(problem, grid, label, states))
    engine: Engine = RungeKutta()
    tolerance, name = FLOOR, "the finest Runge-Kutta solution"
    if is_available():
        engine, tolerance, name = Taylor(113), QUADRUPLE_TOLERANCE, "quadruple precision"
    stage = problem.first_stage(engine.precision, 0.0)
    try:
        run = integrate(stage, grid * problem.time_unit, tolerance, engine)
    except WorkLimitError as limit:
        raise limit.counted(1 / problem.time_unit, problem.time_name) from None
    return Truth(name, problem, run)


def _tabulated(
    problem: CurveProblem | ODE, grid: np.ndarray, label: str, states: States
) -> Trajectory:
    """A trajectory of exact states."""
    stage: Stage = problem.first_stage(53, 0.0)
    assert stage.label == label
    rows = np.array([list(row) for row in states(grid)])
    times = grid * problem.time_unit
    run = Run(times, rows, float(times[-1]), rows[-1], "done", 0, 0, 0.0, 0.0)
    return Trajectory(RungeKutta(), 0.0, (Segment(stage, run, 0, len(grid), rows),), "done")
