"""MathML: well formed, only core elements, all letters and numbers present, fonts included."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import pytest
import sympy
from hypothesis import given

from geomtorsion import spaces
from geomtorsion.errors import ExpressionError
from geomtorsion.geometry.quantities import TABLE
from geomtorsion.pictures import formula
from geomtorsion.pictures.formula import (
    LETTERS,
    expression_mathml,
    font_face,
    mathml,
)
from geomtorsion.pictures.latex import equation_latex, latex_label, latex_name, text_label
from geomtorsion.pictures.report import write_report
from geomtorsion.pictures.text import greek_name
from geomtorsion.teaching.exercises.sheets import write_sheet
from tests.browser import Watched, hosted
from tests.pictures.test_text import _expressions

# Elements of MathML Core that browsers support: no mfenced, no entities.
CORE = {
    "math", "mrow", "mi", "mn", "mo", "mtext", "mspace", "mfrac", "msqrt", "mroot", "msup", "msub",
    "msubsup", "mover", "munder", "mpadded", "mtable", "mtr", "mtd",
}  # fmt: skip
CHILDREN = {"mfrac": 2, "msup": 2, "msub": 2, "mover": 2, "mroot": 2}
r, M, theta = sympy.symbols("r M theta", positive=True)
f, h = sympy.Function("f")(r), sympy.Function("h")(r, theta)


def parsed(markup: str) -> ElementTree.Element:
    """Root element of some markup, checked for the rules of browsers."""
    root = ElementTree.fromstring(markup if "<math" in markup else f"<math>{markup}</math>")
    for element in root.iter():
        assert element.tag in CORE
        if element.tag in CHILDREN:
            assert len(element) == CHILDREN[element.tag], ElementTree.tostring(element)
    return root


def shape(markup: str) -> str:
    """Markup as text with brackets, which makes structures easy to compare."""
    marks = {"mfrac": "({}/{})", "msup": "{}^{}", "msub": "{}_{}", "msqrt": "√({})"}

    def of(element: ElementTree.Element) -> str:
        inner = [of(child) for child in element]
        if element.tag in marks and element.tag != "msqrt":
            return marks[element.tag].format(*inner)
        text = (element.text or "") + "".join(inner)
        return f"√({text})" if element.tag == "msqrt" else text

    return re.sub("[\u2061\u2062]", "", of(parsed(markup)))


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        (sympy.Integer(-2), "−2"),
        (sympy.Rational(-3, 2), "−(3/2)"),
        (1 - 2 * M / r, "1−(2M/r)"),
        (-r / 2, "−(r/2)"),
        (sympy.sqrt(1 - r), "√(1−r)"),
        (1 / sympy.sqrt(r), "(1/√(r))"),
        (r**2 * sympy.sin(theta) ** 2, "r^2sin^2θ"),
        (sympy.sin(2 * theta), "sin(2θ)"),
        (-sympy.sin(theta) * r, "−rsinθ"),
        (M * (r - M), "M(r−M)"),
        ((r - M) ** 2, "(r−M)^2"),
        (2 * r * M, "2Mr"),
        (sympy.exp(-2 * r) * r, "re^−2r"),
        (sympy.log(r) ** 2, "ln^2r"),
        (f**2, "f(r)^2"),
        (f.diff(r, 2) / f, "(f′′(r)/f(r))"),
        (h.diff(r, theta), "∂_rθh(r,θ)"),
        (sympy.I * r, "ir"),
        (sympy.pi / 2, "(π/2)"),
        (r**M, "r^M"),
        (2 ** (r + 1), "2^r+1"),
        (sympy.Symbol("x_1") + sympy.Symbol("phi2"), "φ_2+x_1"),
    ],
)
def test_structure(expression, expected):
    """Fractions, roots, powers, brackets and signs are in their usual positions."""
    assert shape(expression_mathml(expression)) == expected


@given(_expressions())
def test_always_well_formed(expression):
    """Any expression gives core elements with the right number of children and all its letters."""
    root = parsed(expression_mathml(expression))
    text = "".join(root.itertext())
    for symbol in expression.free_symbols:
        assert greek_name(symbol.name) in text


def parsed_text(expression) -> str:
    """Markup of an expression, checked to be well formed."""
    markup = expression_mathml(expression)
    parsed(markup)
    return markup


def test_names_are_escaped():
    """Markup in a name is escaped."""
    for name in ("<script>", "a}<script>{", "x&"):
        assert "<script>" not in mathml(latex_name(name))
        assert "<script>" not in parsed_text(sympy.Function(name)(r))


@pytest.mark.parametrize("entry", TABLE, ids=lambda entry: entry.name)
def test_equations_are_well_formed(entry):
    """Each definition becomes markup, with each index in its own column."""
    root = parsed(mathml(equation_latex(entry.equation)))
    both = re.search(r"[_^](?:\{[^}]*\}|\w)[_^]", entry.equation)
    empty = [
        script
        for script in root.iter()
        if script.tag[:4] in ("msub", "msup") and not len(script[0])
    ]
    assert any(one[0].tag == "mrow" for one in empty) == bool(both)
    assert not list(root.iter("msubsup")), "an index is above another"
    assert "_" not in "".join(root.itertext())
    assert "{" not in "".join(root.itertext())


@pytest.mark.parametrize(
    ("text", "latex"),
    [
        pytest.param(
            "[E_i, E_j] = C_ij^k E_k", r"[E_{i}, E_{j}] = C_{i j}{}^{k}\,E_{k}", id="frame"
        ),
        pytest.param("[X_a, Y_b]^c", "[X_{a}, Y_{b}]^{c}", id="with an index"),
        pytest.param("T_[abc]", "T_{[ a b c ]}", id="antisymmetric"),
        pytest.param("d_[n e^i_m]", r"d_{[ n}\,e^{i}{}_{m ]}", id="across factors"),
    ],
)
def test_brackets_of_commutators_and_of_indices(text, latex):
    """A bracket closes among the indices only if it was opened among them."""
    assert equation_latex(text) == latex
    parsed(mathml(equation_latex(text)))


def test_index_positions_are_visible():
    """Lower and upper indices follow each other; none is above another."""
    assert text_label("S", list("abc"), "ddu") == "S_{ab}^c"
    assert text_label("S", list("abc"), "dud") == "S_a^b_c"
    assert latex_label("S", list("abc"), "dud") == "S_{a}{}^{b}{}_{c}"
    element = parsed(mathml(latex_label("S", list("abc"), "dud")))
    scripts = [(one.tag, *("".join(part.itertext()) for part in one)) for one in element]
    assert scripts == [("msub", "S", "a"), ("msup", "", "b"), ("msub", "", "c")]


def test_formulas_as_markup():
    """Scripts, fractions, roots, matrices, accents."""
    assert mathml("x_1^2") == "<math><msubsup><mi>x</mi><mn>1</mn><mn>2</mn></msubsup></math>"
    assert "<msqrt>" in mathml(r"\sqrt{2}")
    assert mathml(r"\begin{pmatrix} 1 & 2 \\ 3 & 4 \end{pmatrix}").count("<mtd>") == 4
    assert "<mover" in mathml(r"\dot\Omega")
    assert 'display="block"' in mathml("x", display=True)
    assert "&lt;" in mathml("x < y")


@pytest.mark.parametrize("latex", [r"\unknown x", "{x", "x}", r"\left( x", r"\frac{1}", "x^"])
def test_formulas_that_are_wrong_are_refused(latex):
    """A malformed formula raises an error, so it never becomes a blank."""
    with pytest.raises(ExpressionError, match="formula"):
        mathml(latex)


SIGNS = (
    "partial wedge times cdot vee oint int sum ldots le ge ne to infty prime approx pm langle "
    "rangle"
).split()
# Each report embeds the font; a larger file would make reports slow to load.
MOST_BYTES = 150_000
# The bracket of a matrix has at least this fraction of the matrix's height.
COVERED = 0.9
LEAVES = "math mi, math mo, math mn"


def fonts_of(page: Any, selector: str) -> set[tuple[str, bool]]:
    """Font family of each drawn element, and whether the page provides the font."""
    link = page.context.new_cdp_session(page)
    link.send("DOM.enable")
    link.send("CSS.enable")
    root = link.send("DOM.getDocument")["root"]["nodeId"]
    nodes = link.send("DOM.querySelectorAll", {"nodeId": root, "selector": selector})["nodeIds"]
    assert nodes
    found = set()
    for node in nodes:
        for font in link.send("CSS.getPlatformFontsForNode", {"nodeId": node})["fonts"]:
            found.add((font["familyName"], font["isCustomFont"]))
    return found


def cut_off(page: Any) -> list[str]:
    """Text of boxes that cut off a part of a formula above or below."""
    return page.evaluate(
        """() => [...document.querySelectorAll(".scroll, .head, main p, main li, .wide")]
            .filter((e) => e.offsetParent && getComputedStyle(e).overflowY === "hidden")
            .filter((e) => {
                const box = e.getBoundingClientRect();
                return [...e.querySelectorAll("math, math *")].some((m) => {
                    const b = m.getBoundingClientRect();
                    return b.height && (b.top < box.top - 0.5 || b.bottom > box.bottom + 0.5);
                });
            }).map((e) => e.textContent.slice(0, 60))"""
    )


def test_the_font_is_small_and_has_its_license():
    """The font file is below 150 kB, and its license is beside it."""
    folder = Path(formula.__file__).with_name("fonts")
    [font] = folder.glob("*.woff2")
    assert font.stat().st_size < MOST_BYTES
    assert font.read_bytes()[:4] == b"wOF2"
    text = (folder / "OFL.txt").read_text("utf-8")
    assert font.name in text
    assert "SIL OPEN FONT LICENSE" in text
    assert "The STIX Fonts Project Authors" in text


def test_every_letter_and_sign_is_in_it(watched: Watched):
    """All letters and signs of formulas are drawn with this font only."""
    letters = [rf"\{name}" for name in (*LETTERS, *SIGNS)]
    letters += [chr(k) for k in (*range(ord("a"), ord("z") + 1), *range(ord("A"), ord("Z") + 1))]
    latex = [*letters, r"\bar{a}\dot{b}\ddot{c}\hat{d}\tilde{e}'", "0123456789.", r"-+=,;/|!<>()[]"]
    latex += [r"\sin x \text{ words, too }", r"\sqrt{x}", r"\left(\frac{1}{2}\right)"]
    html = "".join(f"<p>{mathml(text)}</p>" for text in latex)
    watched.page.set_content(f"<!doctype html><style>{font_face()}</style>{html}")
    watched.page.evaluate("document.fonts.ready")
    assert fonts_of(watched.page, LEAVES) == {("STIX Two Math", True)}


@pytest.mark.parametrize("name", [pytest.param("so3", marks=pytest.mark.slow), "schwarzschild"])
def test_a_report_brings_its_font(name: str, watched: Watched, tmp_path: Path):
    """The report uses its own font, brackets are as high as their matrix, no index is cut off."""
    page = watched.page
    with hosted(write_report(spaces.load(name), tmp_path, pictures=False)) as address:
        page.goto(address)
        page.evaluate("document.fonts.ready")
        assert fonts_of(page, LEAVES) == {("STIX Two Math", True)}
        heights = page.locator("#metric mtable").evaluate_all(
            """(all) => all.map((m) => [m.getBoundingClientRect().height,
                m.previousElementSibling.getBoundingClientRect().height])"""
        )
        assert heights
        assert all(bracket > COVERED * matrix for matrix, bracket in heights)
        assert cut_off(page) == []


def test_a_sheet_brings_its_font(watched: Watched, tmp_path: Path):
    """A sheet of exercises uses its own font, and no formula is cut off."""
    with hosted(write_sheet("4", tmp_path)[0]) as address:
        watched.page.goto(address)
        watched.page.evaluate("document.fonts.ready")
        assert fonts_of(watched.page, LEAVES) == {("STIX Two Math", True)}
        assert cut_off(watched.page) == []


def test_the_page_brings_its_font(shared_lab: Watched):
    """The served page uses its own font, and no formula is cut off."""
    shared_lab.tab("Any tetrad").wait_for_selector("#torsion math")
    shared_lab.page.evaluate("document.fonts.ready")
    assert fonts_of(shared_lab.page, LEAVES) == {("STIX Two Math", True)}
    assert cut_off(shared_lab.page) == []
