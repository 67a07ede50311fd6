"""Compare: exact equality, agreement on a part of the domain, and the rule that decides."""

import pytest
import sympy as sp

from geomtorsion.errors import ExpressionError, LimitError
from geomtorsion.teaching.exercises.checking import check_question
from geomtorsion.teaching.exercises.compare import (
    DIFFERENT,
    EQUAL,
    PARTLY,
    agreement,
    agrees,
    compare,
)
from geomtorsion.teaching.exercises.domain import Domain
from geomtorsion.teaching.exercises.question import Question
from tests.teaching.exercises.hard_answers import HARD

x = sp.Symbol("x", real=True)
p = sp.Symbol("p", positive=True)
DOMAIN = Domain((x, p), (x > -2, x < 2))


def test_three_verdicts():
    """Equal in another form, equal for one sign of x, different."""
    assert compare(DOMAIN, (x + 1) ** 2, x**2 + 2 * x + 1) == EQUAL
    assert compare(DOMAIN, sp.sqrt(x**2 * p**2), x * p) == PARTLY
    assert compare(DOMAIN, x, x + 1) == DIFFERENT


def test_poles_do_not_count():
    """Points at which one side has no value are skipped."""
    assert compare(DOMAIN, (x**2 - 1) / (x - 1), x + 1) == EQUAL


def test_opaque_constants_are_decided_by_digits():
    """If exact arithmetic has no rule, a hundred digits at each point decide."""
    angle = sp.atan(sp.Rational(1, 2)) + sp.atan(sp.Rational(1, 3))
    assert compare(DOMAIN, angle * x, sp.pi / 4 * x) == EQUAL
    near = sp.Rational(str(sp.N(sp.pi / 4, 90)))
    assert compare(DOMAIN, angle * x, near * x) == DIFFERENT


def test_special_functions_are_compared():
    """A function that the library reads is compared, with or without a rule for its zeros."""
    assert compare(DOMAIN, sp.erf(x), sp.erf(x) + x) == DIFFERENT
    assert compare(DOMAIN, sp.erf(x) ** 2 - 1, (sp.erf(x) - 1) * (sp.erf(x) + 1)) == EQUAL


def test_imaginary_answers_are_refused():
    """The imaginary unit is not a symbol of a real problem."""
    assert compare(DOMAIN, sp.I * x, x) == DIFFERENT
    waves = (sp.exp(sp.I * x) + sp.exp(-sp.I * x)) / 2
    with pytest.raises(ExpressionError, match="cannot be read exactly"):
        compare(DOMAIN, waves, sp.cos(x))
    with pytest.raises(ExpressionError, match="Heaviside"):
        compare(DOMAIN, sp.Heaviside(x), x)


def test_a_form_too_large_to_expand_is_refused():
    """A form that is too large to multiply out raises LimitError."""
    big = sp.Mul(*(sp.sin(k * x) ** 2 + sp.cos(k * x) ** 2 for k in range(1, 25)))
    with pytest.raises(LimitError, match="multiplied out"):
        compare(DOMAIN, big * x, x)


def test_components_are_compared_one_by_one():
    """Components are compared one by one; a missing component is zero."""
    asked = Question("q", "components", "?", dict, DOMAIN, shape=(3,))
    states = agreement(asked, {(0,): x, (1,): p}, {(0,): x, (2,): 1})
    assert states == {(0,): EQUAL, (1,): DIFFERENT, (2,): DIFFERENT}
    assert agrees(asked, {(0,): x - x}, {})
    assert not agrees(asked, {(0,): x}, {})


def test_numbers_agree_within_the_tolerance():
    """The tolerance is relative to the largest component of the right answer, or to 1."""
    asked = Question("q", "number", "?", dict, DOMAIN, shape=(2,), tolerance=1e-2)
    right = {(0,): 100.0, (1,): 1.0}
    assert agrees(asked, {(0,): 100.9, (1,): 0.1}, right)
    assert agreement(asked, {(0,): 101.1}, right) == {(0,): DIFFERENT, (1,): EQUAL}
    assert agrees(asked, {(0,): 0.009}, {})
    assert not agrees(asked, {(0,): 0.011}, {})


@pytest.mark.parametrize("name", HARD)
def test_forms_at_which_graders_fail(name):
    """Sines, factored powers, nested lists, x^(a/b), parts of the domain, other minus signs."""
    hard = HARD[name]
    question = hard.question()
    for answer in hard.right:
        said = check_question(question, answer)
        assert said.right, (answer, said)
    for answer in hard.wrong:
        said = check_question(question, answer)
        assert not said.right, answer
        assert said.diagnosis not in ("unreadable", "too large"), (answer, said)


def test_large_numbers_on_the_way_to_a_large_solution():
    """High powers are compared exactly if they have few terms when multiplied out."""
    power = (x + 10) ** 600
    assert compare(Domain((x,)), (x + 10) * (x + 10) ** 599, power) == EQUAL
    assert compare(Domain((x,)), power + 1, power) == DIFFERENT
    with pytest.raises(LimitError, match="multiplied out"):
        compare(DOMAIN, x * power / (x**2 + 20 * x + 100) ** 300, x)


@pytest.mark.parametrize(("power", "taken"), [(90, True), (112, False)])
def test_how_many_digits_may_cancel(power, taken):
    """Without an exact rule a hundred digits may cancel; more are refused, not guessed."""
    right, angle = sp.pi / 4 * x, (sp.atan(sp.Rational(1, 2)) + sp.atan(sp.Rational(1, 3))) * x
    answer = angle + (x + 10) ** power - (x**2 + 20 * x + 100) ** (power // 2)
    if taken:
        assert compare(DOMAIN, answer, right) == EQUAL
    else:
        with pytest.raises(LimitError, match="more than 100 digits cancel"):
            compare(DOMAIN, answer, right)
    assert compare(DOMAIN, answer + x, right) == DIFFERENT


def test_rounding_on_the_way_decides_nothing():
    """A quotient by a small difference and a root of one lose more digits than their own size."""
    quotient = 1 / ((x + 300) ** 2 - x**2 - 600 * x - 90000 + sp.Rational(1, 10**5))
    assert compare(DOMAIN, quotient, sp.Integer(10**5)) == EQUAL
    small = sp.Rational(1, 10**9) * (x + 3)
    assert compare(DOMAIN, sp.sqrt((1 + small) ** 2 - 1 - 2 * small), small) == EQUAL
