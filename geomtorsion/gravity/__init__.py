"""Gravity: a Lagrangian of torsion, curvature and nonmetricity in, field equations out."""

from geomtorsion.gravity.equations import FieldEquations, equations
from geomtorsion.gravity.inertial import inertial
from geomtorsion.gravity.invariants import Invariant, invariants
from geomtorsion.gravity.lagrangian import Lagrangian, names
from geomtorsion.gravity.matter import fluid, maxwell, scalar_field, torsion_from_spin, weyssenhoff
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
from geomtorsion.gravity.translations import Translation, translations

__all__ = [
    "FieldEquations",
    "Invariant",
    "Lagrangian",
    "Translation",
    "einstein_cartan",
    "equations",
    "f_of",
    "fluid",
    "gauss_bonnet",
    "general_relativity",
    "holst",
    "inertial",
    "invariants",
    "maxwell",
    "names",
    "new_gr",
    "poincare",
    "scalar_field",
    "stegr",
    "tegr",
    "torsion_from_spin",
    "translations",
    "weyssenhoff",
]
