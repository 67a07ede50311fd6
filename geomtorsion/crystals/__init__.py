"""Crystals: from atoms to dislocation lines."""

from geomtorsion.crystals.circuits import AtomCircuit
from geomtorsion.crystals.crystal import Crystal
from geomtorsion.crystals.lattices import LATTICES, Lattice
from geomtorsion.crystals.reading import read, read_all

__all__ = ["LATTICES", "AtomCircuit", "Crystal", "Lattice", "read", "read_all"]
