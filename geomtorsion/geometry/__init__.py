"""Geometry: symbols in, tensors out.

Many files here import each other, because a tensor holds its frame, while a frame makes its own
tensors and returns each quantity by name: forms, connections, curvature. `Frame`, `Tensor` and
`Connection` are the interface; most of their methods are one call of a function in another file.
The imports at the top of these files, which run, form no ring: connection is above frame, and frame
above tensor. The other imports are for types, or within a method that needs a file above its own.
"""

from geomtorsion.geometry import (
    assumption,
    connections,
    notation,
    numeric,
    quantities,
    validation,
)
from geomtorsion.geometry.brackets import Brackets
from geomtorsion.geometry.components import antisymmetric, determinant, symmetric
from geomtorsion.geometry.connection import Connection
from geomtorsion.geometry.connections import (
    blend,
    cartan,
    from_coefficients,
    from_contortion,
    from_nonmetricity,
    from_spin_connection,
    from_torsion,
    levi_civita,
)
from geomtorsion.geometry.constrained import constrained
from geomtorsion.geometry.contraction import contract
from geomtorsion.geometry.curvature import Curvature
from geomtorsion.geometry.embedded import embedded
from geomtorsion.geometry.forms import Form
from geomtorsion.geometry.frame import Frame
from geomtorsion.geometry.holonomy import HolonomyAlgebra
from geomtorsion.geometry.homes import at_home
from geomtorsion.geometry.identity import IdentityCheck, identities
from geomtorsion.geometry.integrability import Integrability, ParallelVolume
from geomtorsion.geometry.lie_algebra import LieAlgebra
from geomtorsion.geometry.lie_derivative import lie, lie_bracket
from geomtorsion.geometry.plan import DependencyGraph
from geomtorsion.geometry.regions import Region
from geomtorsion.geometry.surfaces import Surface, surface
from geomtorsion.geometry.tensor import Tensor
from geomtorsion.geometry.torsion import Torsion

__all__ = [
    "Brackets",
    "Connection",
    "Curvature",
    "DependencyGraph",
    "Form",
    "Frame",
    "HolonomyAlgebra",
    "IdentityCheck",
    "Integrability",
    "LieAlgebra",
    "ParallelVolume",
    "Region",
    "Surface",
    "Tensor",
    "Torsion",
    "antisymmetric",
    "assumption",
    "at_home",
    "blend",
    "cartan",
    "connections",
    "constrained",
    "contract",
    "determinant",
    "embedded",
    "from_coefficients",
    "from_contortion",
    "from_nonmetricity",
    "from_spin_connection",
    "from_torsion",
    "identities",
    "levi_civita",
    "lie",
    "lie_bracket",
    "notation",
    "numeric",
    "quantities",
    "surface",
    "symmetric",
    "validation",
]


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]
