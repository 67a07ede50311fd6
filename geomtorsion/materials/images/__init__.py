"""Images: Burgers vectors of lattice images, by geometric phase analysis."""

from geomtorsion.materials.images.lattice_image import LatticeImage
from geomtorsion.materials.images.phase_circuits import LatticeBurgers
from geomtorsion.materials.images.phases import LatticePhases
from geomtorsion.materials.images.spots import Spots

__all__ = ["LatticeBurgers", "LatticeImage", "LatticePhases", "Spots"]


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]
