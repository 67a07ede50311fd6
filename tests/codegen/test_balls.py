"""Balls: values, series and branch cuts of all functions, compared with mpmath."""

import math
import random
from dataclasses import replace
from fractions import Fraction

import flint
import mpmath
import numpy as np
import pytest
import sympy as sp
from flint import acb, arb, arb_series, ctx

from geomtorsion.codegen import balls, graph
from geomtorsion.codegen.ball_functions import COMPLEX, REAL
from geomtorsion.codegen.balls import BallCode, coefficient, exact_ball, float_values
from geomtorsion.codegen.printers import FUNCTIONS
from geomtorsion.errors import ExpressionError
from geomtorsion.support.precision import ball_precision
from tests.rounding import ROUNDED

X = sp.Symbol("x", real=True)
Y = sp.Symbol("y", real=True)
# Expressions with a point where they are analytic.
SMOOTH = [
    (sp.sin(X) * sp.cos(X), 0.3), (sp.tan(X), 1.1), (sp.exp(X) / (1 + X**2), -0.7),
    (sp.log(X), 0.4), (sp.sqrt(X), 2.3), (X ** sp.Rational(1, 3), 2.3), (X ** sp.pi, 1.7),
    (sp.sinh(X), -1.2), (sp.cosh(X), 0.6), (sp.tanh(X), -2.5), (sp.tanh(X), 2.5),
    (sp.tanh(X), 0), (sp.asin(X), 0.4), (sp.acos(X), -0.3), (sp.atan(X), 3.0),
    (sp.asinh(X), -1.5), (sp.acosh(X), 1.6), (sp.atanh(X), 0.35), (sp.erf(X), 0.8),
    (sp.erfc(X), 0.8), (sp.erfi(X), 0.5), (sp.gamma(X), 2.6), (sp.loggamma(X), 3.1),
    (sp.Ei(X), 1.2), (sp.atan2(X, X - 2), 0.5), (sp.atan2(-X, X - 2), 0.5),
    (sp.atan2(X, X + 2), -0.5), (sp.Abs(X), -0.5), (X**-3, 1.3), (X**7 - 3 * X, -0.9),
    (sp.Max(X, 1) + sp.Min(X, 1), 0.25), (2 ** X, 0.75), (sp.EulerGamma * X + sp.E, 1.0),
]  # fmt: skip
SPECIAL = [
    (sp.besselj(2, X), 1.5), (sp.besseli(1, X), 0.7), (sp.bessely(0, X), 2.0),
    (sp.besselk(1, X), 1.1), (sp.besselj(3, X), -1.5), (sp.besselj(2, X), 0),
    (sp.besselj(3, X), 0), (sp.besseli(3, X), 0), (sp.besselj(sp.Rational(1, 3), X), 2.5),
    (sp.besseli(sp.Rational(1, 3), X), 2.5), (sp.besselk(sp.Rational(1, 3), X), 2.5),
    (sp.bessely(sp.Rational(-4, 3), X), 2.5), (sp.besselj(1, sp.sin(X)), 0.5),
    (sp.airyai(X), -1.5), (sp.airybi(X), 0.5), (sp.airyaiprime(X), 1.5),
    (sp.airybiprime(X**2), 0.75), (sp.LambertW(X), 0.7), (sp.LambertW(X), 0),
    (sp.LambertW(X, -1), -0.25), (sp.polygamma(0, X), 1.5), (sp.polygamma(0, X), -1.5),
    (sp.polygamma(2, X), 0.75), (sp.expint(1, X), 0.5), (sp.expint(sp.Rational(5, 2), X), 1.5),
    (sp.expint(3, X * X), 1.5), (sp.uppergamma(sp.Rational(1, 3), X), 0.5),
    (sp.lowergamma(sp.Rational(1, 3), X), 2.5), (sp.Ei(X), -1.5), (sp.li(X), 0.5),
    (sp.li(X), 2.5), (sp.Si(X), -0.5), (sp.Ci(X), 0.5), (sp.Shi(X), 0.5), (sp.Chi(X), 1.5),
    (sp.factorial(X), 1.5), (sp.beta(X, 1 + X), 0.75), (sp.erf2(X, X**2), 0.75),
    (sp.gamma(X), -0.5),
]  # fmt: skip


def _code(expr):
    return BallCode(graph(["x"], [expr], factor=False))


def _truth(expr, at, order=0):
    """A Taylor coefficient to 50 digits, by sympy and mpmath."""
    if expr == sp.LambertW(X) and at == 0:
        # W(x) = x - x^2 + 3/2 x^3 - ...; its slope is written as a quotient 0/0.
        return mpmath.mpf(-order) ** (order - 1) / math.factorial(order) if order else mpmath.mpf(0)
    slope = sp.diff(expr.rewrite(sp.erf), X, order) / math.factorial(order)
    with mpmath.workdps(60):
        return mpmath.mpf(sp.N(slope.subs(X, sp.Rational(at)), 50))


def _contains(ball, value):
    """Whether a ball contains an mpmath number to about 90 bits."""
    return abs(ball - exact_ball(value)) < arb(2) ** -90 * (1 + abs(ball))


@pytest.mark.parametrize(("expr", "at"), SMOOTH + SPECIAL, ids=str)
def test_balls_contain_the_value(expr, at):
    """Real and complex balls contain the value to about 90 bits."""
    with ball_precision(128):
        real = _code(expr).real([arb(at)])[0]
        both = _code(expr).complex([acb(at)], analytic=True)[0]
        truth = _truth(expr, at)
        assert _contains(real, truth)
        assert _contains(both.real, truth)
        assert both.imag.contains(0)


@pytest.mark.parametrize(("expr", "at"), SMOOTH + SPECIAL, ids=str)
def test_wide_analytic_balls_contain_real_values(expr, at):
    """A box around a real interval contains the values on it: the continuation is of these."""
    if expr.has(sp.polygamma) and at < 0:
        pytest.skip("Arb has no bounds of wide balls left of zero")
    with ball_precision(128):
        sides = acb(arb(0, 2.0**-5), arb(0, 2.0**-5))
        wide = _code(expr).complex([acb(at) + sides], analytic=True)[0]
        assert wide.is_finite()
        for part in (-0.03, 0.0, 0.02):
            place = sp.Rational(at) + sp.Rational(part)
            assert wide.contains(acb(exact_ball(_truth(expr, place)).mid()))


@pytest.mark.parametrize(("expr", "at"), SMOOTH + SPECIAL, ids=str)
def test_series_are_the_derivatives(expr, at):
    """The first coefficients of a series are derivatives over factorials."""
    with ball_precision(128):
        before, ctx.cap = ctx.cap, 4
        try:
            made = _code(expr).real([arb_series([at, 1], prec=4)])[0]
            found = [coefficient(made, k) for k in range(4)]
        finally:
            ctx.cap = before
        for k, ball in enumerate(found):
            assert _contains(ball, _truth(expr, at, k))


@pytest.mark.parametrize(
    ("expr", "at"),
    [
        (sp.log(X), -1), (sp.sqrt(X), -1), (X ** sp.Rational(1, 3), -1), (X ** sp.pi, -1),
        (sp.atan(X), 1.5j), (sp.atan(X), -1.5j), (sp.asinh(X), 2j), (sp.asin(X), 1.5),
        (sp.acos(X), -1.5), (sp.atanh(X), 2), (sp.acosh(X), 0.5), (sp.acosh(X), -3),
        (sp.loggamma(X), -1.5), (sp.Ei(X), 0), (sp.li(X), 1), (sp.li(X), -1),
        (sp.atan2(X, -2), 0), (sp.bessely(0, X), -1),
        (sp.besselk(1, X), -1), (sp.besselj(sp.Rational(1, 2), X), -1), (sp.Abs(X), 0),
        (1 / X, 0), (sp.gamma(X), -2), (sp.tan(X), sp.pi / 2),
        (sp.LambertW(X), -0.5), (sp.LambertW(X, -1), -0.5), (sp.LambertW(X, -1), 0.5),
        (sp.Ci(X), -1), (sp.Chi(X), -1), (sp.expint(1, X), -1), (sp.expint(2, X), 0),
        (sp.uppergamma(sp.Rational(1, 3), X), -1), (sp.lowergamma(sp.Rational(1, 3), X), -1),
        (sp.polygamma(0, X), -1), (sp.factorial(X), -1), (sp.beta(X, 2), -1),
        (sp.besseli(sp.Rational(1, 3), X), -1),
    ],
    ids=str,
)  # fmt: skip
def test_nothing_is_analytic_on_a_cut(expr, at):
    """A ball about a point of a branch cut or pole has no value; a ball beside it has one."""
    value = complex(at)
    side = value + (0.5 if value.real == 0 and value.imag else 0.25 + 0.5j)
    with ball_precision(64):
        small = acb(arb(value.real, 2.0**-20), arb(value.imag, 2.0**-20))
        assert not _code(expr).complex([small], analytic=True)[0].is_finite()
        beside = _code(expr).complex([acb(side.real, side.imag)], analytic=True)[0]
        assert beside.is_finite()


def test_an_integral_over_a_cut_shows_who_forgets_it(monkeypatch):
    """Without the test for the branch cut of atan this integral would be wrong."""

    def integral():
        code = _code(sp.atan(3 / (X - sp.Rational(1, 2))))
        function, numbers = code.complex_function(), code.numbers()
        return acb.integral(lambda z, a: function([z], numbers, a)[0], 0, 1, eval_limit=20000).real

    with ball_precision(64):
        # The integrand is odd about 1/2, where it jumps from -pi/2 to pi/2.
        found = integral()
        assert found.contains(0) or not found.is_finite()
        code = BallCode(graph(["x"], [sp.atan(X)], factor=False))
        whole = acb(arb(0, 0.1), arb(1, 0.5))
        assert not code.complex([whole], analytic=True)[0].is_finite()
        monkeypatch.setitem(COMPLEX, "atan", lambda x, analytic: x.atan() if not analytic else x)
        balls._compiled.cache_clear()
        assert replace(code).complex([whole], analytic=True)[0].is_finite()
    balls._compiled.cache_clear()


def test_angles_continue_as_one_function():
    """atan2 of complex numbers is one analytic function in the right half plane."""
    code = BallCode(graph(["y", "x"], [sp.atan2(Y, X)], factor=False))
    with ball_precision(100):
        random.seed(7)
        for _ in range(50):
            x, y = (acb(random.uniform(0.2, 2), random.uniform(-0.1, 0.1)) for _ in range(2))
            angle = code.complex([y, x], analytic=True)[0]
            assert (angle.tan() - y / x).contains(0)
            # Both formulas that hold in parts of the plane agree with it.
            assert (angle - (y / x).atan()).contains(0)
            assert (angle - (acb.pi() / 2 - (x / y).atan())).contains(0)


def test_series_that_end_early_have_no_coefficient():
    """FLINT shortens quotients of series that begin with zero; a missing term is not zero."""
    with ball_precision(64):
        before, ctx.cap = ctx.cap, 5
        try:
            x = arb_series([0, 1], prec=5)
            found = BallCode(graph(["x"], [sp.sin(X) / X], factor=False)).real([x])[0]
            assert not coefficient(found, 4).is_finite()
            assert not coefficient(arb_series([1, 2], prec=2), 3).is_finite()
        finally:
            ctx.cap = before


def test_exact_numbers():
    """Floats are dyadic, fractions and expressions exact; the sign of an mpf counts."""
    with ball_precision(200):
        with mpmath.workprec(600):
            long = -mpmath.sqrt(2)
        assert abs(exact_ball(long) + arb(2).sqrt()) < arb(2) ** -190
        assert exact_ball(long) < 0
        assert exact_ball(sp.Float(-0.5)) == -0.5
        assert exact_ball(np.float64(0.1)) == arb(0.1)
        assert exact_ball(np.longdouble(1) / 3) == arb(
            flint.fmpq(*(np.longdouble(1) / 3).as_integer_ratio())
        )
        assert (exact_ball(Fraction(1, 3)) * 3 - 1).contains(0)
        assert (exact_ball(sp.sqrt(sp.Integer(2)) - sp.pi) + arb.pi() - arb(2).sqrt()).contains(0)


def test_the_sign_of_an_mpf_is_not_forgotten():
    """The sign of an mpf is stored beside its digits."""
    assert exact_ball(mpmath.mpf(-0.5)) == -0.5


def test_unknown_constants_are_refused():
    """A constant without a known enclosure has no ball."""
    with pytest.raises(ExpressionError, match="expected a constant"):
        exact_ball(sp.TribonacciConstant)
    with pytest.raises(ExpressionError, match="expected a number"):
        exact_ball(sp.Symbol("x"))


def test_every_function_of_graphs_has_its_balls():
    """Both tables contain each function that a graph may call."""
    assert set(FUNCTIONS) <= set(COMPLEX)
    assert set(FUNCTIONS) <= set(REAL)


def test_floats_are_right_where_terms_cancel():
    """A value is right up to rounding, or None."""
    found = float_values(
        BallCode(graph(["x"], [1 - sp.cos(X), sp.sqrt(X - 1), sp.floor(X)])), [1e-9]
    )
    assert found[0] == pytest.approx(5e-19, rel=ROUNDED)
    assert found[1:] == [None, 0.0]


def test_precision_is_as_it_was():
    """The precision of FLINT is the same as before."""
    before = ctx.prec, ctx.cap
    float_values(BallCode(graph(["x"], [1 - sp.cos(X)])), [1e-9])
    assert (ctx.prec, ctx.cap) == before
