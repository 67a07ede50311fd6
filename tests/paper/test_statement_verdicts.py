"""The paper: each statement is recomputed, and verdicts follow from the computation."""

from dataclasses import replace

import pytest
import sympy as sp

from geomtorsion.geometry import Frame
from geomtorsion.paper import paper_frames, statements
from geomtorsion.paper.frames import POSITION, attitude
from geomtorsion.paper.statement import PHI

# The misprints that were found by hand.
MISPRINTS = {
    "(9) right": "factor",
    "after (9)": "garbled",
    "(11)": "last index",
    "(17)": "dot",
    "(18)": "dot",
    "around (21)": "order",
    "(23)": "sign",
    "under (24)": "sign",
    "(26)": "index",
    "(27)": "dot",
}
ANOTHER = Frame(PHI, [[1, 0, 0], [0, sp.sin(PHI[0]), 0], [0, 0, PHI[0]]], name="another")


@pytest.fixture(scope="module")
def found():
    """All statements, recomputed once."""
    return statements()


def test_every_equation_from_1_to_27_is_there(found):
    """Each equation number has at least one statement, in the order of the paper."""
    numbers = [int(one.equation[1:].split(")")[0]) for one in found if one.equation[0] == "("]
    assert set(numbers) == set(range(1, 28))
    assert numbers == sorted(numbers)
    assert len(found) == 42
    assert all(one.right for one in found)


def test_verdicts(found):
    """The misprints are the ones found by hand, with their reasons; all other statements agree."""
    wrong = {one.equation: one.verdict for one in found if not one.agrees}
    assert set(wrong) == set(MISPRINTS)
    assert sum(one.agrees for one in found) == 32
    for number, reason in MISPRINTS.items():
        assert wrong[number].startswith("misprint: ")
        assert reason in wrong[number], number
    assert "1/s2**2" in wrong["(9) right"]


def test_the_right_inverse_metric_is_given(found):
    """The right formula is the inverse of g, entry by entry."""
    (statement,) = [one for one in found if one.equation == "(9) right"]
    s2, c2 = sp.symbols("s2 c2")
    given = sp.Matrix(sp.sympify(statement.right.removeprefix("g^-1 = "), {"s2": s2, "c2": c2}))
    metric = sp.Matrix([[1, 0, c2], [0, 1, 0], [c2, 0, 1]])
    product = (given * metric).applyfunc(lambda e: sp.simplify(e.subs(c2**2, 1 - s2**2)))
    assert product == sp.eye(3)


def test_coframe_is_derived_from_the_attitude():
    """The coframe comes from R^T dR and agrees with eq. (8): det e = sin(phi2)."""
    rotations = paper_frames().rotations
    assert rotations.coordinates == PHI
    assert rotations.determinant[()] == sp.sin(PHI[1])


def test_verdicts_follow_the_rotations():
    """With another frame of rotations, the statements on geometry and action principle fail."""
    other = statements(replace(paper_frames(), rotations=ANOTHER))
    wrong = {one.equation: one.verdict for one in other if not one.agrees}
    assert {"(9) left", "(9) right", "(10)", "(12)"} <= set(wrong)
    assert "proportional" in wrong["(9) right"]
    assert {"(1)", "(3)", "(15)", "(18)", "(19)"} <= set(wrong)
    assert "more than its notation" in wrong["(18)"]
    assert "(16)" not in wrong, "holds over any frame"


def test_verdicts_follow_the_motions():
    """With the forms R dx instead of R^T dx, (2), (23), (25) and (27) fail as a whole."""
    frames = paper_frames()
    forms = sp.diag(frames.spin_forms, attitude())
    other = statements(replace(frames, motions=Frame((*PHI, *POSITION), forms)))
    wrong = {one.equation: one.verdict for one in other if not one.agrees}
    assert {"(2)", "(23)", "(25)", "(27)"} <= set(wrong)
    assert "more than a sign" in wrong["(23)"]
    assert "more than its notation" in wrong["(27)"]


def test_right_form_of_23_follows_the_chain_rule():
    """(23) checked by hand: the variation of eps^i_mu(phi) x'^mu, at a numeric point."""
    turn, place = attitude().T, sp.Matrix(POSITION)
    s, t = sp.symbols("s t")
    values = [sp.Rational(3, 10) + s * 2 - t, 1 + t + s**2, t * s - 2 * t + s]
    path = dict(zip(PHI, values, strict=True)) | dict(
        zip(place, [t**2 + s, s * t - t, 3 * s - t], strict=True)
    )
    on = turn.subs(path)
    velocity, moved = on * place.subs(path).diff(t), on * place.subs(path).diff(s)
    forms = paper_frames().spin_forms.subs(path)
    angles = sp.Matrix(values)
    spin, turned = forms * angles.diff(t), forms * angles.diff(s)
    left = velocity.diff(s) - moved.diff(t)
    right = spin.cross(moved) - turned.cross(velocity)
    here = {s: sp.Rational(1, 7), t: sp.Rational(2, 5)}
    assert max(abs(sp.N((left - right).subs(here), 30))) < 1e-25
    assert max(abs(sp.N((left + right).subs(here), 30))) > 1e-2
