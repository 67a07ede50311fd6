"""Elasticity: stresses that belong to torsion, from lines, coframes and Nye fields."""

from geomtorsion.materials.elasticity.cell import Cell
from geomtorsion.materials.elasticity.constants import ElasticConstants
from geomtorsion.materials.elasticity.nye_field import NyeField
from geomtorsion.materials.elasticity.stress_errors import StressErrors
from geomtorsion.materials.elasticity.stresses import Stresses, stresses

__all__ = ["Cell", "ElasticConstants", "NyeField", "StressErrors", "Stresses", "stresses"]
