"""Images: Burgers vectors of lattice images, by geometric phase analysis."""

from geomtorsion.images.circuits import LatticeBurgers
from geomtorsion.images.lattice_image import LatticeImage
from geomtorsion.images.phases import LatticeCircuits, LatticePhases
from geomtorsion.images.spots import Spots

__all__ = ["LatticeBurgers", "LatticeCircuits", "LatticeImage", "LatticePhases", "Spots"]
