"""Lines: dislocation lines and networks of them, from files and from atoms."""

from geomtorsion.materials.lines.box import Box
from geomtorsion.materials.lines.circuit import CircuitBurgers
from geomtorsion.materials.lines.dislocation_network import DislocationNetwork
from geomtorsion.materials.lines.line_arrays import LineArrays
from geomtorsion.materials.lines.line_families import LineFamily
from geomtorsion.materials.lines.reactions import Reaction

__all__ = [
    "Box",
    "CircuitBurgers",
    "DislocationNetwork",
    "LineArrays",
    "LineFamily",
    "Reaction",
]
