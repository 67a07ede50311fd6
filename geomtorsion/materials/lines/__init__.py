"""Lines: dislocation lines and networks of them, from files and from atoms."""

from geomtorsion.materials.lines.box import Box
from geomtorsion.materials.lines.circuit import LineBurgers
from geomtorsion.materials.lines.dislocation_network import DislocationNetwork
from geomtorsion.materials.lines.line_arrays import LineArrays
from geomtorsion.materials.lines.line_families import LineFamily
from geomtorsion.materials.lines.reactions import Reaction
from geomtorsion.materials.lines.series import DislocationSeries, JunctionChange

__all__ = [
    "Box",
    "DislocationNetwork",
    "DislocationSeries",
    "JunctionChange",
    "LineArrays",
    "LineBurgers",
    "LineFamily",
    "Reaction",
]
