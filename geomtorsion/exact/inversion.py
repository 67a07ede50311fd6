"""Inversion: algebraic generators are cleared from a denominator by their conjugates."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

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
                norm = _by_linear_system(field, num, position)
                return norm * field.polynomial(multiplier * den)
            tail = field.lift(generator.tail)  # type: ignore[arg-type]
            w = field.ctx.gen(position)
            below, above = split(field, num, position)
            if not below:
                num = field.reduced(above * tail)
                multiplier = field.reduced(multiplier * w)
            else:
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


def _by_linear_system(field: Field, num: Any, position: int) -> Element:
    """The inverse in an extension of degree n: solves (num * x = 1) for n coefficients."""
    generator = field.generators[position]
    n = generator.degree
    w = field.generator_element(generator)
    # Column k holds the coefficients of num * w**k; the solution is x = sum x_k w**k.
    columns = []
    power = field.polynomial(num)
    for _ in range(n):
        columns.append([field.polynomial(c) for c in coefficients(field, power._num, position, n)])
        power = power * w
    rows = [
        [columns[k][i] for k in range(n)] + [field.one if i == 0 else field.zero] for i in range(n)
    ]
    solution = _solved(rows)
    return field.sum((1, x, w**k) for k, x in enumerate(solution))


def _solved(rows: list[list[Element]]) -> list[Element]:
    """The solution of a regular linear system, by elimination over the field."""
    n = len(rows)
    for column in range(n):
        pivot = next(i for i in range(column, n) if rows[i][column]._num)
        rows[column], rows[pivot] = rows[pivot], rows[column]
        scale = rows[column][column].inverse()
        rows[column] = [scale * entry for entry in rows[column]]
        for i in range(n):
            factor = rows[i][column]
            if i != column and factor._num:
                rows[i] = [a - factor * b for a, b in zip(rows[i], rows[column], strict=True)]
    return [row[n] for row in rows]
