"""Cosine: elements that depend on an angle by its cosine alone, with a symbol in place of that."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy
from flint import fmpq

if TYPE_CHECKING:
    from flint import fmpq_mpoly

    from geomtorsion.exact.element import Element
    from geomtorsion.exact.tower import Tower


def by_cosine(
    element: Element, angle: sympy.Symbol, field: Tower, cosine: sympy.Symbol
) -> Element | None:
    """An element as one of another field with a symbol for the cosine; None: not possible.

    Only rational functions of symbols, cos(angle) and even powers of sin(angle) are.

    Examples
    --------
    >>> import sympy
    >>> from geomtorsion.exact import Field
    >>> x, y, z = sympy.symbols("x y z")
    >>> found = Field([x, y]).read(x * sympy.sin(y) ** 2 + sympy.cos(y))
    >>> print(by_cosine(found, y, Field([x, z]), z))
    -x*z**2 + x + z
    >>> by_cosine(Field([x, y]).read(sympy.sin(y)), y, Field([x, z]), z) is None
    True
    """
    source = element.field
    if source.lift(element) == 0:
        return field.zero
    top = _turned(source, source.lift(element), angle, field, cosine)
    if top is None:
        return None
    result, sines = top
    for index, exponent in element._den:
        factor = _turned(source, source.factors[index], angle, field, cosine)
        if factor is None or factor[0].is_zero:
            return None
        result = result / factor[0] ** exponent
        sines -= exponent * factor[1]
    if sines % 2:
        return None
    return result * (1 - field.symbol(cosine) ** 2) ** (sines // 2)


def _turned(
    source: Tower, poly: fmpq_mpoly, angle: sympy.Symbol, field: Tower, cosine: sympy.Symbol
) -> tuple[Element, int] | None:
    """A polynomial over one power, 0 or 1, of the sine, and that power."""
    z, sine, places = field.symbol(cosine), -1, {}
    for place, generator in enumerate(source.generators):
        if generator.shown == sympy.sin(angle):
            sine = place
        elif generator.shown == sympy.cos(angle):
            places[place] = z
        elif generator.shown in field.symbols:
            places[place] = field.symbol(generator.shown)
    terms, odd = [], set()
    for monomial, coefficient in poly.to_dict().items():
        term, value = field.one, fmpq(coefficient)
        for place, power in enumerate(map(int, monomial)):
            if not power:
                continue
            if place == sine:
                term = term * (1 - z**2) ** (power // 2)
            elif place in places:
                term = term * places[place] ** power
            else:
                return None
        odd.add(int(monomial[sine]) % 2 if sine >= 0 else 0)
        terms.append((int(value.p), term, field.rational(1, int(value.q))))
    if len(odd) != 1:
        return None
    return field.sum(terms), odd.pop()
