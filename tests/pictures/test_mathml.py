"""MathML: well formed, of the core elements only, with every letter and number in it."""

import re
import xml.etree.ElementTree as ElementTree

import pytest
import sympy
from hypothesis import given

from geomtorsion.pictures.catalogue import CATALOGUE
from geomtorsion.pictures.equations import equation_mathml
from geomtorsion.pictures.labels import latex_label, mathml_label, text_label
from geomtorsion.pictures.mathml import identifier, mathml
from geomtorsion.pictures.text import greek_name
from tests.pictures.test_text import _expressions

# MathML Core as browsers have it: no mfenced, no entities.
CORE = {
    "math", "mrow", "mi", "mn", "mo", "mtext", "mspace", "mfrac", "msqrt", "mroot", "msup", "msub",
    "msubsup", "mover", "munder", "mmultiscripts", "mtable", "mtr", "mtd",
}  # fmt: skip
CHILDREN = {"mfrac": 2, "msup": 2, "msub": 2, "mover": 2, "mroot": 2}
r, M, theta = sympy.symbols("r M theta", positive=True)
f, h = sympy.Function("f")(r), sympy.Function("h")(r, theta)


def parsed(markup: str) -> ElementTree.Element:
    """The element of some markup, checked for what a browser needs."""
    root = ElementTree.fromstring(f"<math>{markup}</math>")
    for element in root.iter():
        assert element.tag in CORE
        if element.tag in CHILDREN:
            assert len(element) == CHILDREN[element.tag], ElementTree.tostring(element)
        if element.tag == "mmultiscripts":
            assert len(element) % 2 == 1
    return root


def shape(markup: str) -> str:
    """Markup as text with brackets, so that structure can be compared at a glance."""
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
    """Fractions, roots, powers, brackets and signs stand where a person puts them."""
    assert shape(mathml(expression)) == expected


@given(_expressions())
def test_always_well_formed(expression):
    """Whatever the expression: core elements, right number of children, no letter lost."""
    root = parsed(mathml(expression))
    text = "".join(root.itertext())
    for symbol in expression.free_symbols:
        assert greek_name(symbol.name) in text


def test_names_are_escaped():
    """A name cannot smuggle markup into a page."""
    assert "<script>" not in identifier("<script>")
    assert "<script>" not in mathml(sympy.Function("<script>")(r))


@pytest.mark.parametrize("entry", CATALOGUE, ids=lambda entry: entry.name)
def test_equations_are_well_formed(entry):
    """Each definition becomes markup, with every index in its own column."""
    root = parsed(equation_mathml(entry.equation))
    indexed = len(re.findall(r"\w\u0304?'?[_^]", re.sub(r"\{[^}]*\}", "x", entry.equation)))
    assert bool(list(root.iter("mmultiscripts"))) == bool(indexed)
    assert "_" not in "".join(root.itertext())
    assert "{" not in "".join(root.itertext())


def test_index_positions_are_visible():
    """Lower and upper indices stand one after the other, not above each other."""
    assert text_label("S", list("abc"), "ddu") == "S_{ab}^c"
    assert text_label("S", list("abc"), "dud") == "S_a^b_c"
    assert latex_label("S", list("abc"), "dud") == "S_{a}{}^{b}{}_{c}"
    element = parsed(mathml_label("<mi>S</mi>", [f"<mi>{m}</mi>" for m in "abc"], "dud"))[0]
    columns = ["".join(part.itertext()) for part in element]
    assert columns == ["S", "a", "", "", "b", "c", ""]
