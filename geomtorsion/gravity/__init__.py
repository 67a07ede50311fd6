"""Gravity: a Lagrangian of torsion, curvature and nonmetricity in, field equations out."""

from geomtorsion.gravity import perturbed
from geomtorsion.gravity.boundary import Shooting, shoot
from geomtorsion.gravity.charges.charge import Charge, charge
from geomtorsion.gravity.charges.horizons import Horizon, horizons
from geomtorsion.gravity.equations import FieldEquations, equations
from geomtorsion.gravity.fluids import fluid, torsion_from_spin, weyssenhoff
from geomtorsion.gravity.hypermomentum import hypermomentum
from geomtorsion.gravity.inertial import inertial
from geomtorsion.gravity.initial_data.constraints import Constraints, constraints
from geomtorsion.gravity.initial_data.sampled_constraints import SampledConstraints
from geomtorsion.gravity.initial_data.slices import Slice, read_slice
from geomtorsion.gravity.invariance import (
    invariant_coframe,
    invariant_connection,
    invariant_torsion,
)
from geomtorsion.gravity.invariants import Invariant, invariant, invariants
from geomtorsion.gravity.lagrangian import Lagrangian, names
from geomtorsion.gravity.matter import maxwell, scalar_field
from geomtorsion.gravity.model import Model, read_model
from geomtorsion.gravity.newman_penrose import NewmanPenrose, newman_penrose
from geomtorsion.gravity.reduction import Reduction
from geomtorsion.gravity.solving import solve
from geomtorsion.gravity.stars.equation_of_state import (
    EquationOfState,
    energy_polytrope,
    incompressible,
    polytropes,
)
from geomtorsion.gravity.stars.family import Family, family
from geomtorsion.gravity.stars.matter_tables import equation_of_state
from geomtorsion.gravity.stars.star import Star, star
from geomtorsion.gravity.statistical import statistical
from geomtorsion.gravity.theories import (
    einstein_cartan,
    f_of,
    gauss_bonnet,
    general_relativity,
    holst,
    new_gr,
    poincare,
    stegr,
    tegr,
)
from geomtorsion.gravity.theory_files import read_theory
from geomtorsion.gravity.translations import Translation, translations
from geomtorsion.gravity.two_forms import kalb_ramond
from geomtorsion.same import killing_equations, killing_yano, symmetries

__all__ = [
    "Charge",
    "Constraints",
    "EquationOfState",
    "Family",
    "FieldEquations",
    "Horizon",
    "Invariant",
    "Lagrangian",
    "Model",
    "NewmanPenrose",
    "Reduction",
    "SampledConstraints",
    "Shooting",
    "Slice",
    "Star",
    "Translation",
    "charge",
    "constraints",
    "einstein_cartan",
    "energy_polytrope",
    "equation_of_state",
    "equations",
    "f_of",
    "family",
    "fluid",
    "gauss_bonnet",
    "general_relativity",
    "holst",
    "horizons",
    "hypermomentum",
    "incompressible",
    "inertial",
    "invariant",
    "invariant_coframe",
    "invariant_connection",
    "invariant_torsion",
    "invariants",
    "kalb_ramond",
    "killing_equations",
    "killing_yano",
    "maxwell",
    "names",
    "new_gr",
    "newman_penrose",
    "perturbed",
    "poincare",
    "polytropes",
    "read_model",
    "read_slice",
    "read_theory",
    "scalar_field",
    "shoot",
    "solve",
    "star",
    "statistical",
    "stegr",
    "symmetries",
    "tegr",
    "torsion_from_spin",
    "translations",
    "weyssenhoff",
]


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]
