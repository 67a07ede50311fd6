"""Square factors: roots of p**2 q, where p is a factor only modulo sin**2 + cos**2 = 1."""

from __future__ import annotations

from typing import Any

import mpmath
import pytest
import sympy as sp
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from geomtorsion.errors import ExpressionError
from geomtorsion.exact import Field, parse_expression

a, b, u, x = SYMBOLS = sp.symbols("a b u x", real=True)
CIRCLES = (sp.cos(a), sp.sin(a), sp.cos(b), sp.sin(b), sp.sin(a + b))
HYPERBOLAS = (sp.cosh(u), sp.sinh(u), sp.cosh(2 * u), sp.Integer(1))
MIXED = (sp.cos(a), sp.sin(a), sp.sinh(u), sp.exp(b), x)
quick = settings(
    max_examples=60,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)


def sums(atoms: tuple[sp.Expr, ...]) -> st.SearchStrategy[sp.Expr]:
    """Sums of up to three products of up to two of these, with small numbers."""
    factor = st.sampled_from([*atoms, sp.Integer(1)])
    term = st.builds(
        lambda number, one, two: number * one * two, st.integers(-3, 3).filter(bool), factor, factor
    )
    return st.lists(term, min_size=1, max_size=3).map(lambda terms: sp.Add(*terms))


def fields() -> st.SearchStrategy[Field]:
    """Fields whose signs are read off at random points."""
    numbers = st.lists(st.fractions(-3, 3, max_denominator=100), min_size=4, max_size=4)
    return numbers.map(
        lambda values: Field(SYMBOLS, sample=dict(zip(SYMBOLS, values, strict=True)))
    )


def roots(field: Field) -> list[Any]:
    """Roots of functions that the field has."""
    return [g for g in field.generators if g.kind == "root" and g.depends]


@pytest.mark.parametrize("atoms", [CIRCLES, HYPERBOLAS, MIXED], ids=["cos", "cosh", "mixed"])
def test_the_root_of_a_square_times_a_factor(atoms: tuple[sp.Expr, ...]) -> None:
    """sqrt(p**2 q) is |p| sqrt(q) at the sample point, without a denominator, in either order."""

    @quick
    @given(fields(), sums(atoms), sums(atoms), st.booleans())
    def check(field: Field, one: sp.Expr, two: sp.Expr, is_first: bool) -> None:
        p, q = field.read_all([("p", one), ("q", two)])
        assume(p._num and q._num)
        sign = field.sample.value(q)
        assume(abs(sign) > 1e-3 and abs(field.sample.value(p)) > 1e-3)
        q = q if sign > 0 else -q
        if is_first:
            q.sqrt()
        root = (p * p * q).sqrt()
        assert root * root == p * p * q
        with mpmath.workdps(60):
            wanted = abs(field.sample.value(p)) * mpmath.sqrt(field.sample.value(q))
            assert abs(field.sample.value(root) / wanted - 1) < mpmath.mpf(10) ** -50
        assert root in (p * q.sqrt(), -p * q.sqrt())
        assert field.denominator(root).is_one
        assert len(roots(field)) < 2

    check()


@pytest.mark.parametrize(
    ("radicand", "written"),
    [
        # A product of two factors of odd degree in half of the angle is even: sin(a)**2.
        ("(1 - cos(a)**2)*(1 + cos(a)**2)", "sin(a)*sqrt(1 + cos(a)**2)"),
        ("sin(a)**2*cos(b)**2 + cos(a)**2*sin(b)**2 + 2*sin(a)*cos(a)*sin(b)*cos(b)", "sin(a + b)"),
        ("(cosh(u)**2 - 1)*(x**2 + 1)", "sinh(u)*sqrt(x**2 + 1)"),
        ("x*(exp(u) + exp(-u))**2", "2*cosh(u)*sqrt(x)"),
        ("(cosh(u) + sinh(u))**4*(2 + cosh(u))", "exp(2*u)*sqrt(2 + cosh(u))"),
        ("(1 + sin(a))**2*(1 + x**2)", "(1 + sin(a))*sqrt(1 + x**2)"),
        ("(1 - cos(a))**3", "(1 - cos(a))*sqrt(1 - cos(a))"),
    ],
)
def test_squares_that_hide(radicand: str, written: str) -> None:
    """Each radicand is a square times a shorter one; all symbols are positive and below 1."""
    names = {symbol.name: symbol for symbol in SYMBOLS}
    field = Field(SYMBOLS, sample=dict.fromkeys(SYMBOLS, sp.Rational(1, 2)))
    under, wanted = (parse_expression(text, names) for text in (radicand, written))
    root = field.read(sp.expand(under)).sqrt()
    assert root == field.read(wanted)


def test_a_factor_without_a_root_among_the_functions_stays() -> None:
    """1 - cos(a) = 2 sin(a/2)**2, and sin(a/2) is not rational in cos(a) and sin(a)."""
    field = Field([a], sample={a: 1})
    root = field.read(1 - sp.cos(a)).sqrt()
    assert root == field.generator_element(roots(field)[0])
    assert (root * root).sympy == 1 - sp.cos(a)


@pytest.mark.parametrize("first", [2, 3, sp.Rational(1, 2)])
def test_numbers_under_a_root(first: sp.Expr) -> None:
    """sqrt(2) beside sqrt(2 X) and sqrt(X): the quotient of the two roots is a number at X = 0."""
    field = Field([x], sample={x: 1})
    over, plain = field.read(first * (x + 3)).sqrt(), field.read(x + 3).sqrt()
    assert len(roots(field)) == 1
    assert (over / plain).evaluate({x: -3}) == pytest.approx(float(sp.sqrt(first)))
    assert field.read(sp.sqrt(first)) * plain == over


def test_signs_bind_the_point() -> None:
    """A sign that a root outside was read with holds for all later roots."""
    field = Field([x, a])
    outside = field.read(sp.expand((x - 2) ** 2 * (x + sp.cos(a) + 3))).sqrt()
    with pytest.raises(ExpressionError, match="negative at every point"):
        field.read(sp.sqrt(x - sp.Rational(5, 2)))
    assert field.sample.value(outside) > 0
