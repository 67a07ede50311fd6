"""Loops: closed paths to Burgers vectors."""

from geomtorsion.loops.burgers import burgers_vector
from geomtorsion.loops.defect_frames import (
    dispiration,
    parallel_dislocations,
    parallel_edges,
    parallel_screws,
)
from geomtorsion.loops.defects import Defect, Enclosed, enclosed_defects, find_defects
from geomtorsion.loops.development import Development, develop
from geomtorsion.loops.dislocation_network import DislocationNetwork
from geomtorsion.loops.edge_list import EdgeList
from geomtorsion.loops.exact_integral import ExactBurgersVector, exact_burgers_vector
from geomtorsion.loops.loop import Loop, Part
from geomtorsion.loops.motions import Motion
from geomtorsion.loops.network import Network
from geomtorsion.loops.node_rule import NodeRule
from geomtorsion.loops.paths import develop_path, develop_round
from geomtorsion.loops.reaction import Reaction
from geomtorsion.loops.result import BurgersVector, Check
from geomtorsion.loops.sampled import SampledFrame
from geomtorsion.loops.sides import Side
from geomtorsion.loops.survey import BurgersMap, burgers_map, burgers_vectors

__all__ = [
    "BurgersMap",
    "BurgersVector",
    "Check",
    "Defect",
    "Development",
    "DislocationNetwork",
    "EdgeList",
    "Enclosed",
    "ExactBurgersVector",
    "Loop",
    "Motion",
    "Network",
    "NodeRule",
    "Part",
    "Reaction",
    "SampledFrame",
    "Side",
    "burgers_map",
    "burgers_vector",
    "burgers_vectors",
    "develop",
    "develop_path",
    "develop_round",
    "dispiration",
    "enclosed_defects",
    "exact_burgers_vector",
    "find_defects",
    "parallel_dislocations",
    "parallel_edges",
    "parallel_screws",
]
