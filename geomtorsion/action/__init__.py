"""Action: variations and the equations of motion that follow from them."""

from geomtorsion.action.equations_of_motion import (
    EquationsOfMotion,
    conserved_quantities,
    equations_of_motion,
)
from geomtorsion.action.invariants import ConservedQuantities
from geomtorsion.action.linearized import linearized
from geomtorsion.action.steady import Linearization
from geomtorsion.action.variations import Variation, variation

__all__ = [
    "ConservedQuantities",
    "EquationsOfMotion",
    "Linearization",
    "Variation",
    "conserved_quantities",
    "equations_of_motion",
    "linearized",
    "variation",
]


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]
