"""Orientations: maps of measured crystal orientations, and Burgers vectors of circuits in them.

LAUE_GROUPS: names of the eleven Laue groups, as "m-3m", for the argument `laue`.
"""

from geomtorsion.materials.maps.curvature import Curvature
from geomtorsion.materials.maps.orientation_map import OrientationMap
from geomtorsion.materials.maps.phases import Phase
from geomtorsion.materials.maps.pixel_circuits import Circuit
from geomtorsion.materials.maps.results import FamilyLines, MapBurgers
from geomtorsion.materials.maps.slip import SlipDensity, SlipFamily, slip_families
from geomtorsion.materials.maps.symmetry import LAUE_GROUPS, LaueGroup, laue_group

__all__ = [
    "LAUE_GROUPS",
    "Circuit",
    "Curvature",
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
