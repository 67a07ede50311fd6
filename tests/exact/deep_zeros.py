"""Deep zeros: identities that may be refused or undecided, but never count as non-zero."""

from __future__ import annotations

from sympy import (
    Rational,
    acos,
    asin,
    asinh,
    atan,
    atanh,
    cbrt,
    cos,
    exp,
    log,
    pi,
    sin,
    sinh,
    sqrt,
    tan,
    tanh,
)

from tests.exact.symbols import m, p, r, x, y

DEEP = {
    "heptagon": cos(pi / 7) - cos(2 * pi / 7) + cos(3 * pi / 7) - Rational(1, 2),
    "twenty degrees": cos(pi / 9) * cos(2 * pi / 9) * cos(4 * pi / 9) - Rational(1, 8),
    "Machin": 4 * atan(Rational(1, 5)) - atan(Rational(1, 239)) - pi / 4,
    "sum of arc tangents": atan(x) + atan(y) - atan((x + y) / (1 - x * y)),
    "twice an arc tangent": 2 * atan(x) - atan(2 * x / (1 - x**2)),
    "arc sine as arc tangent": asin(x) - atan(x / sqrt(1 - x**2)),
    "Gudermann": atan(sinh(x)) - 2 * atan(tanh(x / 2)),
    "logarithm of a unit": log(3 + 2 * sqrt(2)) - 2 * log(1 + sqrt(2)),
    "logarithms of conjugates": log(sqrt(x**2 + 1) + x) + log(sqrt(x**2 + 1) - x),
    "cube root nested": cbrt(7 + 5 * sqrt(2)) - 1 - sqrt(2),
    "Ramanujan": sqrt(cbrt(5) - cbrt(4)) - (cbrt(2) + cbrt(20) - cbrt(25)) / 3,
    "Cardano": cbrt(2 + sqrt(5)) - cbrt(sqrt(5) - 2) - 1,
    "arc tangent of a tangent": atan(tan(x)) - x,
    "atanh of a quotient": atanh((x + y) / (1 + x * y)) - atanh(x) - atanh(y),
    "power of a power": (r**p) ** (1 / p) - r,
    "sine of a multiple arc": sin(3 * asin(x)) - 3 * x + 4 * x**3,
    "exponential of an area sine": exp(asinh(x)) - x - sqrt(x**2 + 1),
    "logarithm over logarithm": log(8) * log(3) - log(9) * log(2) * Rational(3, 2),
    "root with exponent symbol": sqrt(r ** (2 * p) + 2 * r**p + 1) - r**p - 1,
    "arc cosine by the Rational(1, 2) angle": acos(x) - 2 * asin(sqrt((1 - x) / 2)),
    "logarithm of a complex unit is real": log(sqrt(r**2 - 1) + r) + log(r - sqrt(r**2 - 1)),
    "nested three deep": sqrt(r + sqrt(r**2 - sqrt(r**4) + m**2)) - sqrt(r + m),
    "root of a norm": sqrt(6 + 4 * sqrt(2)) - sqrt(2) * sqrt(3 + 2 * sqrt(2)),
    "two nested roots multiply": sqrt(2 + sqrt(2)) * sqrt(2 - sqrt(2)) - sqrt(2),
    "nested roots of angles": 2 * cos(pi / 8) - sqrt(2 + sqrt(2)),
    "nested roots of angles, twice": 2 * cos(pi / 16) - sqrt(2 + sqrt(2 + sqrt(2))),
}
