"""Near-zeros: expressions that look like zero, or are tiny, and are not zero."""

from __future__ import annotations

import sympy as sp
from sympy import (
    E,
    I,
    Rational,
    asin,
    asinh,
    atan,
    cbrt,
    cos,
    cosh,
    exp,
    log,
    pi,
    sec,
    sin,
    sinh,
    sqrt,
    tan,
    tanh,
)

from tests.exact.symbols import a, f, g, h, m, p, q, r, t, theta, x, y, z

tiny = Rational(1, 10**30)

SERIES = {
    "sine to third order": sin(x) - x + x**3 / 6,
    "cosine to fourth order": cos(x) - 1 + x**2 / 2 - x**4 / 24,
    "tangent to third order": tan(x) - x - x**3 / 3,
    "root to first order": sqrt(x + 1) - 1 - x / 2,
    "root of Schwarzschild to first order": sqrt(1 - 2 * m / r) - 1 + m / r,
    "logarithm to first order": log(1 + 1 / r) - 1 / r,
    "exponential to third order": exp(x) - 1 - x - x**2 / 2 - x**3 / 6,
    "arc tangent to third order": atan(x) - x + x**3 / 3,
    "exponential against cosh": cosh(x) - exp(x) / 2,
    "area sine against a logarithm": asinh(r) - log(2 * r),
    "sine of small argument": sin(x * tiny) - x * tiny,
    "tanh far out": tanh(r * 10) - 1,
}

TINY = {
    "tiny rational": tiny * x,
    "tiny number": sp.Integer(1) / 10**300,
    "nested root off by a little": sqrt(3 + 2 * sqrt(2)) - 1 - sqrt(2) - tiny,
    "Pythagoras off by a little": sin(x) ** 2 + cos(x) ** 2 - 1 - tiny,
    "double angle off by a little": sin(2 * x) - (2 + tiny) * sin(x) * cos(x),
    "shift off by a little": sin(x + pi / 3) - sin(x) / 2 - sqrt(3) / 2 * cos(x) + tiny * sin(x),
    "cosh off by a little": cosh(x) ** 2 - sinh(x) ** 2 - 1 + tiny,
    "arc tangents off by a little": atan(r) + atan(1 / r) - pi / 2 - tiny,
    "exponentials off by a little": exp(x) * exp(y) - (1 + tiny) * exp(x + y),
    "logarithm off by a little": log(r**2) - (2 + tiny) * log(r),
    "two close angles": sin(x + 1) - sin(x + 1 + tiny),
    "two close frequencies": cos(x) - cos((1 + tiny) * x),
    "two close exponents": exp(x) - exp((1 + tiny) * x),
    "two close radicands": sqrt(r + 1) - sqrt(r + 1 + tiny),
    "two close powers": r**p - r ** (p + tiny),
    "two close arguments of a function": f(r) - f(r + tiny),
    "two close poles": 1 / (x - 1) - 1 / (x - 1 - tiny),
}

NUMBERS = {
    "pi is not 22/7": pi - Rational(22, 7),
    "pi is not 355/113": pi - Rational(355, 113),
    "pi is not a convergent": pi - Rational(21053343141, 6701487259),
    "pi is not root two and three": pi - sqrt(2) - sqrt(3),
    "e is not a convergent": E - Rational(1084483, 398959),
    "root two is not a convergent": sqrt(2) - Rational(1855077841, 1311738121),
    "Gelfond": exp(pi) - pi - 20,
    "Ramanujan's constant": exp(pi * sqrt(163)) - 262537412640768744,
    "sine of eleven": sin(11) + 1,
    "cosine of 355": cos(355) + 1,
    "sums of roots": sqrt(10) + sqrt(11) - sqrt(5) - sqrt(18),
    "logarithm of two": log(2) - Rational(13614799, 19642003),
    "cube roots": cbrt(2) + cbrt(3) - Rational(27, 10),
    "e to the pi over pi to the e": exp(pi) * x - pi**E * x - Rational(6815, 10000) * x,
    # This needs the root of 10**68 + 1, but not the large prime factors of that number.
    "angle of a long number": atan(Rational(1, 10**34)) - Rational(1, 10**34),
    "sqrt of a nested difference": sqrt(2 + sqrt(3)) - sqrt(3 + sqrt(2)) + Rational(17, 100),
}

MIXED_UP = {
    "two different angles": cos(x) ** 2 + sin(y) ** 2 - 1,
    "half of the sine": sin(x / 2) - sin(x) / 2,
    "doubled sine": sin(2 * x) - 2 * sin(x),
    "wrong triple angle": sin(3 * x) - 3 * sin(x) + 3 * sin(x) ** 3,
    "wrong shift": sin(x + pi / 3) - sin(x) / 2 - cos(x) / 2,
    "wrong sum": sin(x + y) - sin(x) - sin(y),
    "wrong quadrant": sqrt(1 - sin(x) ** 2) + cos(x),
    "root with the other sign": sqrt(r**2 + 2 * r + 1) + r + 1,
    "root of a sum": sqrt(r + m) - sqrt(r) - sqrt(m),
    "root of a difference": sqrt(r**2 - m**2) - r + m,
    "independent roots": sqrt(r) * sqrt(r + m) - sqrt(r * m),
    "quotient of close roots": sqrt(1 - 2 * m / r) - sqrt(r**2 - 2 * m * r) / m,
    "Delta is not a square": sqrt(r**2 - 2 * m * r + a**2) - r + m,
    "conjugate nested root": sqrt(r + 2 * sqrt(r) + 1) - sqrt(r) + 1,
    "wrong exponent": exp(x) * exp(y) - exp(x * y),
    "wrong base": 2**x * 3**x - 5**x,
    "independent logarithms": log(2) * log(3) - log(6),
    "logarithm of a sum": log(r + m) - log(r) - log(m),
    "symbolic powers": r**p - r**q,
    "power of a sum": (r + m) ** p - r**p - m**p,
    "cube root of a sum": cbrt(r**3 + m**3) - r - m,
    "cube root squared": cbrt(r) ** 2 - cbrt(r),
    "arc sine against arc tangent": asin(x) - atan(x),
    "arc tangent of twice": 2 * atan(x) - atan(2 * x),
    "secant against tangent": sec(x) - tan(x) - 1,
    "function against its derivative": f(r) - sp.diff(f(r), r),
    "two functions": f(r) - g(r),
    "two arguments": f(r) - f(m),
    "shifted argument": f(t - r) - f(t + r),
    "wrong wave": sp.diff(f(t - r), r) - sp.diff(f(t - r), t),
    "mixed against pure partial": sp.diff(h(r, theta), r, theta) - sp.diff(h(r, theta), r, 2),
    "arguments exchanged": h(r, theta) - h(theta, r),
    "order of differentiation matters": f(r) * sp.diff(f(r), r, 2) - sp.diff(f(r), r) ** 2,
    "determinant off by one coefficient": sp.Matrix([[1, v, v**2] for v in (x, y, z)]).det()
    - (y - x) * (z - x) * (z - y + tiny),
}

COMPLEX = {
    "Euler with the wrong sign": exp(I * x) - cos(x) + I * sin(x),
    "modulus with the wrong sign": (x + I * y) * (x - I * y) - x**2 + y**2,
    "conjugate": (r + I * a * cos(x)) - (r - I * a * cos(x)),
    "square is not a modulus": (r + I * a) ** 2 - r**2 - a**2,
    "sine of imaginary, no factor": sin(I * x) - sinh(x),
    "imaginary unit": I * x - x,
    "root of unity": exp(2 * I * pi / 3) - exp(I * pi / 3),
}

REAL_GROUPS = {"series": SERIES, "tiny": TINY, "numbers": NUMBERS, "mixed up": MIXED_UP}
