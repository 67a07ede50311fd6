"""Crystals: from atoms to dislocation lines."""

from geomtorsion.crystals.blocked import BlockedCrystal, blocked_crystal
from geomtorsion.crystals.circuits import AtomCircuit
from geomtorsion.crystals.crystal import Crystal
from geomtorsion.crystals.grains import Grain, Grains, Wall
from geomtorsion.crystals.lattices import LATTICES, Lattice
from geomtorsion.crystals.reading import read, read_all

__all__ = [
    "LATTICES",
    "AtomCircuit",
    "BlockedCrystal",
    "Crystal",
    "Grain",
    "Grains",
    "Lattice",
    "Wall",
    "blocked_crystal",
    "read",
    "read_all",
]
