"""Crystals: from atoms to dislocation lines."""

from geomtorsion.crystals.blocked import BlockedCrystal, blocked_crystal
from geomtorsion.crystals.circuits import AtomCircuit
from geomtorsion.crystals.crystal import Crystal
from geomtorsion.crystals.lattices import LATTICES, Lattice
from geomtorsion.crystals.reading import read, read_all

__all__ = [
    "LATTICES",
    "AtomCircuit",
    "BlockedCrystal",
    "Crystal",
    "Lattice",
    "blocked_crystal",
    "read",
    "read_all",
]
