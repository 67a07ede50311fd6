"""Maxima: the reader of answers reads exported text as the same expression."""

import pytest
import sympy as sp

from geomtorsion.teaching.exercises.checking import check_question
from geomtorsion.teaching.exercises.domain import Domain
from geomtorsion.teaching.exercises.exports.maxima import maxima_list, maxima_matrix, maxima_text
from geomtorsion.teaching.exercises.question import Question

r, phi = sp.symbols("r phi", positive=True)
DOMAIN = Domain((r, phi))


@pytest.mark.parametrize(
    "expr",
    [
        sp.pi * r / 2,
        sp.E * r - sp.exp(-2 * r),
        sp.sqrt(1 - r**2) / (3 * sp.sin(phi) ** 2),
        -sp.cosh(r) * sp.tan(phi / 3) + sp.Rational(22, 7),
        sp.log(r) ** sp.Rational(3, 2),
        sp.atan2(r, phi),
    ],
    ids=str,
)
def test_expressions(expr):
    """Constants with a percent sign, powers with ^, and fractions are read unchanged."""
    question = Question("q", "expression", "?", lambda: expr, DOMAIN)
    assert check_question(question, maxima_text(expr)).right


def test_components():
    """A matrix of Maxima is read as a matrix; a list contains all components in order."""
    value = {(0, 0): r, (1, 0): 1 / r, (1, 1): sp.pi}
    question = Question("q", "components", "?", lambda: value, DOMAIN, shape=(2, 2))
    assert check_question(question, maxima_matrix(value, (2, 2))).right
    assert maxima_list({(0,): 0.25}, 2) == "[0.25,0]"
