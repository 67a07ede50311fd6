"""Inversion: algebraic generators are cleared from a denominator by their conjugates."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, Any

from geomtorsion.exact.limits import check_product

if TYPE_CHECKING:
    from geomtorsion.exact.element import Element
    from geomtorsion.exact.field import Field


def inverse(field: Field, element: Element) -> Element:
    """1/element = den/num, with num freed of algebraic generators first."""
    num = field.lift(element)
    den = field.cofactor(element._den, ())
    multiplier = field.ctx.constant(1)
    degrees = num.degrees()
    if len(num) > 1 and any(
        g.degree and d > 0 for g, d in zip(field.generators, degrees, strict=True)
    ):
        field.note_rooted(field.polynomial(num))
    for position, generator in enumerate(field.generators):
        if generator.degree and degrees[position] > 0:
            if generator.degree > 2:
                num, conjugate = _conjugate(field, num, position)
                check_product(multiplier, conjugate)
                multiplier = field.reduced(multiplier * conjugate)
                degrees = num.degrees()
                continue
            assert generator.tail is not None
            tail = field.lift(generator.tail)
            w = field.ctx.gen(position)
            below, above = split(field, num, position)
            if not below:
                num = field.reduced(above * tail)
                multiplier = field.reduced(multiplier * w)
            else:
                check_product(num, num)
                check_product(multiplier, num)
                num = field.reduced(below * below - above * above * tail)
                multiplier = field.reduced(multiplier * (below - above * w))
            degrees = num.degrees()
    content, factors = num.factor()
    signed = []
    for factor, exponent in factors:
        positive, sign = monic(factor)
        content = content * sign if exponent % 2 else content
        signed.append((positive, exponent))
    return field.over_factors(multiplier * den * (1 / content), signed)


def monic(factor: Any) -> tuple[Any, int]:
    """A factor with positive leading coefficient, and the sign taken out."""
    return (-factor, -1) if factor.leading_coefficient() < 0 else (factor, 1)


def split(field: Field, poly: Any, position: int) -> tuple[Any, Any]:
    """(A, B) with poly = A + B w, for the generator w at a position, degree at most 1."""
    above = poly.derivative(position)
    return poly - above * field.ctx.gen(position), above


def coefficients(field: Field, poly: Any, position: int, degree: int) -> list[Any]:
    """The coefficients of 1, w, ..., w**(degree - 1) for the generator at a position."""
    parts: list[dict[tuple[int, ...], Any]] = [{} for _ in range(degree)]
    for monomial, value in poly.to_dict().items():
        exponents = list(monomial)
        power, exponents[position] = int(exponents[position]), 0
        parts[power][tuple(exponents)] = value
    return [field.ctx.from_dict(part) for part in parts]


def _conjugate(field: Field, num: Any, position: int) -> tuple[Any, Any]:
    """(norm, c) with num * c = norm, free of the generator w of degree n at the position.

    Multiplication by num is an n by n matrix on the powers of w; c is made of the cofactors
    of its first row and the norm is its determinant, both without any division.
    """
    generator = field.generators[position]
    n = generator.degree
    w = field.ctx.gen(position)
    columns = []
    power = num
    for _ in range(n):
        columns.append(coefficients(field, power, position, n))
        power = field.reduced(power * w)
    # minors[S]: determinant of the last len(S) rows in the columns S, built row by row.
    minors: dict[tuple[int, ...], Any] = {(): field.ctx.constant(1)}
    for size in range(1, n):
        row = n - size
        minors = {
            chosen: _expanded(field, [columns[k][row] for k in chosen], chosen, minors)
            for chosen in combinations(range(n), size)
        }
    norm = conjugate = field.ctx.constant(0)
    for k in range(n):
        minor = minors[tuple(j for j in range(n) if j != k)]
        cofactor = -minor if k % 2 else minor
        norm = norm + columns[k][0] * cofactor
        conjugate = conjugate + cofactor * w**k
    return field.reduced(norm), field.reduced(conjugate)


def _expanded(
    field: Field, row: list[Any], chosen: tuple[int, ...], minors: dict[tuple[int, ...], Any]
) -> Any:
    """A determinant expanded along its first row."""
    total = field.ctx.constant(0)
    for place, entry in enumerate(row):
        if entry:
            check_product(entry, minors[chosen[:place] + chosen[place + 1 :]])
            product = entry * minors[chosen[:place] + chosen[place + 1 :]]
            total = total - product if place % 2 else total + product
    return field.reduced(total)
