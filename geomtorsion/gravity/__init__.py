"""Gravity: a Lagrangian of torsion, curvature and nonmetricity in, field equations out.

general_relativity: L = R for the Levi-Civita connection.
tegr: teleparallel equivalent of general relativity, L = T.
stegr: symmetric teleparallel equivalent of general relativity, L = Q.
einstein_cartan: Einstein-Cartan theory, L = R/(2 kappa) for a metric connection with torsion.
gauss_bonnet: L = GB for the Levi-Civita connection; its equations vanish in four dimensions.
names: symbols of the invariants and matter fields for Lagrangians as sympy expressions.
"""

from geomtorsion.gravity import perturbed
from geomtorsion.gravity.charges.charge import Charge, charge
from geomtorsion.gravity.charges.horizons import Horizon, horizons
from geomtorsion.gravity.initial_data.constraints import Constraints, constraints
from geomtorsion.gravity.initial_data.sampled_constraints import SampledConstraints
from geomtorsion.gravity.initial_data.slices import Slice, read_slice
from geomtorsion.gravity.motion.boundary import Shooting, shoot
from geomtorsion.gravity.motion.model import Model, read_model
from geomtorsion.gravity.motion.solving import solve
from geomtorsion.gravity.reduced.reduction import Reduction
from geomtorsion.gravity.stars.family import Family, family
from geomtorsion.gravity.stars.star import Star, star
from geomtorsion.gravity.states.equation_of_state import (
    EquationOfState,
    energy_polytrope,
    incompressible,
    polytropes,
)
from geomtorsion.gravity.states.matter_tables import equation_of_state
from geomtorsion.gravity.theory.field_equations import FieldEquations, equations
from geomtorsion.gravity.theory.fluids import fluid, torsion_from_spin, weyssenhoff
from geomtorsion.gravity.theory.hypermomentum import hypermomentum
from geomtorsion.gravity.theory.inertial import inertial
from geomtorsion.gravity.theory.invariance import (
    invariant_coframe,
    invariant_connection,
    invariant_torsion,
)
from geomtorsion.gravity.theory.invariants import Invariant, invariant, invariants
from geomtorsion.gravity.theory.lagrangian import Lagrangian, names
from geomtorsion.gravity.theory.matter import maxwell, scalar_field
from geomtorsion.gravity.theory.newman_penrose import NewmanPenrose, newman_penrose
from geomtorsion.gravity.theory.statistical import statistical
from geomtorsion.gravity.theory.theories import (
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
from geomtorsion.gravity.theory.theory_files import read_theory
from geomtorsion.gravity.theory.translations import Translation, translations
from geomtorsion.gravity.theory.two_forms import kalb_ramond
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
