"""Expressions on one line: short, and readable as input in ASCII."""

import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from geomtorsion.exact import parse_expression
from geomtorsion.pictures.latex import latex_text
from geomtorsion.pictures.text import expression_text, greek_name

r, M, theta, phi1 = sympy.symbols("r M theta phi1", positive=True)
NAMES = {"r": r, "M": M, "theta": theta, "phi1": phi1}
f, h = sympy.Function("f")(r), sympy.Function("h")(r, theta)


@pytest.mark.parametrize(
    ("expression", "text"),
    [
        (sympy.Integer(0), "0"),
        (1 - 2 * M / r, "1 - 2*M/r"),
        (-M - r, "-M - r"),
        (M - r, "M - r"),
        (sympy.sin(theta) ** 2, "sin(θ)^2"),
        (1 / sympy.sin(theta) ** 2, "1/sin(θ)^2"),
        (1 / sympy.sin(theta), "1/sin(θ)"),
        (1 / (1 - r) ** 2, "1/(1 - r)^2"),
        (sympy.cos(phi1) / sympy.sin(phi1), "cos(φ1)/sin(φ1)"),
        (sympy.sqrt(r), "sqrt(r)"),
        (r ** sympy.Rational(-3, 2), "r^(-3/2)"),
        (r**-M, "r^(-M)"),
        (sympy.pi / 2, "π/2"),
        (f.diff(r) * f, "f(r)*f'(r)"),
        (f.diff(r, 3), "f'''(r)"),
        (f.diff(r, 4), "f^(4)(r)"),
        (h.diff(r, 2, theta), "diff(h(r, θ), r, 2, θ)"),
        (M * (r - M) / 2, "M*(r - M)/2"),
    ],
)
def test_as_a_person_would_write_it(expression, text):
    """Positive terms first, one slash, primes for derivatives, Greek letters for their names."""
    assert expression_text(expression) == text


def test_names():
    """Names of Greek letters become letters, with their number; others do not change."""
    assert [greek_name(n) for n in ("phi2", "Omega", "x1", "theta_12", "beta_x", "etas")] == [
        "φ2", "Ω", "x1", "θ12", "beta_x", "etas",
    ]  # fmt: skip


def _expressions():
    leaves = st.sampled_from([r, M, theta, sympy.Integer(2), sympy.Rational(3, 4), f, h.diff(r)])
    return st.recursive(
        leaves,
        lambda inner: st.one_of(
            st.tuples(inner, inner).map(lambda p: p[0] + p[1]),
            st.tuples(inner, inner).map(lambda p: p[0] * p[1]),
            st.tuples(inner, st.sampled_from([-2, -1, 2, sympy.Rational(1, 2)])).map(
                lambda p: p[0] ** p[1]
            ),
            inner.map(sympy.sin),
            inner.map(lambda x: -x),
        ),
        max_leaves=8,
    )


@given(_expressions())
def test_ascii_text_can_be_read_back(expression):
    """ASCII text of an expression is read as the same expression."""
    written = expression_text(expression, greek=False)
    assert written.isascii()
    assert sympy.expand(parse_expression(written, NAMES) - expression) == 0


def test_three_primes_at_most():
    """Up to three primes are written; a fourth derivative shows its order for readability."""
    r = sympy.Symbol("r")
    a = sympy.Function("a")(r)
    assert expression_text(a.diff(r, 3)) == "a'''(r)"
    assert expression_text(a.diff(r, 4)) == "a^(4)(r)"
    assert latex_text(a.diff(r, 4)) == r"a^{(4)}\left(r\right)"
