"""Vanishing: whether an invariant vanishes at all points, for some values of the parameters."""

from __future__ import annotations

import sympy as sp

from geomtorsion.exact import Element
from geomtorsion.exact.common_values import LONGEST
from geomtorsion.geometry import Frame


def never_vanishes(element: Element, frame: Frame) -> bool:
    """Whether an element vanishes at all points for no values of the parameters; False: open.

    The parameters are not zero; geometries at which some are zero have frames of their own. The
    numerator is a polynomial in the coordinates and in sines and cosines of them. It vanishes at
    all points where all its coefficients do. One of them is never zero if it is one product of
    powers, or if all its terms have one sign.
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
    """Whether a polynomial vanishes for no values of the parameters that are not zero."""
    if coefficient.is_number:
        return True
    polynomial = sp.Poly(coefficient)
    terms, gens = polynomial.terms(), polynomial.gens
    if not all(g in frame.parameters for g in gens) or not all(x.is_real for _, x in terms):
        return False
    if len(terms) == 1:
        return True
    positive = [g.is_positive or frame.region.sign(g) == 1 for g in gens]
    squares = all(
        ok or power % 2 == 0
        for powers, _ in terms
        for ok, power in zip(positive, powers, strict=True)
    )
    return squares and len({bool(x > 0) for _, x in terms}) == 1
