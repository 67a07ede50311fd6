"""Odd roots: one generator an irreducible factor, each factor positive at the sample point."""

from __future__ import annotations

from math import lcm
from typing import TYPE_CHECKING, Any

import sympy
from flint import fmpq

from geomtorsion.errors import ExpressionError
from geomtorsion.exact.generators import Branch
from geomtorsion.exact.integers import prime_factors

if TYPE_CHECKING:
    from geomtorsion.exact.element import Element
    from geomtorsion.exact.field import Field


def odd_root(field: Field, element: Element, order: int) -> Element:
    """The odd root: factor by factor, each factor positive at the sample point."""
    if any(g.degree for g in field.generators_of(element)):
        square = element * element
        if any(g.degree for g in field.generators_of(square)):
            tail = field.polynomial(field.lift(element)) * field.denominator(element) ** (order - 1)
            new = field.add_root(tail, order, sure=False)
            return new / field.denominator(element)
        # u**(1/m) = u / ((u**2)**(1/m))**((m - 1)/2), and u**2 has no algebraic generator.
        return element / odd_root(field, square, order) ** ((order - 1) // 2)
    field.sample.prefer_positive(element)
    content, factors = field.lift(element).factor()
    value = fmpq(content)
    powers = [(field.polynomial(factor), exponent) for factor, exponent in factors]
    powers += [(field.polynomial(field.factors[i]), -e) for i, e in element._den]
    result, sign = field.one, -1 if value < 0 else 1
    for prime, exponent in [*prime_factors(abs(value.p)), *_negated(prime_factors(value.q))]:
        result = result * _factor_power(field, field.rational(fmpq(prime)), exponent, order)
    for base, exponent in powers:
        if not field.sample.is_positive(base):
            base = -base
            sign *= -1 if exponent % 2 else 1
        result = result * _factor_power(field, base, exponent, order)
    if sign < 0 and not field.is_complex:
        shown = element.sympy ** sympy.Rational(1, order)
        field.state_branch(Branch(shown, (-result).sympy, f"{element} <= 0: the real root"))
    if sign < 0 and field.is_complex:
        raise ExpressionError(
            f"the root of order {order} of {element} is that of a negative number at the sample "
            "point; give a domain where it is positive"
        )
    return result * sign


def _negated(factors: Any) -> list[tuple[Any, int]]:
    return [(prime, -exponent) for prime, exponent in factors]


def _factor_power(field: Field, base: Element, exponent: int, order: int) -> Element:
    """base**(exponent/order) for an irreducible base."""
    whole, rest = divmod(exponent, order)
    result = base**whole
    if not rest:
        return result
    return result * _irreducible_root(field, base, order) ** rest


def _irreducible_root(field: Field, base: Element, order: int) -> Element:
    """base**(1/order), through the finest root of this base that is already there."""
    finest, depth = base, 1
    for generator in reversed(field.generators):
        known = generator.argument if generator.kind == "root" else None
        if known is not None and known[0] == base:
            finest, depth = field.generator_element(generator), known[1]
    if depth % order == 0:
        return finest ** (depth // order)
    step = lcm(depth, order) // depth
    new = field.add_root(finest, step, sure=True, base=(base, depth * step))
    return new ** (depth * step // order)
