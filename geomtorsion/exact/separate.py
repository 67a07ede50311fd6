"""Separate: elements as sums of parts that depend on one symbol each, or on none."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from flint import fmpq

from geomtorsion.exact.form import form
from geomtorsion.exact.sign import generators, of_factor

if TYPE_CHECKING:
    import sympy
    from flint import fmpq_mpoly

    from geomtorsion.exact.element import Element

# Numbers that may stand for functions which the derivatives of the parts do not feel.
_PLACES = {"cos": (0,), "sin": (1,), "cosh": (1,), "sinh": (0,), "exp": (1,), "symbol": (0, 1, 2)}


def additive_parts(element: Element, symbols: Sequence[sympy.Symbol]) -> list[Element] | None:
    """Parts, one for each symbol and free of the others, that add up to an element; None: none.

    Examples
    --------
    >>> import sympy
    >>> from geomtorsion.exact import Field
    >>> x, y = sympy.symbols("x y")
    >>> field = Field([x, y])
    >>> [str(part) for part in additive_parts(field.read(x**2 + sympy.cos(y) + 1), [x, y])]
    ['x**2 + 1', 'cos(y)']
    >>> additive_parts(field.read(x * y), [x, y]) is None
    True
    """
    for last in reversed(symbols):
        parts: dict[sympy.Symbol, Element] = {}
        left = element
        for symbol in symbols:
            if symbol != last:
                part = specialised(element, set(symbols) - {symbol})
                if part is None:
                    break
                parts[symbol] = part
                left = left - part
        else:
            if not left.symbols & (set(symbols) - {last}):
                return [parts.get(symbol, left) for symbol in symbols]
    return None


def specialised(element: Element, away: Collection[sympy.Symbol]) -> Element | None:
    """An element with numbers in place of all that depends on some symbols; None: not possible.

    The numbers satisfy all relations of these functions, but are not their values at one place:
    they serve where only derivatives with respect to other symbols matter.
    """
    field = element.field
    inside = [g for g in field.generators_of(element) if g.depends & set(away)]
    if any(g.kind not in _PLACES or not g.depends <= set(away) for g in inside):
        return None
    polys = [field.lift(element), *(field.factors[index] for index, _ in element._den)]
    # A denominator may vanish for one choice of numbers: then the next is tried.
    for choice in range(len(_PLACES["symbol"])):
        values: dict[int, int] = {}
        for generator in inside:
            places = _PLACES[generator.kind]
            values[field.generators.index(generator)] = places[min(choice, len(places) - 1)]
        top, *below = (field.polynomial(field.ctx.from_dict(_put(p, values))) for p in polys)
        if any(factor.is_zero for factor in below):
            continue
        for factor, (_, exponent) in zip(below, element._den, strict=True):
            top = top / factor**exponent
        return top
    return None


def _put(poly: fmpq_mpoly, values: Mapping[int, int]) -> dict[tuple[int, ...], fmpq]:
    """The terms of a polynomial with numbers for some of its variables."""
    found: dict[tuple[int, ...], fmpq] = {}
    for monomial, coefficient in poly.to_dict().items():
        powers, value = [int(e) for e in monomial], fmpq(coefficient)
        for place, number in values.items():
            value, powers[place] = value * number ** powers[place], 0
        key = tuple(powers)
        found[key] = found.get(key, fmpq(0)) + value
    return {key: value for key, value in found.items() if value}


def by_powers(element: Element, symbols: Collection[sympy.Symbol]) -> list[tuple[Element, Element]]:
    """Pairs (coefficient free of symbols, product of powers of what depends on them).

    Products over the denominator of what depends on them; together they add up to the element.
    """
    field, inside = element.field, set(symbols)
    moving = [bool(g.depends & inside) for g in field.generators]
    groups: dict[tuple[int, ...], dict[tuple[int, ...], fmpq]] = {}
    for monomial, value in field.lift(element).to_dict().items():
        powers = tuple(int(e) for e in monomial)
        key = tuple(e if m else 0 for e, m in zip(powers, moving, strict=True))
        rest = tuple(0 if m else e for e, m in zip(powers, moving, strict=True))
        groups.setdefault(key, {})[rest] = fmpq(value)
    free = divisor = field.one
    for index, exponent in element._den:
        factor = field.polynomial(field.factors[index]) ** exponent
        if factor.symbols & inside:
            divisor = divisor * factor
        else:
            free = free * factor
    return [
        (
            field.polynomial(field.ctx.from_dict(terms)) / free,
            field.polynomial(field.ctx.from_dict({key: fmpq(1)})) / divisor,
        )
        for key, terms in groups.items()
    ]


def clearing(elements: Iterable[Element], symbols: Collection[sympy.Symbol]) -> Element | None:
    """The least product h, of factors that depend on symbols, so that h^2 clears all quotients.

    None where there are no elements, or factors that the field cannot hold.
    """
    most: dict[str, int] = {}
    bases = {}
    field = None
    for element in elements:
        field = element.field
        for base, exponent in form(element).powers:
            if not set(generators(base)) <= set(field.generators):
                return None
            factor = of_factor(field, base)
            if exponent < 0 and factor.symbols & set(symbols):
                key = str(factor)
                bases[key] = factor
                most[key] = max(most.get(key, 0), (1 - exponent) // 2)
    if field is None:
        return None
    result = field.one
    for key, exponent in most.items():
        result = result * bases[key] ** exponent
    return result
