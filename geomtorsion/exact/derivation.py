"""Derivation: partial derivatives of elements from those of the generators."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from flint import fmpq

from geomtorsion.exact import kept, polynomials
from geomtorsion.exact.element import Element
from geomtorsion.exact.entries import counted_as
from geomtorsion.exact.functions import jet

if TYPE_CHECKING:
    from collections.abc import Callable

    import sympy
    from flint import fmpq_mpoly

    from geomtorsion.exact.generators import Generator
    from geomtorsion.exact.tower import Tower

    # The derivative of a generator with respect to a symbol.
    Rule = Callable[[Tower, Generator, sympy.Symbol], Element]


def derivative(field: Tower, element: Element, symbol: sympy.Symbol, /) -> Element:
    """d(num/den) = d num / den - num / den * sum of exponent * d factor / factor."""
    if symbol not in field._symbol_elements:
        symbol = counted_as([symbol], field.symbols).get(symbol, symbol)
    if element._level is None:
        return kept.derivative(field, element, symbol)
    num = field.lift(element)
    den = element._den
    # Everything goes into one sum, which is normalised once.
    terms: list[tuple[Any, ...]] = []
    for part, inner in _parts(field, num, symbol):
        terms.append((1, Element(field, part, den, field.level), inner))
    for index, exponent in den:
        inner = _factor_derivative(field, index, symbol)
        if inner.is_kept or inner._num:
            # d(1/f**e) = -e (1/f**e) df/f: the denominator grows by one power of each factor.
            once = Element(field, field.ctx.constant(1), ((index, 1),), field.level)
            terms.append((-exponent, element, inner, once))
    return field.sum(terms) if terms else field.zero


def _parts(
    field: Tower, poly: fmpq_mpoly, symbol: sympy.Symbol
) -> list[tuple[fmpq_mpoly, Element]]:
    """Pairs (d poly / d generator, d generator / d symbol) that are not zero."""
    found = []
    pairs = zip(field.generators, poly.degrees(), strict=True)
    names = [generator for generator, degree in pairs if degree > 0 and symbol in generator.depends]
    if not names:
        return []
    # A derivative may add generators (jets): all of them first, then one common ring.
    inners, slopes = [], field.generator_slopes
    for generator in names:
        key = (generator.name, symbol)
        if key not in slopes:
            slopes[key] = _RULES[generator.kind](field, generator, symbol)
        inners.append(slopes[key])
    if poly.context() is not field.ctx:
        grown = field.ctx.nvars() - poly.context().nvars()
        poly = polynomials.lifted(field.ctx, poly, grown)
    for generator, inner in zip(names, inners, strict=True):
        if inner.is_kept or inner._num:
            found.append((poly.derivative(field.generators.index(generator)), inner))
    return found


def _factor_derivative(field: Tower, index: int, symbol: sympy.Symbol) -> Element:
    """The derivative of a registered factor."""
    key = (index, symbol)
    known = field.factor_slopes.get(key)
    if known is None:
        parts = _parts(field, field.factors[index], symbol)
        known = field.sum((1, Element(field, part, (), field.level), d) for part, d in parts)
        field.factor_slopes[key] = known
    return known


def _constant(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
    return field.zero


def _symbol(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
    return field.one if generator.shown == symbol else field.zero


def _partnered(sign: int) -> Rule:
    """Rule for cos, sin, cosh, sinh: argument = (angle, name of the partner)."""

    def rule(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
        angle, partner = generator.argument
        other = field.generator_element(field.by_name[partner])
        return field.sum(((sign, other, angle.diff(symbol)),))

    return rule


def _exp(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
    return field.generator_element(generator) * generator.argument.diff(symbol)


def _log(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
    return generator.argument.diff(symbol) / generator.argument


def _root(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
    """w**n = P: w' = w P' / (n P)."""
    tail = generator.tail
    assert tail is not None
    slope = tail.diff(symbol) / tail
    return field.sum(((fmpq(1, generator.degree), field.generator_element(generator), slope),))


def _chebyshev(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
    """cos of a part of an angle: argument = (angle, function that gives its sine)."""
    angle, sine = generator.argument
    return field.sum(((-1, sine(), angle.diff(symbol)),))


def _primitive(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
    """argument = (inner element, derivative with respect to it, arguments)."""
    inner, slope, _ = generator.argument
    return field.sum(((1, slope, inner.diff(symbol)),))


def _jet(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
    """The chain rule over the arguments of an unknown function."""
    name, orders, arguments = generator.argument
    terms = []
    for k, argument in enumerate(arguments):
        inner = argument.diff(symbol)
        if inner.is_kept or inner._num:
            up = tuple(n + (j == k) for j, n in enumerate(orders))
            terms.append((1, jet(field, name, up, arguments), inner))
    return field.sum(terms)


def _opaque(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
    return field.read(generator.shown.diff(symbol), f"derivative of {generator.shown}")


_RULES: dict[str, Rule] = {
    "symbol": _symbol,
    "cos": _partnered(-1),
    "sin": _partnered(1),
    "cosh": _partnered(1),
    "sinh": _partnered(1),
    "exp": _exp,
    "log": _log,
    "root": _root,
    "chebyshev": _chebyshev,
    "primitive": _primitive,
    "jet": _jet,
    "opaque": _opaque,
    "constant": _constant,
    "imaginary": _constant,
}
