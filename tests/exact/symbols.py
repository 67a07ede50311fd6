"""Symbols: the letters, unknown functions and one numeric point that the zero lists share."""

from __future__ import annotations

from fractions import Fraction

import mpmath
import sympy as sp

x, y, z, t, theta = sp.symbols("x y z t theta", real=True)
r, m, a, p, q = sp.symbols("r m a p q", positive=True)
f, g, h = sp.Function("f"), sp.Function("g"), sp.Function("h")

# 0 < x, y, z < pi/4 and r > 2 m > 2 a: every radical of the lists is real and positive here.
POINT = {
    x: Fraction(3, 10),
    y: Fraction(2, 7),
    z: Fraction(5, 11),
    t: Fraction(13, 6),
    theta: Fraction(4, 7),
    r: Fraction(37, 8),
    m: Fraction(9, 8),
    a: Fraction(3, 4),
    p: Fraction(7, 5),
    q: Fraction(5, 3),
}


def with_definite_functions(expression: sp.Expr) -> sp.Expr:
    """Expression with definite functions instead of f, g and h, so that it has a numeric value."""
    u, v = sp.Dummy("u"), sp.Dummy("v")
    known = {
        f: sp.Lambda(u, 2 + sp.sin(u) + u**3 / 7),
        g: sp.Lambda(u, 3 + u**2 / 5 + sp.cos(2 * u)),
        h: sp.Lambda((u, v), 4 + sp.sin(u * v) + u * v**2),
    }
    expression = sp.sympify(expression)
    for name, value in known.items():
        expression = expression.replace(name, value)
    return expression.doit()


def number(expression: sp.Expr, digits: int = 60, point: dict = POINT) -> mpmath.mpf | mpmath.mpc:
    """Value of an expression at a point (by default POINT), by mpmath and without the package."""
    expression = with_definite_functions(expression)
    order = sorted(expression.free_symbols, key=str)
    with mpmath.workdps(digits):
        values = [
            mpmath.mpf(point[s].numerator) / point[s].denominator if s in point else None
            for s in order
        ]
        return mpmath.mpmathify(sp.lambdify(order, expression, modules="mpmath")(*values))


def plain(expression: sp.Expr) -> sp.Expr:
    """The same expression in symbols without assumptions."""
    expression = sp.sympify(expression)
    return expression.xreplace({s: sp.Symbol(s.name) for s in expression.free_symbols})
