"""Prose: formulas as text, and the small subset of Markdown."""

from xml.etree import ElementTree

import pytest
import sympy

from geomtorsion import exercises
from geomtorsion.teaching.exercises.prose import html_of, latex_of, plain_of, text_of
from geomtorsion.teaching.exercises.tex import tex
from geomtorsion.teaching.exercises.verdict import MESSAGES


def texts(number: str, seed: int) -> list[str]:
    """All texts that an exercise may show."""
    exercise = exercises.load(number, seed)
    found = [exercise.statement, *exercise.hints]
    for question in exercise.questions:
        found += [question.prompt, *question.options.values()]
        if seed == 0:
            found += [mistake.message for mistake in question.mistakes if mistake.message]
    return found


@pytest.mark.parametrize("number", exercises.names())
def test_everything_can_be_shown(number):
    """Well-formed HTML and text, without a stray dollar sign or backslash."""
    for seed in range(2):
        for text in texts(number, seed):
            html = html_of(text)
            ElementTree.fromstring(f"<div>{html}</div>")
            assert "$" not in html
            assert "\\" not in html
            plain = text_of(text)
            assert "$" not in plain
            assert "\\m" not in plain
            assert "**" not in plain
            assert plain


def test_messages_can_be_shown():
    """No message of a diagnosis keeps a dollar sign in the terminal."""
    for text in MESSAGES.values():
        assert "$" not in text_of(text)


@pytest.mark.parametrize(
    ("latex", "plain"),
    [
        (r"\Gamma_{ab}{}^c = E_i{}^c\,\partial_a e^i{}_b", "Γ_ab^c = E_i^c ∂_a e^i_b"),
        (r"\frac{a + b}{2 r}", "(a + b)/(2r)"),
        (r"\tfrac12 x", "1/2 x"),
        (r"\dot q^a + \ddot\phi", "q̇^a + φ̈"),
        (r"\bar\Gamma", "Γ̄"),
        (r"\sqrt{1 - x^2}", "sqrt(1 - x^2)"),
        (r"f'' - g'", "f′′ - g′"),
        (r"\sin{\left(\phi_{1} \right)}", "sin(φ_1)"),
        (r"\text{two words}", "two words"),
        (r"x^{2 k}", "x^(2k)"),
        (r"g^{ij} T_{ijk}", "g^ij T_ijk"),
        (r"\sin\theta\,\mathrm{d}\phi", "sin(θ) dφ"),
        (r"\cos^2\phi_1\det e", "cos^2(φ_1) det e"),
        (r"\sqrt[3]{r}", "(r)^(1/3)"),
        (r"\phi_{2} \mathrm{e}^{3 \phi_{2}}", "φ_2 exp(3φ_2)"),
    ],
)
def test_formulas_as_text(latex, plain):
    """A formula becomes one readable line."""
    assert plain_of(latex) == plain


def test_exponentials_differ_from_one_forms():
    """exp is a function, e with an index a one-form."""
    x = sympy.Symbol("phi2")
    assert plain_of(tex(x * sympy.exp(3 * x))) == "φ_2 exp(3φ_2)"
    assert plain_of(r"\mathrm{d}e^1 = e^2\wedge e^3") == "de^1 = e^2 ∧ e^3"


def test_markdown():
    """Paragraphs, lists, bold text around a formula, and code, which is not a formula."""
    html = html_of("One **bold $x$ text**.\n\n- first `a<b`\n- second\n\n$$y.$$")
    assert "<strong>bold <math><mi>x</mi></math> text</strong>" in html
    assert "<li>first <code>a&lt;b</code></li><li>second</li>" in html
    assert 'display="block"' in html
    assert text_of("a `code` and **bold**") == "a code and bold"


def test_prose_as_latex():
    """Special characters of LaTeX are escaped outside of formulas and kept inside them."""
    assert latex_of("50 % of `r_1` & {x}:\n\n$$a_1 & b$$") == (
        "50 \\% of \\texttt{r\\_1} \\& \\{x\\}:\n\n\\[a_1 & b\\]"
    )
    assert latex_of("~ ^ \\ $x_1$") == (
        r"\textasciitilde{} \textasciicircum{} \textbackslash{} $x_1$"
    )
    assert latex_of("- one\n- **two**") == "\\par -- one\n\\par -- \\textbf{two}"
