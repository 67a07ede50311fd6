"""Loops: closed paths to Burgers vectors."""

from geomtorsion.loops.affine_map import AffineMap
from geomtorsion.loops.arcs import Arc, Part
from geomtorsion.loops.box import Box
from geomtorsion.loops.burgers import burgers_vector
from geomtorsion.loops.circuit import CircuitBurgers
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
from geomtorsion.loops.dislocation_network import DislocationNetwork
from geomtorsion.loops.edges import EdgeList
from geomtorsion.loops.exact_integral import ExactBurgersVector, exact_burgers_vector
from geomtorsion.loops.fields.blocks import BlockMap, blocked_map
from geomtorsion.loops.line_arrays import LineArrays
from geomtorsion.loops.line_families import LineFamily
from geomtorsion.loops.loop import Loop
from geomtorsion.loops.maps import BurgersMap, burgers_map, burgers_vectors
from geomtorsion.loops.network import Network
from geomtorsion.loops.node_rule import NodeRule
from geomtorsion.loops.paths import develop_path, develop_period
from geomtorsion.loops.reactions import Reaction
from geomtorsion.loops.result import BurgersVector, Check
from geomtorsion.loops.sampled import SampledFrame
from geomtorsion.loops.scattered import ScatteredFrame

__all__ = [
    "AffineMap",
    "Arc",
    "BlockMap",
    "Box",
    "BurgersMap",
    "BurgersVector",
    "ChainSums",
    "Check",
    "CircuitBurgers",
    "Cochain",
    "Complex",
    "Defect",
    "Development",
    "DislocationNetwork",
    "EdgeList",
    "EnclosedDefect",
    "ExactBurgersVector",
    "LineArrays",
    "LineFamily",
    "Loop",
    "Network",
    "NodeRule",
    "Part",
    "Reaction",
    "SampledFrame",
    "ScatteredFrame",
    "blocked_map",
    "burgers_map",
    "burgers_vector",
    "burgers_vectors",
    "develop",
    "develop_path",
    "develop_period",
    "dispiration",
    "enclosed_defects",
    "exact_burgers_vector",
    "find_defects",
    "parallel_dislocations",
    "parallel_edges",
    "parallel_screws",
]
