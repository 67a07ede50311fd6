"""Frames, tensors and connections in a notebook: right values, safe markup, no MathJax."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from typing import Any

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.pictures.formula import mathml
from geomtorsion.pictures.latex import latex_text
from geomtorsion.pictures.style import STYLE
from tests.chosen import one_in

R, PHI = sp.symbols("r phi", positive=True)
EVIL = "<img src=x onerror=alert(1)>"


def tree(html: str) -> ElementTree.Element:
    """Element tree of some HTML; fails if the HTML is not well formed."""
    return ElementTree.fromstring(f"<div>{html}</div>")


def rows(html: str) -> list[list[str]]:
    """Texts of the cells in all rows of components."""
    found = [["".join(cell.itertext()) for cell in row.iter("td")] for row in tree(html).iter("tr")]
    return [row for row in found if row]


def text(expression: object) -> str:
    """Text of a formula, without its markup."""
    return "".join(tree(mathml(latex_text(expression))).itertext())


def test_a_tensor_is_a_table_of_its_components():
    """Each independent component has a row with name and value; the table can be folded."""
    torsion = gt.cartan(gt.spaces.load("kerr").frame).torsion.S
    html = torsion._repr_html_()
    found = rows(html)
    assert [row[1] for row in found] == [text(row.value) for row in torsion.table()]
    assert found[0][0] == "Strt"
    assert tree(html)[0].tag == "details"
    assert "18 of 64 components do not vanish" in html
    assert "9 more follow by symmetry" in html
    assert gt.cartan(gt.spaces.load("kerr").frame).torsion._repr_html_() == html


def test_chosen_names_are_shown():
    """Chosen names are also used in the HTML table; indices of legs have a hat."""
    polar = gt.Frame([R, PHI], [[1, 0], [0, R]])
    assert rows(gt.cartan(polar).torsion.S.table("uv")._repr_html_())[0][0] == "Suvv"
    assert rows(polar.anholonomy.table("uv")._repr_html_())[0][0] == "Cuˆvˆvˆ"
    assert rows(polar.anholonomy._repr_html_())[0][0] == "C1ˆ2ˆ2ˆ"


def test_short_things_are_short():
    """Vanishing tensors and scalars have no table."""
    sphere = gt.spaces.load("s2").frame
    assert gt.cartan(sphere).curvature._repr_html_().count("all components vanish") == 1
    assert not rows(gt.cartan(sphere).curvature._repr_html_())
    shown = "".join(tree(gt.levi_civita(sphere).curvature.scalar._repr_html_()).itertext())
    assert shown == "curvature scalar R = 2R2"


def test_long_things_are_folded():
    """The first components are open, the others folded; the summary gives their number."""
    kerr = gt.spaces.load("kerr").frame
    derivative = gt.levi_civita(kerr).covariant_derivative(gt.cartan(kerr).torsion.S)
    html = derivative._repr_html_()
    count = len(derivative.components.independent)
    assert count > STYLE.unfolded
    assert f"<summary>{count - STYLE.unfolded} more components</summary>" in html
    assert len(rows(html)) == count


def test_a_connection_is_chosen_by_its_upper_index():
    """Each upper index has a part, and the parts together list all components."""
    bar = gt.levi_civita(gt.spaces.load("schwarzschild").frame)
    html = bar._repr_html_()
    parts = tree(html)[0].findall("details")
    assert len(parts) == 4
    assert len(rows(html)) == len(bar.table(every=True)) == 13
    assert "Levi-Civita connection" in html


def test_a_frame_shows_its_forms():
    """Each one-form, the signature and the branches of roots are shown."""
    frame = gt.spaces.load("schwarzschild").frame
    found = rows(frame._repr_html_())
    assert len(found) == 4
    assert found[2][1] == "= rdθ"
    assert "η=diag\u2061(−1,1,1,1)" in "".join(tree(frame._repr_html_()).itertext())
    assert "right where" in frame._repr_html_() or not frame.branches
    null = gt.spaces.load("kerr_kinnersley").frame
    assert "<mtable" in null._repr_html_()


def test_typed_text_is_escaped():
    """Names of coordinates, frames and spaces, and chosen names, never become markup."""
    x, y = sp.Symbol(EVIL), sp.Symbol("y")
    function = sp.Function(EVIL)
    frame = gt.Frame([x, y], [[1, 0], [x, function(y)]], name=EVIL)
    space = gt.spaces.Space(EVIL, EVIL, EVIL, EVIL, frame=frame, notes=EVIL)
    shown = [
        frame, frame.metric, frame.legs, gt.cartan(frame), gt.levi_civita(frame).curvature,
        gt.cartan(frame).torsion, frame.metric.table([EVIL, f"{EVIL}2"]), space,
        frame.scalar(function(y), EVIL, EVIL), frame.plan("ricci"),
    ]  # fmt: skip
    for one in shown:
        html = one._repr_html_()
        assert "<img" not in html, type(one)
    # Unescaped braces in names would end a formula early.
    odd = gt.Frame([sp.Symbol("a}b"), y], [[1, 0], [sp.Symbol("a}b"), 1]])
    assert "<tr>" in odd._repr_html_()


@pytest.mark.parametrize("name", one_in(3, gt.spaces.names()))
def test_every_shipped_space_is_shown(name):
    """All formulas of the space become MathML, in well-formed markup."""
    space = gt.spaces.load(name)
    for one in (space, space.frame.metric, gt.cartan(space.frame).torsion):
        html = one._repr_html_()
        tree(html)
        assert not re.search(r"<code>", html)


def test_people_count_legs_from_one():
    """Text, LaTeX and HTML count legs from 1; Python indices in square brackets count from 0."""
    polar = gt.Frame([R, PHI], [[1, 0], [0, R]])
    assert "e^1 = dr" in repr(polar)
    assert "e^0" not in repr(polar)
    assert r"\hat{0}" not in polar._repr_latex_() + polar.anholonomy._repr_latex_()
    assert ">0<" not in polar._repr_html_() + polar.anholonomy._repr_html_()
    assert "C_{12}^{2}  [0, 1, 1]" in str(polar.anholonomy.table())


def shown_in_notebooks() -> dict[str, Any]:
    """One object of each kind that once needed MathJax or was plain text."""
    frame = gt.spaces.load("so3").frame
    u = sp.symbols("u1 u2 u3")
    motion = gt.equations_of_motion(frame, (u[0] ** 2 + 2 * u[1] ** 2 + 3 * u[2] ** 2) / 2)
    exercise = gt.exercises.load("3.2")
    return {
        "equations of motion": motion,
        "reduced equations": motion.reduced,
        "variation": gt.variation(frame),
        "geodesic": gt.geodesic(frame, [0.3, 1, 0.2], frame_velocity=[1, 0, 0]),
        "exercise": exercise,
        "exercise with matrices": gt.exercises.load("1.1"),
        "verdict": exercise.check("2*phi2"),
        "verdict with formulas": exercise.check("-cos(phi2)*sin(phi2)"),
        "scene": gt.scenes.load("dzhanibekov"),
        "Burgers vector": gt.burgers_vector(frame, gt.Loop.circle([0.3, 1, 0.2], 0.3)),
    }


@pytest.mark.parametrize("name", list(shown_in_notebooks()))
def test_notebooks_need_no_mathjax(name):
    """The HTML is well formed, with formulas in MathML and without LaTeX."""
    html = shown_in_notebooks()[name]._repr_html_()
    assert tree(html) is not None
    # Figures have LaTeX in comments.
    html = re.sub(r"<!--.*?-->", "", html, flags=re.DOTALL)
    assert "$" not in html
    assert not re.search(r"\\[a-zA-Z]", html)
    if name not in ("verdict", "scene", "Burgers vector"):
        assert "<math" in html


def test_the_route_is_named_once():
    """The text does not repeat the route, as in "by the flux route: flux: ..."."""
    b = gt.burgers_vector(gt.spaces.load("so3").frame, gt.Loop.circle([0.3, 1, 0.2], 0.3))
    first = b._repr_html_().partition("</pre>")[0].splitlines()[3]
    assert first.count("flux") == 1
    assert "route: " not in first
