"""geomtorsion paper: every claim is recomputed, verdicts follow from the computation."""

import json

import pytest
import sympy as sp
from typer.testing import CliRunner

from geomtorsion.cli import claims as claims_module
from geomtorsion.cli.claims import PHI, claims, epsilon, rotations, same
from geomtorsion.cli.paper import written
from geomtorsion.errors import UnknownNameError
from geomtorsion.geometry import Frame, cartan

EQUATIONS = ["(5)", "(6)", "(7)", "(8)", "(9) left", "(9) right", "(10)", "(11)", "(12)"]


def test_every_equation_from_5_to_12_is_there():
    """Each number of section 2 has at least one claim, and every claim a recomputed formula."""
    found = [claim.equation for claim in claims()]
    assert [number for number in found if number.startswith("(")] == EQUATIONS
    assert len(found) >= 17
    assert all(claim.right for claim in claims())


def test_verdicts():
    """Only the inverse metric and the sentence after it are misprinted, as READING found."""
    wrong = {c.equation: c.verdict for c in claims() if not c.agrees}
    assert set(wrong) == {"(9) right", "after (9)"}
    assert all(text.startswith("misprint: ") for text in wrong.values())
    assert "1/s2**2" in wrong["(9) right"]


def test_the_right_inverse_metric_is_given():
    """The right formula is the inverse of g, entry by entry."""
    (claim,) = [c for c in claims() if c.equation == "(9) right"]
    s2, c2 = sp.symbols("s2 c2")
    given = sp.Matrix(sp.sympify(claim.right.removeprefix("g^-1 = "), {"s2": s2, "c2": c2}))
    metric = sp.Matrix([[1, 0, c2], [0, 1, 0], [c2, 0, 1]])
    product = (given * metric).applyfunc(lambda e: sp.simplify(e.subs(c2**2, 1 - s2**2)))
    assert product == sp.eye(3)


def test_coframe_is_derived_from_the_attitude():
    """The coframe of the claims comes from R^T dR: it is that of eq. (8), det e = sin(phi2)."""
    assert rotations().coordinates == PHI
    assert rotations().determinant[()] == sp.sin(PHI[1])


def test_verdicts_follow_the_computation(monkeypatch):
    """With another frame in place of the right one the same claims are found to be wrong."""
    other = Frame(PHI, [[1, 0, 0], [0, sp.sin(PHI[0]), 0], [0, 0, PHI[0]]], name="another")
    monkeypatch.setattr(claims_module, "rotations", lambda: other)
    wrong = [c for c in (*claims_module._metric(), *claims_module._torsion()) if not c.agrees]
    assert {"(9) left", "(9) right", "(10)", "(12)"} <= {c.equation for c in wrong}
    (inverse,) = [c for c in wrong if c.equation == "(9) right"]
    assert "proportional" in inverse.verdict


def test_comparison_is_strict():
    """A missing, an extra and a wrong component are each seen."""
    torsion = cartan(rotations()).torsion.T.in_frame().lowered(2)
    right = epsilon(-1)
    assert same(torsion, right)
    assert not same(torsion, {k: v for k, v in right.items() if k != (0, 1, 2)})
    assert not same(torsion, right | {(0, 0, 1): 1})
    assert not same(torsion, right | {(0, 1, 2): 1})


def test_json():
    """JSON holds the same claims."""
    data = json.loads(written("json"))
    assert [entry["equation"] for entry in data] == [claim.equation for claim in claims()]
    assert set(data[0]) == {"equation", "says", "verdict", "right", "note"}


def test_unknown_format():
    """A format that does not exist is refused, with those that do."""
    with pytest.raises(UnknownNameError, match="text or json"):
        written("xml")


def test_command():
    """The command prints the text; the last line counts."""
    from geomtorsion.cli.app import app

    result = CliRunner().invoke(app, ["paper"])
    assert result.exit_code == 0, result.output
    assert result.output.strip() == written().strip()
    assert result.output.strip().endswith("17 claims recomputed: 15 agree, 2 misprints.")
    as_json = CliRunner().invoke(app, ["paper", "--format", "json"])
    assert len(json.loads(as_json.output)) == 17
