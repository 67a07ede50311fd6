"""Properties on random expressions: ring laws, derivation, division, numbers, growth."""

from fractions import Fraction

import mpmath
import sympy as sp
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from geomtorsion.exact import Field
from tests.strategies import expressions, points, x, y

SYMBOLS = (x, y)
SAMPLE = {x: Fraction(3, 10), y: Fraction(2, 7)}
quick = settings(
    max_examples=40,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)


def exact_value(expression, point, digits=50):
    """The expression's value by mpmath."""
    with mpmath.workdps(digits):
        numbers = [mpmath.mpf(point[s].numerator) / point[s].denominator for s in SYMBOLS]
        return mpmath.mpmathify(sp.lambdify(SYMBOLS, expression, modules="mpmath")(*numbers))


@quick
@given(expressions(), expressions(), expressions())
def test_ring_laws(one, two, three):
    """Addition and multiplication commute, associate and distribute, exactly."""
    field = Field(SYMBOLS, sample=SAMPLE)
    a, b, c = (field.read(e) for e in (one, two, three))
    assert a + b == b + a
    assert a * b == b * a
    assert (a + b) + c == a + (b + c)
    assert (a * b) * c == a * (b * c)
    assert a * (b + c) == a * b + a * c
    assert a + field.zero == a
    assert a * field.one == a
    assert (a - a).is_zero is True
    assert a**3 == a * a * a
    assert field.sum([(2, a, b), (-3, c), (Fraction(1, 2), a, a, c)]) == (
        2 * a * b - 3 * c + a * a * c / 2
    )


@quick
@given(expressions(), expressions())
def test_division(one, two):
    """a / b * b is a, and the inverse of the inverse is the element."""
    field = Field(SYMBOLS, sample=SAMPLE)
    a, b = field.read(one), field.read(two)
    if b.is_zero is False:
        assert a / b * b == a
        assert b.inverse().inverse() == b
        assert b**-2 == (b * b).inverse()


@quick
@given(expressions(), expressions())
def test_derivation(one, two):
    """d is linear, obeys the product and quotient rules, and partials commute."""
    field = Field(SYMBOLS, sample=SAMPLE)
    a, b = field.read(one), field.read(two)
    assert (a + b).diff(x) == a.diff(x) + b.diff(x)
    assert (a * b).diff(x) == a.diff(x) * b + a * b.diff(x)
    assert a.diff(x).diff(y) == a.diff(y).diff(x)
    if b.is_zero is False:
        assert (a / b).diff(y) * b * b == a.diff(y) * b - a * b.diff(y)


@quick
@given(expressions(leaves=7), points(SYMBOLS))
def test_values(expression, point):
    """The element, its written form and its derivative have the values that mpmath gives."""
    field = Field(SYMBOLS, sample=SAMPLE)
    element = field.read(expression)
    wanted = exact_value(expression, point)
    scale = max(1, abs(wanted))
    with mpmath.workdps(50):
        assert (
            abs(mpmath.mpmathify(element.evaluate(point, precision=170)) - wanted) < 1e-30 * scale
        )
        assert abs(exact_value(element.sympy, point) - wanted) < 1e-30 * scale
        slope = exact_value(sp.diff(expression, x), point)
        found = exact_value(element.diff(x).sympy, point)
        assert abs(found - slope) < 1e-30 * max(1, abs(slope))


@quick
@given(expressions(), st.lists(expressions(leaves=2), min_size=1, max_size=3))
def test_earlier_expressions_change_nothing(expression, others):
    """An expression reads the same in a fresh field and in a field that holds other expressions."""
    crowded = Field(SYMBOLS, sample=SAMPLE)
    early = crowded.read(expression)
    for other in others:
        crowded.read(other)
    late = crowded.read(expression)
    assert early == late
    assert hash(early) == hash(late)
    after = Field(SYMBOLS, sample=SAMPLE)
    for other in others:
        after.read(other)
    assert after.read(expression - early.sympy).is_zero is True


@quick
@given(expressions(leaves=4))
def test_expanded_and_factored_forms_agree(expression):
    """Rewritten by sympy in several ways, an expression gives the same element."""
    field = Field(SYMBOLS, sample=SAMPLE)
    element = field.read(expression)
    for rewrite in (sp.expand, sp.expand_trig, sp.together, lambda e: e.rewrite(sp.exp)):
        changed = rewrite(expression)
        if changed.has(sp.I):
            continue
        assert field.read(changed) == element, changed
