"""same: whether two geometries are one, by their invariants, and the symmetries of one."""

from geomtorsion.same.classification import Classification, classified
from geomtorsion.same.comparison import same_geometry
from geomtorsion.same.coordinate_map import CoordinateMap, MappedPoint
from geomtorsion.same.equivalence import Equivalence
from geomtorsion.same.invariants import Growth, Invariants
from geomtorsion.same.matching import Match
from geomtorsion.same.products import Factor
from geomtorsion.same.symmetry.killing_yano import killing_yano
from geomtorsion.same.symmetry.symmetries import Symmetries, killing_equations, symmetries
from geomtorsion.same.symmetry.symmetry_integration import IntegratedSymmetry
from geomtorsion.same.symmetry.symmetry_products import functions_of_coordinates

__all__ = [
    "Classification",
    "CoordinateMap",
    "Equivalence",
    "Factor",
    "Growth",
    "IntegratedSymmetry",
    "Invariants",
    "MappedPoint",
    "Match",
    "Symmetries",
    "classified",
    "functions_of_coordinates",
    "killing_equations",
    "killing_yano",
    "same_geometry",
    "symmetries",
]


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]
