"""Measured: measured fields of any kind, as commands and pictures ask for them."""

from geomtorsion.materials.measured.fields import CrystalField, LatticeField, SampledField
from geomtorsion.materials.measured.results import Backdrop, Closure, Measured, Section, Survey

__all__ = [
    "Backdrop",
    "Closure",
    "CrystalField",
    "LatticeField",
    "Measured",
    "SampledField",
    "Section",
    "Survey",
]
