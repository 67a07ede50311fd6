"""Independence: long elements without the symbols on which they do not depend.

In crooked coordinates the curvature scalar of de Sitter space is a sum of millions of terms; it is
4*Lambda everywhere.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy

from geomtorsion.errors import AllowanceError, ExpressionError, GeomtorsionError
from geomtorsion.exact.element import in_order
from geomtorsion.exact.limits import NoPointError
from geomtorsion.exact.points import roomy_point_of

if TYPE_CHECKING:
    from flint import fmpq_mpoly

    from geomtorsion.exact.element import Element
    from geomtorsion.exact.tower import Tower


def without_idle_symbols(element: Element) -> Element | None:
    """An equal element without symbols on which it does not depend; None where it is also long."""
    field = element.field
    try:
        point = roomy_point_of(field)
        idle = [x for x in sorted(element.symbols, key=str) if point.moves(element, x) is False]
        reduced = element
        for symbol in idle:
            reduced = _at_some_place(reduced, symbol)
        short = reduced.field.brief(reduced) if idle else None
        if short is None:
            return None
        # Numbers such as sin(1) drop out of the whole.
        if any(generator.kind == "opaque" for generator in short.field.generators_of(short)):
            return None
        whole = field.read(short.sympy)
        # That is proved of the whole, not of the places.
        return whole if (whole - element).is_zero is True else None
    except AllowanceError:
        raise
    except (GeomtorsionError, NoPointError, ZeroDivisionError):
        return None


def _at_some_place(element: Element, symbol: sympy.Symbol) -> Element:
    """An element with a number for a symbol: the first at which it is not singular."""
    # At 0 and a right angle functions have simple values, and many forms are singular.
    for number in (sympy.S.Zero, sympy.pi / 2, sympy.S.One):
        try:
            return _at(element, symbol, number)
        except (ExpressionError, ZeroDivisionError):
            continue
    raise ZeroDivisionError


def _at(element: Element, symbol: sympy.Symbol, number: sympy.Expr) -> Element:
    """An element with a number for a symbol, part by part, in a field of its own."""
    field = element.field
    other: Tower = field.with_symbol(sympy.Dummy(), 1)
    used = field.generators_of(element)
    images = [
        other.read(generator.shown.subs(symbol, number)) if generator in used else other.zero
        for generator in field.generators
    ]
    # Only polynomials are put into polynomials.
    if any(image.is_kept or image._den for image in images):
        raise ZeroDivisionError
    polys = [other.lift(image) for image in images]
    values: dict[int, Element] = {}
    below: dict[int, Element] = {}

    def of_polynomial(poly: fmpq_mpoly) -> Element:
        return other.polynomial(other.reduced(poly.compose(*polys, ctx=other.ctx)))

    def at(part: Element) -> Element:
        if id(part) not in values:
            whole = of_polynomial(field.lift(part))
            for index, exponent in part._den:
                if index not in below:
                    below[index] = of_polynomial(field.factors[index]).inverse()
                whole = whole * below[index] ** exponent
            values[id(part)] = whole
        return values[id(part)]

    for node in in_order(element, lambda x: id(x) in values):
        recipe = node._recipe
        whole = other.sum([(c, *map(at, factors)) for c, *factors in recipe.terms])
        if recipe.below and whole.is_zero:
            raise ZeroDivisionError
        values[id(node)] = whole.inverse() if recipe.below else whole
    return at(element)
