"""Loops: closed paths to Burgers vectors.

Number: type of a coordinate: int, float, complex, Fraction or a sympy expression.
Parameters: type of the values of parameters, {name or symbol: number}.
"""

from geomtorsion.loops import arcs, exact_integral, integrals, loop_files, quadrature, validation
from geomtorsion.loops.affine_map import AffineMap
from geomtorsion.loops.arcs import Arc, Number, Parameters, Part, Segment
from geomtorsion.loops.brownian import (
    Diffusion,
    EnsembleMean,
    InvariantMeasure,
    StochasticEnsemble,
    diffusion,
)
from geomtorsion.loops.burgers import burgers_vector
from geomtorsion.loops.cochain import ChainSums, Cochain
from geomtorsion.loops.complexes import Complex
from geomtorsion.loops.defect_lines import (
    dispiration,
    parallel_dislocations,
    parallel_edges,
    parallel_screws,
)
from geomtorsion.loops.defects import Defect, EnclosedDefect, enclosed_defects, find_defects
from geomtorsion.loops.development import Development, develop
from geomtorsion.loops.development_slopes import (
    DevelopmentDerivative,
    development_derivatives,
)
from geomtorsion.loops.edges import EdgeIntegrals, EdgeList
from geomtorsion.loops.exact_circle import exact_circle
from geomtorsion.loops.exact_integral import ExactBurgersVector, exact_burgers_vector
from geomtorsion.loops.forms import forms
from geomtorsion.loops.frame_vector import VectorSum
from geomtorsion.loops.hodograph import Hodograph, hodograph, outline
from geomtorsion.loops.interpolants import HasInterpolant, Interpolant
from geomtorsion.loops.loop import Loop
from geomtorsion.loops.maps import BurgersMap, burgers_map, burgers_vectors
from geomtorsion.loops.network import Network
from geomtorsion.loops.node_rule import NodeRule
from geomtorsion.loops.paths import DevelopedPath, develop_path, develop_period, developed_path
from geomtorsion.loops.protocols import HasBurgers
from geomtorsion.loops.result import BurgersVector, Check
from geomtorsion.loops.slopes import burgers_derivatives
from geomtorsion.loops.spanning_forest import spanning_forest

__all__ = [
    "AffineMap",
    "Arc",
    "BurgersMap",
    "BurgersVector",
    "ChainSums",
    "Check",
    "Cochain",
    "Complex",
    "Defect",
    "DevelopedPath",
    "Development",
    "DevelopmentDerivative",
    "Diffusion",
    "EdgeIntegrals",
    "EdgeList",
    "EnclosedDefect",
    "EnsembleMean",
    "ExactBurgersVector",
    "HasBurgers",
    "HasInterpolant",
    "Hodograph",
    "Interpolant",
    "InvariantMeasure",
    "Loop",
    "Network",
    "NodeRule",
    "Number",
    "Parameters",
    "Part",
    "Segment",
    "StochasticEnsemble",
    "VectorSum",
    "arcs",
    "burgers_derivatives",
    "burgers_map",
    "burgers_vector",
    "burgers_vectors",
    "develop",
    "develop_path",
    "develop_period",
    "developed_path",
    "development_derivatives",
    "diffusion",
    "dispiration",
    "enclosed_defects",
    "exact_burgers_vector",
    "exact_circle",
    "exact_integral",
    "find_defects",
    "forms",
    "hodograph",
    "integrals",
    "loop_files",
    "outline",
    "parallel_dislocations",
    "parallel_edges",
    "parallel_screws",
    "quadrature",
    "spanning_forest",
    "validation",
]


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]
