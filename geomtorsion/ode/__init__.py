"""First-order equations with events: engines, solutions to a stated accuracy, ensembles."""

from geomtorsion.ode import (
    checkpoint,
    derivatives,
    engines,
    error_estimate,
    newton,
    numbers,
    pieces,
    solution,
    writing,
)
from geomtorsion.ode.centre import Centre
from geomtorsion.ode.checkpoint import Checkpoint
from geomtorsion.ode.derivatives import EventDerivative
from geomtorsion.ode.engines import Engine, RungeKutta, Stiff, Taylor
from geomtorsion.ode.ensemble import Ensemble, solve_many
from geomtorsion.ode.equation_files import is_equation_file, read_equations
from geomtorsion.ode.fates import EndMap, end_map
from geomtorsion.ode.moment import Moment
from geomtorsion.ode.problem import ODE
from geomtorsion.ode.solution import Cost, Solution
from geomtorsion.ode.solution_files import SavedSolution
from geomtorsion.ode.solve import solve
from geomtorsion.ode.system import Run, WorkLimitError
from geomtorsion.ode.tables import Table
from geomtorsion.ode.terms import At, When
from geomtorsion.ode.trajectory import Segment, Stage, Trajectory, integrate

__all__ = [
    "ODE",
    "At",
    "Centre",
    "Checkpoint",
    "Cost",
    "EndMap",
    "Engine",
    "Ensemble",
    "EventDerivative",
    "Moment",
    "Run",
    "RungeKutta",
    "SavedSolution",
    "Segment",
    "Solution",
    "Stage",
    "Stiff",
    "Table",
    "Taylor",
    "Trajectory",
    "When",
    "WorkLimitError",
    "checkpoint",
    "derivatives",
    "end_map",
    "engines",
    "error_estimate",
    "integrate",
    "is_equation_file",
    "newton",
    "numbers",
    "pieces",
    "read_equations",
    "solution",
    "solve",
    "solve_many",
    "writing",
]


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]
