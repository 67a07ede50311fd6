"""same: whether two geometries are one, by their invariants."""

from geomtorsion.same.classification import Classification, classified
from geomtorsion.same.comparison import same_geometry
from geomtorsion.same.coordinate_map import CoordinateMap, MappedPoint
from geomtorsion.same.equivalence import Equivalence
from geomtorsion.same.invariants import Growth, Invariants
from geomtorsion.same.matching import Match
from geomtorsion.same.products import Factor

__all__ = [
    "Classification",
    "CoordinateMap",
    "Equivalence",
    "Factor",
    "Growth",
    "Invariants",
    "MappedPoint",
    "Match",
    "classified",
    "same_geometry",
]
