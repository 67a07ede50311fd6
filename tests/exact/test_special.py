"""Special functions: zeros are decided by their relations, and numbers agree with mpmath."""

from __future__ import annotations

import random

import mpmath
import pytest
import sympy as sp

from geomtorsion.errors import ExpressionError, GeomtorsionError
from geomtorsion.exact import Field, parse_expression
from tests.rounding import ROUNDED

x, y, n = sp.symbols("x y n", positive=True)
H, T = sp.Rational(1, 2), sp.Rational(1, 3)
J, Y, K, W = sp.besselj, sp.bessely, sp.besselk, sp.LambertW
gamma, psi = sp.gamma, sp.polygamma

ZEROS = [
    *(
        F(m + 2, x) + F(m, x) - 2 * (m + 1) * F(m + 1, x) / x
        for F in (J, Y)
        for m in (0, 3, T, -H, n)
    ),
    *(
        sp.besseli(m + 2, x) - sp.besseli(m, x) + 2 * (m + 1) * sp.besseli(m + 1, x) / x
        for m in (0, 3, T, n)
    ),
    *(K(m + 2, x) - K(m, x) - 2 * (m + 1) * K(m + 1, x) / x for m in (0, 3, T, n)),
    *(F(n - 3, x) + F(n - 1, x) - 2 * (n - 2) * F(n - 2, x) / x for F in (J, Y)),
    sp.besseli(n - 3, x) - sp.besseli(n - 1, x) - 2 * (n - 2) * sp.besseli(n - 2, x) / x,
    K(n - 3, x) - K(n - 1, x) + 2 * (n - 2) * K(n - 2, x) / x,
    J(1, x * y) * Y(0, x * y) - J(0, x * y) * Y(1, x * y) - 2 / (sp.pi * x * y),
    sp.besseli(n, x) * K(n + 1, x) + sp.besseli(n + 1, x) * K(n, x) - 1 / x,
    J(3 * H, x) - sp.sqrt(2 / (sp.pi * x)) * (sp.sin(x) / x - sp.cos(x)),
    K(H, x) ** 2 - sp.pi / (2 * x) * sp.exp(-2 * x),
    J(-n, x) - sp.cos(n * sp.pi) * J(n, x) + sp.sin(n * sp.pi) * Y(n, x),
    Y(-n, x) - sp.sin(n * sp.pi) * J(n, x) - sp.cos(n * sp.pi) * Y(n, x),
    sp.besseli(-n, x) - sp.besseli(n, x) - 2 / sp.pi * sp.sin(n * sp.pi) * K(n, x),
    J(30, x) + J(32, x) - 62 * J(31, x) / x,
    W(x) * sp.exp(W(x)) - x,
    W(x * y) ** 2 * sp.exp(2 * W(x * y)) - x**2 * y**2,
    W(x) * sp.exp(W(x) / 3) ** 3 - x,
    sp.log(W(x)) - sp.log(x) + W(x),
    W((x + y) * sp.exp(x + y)) - x - y,
    W(x * sp.log(x)) - sp.log(x),
    W(2) * sp.exp(W(2)) - 2,
    gamma(x + 3) - (x + 2) * (x + 1) * x * gamma(x),
    gamma(x - 2) * (x - 1) * (x - 2) - gamma(x),
    gamma(1 - x) * gamma(x) * sp.sin(sp.pi * x) - sp.pi,
    psi(0, x + 2) - psi(0, x) - 1 / x - 1 / (x + 1),
    psi(2, x + 1) - psi(2, x) - 2 / x**3,
    psi(1, 1 - x) + psi(1, x) - sp.pi**2 / sp.sin(sp.pi * x) ** 2,
    sp.loggamma(x + 2) - sp.loggamma(x) - sp.log(x) - sp.log(x + 1),
    sp.exp(sp.loggamma(x)) - gamma(x),
    sp.log(gamma(x + 2)) - sp.loggamma(x + 2),
    sp.factorial(x + 1) - (x + 1) * gamma(x + 1),
    sp.beta(x, y) * gamma(x + y) - gamma(x) * gamma(y),
    sp.erf(x) + sp.erfc(x) - 1,
    sp.erf(x - y) + sp.erf(y - x),
    sp.erf2(x, y) - sp.erf(y) + sp.erf(x),
    sp.expint(3, x) - (sp.exp(-x) - x * sp.exp(-x) + x**2 * sp.expint(1, x)) / 2,
    sp.expint(1, x) + sp.Ei(-x),
    sp.li(x) - sp.Ei(sp.log(x)),
    sp.Shi(x) + sp.Chi(x) - sp.Ei(x),
    sp.lowergamma(T, x) + sp.uppergamma(T, x) - gamma(T),
    sp.uppergamma(T + 1, x) - T * sp.uppergamma(T, x) - x**T * sp.exp(-x),
    sp.uppergamma(H, x) - sp.sqrt(sp.pi) * sp.erfc(sp.sqrt(x)),
    sp.airyai(x) * sp.airybiprime(x) - sp.airyaiprime(x) * sp.airybi(x) - 1 / sp.pi,
    sp.jn(1, x) - sp.sin(x) / x**2 + sp.cos(x) / x,
]


@pytest.mark.parametrize("zero", ZEROS, ids=str)
def test_relations_decide_zero(zero):
    """A relation and its derivative vanish; the relation plus 1e-40 does not."""
    field = Field([x, y, n])
    element = field.read(zero)
    assert element.is_zero is True
    assert element.certainty.proved or element.certainty.error < 1e-30
    assert element.diff(x).is_zero is True
    assert (element + field.rational(1, 10**40)).is_zero is False


# True relations that neither sympy nor the field knows.
UNKNOWN = [
    gamma(2 * x) * sp.sqrt(sp.pi) - 2 ** (2 * x - 1) * gamma(x) * gamma(x + H),
    sp.airyai(x) - sp.sqrt(x / 3) / sp.pi * K(T, 2 * x ** sp.Rational(3, 2) / 3),
    sp.polylog(2, x / 3)
    + sp.polylog(2, 1 - x / 3)
    - sp.pi**2 / 6
    + sp.log(x / 3) * sp.log(1 - x / 3),
]


@pytest.mark.parametrize("zero", UNKNOWN, ids=str)
def test_unknown_relations_are_undecided(zero):
    """The zero test of an unknown relation is undecided, with an error probability of 1."""
    element = Field([x, y]).read(zero)
    assert element.is_zero is None
    assert not element.certainty.proved
    assert element.certainty.error == 1
    assert "undecided" in str(element.certainty)


def _random_zero(chance: random.Random) -> sp.Expr:
    """A sum of relations times factors, expanded, so that the relations are hidden."""
    parts = chance.sample(ZEROS, 2)
    weights = [
        sp.sin(x) + y,
        1 / (1 + x**2),
        W(x * y),
        J(1, x),
        gamma(x + 1),
        sp.erf(y),
        sp.sqrt(x),
    ]
    return sp.expand(sum(part * chance.choice(weights) for part in parts))


@pytest.mark.parametrize(
    "seed", [*range(3), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(3, 16))]
)
def test_random_expressions_that_vanish_are_never_called_nonzero(seed):
    """The result is True, or None and not proved; with 1e-12 of a term added it is False."""
    chance = random.Random(seed)
    field, zero = Field([x, y, n]), _random_zero(chance)
    with mpmath.workdps(60):
        place = {x: sp.Rational(13, 10), y: sp.Rational(7, 10), n: sp.Rational(6, 5)}
        plain = zero.replace(sp.erf2, lambda a, b: sp.erf(b) - sp.erf(a))
        assert abs(plain.evalf(30, subs=place, maxn=200)) < 1e-20
    element = field.read(zero)
    assert element.is_zero is not False
    assert element.is_zero or not element.certainty.proved
    more = chance.choice(zero.args) / 10**12
    assert field.read(zero + more).is_zero is False


@pytest.mark.parametrize(
    "function",
    [
        J(20, x), J(T, x), Y(3, x), sp.besseli(2, x), K(4, x), J(n, x * y), J(-n, x), Y(-n, x),
        sp.besseli(n - 3, x), W(x),
        W(-x / 100, -1), gamma(x + T),
        sp.loggamma(x), psi(1, x), sp.erf(x), sp.erfc(40 * x), sp.erfi(x),
        sp.Ei(x), sp.expint(2, x),
        sp.uppergamma(T, x), sp.lowergamma(T, x), sp.airyai(x), sp.airybiprime(x), sp.erf2(x, y),
    ],
    ids=str,
)  # fmt: skip
def test_numbers_against_mpmath(function):
    """Values have 38 right digits, and so do derivatives against difference quotients."""
    place = {x: mpmath.mpf(3) / 8, y: mpmath.mpf(5) / 4, n: mpmath.mpf(7) / 4}
    element = Field([x, y, n]).read(function)
    with mpmath.workdps(60):
        known = {
            "erf2": lambda a, b: mpmath.erf(b) - mpmath.erf(a),
            "airybiprime": lambda a: mpmath.airybi(a, derivative=1),
        }
        of = sp.lambdify((x, y, n), function, [known, "mpmath"])

        def value(u):
            return mpmath.re(of(u, place[y], place[n]))

        for found, want in (
            (element.evaluate(place, 150), value(place[x])),
            (element.diff(x).evaluate(place, 150), mpmath.diff(value, place[x])),
        ):
            assert abs(found - want) < mpmath.mpf(10) ** -38 * abs(want)


def test_values_where_recurrences_would_lose_all_digits():
    """J_20 at 1/100, and W and J_1 with their derivatives at 0."""
    field = Field([x])
    small = field.read(J(20, x)).evaluate({x: sp.Rational(1, 100)}, 53)
    assert small == pytest.approx(float(mpmath.besselj(20, mpmath.mpf("0.01"))), rel=ROUNDED, abs=0)
    lambert, bessel = field.read(W(x)), field.read(J(1, x))
    assert [lambert.evaluate({x: 0}), lambert.diff(x).evaluate({x: 0})] == [0, 1]
    assert [bessel.evaluate({x: 0}), bessel.diff(x).evaluate({x: 0})] == [0, 0.5]


def test_orders_have_no_slope():
    """A Bessel function is read with any order, but not differentiated with respect to it."""
    element = Field([x, n]).read(J(n, x))
    assert element.diff(x).sympy.has(sp.besselj)
    with pytest.raises(ExpressionError, match="besselj.* has no derivative by n"):
        element.diff(n)


def test_division_by_a_hidden_zero_is_refused():
    """1/(J_0 + J_2 - 2 J_1/x) and 1/(W exp(W) - x) are refused."""
    for zero in (ZEROS[0], W(x) * sp.exp(W(x)) - x):
        with pytest.raises(GeomtorsionError, match="denominator is exactly zero"):
            Field([x, y, n]).read(1 / zero)


def test_equal_elements_are_equal_by_any_relation():
    """Elements that are equal by a relation compare equal."""
    field = Field([x, y, n])
    assert field.read(gamma(x + 1)) == field.read(x * gamma(x))
    assert field.read(W(x) * sp.exp(W(x))) == field.read(x)
    assert field.read(gamma(x + 1)) != field.read(gamma(x))


def test_special_functions_as_text():
    """The names of special functions are read, and a written element is read back."""
    names = {"x": x, "y": y}
    text = "besselj(1, x) + LambertW(x*y) + erfc(y) + polygamma(0, x)"
    want = J(1, x) + W(x * y) + sp.erfc(y) + psi(0, x)
    assert parse_expression(text, names) == want
    field = Field([x, y])
    element = field.read(want + gamma(x) + sp.Ei(y))
    assert field.from_json(element.to_json()) == element
    # Without a list of functions gamma(x) may be a function of the user.
    assert isinstance(parse_expression("gamma(x)", names), sp.core.function.AppliedUndef)
