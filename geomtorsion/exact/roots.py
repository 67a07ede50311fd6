"""Roots: rational powers of elements, with the branch that was chosen."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import mpmath
from flint import fmpq, fmpz

from geomtorsion.errors import ExpressionError
from geomtorsion.exact.generators import Branch
from geomtorsion.exact.integers import prime_factors
from geomtorsion.exact.odd_roots import odd_root
from geomtorsion.exact.squares import square_root_inside, without_odd_roots

if TYPE_CHECKING:
    import sympy

    from geomtorsion.exact.element import Element
    from geomtorsion.exact.field import Field


def root(field: Field, element: Element, order: int, radical: sympy.Expr | None = None) -> Element:
    """The root of an order: odd part first, then square roots one by one."""
    if not element._num:
        return field.zero
    value = element
    odd = order
    while odd % 2 == 0:
        odd //= 2
    if odd > 1:
        value = odd_root(field, value, odd)
    while odd < order:
        value = _square_root(field, value, radical)
        odd *= 2
    return value


def _square_root(field: Field, element: Element, radical: sympy.Expr | None) -> Element:
    """The square root: inside the field where it exists there, else a new generator."""
    if not field.sample.prefer_positive(element) and not field.is_complex:
        raise ExpressionError(
            f"the square root of {element}, which is negative at every place that was tried; turn "
            "its sign, give a domain where it is positive, or declare the frame complex"
        )
    inside = square_root_inside(field, element)
    if inside is not None:
        positive = inside if field.sample.is_positive(inside) else -inside
        _state(field, element, positive, radical)
        return positive
    taken = without_odd_roots(field, element)
    if taken is not None and taken[0] != 1:
        half, rest = taken
        value = half * _square_root(field, rest, None)
        return value if _matches_principal(field, value, element) else -value
    outer, content, tail = _squares_taken_out(field, element)
    if content < 0 and field.is_complex:
        turned = _square_root(field, -element, None) * field.imaginary
        return turned if _matches_principal(field, turned, element) else -turned
    generator = field.add_root(tail, 2, _is_decided(field, tail))
    value = outer * generator
    if not outer.is_rational:
        if not _matches_principal(field, value, element):
            value = -value
        _state(field, element, value, radical, outer)
    return value


def _squares_taken_out(field: Field, element: Element) -> tuple[Element, Any, Element]:
    """(outer, content, tail) with element = outer**2 * tail, tail a polynomial."""
    content, factors = field.lift(element).factor()
    outer, tail = field.ctx.constant(1), field.ctx.constant(1)
    for factor, exponent in factors:
        outer = outer * factor ** (exponent // 2)
        tail = tail * factor ** (exponent % 2)
    below = field.one
    for index, exponent in element._den:
        tail = tail * field.factors[index] ** (exponent % 2)
        below = below * field.polynomial(field.factors[index]) ** ((exponent + 1) // 2)
    square, free = _square_part(fmpq(content))
    outside = field.polynomial(outer) / below * square
    return outside, free, field.polynomial(tail * free)


def _square_part(value: Any) -> tuple[Any, Any]:
    """(s, f) with value = s**2 f, f a square-free integer with the sign of value."""
    whole = fmpz(value.p * value.q)
    sign = -1 if whole < 0 else 1
    square, free = fmpz(1), fmpz(sign)
    for prime, exponent in prime_factors(abs(whole)):
        square *= prime ** (exponent // 2)
        free *= prime ** (exponent % 2)
    return fmpq(square, value.q), free


def _is_decided(field: Field, tail: Element) -> bool:
    """Whether the tower decides that `tail` is no square (no higher roots involved)."""
    return not any(g.degree > 2 for g in field.generators_of(tail))


def _matches_principal(field: Field, value: Element, element: Element) -> bool:
    """Whether value is the principal root of element at the sample point."""
    try:
        with mpmath.workprec(200):
            want = mpmath.sqrt(field.sample.value(element))
            have = field.sample.value(value)
            return bool(abs(have - want) <= abs(have + want))
    except (ArithmeticError, ValueError):
        return True


def _state(
    field: Field,
    element: Element,
    value: Element,
    radical: sympy.Expr | None,
    outer: Element | None = None,
) -> None:
    """Notes the branch, unless the symbols' assumptions leave only one."""
    if radical is None:
        return
    shown = (value if outer is None else outer).sympy
    if shown.is_nonnegative:
        return
    field.state_branch(Branch(radical, value.sympy, f"{shown} >= 0"))
