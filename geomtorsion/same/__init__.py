"""same: whether two geometries are one, by their invariants."""

from geomtorsion.same.coordinate_map import CoordinateMap, MappedPoint
from geomtorsion.same.equivalence import Equivalence, same_geometry
from geomtorsion.same.invariants import Growth, Invariants
from geomtorsion.same.matching import Match

__all__ = [
    "CoordinateMap",
    "Equivalence",
    "Growth",
    "Invariants",
    "MappedPoint",
    "Match",
    "same_geometry",
]
