"""geomtorsion paper: every claim is recomputed, verdicts follow from the computation."""

import json

import pytest
import sympy as sp
from typer.testing import CliRunner

from geomtorsion.cli import claims_frames, claims_geometry, claims_rotation, claims_translation
from geomtorsion.cli.claims import claims
from geomtorsion.cli.claims_frames import rotations
from geomtorsion.cli.paper import written
from geomtorsion.cli.printed import PHI, epsilon, same
from geomtorsion.errors import UnknownNameError
from geomtorsion.geometry import Frame, cartan

# The misprints that were found by hand before.
MISPRINTS = {
    "(9) right": "factor",
    "after (9)": "garbled",
    "(17)": "dot",
    "(18)": "dot",
    "around (21)": "order",
    "(23)": "sign",
    "under (24)": "sign",
    "(26)": "index",
    "(27)": "dot",
}


def test_every_equation_from_1_to_27_is_there():
    """Each number has at least one claim, in the order of the paper but for (1) to (4)."""
    numbers = [
        int(claim.equation[1:].split(")")[0]) for claim in claims() if claim.equation[0] == "("
    ]
    assert set(numbers) == set(range(1, 28))
    assert numbers == sorted(numbers)
    assert len(claims()) >= 42
    assert all(claim.right for claim in claims())


def test_verdicts():
    """Misprints are those of the reading, each with the reason; all else agrees."""
    wrong = {c.equation: c.verdict for c in claims() if not c.agrees}
    assert set(wrong) == set(MISPRINTS)
    for number, reason in MISPRINTS.items():
        assert wrong[number].startswith("misprint: ")
        assert reason in wrong[number], number
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


ANOTHER = [[1, 0, 0], [0, sp.sin(PHI[0]), 0], [0, 0, PHI[0]]]


def test_verdicts_follow_the_geometry(monkeypatch):
    """With another frame in place of the right one the same claims are found to be wrong."""
    other = Frame(PHI, ANOTHER, name="another")
    monkeypatch.setattr(claims_geometry, "rotations", lambda: other)
    found = (*claims_geometry._metric(), *claims_geometry._torsion())
    wrong = [c for c in found if not c.agrees]
    assert {"(9) left", "(9) right", "(10)", "(12)"} <= {c.equation for c in wrong}
    (inverse,) = [c for c in wrong if c.equation == "(9) right"]
    assert "proportional" in inverse.verdict


def test_verdicts_follow_the_mechanics(monkeypatch):
    """So are those of the action principle: with another frame (1), (15) and (19) are wrong."""
    monkeypatch.setattr(claims_frames, "rotations", lambda: Frame(PHI, ANOTHER))
    turning = claims_rotation
    found = [*turning.first(), *turning.third(), *turning.variations(), *turning.principle()]
    wrong = {c.equation: c.verdict for c in found if not c.agrees}
    assert {"(1)", "(3)", "(15)", "(18)", "(19)"} <= set(wrong)
    assert "more than its notation" in wrong["(18)"]
    assert "(16)" not in wrong, "holds over any frame"


def test_verdicts_follow_the_motion(monkeypatch):
    """With the forms R dx instead of R^T dx: (2), (23), (25) and (27) fail in earnest."""
    turn = claims_frames.attitude()
    rows = sp.diag(rotations().coframe.to_sympy().tomatrix(), turn)
    coordinates = (*PHI, *claims_frames.PLACE)
    monkeypatch.setattr(claims_frames, "motions", lambda: Frame(coordinates, rows))
    flying = claims_translation
    found = [*flying.second(), *flying.variations(), *flying.action()]
    wrong = {c.equation: c.verdict for c in found if not c.agrees}
    assert {"(2)", "(23)", "(25)", "(27)"} <= set(wrong)
    assert "more than a sign" in wrong["(23)"]
    assert "more than its notation" in wrong["(27)"]


def test_right_form_of_23_is_that_of_the_chain_rule():
    """(23) by hand: eps^i_mu(phi) x'^mu varied, at numbers chosen at random."""
    turn, place = claims_frames.attitude().T, sp.Matrix(claims_frames.PLACE)
    s, t = sp.symbols("s t")
    values = [sp.Rational(3, 10) + s * 2 - t, 1 + t + s**2, t * s - 2 * t + s]
    path = dict(zip(PHI, values, strict=True)) | dict(
        zip(place, [t**2 + s, s * t - t, 3 * s - t], strict=True)
    )
    on = turn.subs(path)
    velocity, moved = on * place.subs(path).diff(t), on * place.subs(path).diff(s)
    forms = rotations().coframe.to_sympy().tomatrix().subs(path)
    angles = sp.Matrix(values)
    spin, turned = forms * angles.diff(t), forms * angles.diff(s)
    left = velocity.diff(s) - moved.diff(t)
    right = spin.cross(moved) - turned.cross(velocity)
    here = {s: sp.Rational(1, 7), t: sp.Rational(2, 5)}
    assert max(abs(sp.N((left - right).subs(here), 30))) < 1e-25
    assert max(abs(sp.N((left + right).subs(here), 30))) > 1e-2


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
    assert result.output.strip().endswith("42 claims recomputed: 33 agree, 9 misprints.")
    as_json = CliRunner().invoke(app, ["paper", "--format", "json"])
    assert len(json.loads(as_json.output)) == 42
