"""Numeric: values at points, in floats and in many digits."""

import cmath

import mpmath
import pytest
import sympy as sp

from geomtorsion.teaching.exercises.answers import expression
from geomtorsion.teaching.exercises.domain import Domain
from geomtorsion.teaching.exercises.numeric import at_point, at_points
from geomtorsion.teaching.exercises.question import (
    Question,
)

x, y = sp.symbols("x y", real=True)


def question(kind="expression", **more) -> Question:
    """A question whose answer is x."""
    return Question("q", kind, "?", lambda: more.pop("right", x), Domain((x, y)), **more)


@pytest.mark.parametrize(
    "text",
    ["sin(x)*exp(y)/(2 + cos(x))", "sqrt(2 + x)", "atan2(x, y)", "acot(x)", "sec(x)*csc(y)",
     "log(3 + x, 2)", "asinh(x) + acosh(2 + y) + atanh(y/3)", "sech(x)*csch(y)", "pi*E*coth(x)",
     "x^(1/3)", "acoth(2 + x) + asec(2 + y) + acsc(-2 - x)", "asech(x)*acsch(y)"],
)  # fmt: skip
def test_values_agree_with_sympy(text):
    """Floats at many points and many digits at one, against sympy's own evaluation."""
    expr = expression(question(), text, "q")
    point = {x: sp.Rational(3, 7), y: sp.Rational(5, 9)}
    exact = complex(expr.subs(point).evalf(40))
    columns = {symbol: [float(value)] for symbol, value in point.items()}
    assert at_points(expr, columns)[0] == pytest.approx(exact, rel=1e-13)
    many = at_point(expr, point)
    assert many is not None
    want = mpmath.mpmathify(expr.subs(point).evalf(60))
    assert abs(many - want) < mpmath.mpf(10) ** -55 * (1 + abs(want))


def test_no_value_is_none():
    """Poles and numbers beyond all size have no value; neither takes time or memory."""
    assert at_point(1 / (x - y), {x: sp.Integer(1), y: sp.Integer(1)}) is None
    assert at_point(sp.exp(sp.exp(sp.exp(x))), {x: sp.Integer(30)}) is None
    [pole, other] = at_points(1 / x - 1 / x**2, {x: [0.0, 2.0]})
    assert cmath.isnan(pole)
    assert other == 0.25
    [large] = at_points(sp.exp(sp.exp(sp.exp(x))), {x: [30.0]})
    assert not cmath.isfinite(large)


@pytest.mark.parametrize(("exponent", "known"), [(3999, True), (4001, False)])
def test_how_large_a_value_may_become(exponent, known):
    """Numbers of four thousand bits are worked out, larger ones are given up."""
    found = at_point(sp.Integer(2) ** x, {x: sp.Rational(exponent)})
    assert (found is not None) == known
    assert found is None or mpmath.mag(found.real) == exponent + 1


@pytest.mark.parametrize(("cancelled", "known"), [(190, True), (210, False)])
def test_how_many_digits_there_are(cancelled, known):
    """So many digits of two hundred may cancel until none is left."""
    small = sp.Rational(1, 10**cancelled)
    found = at_point(sp.exp(small * x) - 1, {x: sp.Rational(1, 2)})
    assert (abs(found / small - 0.5) < 1e-5) == known


@pytest.mark.parametrize(("size", "known"), [(199, True), (201, False)])
def test_how_large_an_angle_may_be(size, known):
    """A sine of a larger angle has lost so many digits that fewer than those compared are left."""
    assert (at_point(sp.sin(x), {x: sp.Integer(2) ** size}) is not None) == known
