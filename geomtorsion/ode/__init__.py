"""First-order equations with events: engines, solutions to a stated accuracy, ensembles."""

from geomtorsion.ode.engines import Engine, RungeKutta, Stiff, Taylor
from geomtorsion.ode.ensemble import Ensemble, solve_many
from geomtorsion.ode.files import SavedSolution
from geomtorsion.ode.moment import Moment
from geomtorsion.ode.problem import ODE
from geomtorsion.ode.solution import Cost, Solution
from geomtorsion.ode.solve import solve
from geomtorsion.ode.terms import At, When

__all__ = [
    "ODE",
    "At",
    "Cost",
    "Engine",
    "Ensemble",
    "Moment",
    "RungeKutta",
    "SavedSolution",
    "Solution",
    "Stiff",
    "Taylor",
    "When",
    "solve",
    "solve_many",
]
