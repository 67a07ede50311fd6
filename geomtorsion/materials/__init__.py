"""Materials: Burgers vectors of measured and simulated matter."""

from geomtorsion.materials.burgers import Burgers

__all__ = ["Burgers"]
