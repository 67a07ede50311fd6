"""Formulas of tables and sentences: mathematics is set, words and code stay text."""

# pyright: reportMissingImports=false

import pytest

docstrings = pytest.importorskip("docstrings")
equations = pytest.importorskip("equations")


@pytest.mark.parametrize(
    ("text", "latex"),
    [
        ("partial_a v^c", "∂_{a}\\,v^{c}"),
        ("(*alpha)_b", "(⋆α)_{b}"),
        ("alpha ^ *alpha", "α ∧ ⋆α"),
        ("sqrt|g| L", "\\sqrt{|g|} L"),
        ("x_1 + ... + x_n", "x_{1} + … + x_{n}"),
        ("(-1)^(p (n - p))", "(-1)^{p ( n - p )}"),
        ("c1 T1", "c_{1}\\,T_{1}"),
        ("alpha^{i3}", "α^{i 3}"),
        ("2*x", "2\\,x"),
    ],
)
def test_signs(text, latex):
    """Signs of plain mathematics in LaTeX."""
    assert " ".join(equations.latex_of(text).split()) == latex


@pytest.mark.parametrize(
    ("sentence", "formulas"),
    [
        ("A frame: n one-forms e^i = e^i_mu dq^mu.", ["e^{i} = e^{i}{}_{μ} \\mathrm{d}q^{μ}"]),
        ("Newton's law: m v' = F in space.", ["m v' = F"]),
        ("omega_ai^j: D_a E_i = 0.", ["ω_{a i}{}^{j}", "D_{a}\\,E_{i} = 0"]),
        ("T_abc = A_abc + tensor part.", ["T_{a b c} = A_{a b c}"]),
        ("Gamma = Gamma_bar + K.", ["\\Gamma = \\bar \\Gamma + K"]),
        ("A tetrad (l, m, m_bar).", []),
        ("Elastic constants C_IJ: stress_I is a sum.", []),
        ('A field: field(metadata=unit("m")).', []),
        ("Nothing here is mathematics.", []),
        ("", []),
    ],
)
def test_sentences(sentence, formulas):
    """Formulas of a sentence, and the words around them unchanged."""
    pieces = equations.pieces(sentence)
    found = [" ".join(text.split("\0")[0].split()) for kind, text in pieces if kind == "math"]
    assert found == formulas


def test_code_in_a_sentence_with_formulas():
    """Code keeps its blanks, and formulas on both sides of it are set."""
    found = docstrings.with_formulas("With S_ab^c = 0, `a b = c` and `Frame`, u^i = 0.")
    assert r"``a b = c``" in found
    assert r":py:obj:`Frame <geomtorsion.Frame>`" in found
    assert found.count(":math:") == 2
    assert docstrings.with_formulas("") == ""
    assert docstrings.with_formulas("`x`") == r"\ ``x``\ "


def test_conventions_are_formulas():
    """Each equation of the conventions is set, and no sign is spelled out."""
    tables = pytest.importorskip("tables")
    conventions = pytest.importorskip("geomtorsion.conventions").CONVENTIONS
    for one in conventions:
        lines = [line for line in tables._formulas(one.formula) if line]
        assert any(line.startswith(":math:") for line in lines), one.name
        text = " ".join(lines)
        assert "partial" not in text
        assert "sqrt|" not in text
