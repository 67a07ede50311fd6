"""Give it any tetrad; get its geometry, its motions and its defects: exactly and fast."""

from geomtorsion import errors, spaces
from geomtorsion.errors import GeomtorsionError
from geomtorsion.exact import numpy_function, parse_expression
from geomtorsion.geometry import (
    Connection,
    Curvature,
    Frame,
    Identity,
    Plan,
    Tensor,
    Torsion,
    blend,
    cartan,
    contract,
    from_coefficients,
    from_contortion,
    from_spin_connection,
    identities,
    levi_civita,
)

__all__ = [
    "Connection",
    "Curvature",
    "Frame",
    "GeomtorsionError",
    "Identity",
    "Plan",
    "Tensor",
    "Torsion",
    "blend",
    "cartan",
    "contract",
    "errors",
    "from_coefficients",
    "from_contortion",
    "from_spin_connection",
    "identities",
    "levi_civita",
    "numpy_function",
    "parse_expression",
    "spaces",
]
