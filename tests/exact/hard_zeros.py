"""Hard zeros: expressions that vanish identically, each with the reason in words.

Roots are positive at the point `symbols.POINT`. A test checks every zero there with 60 digits by
mpmath, independently of the package.
"""

from __future__ import annotations

import sympy as sp
from sympy import (
    E,
    I,
    Rational,
    acos,
    acosh,
    acot,
    asin,
    asinh,
    atan,
    atanh,
    cbrt,
    cos,
    cosh,
    cot,
    coth,
    csc,
    csch,
    exp,
    log,
    pi,
    sec,
    sech,
    sin,
    sinh,
    sqrt,
    tan,
    tanh,
)

from tests.exact.symbols import a, f, g, h, m, p, q, r, t, theta, x, y, z

half, third = Rational(1, 2), Rational(1, 3)
s, c, S, C = sin(x), cos(x), sinh(x), cosh(x)

TRIGONOMETRIC = {
    "Pythagoras": s**2 + c**2 - 1,
    "double angle, sine": sin(2 * x) - 2 * s * c,
    "double angle, cosine": cos(2 * x) - 1 + 2 * s**2,
    "triple angle, sine": sin(3 * x) - 3 * s + 4 * s**3,
    "triple angle, cosine": cos(3 * x) - 4 * c**3 + 3 * c,
    "fivefold angle": cos(5 * x) - 16 * c**5 + 20 * c**3 - 5 * c,
    "seven and five against sums": sin(7 * x) - sin(5 * x) - 2 * cos(6 * x) * s,
    "sum of angles": sin(x + y) - s * cos(y) - c * sin(y),
    "difference of angles": cos(x - y) - c * cos(y) - s * sin(y),
    "three angles": sin(x + y + z) - sin(x + y) * cos(z) - (c * cos(y) - s * sin(y)) * sin(z),
    "twice one and thrice another": sin(2 * x + 3 * y)
    - sin(2 * x) * cos(3 * y)
    - cos(2 * x) * sin(3 * y),
    "product of sines": sin(x + y) * sin(x - y) - s**2 + sin(y) ** 2,
    "sum to product with halves": cos(x) + cos(y) - 2 * cos((x + y) / 2) * cos((x - y) / 2),
    "tangent is sine over cosine": tan(x) - s / c,
    "tangent of the double": tan(2 * x) - 2 * tan(x) / (1 - tan(x) ** 2),
    "tangent of a sum": tan(x + y) * (1 - tan(x) * tan(y)) - tan(x) - tan(y),
    "cotangent": cot(x) - 1 / tan(x),
    "cotangent of the double": cot(x) - tan(x) - 2 * cot(2 * x),
    "secant": sec(x) ** 2 - tan(x) ** 2 - 1,
    "cosecant": csc(x) ** 2 - cot(x) ** 2 - 1,
    "cosecant of the double": csc(2 * x) - (cot(x) + tan(x)) / 2,
    "half angle, sine": sin(x / 2) ** 2 - (1 - c) / 2,
    "half angle, tangent": tan(x / 2) - s / (1 + c),
    "half angle, cotangent": cot(x / 2) - (1 + c) / s,
    "Weierstrass substitution": s - 2 * tan(x / 2) / (1 + tan(x / 2) ** 2),
    "third of an angle": 3 * sin(x / 3) - 4 * sin(x / 3) ** 3 - s,
    "half and third together": sin(x / 2) * cos(x / 3) + cos(x / 2) * sin(x / 3) - sin(5 * x / 6),
    "shift by pi/3": sin(x + pi / 3) - s / 2 - sqrt(3) / 2 * c,
    "shift by pi/4": sqrt(2) * cos(x + pi / 4) - c + s,
    "shift by pi/12": sin(x + pi / 12) - s * (sqrt(6) + sqrt(2)) / 4 - c * (sqrt(6) - sqrt(2)) / 4,
    "shift by pi/5": cos(x + pi / 5) - c * (1 + sqrt(5)) / 4 + s * sqrt(10 - 2 * sqrt(5)) / 4,
    "shifts that cancel": sin(x + pi / 3) + sin(x - pi / 3) - s,
    "three shifts multiply": 4 * s * sin(pi / 3 - x) * sin(pi / 3 + x) - sin(3 * x),
    "three tangents": tan(x) + tan(x + pi / 3) + tan(x + 2 * pi / 3) - 3 * tan(3 * x),
    "tangent shifted by pi/4": tan(x + pi / 4) - (1 + tan(x)) / (1 - tan(x)),
    "shift of a half angle": sin(x / 2 + pi / 4) ** 2 - (1 + s) / 2,
    "shift by one radian": sin(x + 1) - s * cos(1) - c * sin(1),
    "sines of numbers": sin(2) - 2 * sin(1) * cos(1),
    "fourth powers": c**4 + s**4 - (3 + cos(4 * x)) / 4,
    "sixth powers": c**6 + s**6 - 1 + 3 * s**2 * c**2,
    "telescoping cosines": c * cos(2 * x) * cos(4 * x) - sin(8 * x) / (8 * s),
    "angle with a parameter": sin(2 * a * x) - 2 * sin(a * x) * cos(a * x),
    "parameter times a sum": sin(a * (x + y)) - sin(a * x) * cos(a * y) - cos(a * x) * sin(a * y),
    "angle in units of a period": cos(4 * pi * x / a) - 2 * cos(2 * pi * x / a) ** 2 + 1,
    "angle that is not a linear form": sin(x**2 + y) - sin(x**2) * cos(y) - cos(x**2) * sin(y),
    "angle written in two ways": sin((x + y) ** 2) - sin(x**2 + 2 * x * y + y**2),
    "angle that is a quotient": sin((x**2 - 1) / (x - 1)) - sin(x + 1),
    "rotation has determinant one": sp.rot_axis1(x).multiply(sp.rot_axis3(y)).det() - 1,
}

HYPERBOLIC = {
    "hyperbolic Pythagoras": C**2 - S**2 - 1,
    "double argument": sinh(2 * x) - 2 * S * C,
    "double argument, cosine": cosh(2 * x) - 2 * S**2 - 1,
    "half argument": cosh(x / 2) ** 2 - (C + 1) / 2,
    "half argument, tangent": tanh(x / 2) - (C - 1) / S,
    "sum of arguments": sinh(x + y) - S * cosh(y) - C * sinh(y),
    "tangent of the double, hyperbolic": tanh(2 * x) - 2 * tanh(x) / (1 + tanh(x) ** 2),
    "tanh, sech": tanh(x) ** 2 + sech(x) ** 2 - 1,
    "coth, csch": coth(x) ** 2 - csch(x) ** 2 - 1,
    "cosh is exponentials": C - (exp(x) + exp(-x)) / 2,
    "tanh is exponentials": tanh(x) - (exp(2 * x) - 1) / (exp(2 * x) + 1),
    "exponential is both": exp(x) - C - S,
    "de Moivre, hyperbolic": (C + S) ** 3 - exp(3 * x),
    "cosh of half against exp": 2 * cosh(x / 2) * exp(x / 2) - exp(x) - 1,
    "sinh of a logarithm": sinh(log(r)) - (r - 1 / r) / 2,
    "cosh shifted by log 2": cosh(x + log(2)) - exp(x) - exp(-x) / 4,
    "trigonometric and hyperbolic": (c * C) ** 2 + (s * S) ** 2 - (cosh(2 * x) + cos(2 * x)) / 2,
}

EXPONENTIAL = {
    "dependent exponents": (exp(x) + 1) * (exp(2 * x) - exp(x) + 1) - exp(3 * x) - 1,
    "exponents in halves and thirds": exp(x / 2) * exp(x / 3) * exp(x / 6) - exp(x),
    "square of a half": (exp(x / 2) - 1) * (exp(x / 2) + 1) - exp(x) + 1,
    "exponent with a number": exp(x + 1) - E * exp(x),
    "exponent a sum": exp(2 * x - y) * exp(3 * y - x) - exp(x) * exp(y) ** 2,
    "exponent written in two ways": exp((x + y) ** 2) - exp(x**2) * exp(y**2) * exp(x * y) ** 2,
    "exponent a quotient": exp((x**2 - y**2) / (x - y)) - exp(x) * exp(y),
    "tower of exponentials": exp(exp(x) + x) - exp(exp(x)) * exp(x),
    "exponential of a logarithm": exp(2 * log(r)) - r**2,
    "exponential of a parameter times a logarithm": exp(a * log(r)) - r**a,
    "logarithm added in the exponent": exp(x + log(r) / 2) - sqrt(r) * exp(x),
    "powers of two": 4**x - (2**x) ** 2,
    "power of two shifted": 2 ** (x + 1) - 2 * 2**x,
    "six is two times three": 6**x - 2**x * 3**x,
    "eight to a third": 8 ** (x / 3) - 2**x,
    "power of two as exponential": exp(x * log(2)) - 2**x,
    "root of an exponential": sqrt(exp(2 * x) + 2 * exp(x) + 1) - exp(x) - 1,
    "exponential under a root": sqrt(exp(2 * x) - 1) * exp(-x) - sqrt(1 - exp(-2 * x)),
}

POWERS = {
    "symbolic exponent plus one": r**p * r - r ** (p + 1),
    "symbolic exponent doubled": (r**p) ** 2 - r ** (2 * p),
    "two symbolic exponents": r ** (p + q) - r**p * r**q,
    "power of a product": (r * m) ** p - r**p * m**p,
    "power of a sum in two ways": (r**2 + 2 * r + 1) ** p - (r + 1) ** (2 * p),
    "Euler's equation": r * sp.diff(r**p, r) - p * r**p,
    "power with itself": r**r * r - r ** (r + 1),
    "cube root": (cbrt(r) - 1) * (cbrt(r) ** 2 + cbrt(r) + 1) - r + 1,
    "cube root of a multiple": cbrt(8 * r) - 2 * cbrt(r),
    "cube root of a product": cbrt(r) * cbrt(m) - cbrt(r * m),
    "cube root of a perfect cube": cbrt(r**3 + 3 * r**2 + 3 * r + 1) - r - 1,
    "half and third powers": sqrt(r) * cbrt(r) - r ** Rational(5, 6),
    "root of a cube root": sqrt(cbrt(r)) ** 2 - cbrt(r),
    "cube roots of numbers": 1 / (1 + cbrt(2)) - (1 - cbrt(2) + cbrt(4)) / 3,
    "three-halves power": (r**2 + a**2) ** Rational(3, 2) - (r**2 + a**2) * sqrt(r**2 + a**2),
    "fourth root": sqrt(sqrt(r)) ** 2 - sqrt(r),
    "two-thirds and one-third": (r - m) ** Rational(2, 3) - cbrt(r - m) ** 2,
}

RADICAL = {
    "nested numbers": sqrt(3 + 2 * sqrt(2)) - 1 - sqrt(2),
    "nested numbers with six": sqrt(5 + 2 * sqrt(6)) - sqrt(2) - sqrt(3),
    "product of roots of numbers": sqrt(2) * sqrt(3) - sqrt(6),
    "rationalised": 1 / (sqrt(2) + sqrt(3)) - sqrt(3) + sqrt(2),
    "product of roots": sqrt(r) * sqrt(m) - sqrt(r * m),
    "root of four": sqrt(4 * r + 4) - 2 * sqrt(r + 1),
    "root of twelve against root of three": sqrt(12 * r + 12) - 2 * sqrt(3) * sqrt(r + 1),
    "root of a reciprocal": sqrt(1 / (r + 1)) - 1 / sqrt(r + 1),
    "Schwarzschild in two ways": sqrt(1 - 2 * m / r) - sqrt(r**2 - 2 * m * r) / r,
    "Schwarzschild and its reciprocal": sqrt(1 - 2 * m / r) * sqrt(r / (r - 2 * m)) - 1,
    "Schwarzschild split": sqrt(1 - 2 * m / r) * sqrt(r) - sqrt(r - 2 * m),
    "three roots, one dependent": sqrt(r - m) * sqrt(r + m) - sqrt(r**2 - m**2),
    "root of sine squared": sqrt(1 - s**2) - c,
    "root of a product": sqrt((1 - c) * (1 + c)) - s,
    "product of roots is sine": sqrt(1 - c) * sqrt(1 + c) - s,
    "root needs the half angle": sqrt(1 + c) - sqrt(2) * cos(x / 2),
    "root of a double angle": sqrt(sin(2 * x)) - sqrt(2) * sqrt(s) * sqrt(c),
    "root with tangent": sqrt(1 + tan(x) ** 2) - sec(x),
    "root with cosh": sqrt(1 + S**2) - C,
    "root of half cosh": sqrt((C + 1) / 2) - cosh(x / 2),
    "root of one plus sine": sqrt(1 + s) - sin(x / 2) - cos(x / 2),
    "perfect square": sqrt(r**2 + 2 * r + 1) - r - 1,
    "perfect square of a difference": sqrt(r**2 - 2 * m * r + m**2) - r + m,
    "perfect fourth power": sqrt((1 + m / (2 * r)) ** 4) - (1 + m / (2 * r)) ** 2,
    "square inside with a root": sqrt(r + 2 * sqrt(r) + 1) - sqrt(r) - 1,
    "sum of two roots": sqrt(r + m + 2 * sqrt(r * m)) - sqrt(r) - sqrt(m),
    "nested, Descartes": sqrt(2 * r + 2 * sqrt(r**2 - m**2)) - sqrt(r + m) - sqrt(r - m),
    "nested, difference": sqrt(r - sqrt(r**2 - 1)) - (sqrt(r + 1) - sqrt(r - 1)) / sqrt(2),
    "nested, product": sqrt(2 + sqrt(r)) * sqrt(2 - sqrt(r) / 3)
    - sqrt(4 + 4 * sqrt(r) / 3 - r / 3),
    "nested in a denominator": 1 / (sqrt(r) + sqrt(m)) - (sqrt(r) - sqrt(m)) / (r - m),
    "Kerr's Delta": sqrt(r**2 - 2 * m * r + a**2) ** 3 / (r**2 - 2 * m * r + a**2)
    - sqrt(r**2 - 2 * m * r + a**2),
    "Kerr's Delta split by its roots": sqrt(r - m - sqrt(m**2 - a**2))
    * sqrt(r - m + sqrt(m**2 - a**2))
    - sqrt(r**2 - 2 * m * r + a**2),
    "root of an unknown function": sqrt(f(r) ** 2 + 2 * f(r) + 1) - f(r) - 1,
    "roots of unknown functions": sqrt(f(r)) * sqrt(g(r)) - sqrt(f(r) * g(r)),
}

LOGARITHMIC = {
    "logarithm of a product": log(r**2 * m) - 2 * log(r) - log(m),
    "logarithm of a number times": log(2 * r) - log(2) - log(r),
    "logarithms of numbers": log(6) - log(2) - log(3),
    "logarithm of a root": log(sqrt(r + m)) - log(r + m) / 2,
    "logarithm of a quotient": log(r / m) - log(r) + log(m),
    "logarithm factors": log(r**2 - m**2) - log(r - m) - log(r + m),
    "tortoise coordinate": log(r / (2 * m) - 1) - log(r - 2 * m) + log(2) + log(m),
    "logarithm of an exponential": log(exp(x) * (1 + exp(x))) - x - log(1 + exp(x)),
    "logarithm of cosh and sinh": log(C + S) - x,
    "logarithm of a tangent": log(tan(x)) - log(s) + log(c),
    "logarithm of a double angle": log(sin(2 * x)) - log(2) - log(s) - log(c),
    "logarithm of a square with a root": log(1 + 2 * sqrt(r) + r) - 2 * log(1 + sqrt(r)),
    "logarithm of e times": log(E * r) - 1 - log(r),
    "logarithm of a symbolic power": log(r**p) - p * log(r),
    "logarithm of a reciprocal": log(1 / (r + m)) + log(r + m),
}

INVERSE = {
    "atan of the reciprocal": atan(r) + atan(1 / r) - pi / 2,
    "arc sine and arc cosine": asin(x) + acos(x) - pi / 2,
    "arc cotangent": acot(r) - atan(1 / r),
    "asinh is a logarithm": asinh(r) - log(r + sqrt(r**2 + 1)),
    "acosh is a logarithm": acosh(r) - log(r + sqrt(r**2 - 1)),
    "atanh is a logarithm": atanh(x) - log((1 + x) / (1 - x)) / 2,
    "sine of an arc sine": sin(2 * asin(x)) - 2 * x * sqrt(1 - x**2),
    "cosine of an arc sine": cos(asin(x)) - sqrt(1 - x**2),
    "sine of an arc tangent": sin(atan(x)) - x / sqrt(1 + x**2),
    "cosine of twice an arc cosine": cos(2 * acos(x)) - 2 * x**2 + 1,
    "sinh of an area sine": sinh(2 * asinh(x)) - 2 * x * sqrt(1 + x**2),
    "derivative of an arc tangent": sp.diff(atan(x / a), x) - a / (a**2 + x**2),
}

UNKNOWN = {
    "product rule": sp.diff(f(r) * g(r), r) - f(r) * sp.diff(g(r), r) - g(r) * sp.diff(f(r), r),
    "mixed partials": sp.diff(h(r, theta), r, theta) - sp.diff(h(r, theta), theta, r),
    "mixed partials of third order": sp.diff(h(r, theta) ** 2, r, theta, r)
    - 2 * sp.diff(h(r, theta) * sp.diff(h(r, theta), r, r), theta)
    - 2 * sp.diff(sp.diff(h(r, theta), r) ** 2, theta),
    "wave equation": sp.diff(f(t - r), r, 2) - sp.diff(f(t - r), t, 2),
    "retarded argument": sp.diff(f(t - r), r) + sp.diff(f(t - r), t),
    "chain rule": sp.diff(f(r**2), r) - 2 * r * sp.Subs(sp.diff(f(z), z), z, r**2),
    "argument in two ways": f((x + y) ** 2) - f(x**2 + 2 * x * y + y**2),
    "argument a quotient": f((x**2 - 1) / (x - 1)) - f(x + 1),
    "argument a trigonometric identity": f(s**2 + c**2 + r) - f(1 + r),
    "exponential of a function": exp(2 * f(r)) - exp(f(r)) ** 2 * (c**2 + s**2),
    "angle is a function": sin(f(r) + x) - sin(f(r)) * c - cos(f(r)) * s,
    "quotient rule": sp.diff(f(r) / g(r), r) * g(r) ** 2
    - sp.diff(f(r), r) * g(r)
    + f(r) * sp.diff(g(r), r),
    "unevaluated derivative": sp.Derivative(r * f(r), r) - f(r) - r * sp.diff(f(r), r),
    "derivative of a root": 2 * sqrt(f(r)) * sp.diff(sqrt(f(r)), r) - sp.diff(f(r), r),
    "fourth derivative": sp.diff(r * f(r), r, 4)
    - 4 * sp.diff(f(r), r, 3)
    - r * sp.diff(f(r), r, 4),
}

RATIONAL = {
    "binomial of degree 12": sp.expand((x + y) ** 12) - (x + y) ** 12,
    "partial fractions": sum(1 / ((x + k) * (x + k + 1)) for k in range(8)) - 8 / (x * (x + 8)),
    "Vandermonde": sp.Matrix([[1, v, v**2] for v in (x, y, z)]).det() - (y - x) * (z - x) * (z - y),
    "cancelling denominators": x / (x - y) + y / (y - x) - 1,
    "Lagrange's four squares": (x**2 + y**2) * (z**2 + t**2)
    - (x * z - y * t) ** 2
    - (x * t + y * z) ** 2,
    "large coefficients": (10**40 * x + 1) * (10**40 * x - 1) - 10**80 * x**2 + 1,
    "constant pi": (x + pi) ** 2 - x**2 - 2 * pi * x - pi**2,
    "golden ratio": sp.GoldenRatio**2 * x - sp.GoldenRatio * x - x,
}

COMPLEX = {
    "Euler": exp(I * x) - c - I * s,
    "de Moivre": (c + I * s) ** 3 - cos(3 * x) - I * sin(3 * x),
    "exponential of a sum": exp(r + I * x) - exp(r) * (c + I * s),
    "two exponentials": exp(I * x) * exp(-I * y) - cos(x - y) - I * sin(x - y),
    "cosine is exponentials": c - (exp(I * x) + exp(-I * x)) / 2,
    "modulus": (r + I * a * c) * (r - I * a * c) - r**2 - a**2 * c**2,
    "reciprocal": 1 / (r - I * a * c) - (r + I * a * c) / (r**2 + a**2 * c**2),
    "sixth root of one": exp(I * pi / 3) - half - sqrt(3) / 2 * I,
    "eighth power": (1 + I) ** 8 * x - 16 * x,
    "hyperbolic of imaginary": cosh(I * x) - c,
    "sine of imaginary": sin(I * x) - I * S,
    "sine of a complex sum": sin(x + I * y) - s * cosh(y) - I * c * sinh(y),
    "conjugated product": (1 / (r + I * m)) * (1 / (r - I * m)) - 1 / (r**2 + m**2),
}

REAL_GROUPS = {
    "trigonometric": TRIGONOMETRIC,
    "hyperbolic": HYPERBOLIC,
    "exponential": EXPONENTIAL,
    "powers": POWERS,
    "radical": RADICAL,
    "logarithmic": LOGARITHMIC,
    "inverse": INVERSE,
    "unknown": UNKNOWN,
    "rational": RATIONAL,
}
