"""Geometry: the whole work of one case by geomtorsion, from a fresh frame to sympy."""

from __future__ import annotations

import sympy as sp

import geomtorsion as gt
from tests.benchmarks.cases import Case
from tests.benchmarks.outcome import Outcome, Reached

Stages = tuple[tuple[str, tuple[str, ...]], ...]
# Order of requests; each quantity is converted to sympy in full before the next is requested.
STAGES: Stages = (
    ("torsion", ("cartan_connection", "torsion", "christoffel", "contortion")),
    ("riemann", ("cartan_curvature", "riemann")),
    ("ricci", ("ricci", "scalar_curvature")),
    ("kretschmann", ("kretschmann",)),
)
# Quantities of the metric, which the rivals also compute.
OF_METRIC: Stages = (
    ("christoffel", ("christoffel",)),
    ("riemann", ("riemann",)),
    *STAGES[2:],
)


def fresh_frame(case: Case) -> gt.Frame:
    """A frame that shares nothing with an earlier one, with the signature of the case."""
    if case.coframe is None:
        assert case.line_element is not None
        return gt.Frame.from_metric(case.coordinates, case.line_element, signature=case.signature)
    return gt.Frame(case.coordinates, case.coframe, signature=case.signature)


def whole_geometry(
    case: Case, reached: Reached = lambda _: None, stages: Stages = STAGES
) -> Outcome:
    """Both connections, torsion, contortion, both curvatures, Ricci, Kretschmann, in sympy."""
    frame = fresh_frame(case)
    components: dict[str, dict[tuple[int, ...], sp.Expr]] = {}
    for stage, names in stages:
        for name in names:
            components[name] = dict(frame.quantity(name).nonzero())
        reached(stage)
    scalar = components["kretschmann"].get((), sp.Integer(0))
    return Outcome(scalar, tuple(components["ricci"].values()))
