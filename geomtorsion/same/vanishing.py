"""Vanishing: whether an invariant vanishes at all points, for some values of the parameters."""

from __future__ import annotations

import sympy as sp

from geomtorsion.exact import Element
from geomtorsion.exact.common_values import LONGEST
from geomtorsion.geometry import Frame


def never_vanishes(element: Element, frame: Frame) -> bool:
    """Whether an element vanishes at all points for no values of the parameters; False: open.

    The numerator is a polynomial in the coordinates and in sines and cosines of them. It vanishes
    at all points where all its coefficients do. One of them is never zero if all its terms have one
    sign for positive parameters.
    """
    if element.is_zero is not False or element.length > LONGEST:
        return False
    numerator, _ = sp.fraction(sp.together(element.sympy))
    for angle in {x.args[0] for x in numerator.atoms(sp.sin)}:
        rule = sp.sin(angle) ** 2 + sp.cos(angle) ** 2 - 1
        if numerator.has(sp.cos(angle)):
            numerator = sp.rem(numerator, rule, sp.sin(angle))
    if not numerator.free_symbols:
        return True
    try:
        polynomial = sp.Poly(sp.expand(numerator))
    except sp.PolynomialError:
        return False
    coordinates = set(frame.coordinates)
    moving = [g for g in polynomial.gens if g.free_symbols & coordinates]
    if not all(_is_simple(g, coordinates) for g in moving):
        return False
    if not moving:
        coefficients = [polynomial.as_expr()]
    else:
        coefficients = sp.Poly(polynomial.as_expr(), *moving).coeffs()
    return any(_has_one_sign(x, frame) for x in coefficients)


def _is_simple(generator: sp.Expr, coordinates: set[sp.Symbol]) -> bool:
    """Whether it is a coordinate, or the sine or cosine of one: independent of the others."""
    inside = generator.args[0] if isinstance(generator, sp.sin | sp.cos) else generator
    return inside in coordinates


def _has_one_sign(coefficient: sp.Expr, frame: Frame) -> bool:
    """Whether a polynomial in parameters has terms of one sign only."""
    if coefficient.is_number:
        return True
    polynomial = sp.Poly(coefficient)
    numbers = polynomial.coeffs()
    if not all(x.is_real for x in numbers):
        return False
    signs = {bool(x > 0) for x in numbers}
    positive = all(
        g.is_positive or frame.region.sign(g) == 1 for g in polynomial.gens if g in frame.parameters
    )
    return positive and len(signs) == 1 and all(g in frame.parameters for g in polynomial.gens)
