"""Sampling: points inside the domain of a frame, found without chance."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import sympy as sp

from geomtorsion import checks
from geomtorsion.errors import CoordinateError
from geomtorsion.precision import EPS

if TYPE_CHECKING:
    from geomtorsion.exact import Element

# So many points are tried, in ranges that become ten times as wide on the way.
TRIES = 400
# As fine as doubles: at small fractions two symbols may coincide, and with them two expressions
# that differ everywhere else.
FINE = round(1 / EPS)
# Fractional parts of multiples of their square roots fill a cube evenly.
PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71)

Point = dict[sp.Symbol, sp.Rational]


def domain_relations(domain: object) -> tuple[sp.Basic, ...]:
    """A domain as relations that all hold: from one relation, And(...), a sequence or None."""
    if domain is None:
        return ()
    relations = "{subject}: relations were needed, but {value} came. Give r > 2*M, 0 < theta."
    items = (
        [domain]
        if isinstance(domain, sp.Basic | bool)
        else checks.entries(domain, "domain", CoordinateError, message=relations)
    )
    found: list[sp.Basic] = []
    item: Any
    for item in items:
        parts = item.args if isinstance(item, sp.And) else (item,)
        for part in parts:
            if part is True or part == sp.true:
                continue
            if not isinstance(part, sp.core.relational.Relational):
                raise CoordinateError(
                    f"domain: {checks.shown(part)} is no relation. "
                    "Give relations such as r > 2*M, 0 < theta."
                )
            found.append(part)
    return tuple(found)


def candidate_points(
    coordinates: Sequence[sp.Symbol],
    parameters: Sequence[sp.Symbol],
    relations: Iterable[sp.Basic],
    fineness: int = 97,
) -> Iterator[Point]:
    """Points that satisfy the relations and the assumptions of the symbols, in a fixed order."""
    relations = tuple(relations)
    symbols = [*coordinates, *parameters]
    ranges = {symbol: _interval(symbol, relations) for symbol in symbols}
    if any(low is not None and high is not None and low >= high for low, high in ranges.values()):
        return
    whole = {symbol for symbol in symbols if symbol.is_integer}
    several = [x for x in relations if len(x.free_symbols) > 1 or whole & x.free_symbols]
    for number in range(TRIES):
        # Domains far from the origin are reached by wider and wider ranges.
        stretch = 1 + 10 * number // TRIES
        point = {}
        for k, symbol in enumerate(symbols):
            root = math.sqrt(PRIMES[k % len(PRIMES)]) * (number + 1 + k // len(PRIMES))
            share = Fraction(int((root % 1) * fineness) + 1, fineness + 2)
            low, high = _finite(ranges[symbol], symbol in parameters, stretch)
            value = low + (high - low) * share
            if symbol.is_integer:
                # The next one on the side where zero is not.
                value = Fraction(math.floor(value) + (ranges[symbol][0] is not None))
            point[symbol] = sp.Rational(value.numerator, value.denominator)
        if all(relation.subs(point) == sp.true for relation in several):
            yield point


def with_functions(element: Element, point: Point) -> dict[Any, Any]:
    """A point, with unknown functions set to one and their derivatives to zero."""
    values: dict[Any, Any] = dict(point)
    for generator in element.field.generators:
        if generator.kind == "jet":
            values[generator.shown] = 0 if isinstance(generator.shown, sp.Derivative) else 1
    return values


def with_generic_functions(element: Element, point: Point) -> dict[Any, Any]:
    """A point, with unknown functions as they are where the signs of roots were read."""
    field = element.field
    jets = [generator for generator in field.generators if generator.kind == "jet"]
    return {**point, **{g.shown: field.sample.value(field.generator_element(g)) for g in jets}}


def _interval(
    symbol: sp.Symbol, relations: Iterable[sp.Basic]
) -> tuple[Fraction | None, Fraction | None]:
    """Bounds of a symbol from its assumptions and from relations to numbers."""
    low = Fraction(0) if symbol.is_nonnegative else None
    high = Fraction(0) if symbol.is_nonpositive else None
    for relation in relations:
        if relation.free_symbols != {symbol}:
            continue
        less, greater = (relation.lts, relation.gts) if hasattr(relation, "lts") else (None, None)
        if less == symbol and greater is not None and greater.is_finite:
            bound = Fraction(float(greater)).limit_denominator(10**6)
            high = bound if high is None else min(high, bound)
        elif greater == symbol and less is not None and less.is_finite:
            bound = Fraction(float(less)).limit_denominator(10**6)
            low = bound if low is None else max(low, bound)
    return low, high


def _finite(
    bounds: tuple[Fraction | None, Fraction | None], parameter: bool, stretch: int
) -> tuple[Fraction, Fraction]:
    """A finite range: coordinates reach further out than parameters."""
    low, high = bounds
    width = Fraction(3, 4) if parameter else Fraction(4)
    width *= stretch
    if low is None and high is None:
        return -width / 2, width / 2
    if low is None:
        assert high is not None
        return high - width, high
    return low, low + width if high is None else high
