"""Fields: frames and displacements on grids and at scattered points."""

from geomtorsion.materials.fields.blocked_map import BlockMap, blocked_map
from geomtorsion.materials.fields.densities import (
    DefectConservation,
    DefectDensities,
    Density,
    defect_conservation,
    defect_densities,
)
from geomtorsion.materials.fields.sampled import SampledFrame
from geomtorsion.materials.fields.scattered import ScatteredFrame

__all__ = [
    "BlockMap",
    "DefectConservation",
    "DefectDensities",
    "Density",
    "SampledFrame",
    "ScatteredFrame",
    "blocked_map",
    "defect_conservation",
    "defect_densities",
]
