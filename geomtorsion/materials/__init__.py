"""Materials: Burgers vectors of measured and simulated matter."""

from geomtorsion.materials.burgers import Burgers, Section
from geomtorsion.materials.source import Backdrop, Source
from geomtorsion.materials.survey import Errors, Survey

__all__ = ["Backdrop", "Burgers", "Errors", "Section", "Source", "Survey"]
