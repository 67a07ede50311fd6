"""Curves: geodesics, autoparallels and quantities carried along them, over an atlas.

`problem` and `readout` import each other: a problem calls the functions that read its states, and
these take a problem. At run time only `problem` imports `readout`; the other import is for types.
"""

from geomtorsion.curves.atlas import Atlas, Chart, TransitionMap
from geomtorsion.curves.camera import Shadow, shadow
from geomtorsion.curves.constructors import (
    autoparallel,
    geodesic,
    geodesic_deviation,
    parallel_transport,
)
from geomtorsion.curves.distance import distance_apart
from geomtorsion.curves.edges import edges_of
from geomtorsion.curves.exponential import exponential_map, holonomy
from geomtorsion.curves.linear import closed_form
from geomtorsion.curves.log_map import LogMap, log_map
from geomtorsion.curves.problem import CurveProblem
from geomtorsion.curves.shadow_image import ShadowEdge, ShadowImage
from geomtorsion.curves.spinning import spinning

__all__ = [
    "Atlas",
    "Chart",
    "CurveProblem",
    "LogMap",
    "Shadow",
    "ShadowEdge",
    "ShadowImage",
    "TransitionMap",
    "autoparallel",
    "closed_form",
    "distance_apart",
    "edges_of",
    "exponential_map",
    "geodesic",
    "geodesic_deviation",
    "holonomy",
    "log_map",
    "parallel_transport",
    "shadow",
    "spinning",
]


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]
