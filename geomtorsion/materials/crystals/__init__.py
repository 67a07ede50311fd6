"""Crystals: from atoms to dislocation lines.

LATTICES: the known lattices by name, such as "fcc".
"""

from geomtorsion.materials.crystals.atom_circuits import AtomCircuit
from geomtorsion.materials.crystals.crystal import Crystal
from geomtorsion.materials.crystals.grains import Grain, Grains, Wall
from geomtorsion.materials.crystals.lattices import LATTICES, Lattice
from geomtorsion.materials.crystals.plane_crystal import PlaneCrystal, PlaneDislocation
from geomtorsion.materials.crystals.plane_grains import PlaneGrain
from geomtorsion.materials.crystals.reading import read, read_all

__all__ = [
    "LATTICES",
    "AtomCircuit",
    "Crystal",
    "Grain",
    "Grains",
    "Lattice",
    "PlaneCrystal",
    "PlaneDislocation",
    "PlaneGrain",
    "Wall",
    "read",
    "read_all",
]


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]
