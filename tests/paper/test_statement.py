"""Comparison with print: components are compared one by one, and written in the paper's form."""

import sympy as sp

from geomtorsion.geometry import cartan
from geomtorsion.paper import paper_frames
from geomtorsion.paper.statement import epsilon, listed, lost, same, short, verdict


def test_comparison_is_strict():
    """A missing, an extra and a wrong component are each detected."""
    torsion = cartan(paper_frames().rotations).torsion.T.in_frame().lowered(2)
    right = epsilon(-1)
    assert same(torsion, right)
    assert not same(torsion, {k: v for k, v in right.items() if k != (0, 1, 2)})
    assert not same(torsion, right | {(0, 0, 1): 1})
    assert not same(torsion, right | {(0, 1, 2): 1})


def test_components_are_listed_from_1():
    """Equal values are written together, and vanishing components are written as R = 0."""
    frame = paper_frames().rotations
    text = listed("Gamma", cartan(frame).coefficients)
    assert "Gamma_12^1 = Gamma_23^3 = c2/s2" in text
    assert listed("R", cartan(frame).curvature.riemann) == "R = 0"


def test_formulas_are_short():
    """Cosines and sines of the angles are written as in the paper."""
    phi1, phi2, _ = paper_frames().rotations.coordinates
    assert short(sp.cos(phi1) * sp.sin(phi2)) == "c1*s2"


def test_verdicts_name_the_error():
    """The verdict names a lost notation only if the corrected formula holds."""
    assert verdict(True) == "agrees"
    assert verdict(False, lost("the dot", True)) == "misprint: the dot is lost"
    assert "more than its notation" in verdict(False, lost("the dot", False))
