"""Motion: curves and their solutions."""

from geomtorsion.motion.batch import Bundle
from geomtorsion.motion.charts import Atlas, Change, Chart
from geomtorsion.motion.curves import (
    autoparallel,
    geodesic,
    geodesic_deviation,
    parallel_transport,
)
from geomtorsion.motion.dispatch import solve, solve_many
from geomtorsion.motion.engines import Engine, RungeKutta, Stiff, Taylor
from geomtorsion.motion.exponential import exponential_map, holonomy
from geomtorsion.motion.flows import Flow, FlowBundle, FlowMoment, FlowSolution, flow
from geomtorsion.motion.free_tops import FreeTop, free_top
from geomtorsion.motion.problem import Problem
from geomtorsion.motion.recorded import Recorded
from geomtorsion.motion.shooting import Connecting, connecting
from geomtorsion.motion.solution import Cost, Moment, Solution, distance_apart

__all__ = [
    "Atlas",
    "Bundle",
    "Change",
    "Chart",
    "Connecting",
    "Cost",
    "Engine",
    "Flow",
    "FlowBundle",
    "FlowMoment",
    "FlowSolution",
    "FreeTop",
    "Moment",
    "Problem",
    "Recorded",
    "RungeKutta",
    "Solution",
    "Stiff",
    "Taylor",
    "autoparallel",
    "connecting",
    "distance_apart",
    "exponential_map",
    "flow",
    "free_top",
    "geodesic",
    "geodesic_deviation",
    "holonomy",
    "parallel_transport",
    "solve",
    "solve_many",
]
