"""MathML: well formed, of the core elements only, with every letter and number in it."""

import re
import xml.etree.ElementTree as ElementTree

import pytest
import sympy
from hypothesis import given

from geomtorsion.errors import ExpressionError
from geomtorsion.pictures.catalogue import CATALOGUE
from geomtorsion.pictures.formula import tree_of
from geomtorsion.pictures.labels import latex_label, text_label
from geomtorsion.pictures.latex import equation_latex, latex_name
from geomtorsion.pictures.mathml import expression_mathml, mathml
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
    root = ElementTree.fromstring(markup if "<math" in markup else f"<math>{markup}</math>")
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
    assert shape(expression_mathml(expression)) == expected


@given(_expressions())
def test_always_well_formed(expression):
    """Whatever the expression: core elements, right number of children, no letter lost."""
    root = parsed(expression_mathml(expression))
    text = "".join(root.itertext())
    for symbol in expression.free_symbols:
        assert greek_name(symbol.name) in text


def parsed_text(expression) -> str:
    """The markup of an expression, which is well formed."""
    markup = expression_mathml(expression)
    parsed(markup)
    return markup


def test_names_are_escaped():
    """A name cannot smuggle markup into a page."""
    for name in ("<script>", "a}<script>{", "x&"):
        assert "<script>" not in mathml(latex_name(name))
        assert "<script>" not in parsed_text(sympy.Function(name)(r))


@pytest.mark.parametrize("entry", CATALOGUE, ids=lambda entry: entry.name)
def test_equations_are_well_formed(entry):
    """Each definition becomes markup, with every index in its own column."""
    root = parsed(mathml(equation_latex(entry.equation)))
    both = re.search(r"[_^](?:\{[^}]*\}|\w)[_^]", entry.equation)
    assert bool(list(root.iter("mmultiscripts"))) == bool(both)
    assert not list(root.iter("msubsup")), "an index stands above another"
    assert "_" not in "".join(root.itertext())
    assert "{" not in "".join(root.itertext())


def test_index_positions_are_visible():
    """Lower and upper indices stand one after the other, not above each other."""
    assert text_label("S", list("abc"), "ddu") == "S_{ab}^c"
    assert text_label("S", list("abc"), "dud") == "S_a^b_c"
    assert latex_label("S", list("abc"), "dud") == "S_{a}{}^{b}{}_{c}"
    element = parsed(mathml(latex_label("S", list("abc"), "dud")))[0]
    columns = ["".join(part.itertext()) for part in element]
    assert columns == ["S", "a", "", "", "b", "c", ""]


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
    """A formula of ours that cannot be shown is an error, not a blank."""
    with pytest.raises(ExpressionError, match="formula"):
        tree_of(latex)
