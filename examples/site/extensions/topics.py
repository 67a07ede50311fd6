"""topics: public names grouped by subject, each with its first line, as tables.

The directive `topics` shows all names that `geomtorsion` exports. A name without a topic appears
below the last one, under its package.
"""

# pyright: reportMissingImports=false

from __future__ import annotations

import re
from collections.abc import Iterable
from inspect import ismodule

from docstrings import with_formulas
from docutils import nodes
from docutils.statemachine import StringList
from sphinx.util.docutils import SphinxDirective
from sphinx.util.nodes import nested_parse_with_titles

import geomtorsion

TOPICS: dict[str, str] = {
    "Frames and tensors": "Frame Region read Tensor contract numpy_function parse_expression "
    "Certainty DependencyGraph limits",
    "Connections, torsion, curvature": "cartan levi_civita Connection Torsion Curvature "
    "from_torsion from_contortion from_nonmetricity from_spin_connection from_coefficients blend "
    "identities IdentityCheck",
    "Forms, symmetries, surfaces": "Form lie lie_bracket symmetries Symmetries killing_equations "
    "LieAlgebra HolonomyAlgebra surface Surface same_geometry Equivalence CoordinateMap "
    "MappedPoint",
    "Gravity": "gravity",
    "Autoparallels and geodesics": "autoparallel geodesic CurveProblem distance_apart "
    "exponential_map log_map LogMap parallel_transport holonomy geodesic_deviation spinning "
    "kerr_orbit KerrOrbit Frequencies",
    "Charts": "Chart TransitionMap Atlas",
    "Solving equations": "solve solve_many ODE At When Solution SavedSolution Ensemble",
    "Engines": "Engine Taylor RungeKutta Stiff",
    "Certainty and cost": "prove Proof price PriceList PriceRow called_for EffectBudget",
    "Burgers vectors of loops": "Loop burgers_vector burgers_vectors burgers_map BurgersVector "
    "BurgersMap exact_burgers_vector ExactBurgersVector",
    "Defects": "Defect dispiration parallel_screws parallel_edges parallel_dislocations "
    "enclosed_defects EnclosedDefect find_defects",
    "Developments": "develop develop_path develop_period Development AffineMap diffusion Diffusion",
    "Steps on a network": "Cochain Complex EdgeList Network NodeRule",
    "Measured fields, maps and images": "SampledFrame ScatteredFrame OrientationMap Circuit Phase "
    "LatticeImage LatticePhases LatticeBurgers images defect_densities defect_conservation",
    "Atoms and dislocation lines": "crystals DislocationNetwork LineArrays Box Reaction",
    "Stresses": "stresses Stresses ElasticConstants NyeField",
    "Rigid bodies": "Body Scene State effects scenes SceneResult StateSelection SceneCost "
    "FreeTop free_top",
    "Actions": "equations_of_motion EquationsOfMotion variation Variation conserved_quantities "
    "linearized Linearization",
    "Spaces, figures, exercises": "spaces pictures exercises conventions",
    "Errors": "GeomtorsionError errors",
}


def ordered(names: Iterable[str]) -> dict[str, list[str]]:
    """Names by topic, in the order of the topics; others at the end."""
    left = list(names)
    found: dict[str, list[str]] = {}
    for topic, words in TOPICS.items():
        here = [word for word in words.split() if word in left]
        if here:
            found[topic] = here
    known = {word for words in found.values() for word in words}
    more = [name for name in left if name not in known]
    return found | ({"More": more} if more else {})


def table(package: str, names: Iterable[str]) -> list[str]:
    """A table of names, with the first line of each docstring."""
    module = __import__(package, fromlist=["*"])
    lines = [".. list-table::", "    :widths: 30 70", ""]
    for name in names:
        value = getattr(module, name)
        role, full = "obj", f"{package}.{name}"
        if ismodule(value):
            role, full = "mod", value.__name__
        lines += [f"    * - :py:{role}:`{name} <{full}>`", f"      - {first_line(value)}"]
    return [*lines, ""]


def first_line(value: object) -> str:
    """First sentence of a docstring with its formulas, without the name of a module."""
    paragraph = (getattr(value, "__doc__", None) or "").strip().split("\n\n")[0]
    text = " ".join(paragraph.split())
    if ismodule(value):
        text = re.sub(r"^\w+: ", "", text)
    found = re.match(r".*?\.(?=\s|$)", text)
    return with_formulas(found[0] if found else text)


class Topics(SphinxDirective):
    """`.. topics::`: every public name by subject."""

    def run(self) -> list[nodes.Node]:
        """A title and a table for each topic."""
        lines: list[str] = []
        for topic, names in ordered(geomtorsion.__all__).items():
            lines += [topic, "-" * len(topic), "", *table("geomtorsion", names)]
        node = nodes.section()
        node.document = self.state.document
        nested_parse_with_titles(self.state, StringList(lines, source="topics"), node)
        return node.children


def setup(app) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("topics", Topics)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
