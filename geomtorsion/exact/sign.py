"""Signs: a shorter element that is positive, zero and negative where another one is."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from geomtorsion.exact.form import Sum, form
from geomtorsion.exact.generators import Generator

if TYPE_CHECKING:
    from geomtorsion.exact.element import Element
    from geomtorsion.exact.tower import Tower


def of_same_sign(element: Element) -> Element:
    """An element without quotients that has the sign of a real one wherever that has a value.

    Examples
    --------
    >>> import sympy
    >>> from geomtorsion.exact import Field
    >>> x, y = sympy.symbols("x y")
    >>> of_same_sign(Field([x, y]).read(3 * (1 + x) ** 3 / (y * x**2))).sympy
    y*(x + 1)
    """
    if element.is_kept:
        return element
    field, written = element.field, form(element)
    used = {g for base, _ in written.powers for g in generators(base)}
    # Waves of many angles are written with functions that the field does not have.
    strange = used - set(field.generators)
    if element.is_zero or strange or any(g.kind == "imaginary" for g in used):
        return element
    result = field.one if written.coefficient > 0 else -field.one
    for base, exponent in written.powers:
        if exponent % 2:
            if not (isinstance(base, Generator) and base.kind == "exp"):
                result = result * of_factor(field, base)
        elif exponent > 0:
            result = result * of_factor(field, base) ** 2
    return result


def generators(base: Generator | Sum) -> Iterator[Generator]:
    """What a factor is made of."""
    if isinstance(base, Generator):
        yield base
    else:
        yield from (generator for _, monomial in base.terms for generator, _ in monomial)


def of_factor(field: Tower, base: Generator | Sum) -> Element:
    """A factor of a written form as an element."""
    if isinstance(base, Generator):
        return field.generator_element(base)
    terms = []
    for value, monomial in base.terms:
        powers = [field.generator_element(generator) ** e for generator, e in monomial]
        terms.append((value, *powers))
    return field.sum(terms)
