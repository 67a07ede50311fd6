"""Orientations: maps of measured crystal orientations, and Burgers vectors of circuits in them."""

from geomtorsion.orientations.circuits import Circuit
from geomtorsion.orientations.orientation_map import OrientationMap
from geomtorsion.orientations.phases import Phase
from geomtorsion.orientations.results import CircuitMap, FamilyLines, MapBurgers
from geomtorsion.orientations.slip import SlipDensity, SlipFamily, slip_families
from geomtorsion.orientations.symmetry import LAUE_GROUPS, LaueGroup, laue_group

__all__ = [
    "LAUE_GROUPS",
    "Circuit",
    "CircuitMap",
    "FamilyLines",
    "LaueGroup",
    "MapBurgers",
    "OrientationMap",
    "Phase",
    "SlipDensity",
    "SlipFamily",
    "laue_group",
    "slip_families",
]
