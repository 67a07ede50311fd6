"""Crystals: from atoms to dislocation lines."""

from geomtorsion.crystals.crystal import Crystal
from geomtorsion.crystals.lattices import LATTICES, Lattice

__all__ = ["LATTICES", "Crystal", "Lattice"]
