"""Shifted zeros: addition theorems for arguments of every form, and their near misses."""

from __future__ import annotations

import sympy as sp
from sympy import E, Rational, atan, cos, exp, log, pi, sin, sinh, sqrt

from tests.exact.symbols import a, f, m, r, x, y

tiny = Rational(1, 10**25)

ARGUMENTS = {
    "symbol": x,
    "sum": x + r,
    "third": x / 3,
    "product": x * r,
    "square": x**2,
    "quotient": x / r,
    "reciprocal": 1 / x,
    "quotient by a sum": x / (r + m),
    "quotient of products": r * x / m,
    "root": sqrt(r),
    "logarithm": log(r),
    "arc tangent": atan(x),
    "exponential": exp(x),
    "sine": sin(x),
    "function": f(r),
    "multiple of a root": sqrt(2) * x,
    "multiple of pi": pi * x,
    "part of pi": x / pi,
    "pi over a symbol": pi / r,
    "period": 2 * pi * x / a,
    "phase": 2 * x / r - 3 * y + 1 / m,
}


def identities(u: sp.Expr) -> dict[str, sp.Expr]:
    """Addition theorems that vanish for every argument."""
    return {
        "pi/3": sin(u + pi / 3) - sin(u) / 2 - sqrt(3) / 2 * cos(u),
        "pi/2": cos(u - pi / 2, evaluate=False) - sin(u),
        "one radian": sin(u + 1) - sin(u) * cos(1) - cos(u) * sin(1),
        "doubled": sin(2 * u) - 2 * sin(u) * cos(u),
        "log 2": exp(u + log(2)) - 2 * exp(u),
        "one": exp(u + 1) - E * exp(u),
        "pi": exp(u + pi) - exp(pi) * exp(u),
        "hyperbolic": sinh(u + 1) - sinh(u) * sp.cosh(1) - sp.cosh(u) * sinh(1),
        "power of two": 2 ** (u + 1) - 2 * 2**u,
        "power of a symbol": m ** (u + 1) - m * m**u,
        "two letters": sin(u + y) - sin(u) * cos(y) - cos(u) * sin(y),
        "logarithm in the exponent": exp(u + log(m)) - m * exp(u),
    }


def near_misses(u: sp.Expr) -> dict[str, sp.Expr]:
    """Addition theorems with one coefficient or sign changed: never zero."""
    return {
        "shift": sin(u + pi / 3) - sin(u) / 2 - (sqrt(3) / 2 + tiny) * cos(u),
        "exponent": exp(u + log(2)) - (2 + tiny) * exp(u),
        "power": 2 ** (u + 1) - (2 + tiny) * 2**u,
        "wrong sign": sin(u + y) - sin(u) * cos(y) + cos(u) * sin(y),
    }
