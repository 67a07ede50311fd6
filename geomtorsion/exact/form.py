"""Form: an element as a person would write it, a product of powers of short factors.

High powers of cos and sin are written as multiple angles, which keeps their digits: cos(60 x) is a
polynomial of degree 60 in cos(x) with coefficients near 2**59, exact, but worthless in floating
point.  As a sum of multiple angles the coefficients stay small.  The factors also determine signs.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from math import comb
from typing import TYPE_CHECKING

import sympy
from flint import fmpq

from geomtorsion.exact import polynomials
from geomtorsion.exact.generators import Generator
from geomtorsion.exact.roots import roots_restored
from geomtorsion.support.exclusive import exclusive

if TYPE_CHECKING:
    from flint import fmpq_mpoly

    from geomtorsion.exact.element import Element
    from geomtorsion.exact.tower import Tower

Monomial = tuple[tuple[Generator, int], ...]
# A polynomial as FLINT gives it, and with its generators by themselves.
Terms = dict[tuple[int, ...], fmpq]
Named = list[tuple[fmpq, Monomial]]

# Longer polynomials are written as they are, neither factored nor rewritten with sin**2: that would
# cost more than it shortens, and nobody reads them.
LONGEST_FACTORED = 2000
# A product of factors that is a sum of so few multiple angles is written as that sum.
_FEW_WAVES = 4
# Up to this degree powers lose less than two digits and read better.
_HIGHEST_DEGREE = 8


@dataclass(frozen=True, eq=False)
class Sum:
    """A polynomial of several terms, (coefficient, monomial) each.

    negative is the sum with opposite signs where that reads as well: half of them are minus.
    source is the sum as an element; sums of multiple angles have none.
    """

    terms: tuple[tuple[fmpq, Monomial], ...]
    negative: Sum | None = None
    source: Element | None = None


@dataclass(frozen=True, eq=False)
class Form:
    """coefficient * product of base**exponent; a base is a generator or a sum."""

    coefficient: fmpq
    powers: tuple[tuple[Generator | Sum, int], ...]


class Radicals:
    """The quadratic generators of a field with their radicands in factors."""

    def __init__(self, field: Tower) -> None:
        self.level: int = field.level
        self.sums: dict[str, tuple[Sum, int]] = {}
        self.table: list[tuple[str, fmpq, tuple[str, ...]]] = []
        # Root -> its square without the number that all its terms share, and that number.
        self.squares: dict[str, tuple[fmpq_mpoly, fmpq]] = {}
        self.partners: list[tuple[int, int, int]] = []
        self.circular: list[tuple[int, int]] = []
        for position, generator in enumerate(field.generators):
            tail = generator.tail
            if generator.degree != 2 or tail is None or generator.kind == "imaginary":
                continue
            content, factors = field.factored(field.lift(tail))
            if all(exponent == 1 for _, exponent in factors) and factors:
                keys = tuple(str(factor) for factor, _ in factors)
                key = str(field.ctx.gen(position))
                self.table.append((key, content, keys))
                if abs(content) != 1 and len(field.lift(tail)) > 1:
                    share = abs(fmpq(content))
                    self.squares[key] = (field.lift(tail) * (1 / share), share)
            if generator.kind in ("sin", "sinh"):
                partner = field.by_name[generator.argument[1]]
                sign = -1 if generator.kind == "sin" else 1
                place = field.generators.index(partner)
                self.partners.append((place, position, sign))
                if generator.kind == "sin":
                    self.circular.append((place, position))


@exclusive
def form(element: Element) -> Form:
    """The written form of an element, made once for all that are equal."""
    if element._form is None:
        forms = element.field.tables.setdefault("forms", {})
        # Equal elements are often different objects; factoring is expensive, their text is cheap.
        key = (str(element.field.lift(element)), element._den)
        if key not in forms:
            forms[key] = _made(element)
        element._form = forms[key]
    return element._form


def radicals(field: Tower) -> Radicals:
    """The table of radicals, made again when the field has grown."""
    table = field.tables.get("radicals")
    if table is None or table.level != field.level:
        fresh = Radicals(field)
        field.tables["radicals"] = table = fresh
    return table


def _made(element: Element) -> Form:
    field = element.field
    num, den, below = roots_restored(element)
    if not num:
        return Form(fmpq(0), ())
    if len(num) == 1 and not den and not below:
        return _monomial(field, num)
    table = radicals(field)
    polys: dict[str, fmpq_mpoly] = {}
    exponents: dict[str, int] = {}
    content, factors = (
        field.factored(num) if len(num) <= LONGEST_FACTORED else (fmpq(1), [(num, 1)])
    )
    if len(factors) > 1 and _is_short_wave(field, table, num):
        # cos(3 x) + cos(2 x) is shorter and more precise than the product of its factors.
        content, factors = fmpq(1), [(num, 1)]
    for factor, exponent in factors:
        key = str(factor)
        polys[key], exponents[key] = factor, exponent
    divisors = [(field.factors[index], exponent) for index, exponent in den]
    for factor, exponent in [*divisors, *below.values()]:
        key = str(factor)
        polys[key] = factor
        exponents[key] = exponents.get(key, 0) - exponent
    for root, scale, keys in table.table:
        counts = [exponents.get(key, 0) for key in keys]
        least, most = min(counts), max(counts)
        # A radicand that is a full factor or divisor is the square of its root.
        take = least if least > 0 else min(0, most)
        if take:
            for key in keys:
                exponents[key] -= take
            exponents[root] = exponents.get(root, 0) + 2 * take
            content = content / scale**take
    powers: list[tuple[Generator | Sum, int]] = []
    for key, exponent in exponents.items():
        if exponent:
            if key in table.squares and exponent % 2 == 0:
                # 3*r**2 - 6*M*r under a root is 3*(r**2 - 2*M*r) where the root is squared.
                square, share = table.squares[key]
                exponent //= 2
                content, key = content * share**exponent, str(square)
                polys[key] = square
            base, sign = _base(field, table, key, polys.get(key))
            content = content * sign if exponent % 2 else content
            powers.append((base, exponent))
    if content < 0:
        content = content * _sign_absorbed(powers)
    return Form(fmpq(content), tuple(powers))


def _is_short_wave(field: Tower, table: Radicals, num: fmpq_mpoly) -> bool:
    """Whether a polynomial of high degree in cos and sin is a sum of very few waves."""
    degrees = num.degrees()
    if not any(degrees[cos] > _HIGHEST_DEGREE for cos, _ in table.circular):
        return False
    terms = {tuple(map(int, m)): fmpq(c) for m, c in num.to_dict().items()}
    high = _high_pairs(terms, table.circular)
    return bool(high) and len(_multiple_angles(field, terms, high)) <= _FEW_WAVES


def _sign_absorbed(powers: list[tuple[Generator | Sum, int]]) -> int:
    """-1 if a sum with as many minus as plus signs could take the minus, else 1."""
    for place, (base, exponent) in enumerate(powers):
        if isinstance(base, Sum) and exponent % 2 and base.negative is not None:
            powers[place] = (base.negative, exponent)
            return -1
    return 1


def _monomial(field: Tower, num: fmpq_mpoly) -> Form:
    """The form of a polynomial of one term."""
    return Form(num.leading_coefficient(), polynomials.powers(field.generators, num.monomial(0)))


def _base(
    field: Tower, table: Radicals, key: str, poly: fmpq_mpoly | None
) -> tuple[Generator | Sum, int]:
    """A factor as generator or as sum with its better sign."""
    generator = field.by_name.get(key)
    if generator is not None:
        return generator, 1
    assert poly is not None
    entry = table.sums.get(key)
    if entry is None:
        entry = table.sums[key] = _sum(field, table, poly)
    return entry


def _sum(field: Tower, table: Radicals, poly: fmpq_mpoly) -> tuple[Sum, int]:
    """A polynomial as sum of terms, with sin**2 for 1 - cos**2 where that is shorter."""
    degrees = poly.degrees()
    if any(degrees[cos] > 1 for cos, _, _ in table.partners):
        terms = {tuple(map(int, m)): fmpq(c) for m, c in poly.to_dict().items()}
        high = _high_pairs(terms, table.circular)
        if high:
            return Sum(tuple(_multiple_angles(field, terms, high))), 1
        # Which of the three is shortest depends on the other terms: all are tried.
        for cos, sin, sign in table.partners:
            if len(terms) <= LONGEST_FACTORED and any(m[cos] > 1 for m in terms):
                others = (_paired(terms, cos, sin, sign), _rewritten(terms, cos, sin, sign))
                terms = min((terms, *others), key=len)
        summands = [(value, polynomials.powers(field.generators, m)) for m, value in terms.items()]
    else:
        summands = list(polynomials.terms(field.generators, poly))
    # A sum with more minus than plus signs reads better with its sign outside.
    positive = sum(1 for value, _ in summands if value > 0)
    sign = -1 if 2 * positive < len(summands) else 1
    named = tuple([(value * sign, own) for value, own in summands])
    source = field.polynomial(poly * sign)
    if 2 * positive != len(named):
        return Sum(named, source=source), sign
    opposite = Sum(tuple((-value, m) for value, m in named), source=-source)
    return Sum(named, opposite, source), sign


def _rewritten(terms: Terms, cos: int, sin: int, sign: int) -> Terms:
    """cos**2 replaced with 1 + sign * sin**2."""
    result: Terms = {}
    for monomial, value in terms.items():
        half, rest = divmod(monomial[cos], 2)
        factor = fmpq(1)
        for k in range(half + 1):
            new = list(monomial)
            new[cos], new[sin] = rest, monomial[sin] + 2 * k
            key = tuple(new)
            total = result.get(key, fmpq(0)) + value * factor
            if total:
                result[key] = total
            else:
                result.pop(key, None)
            factor = factor * sign * (half - k) / (k + 1)
    return result


def _paired(terms: Terms, cos: int, sin: int, sign: int) -> Terms:
    """A - A cos**2 replaced with A sin**2, pair by pair (A cosh**2 - A with A sinh**2)."""
    result = dict(terms)
    for monomial in sorted(terms, key=lambda m: -m[cos]):
        value = result.get(monomial, fmpq(0))
        lower = list(monomial)
        lower[cos] -= 2
        partner = tuple(lower)
        if monomial[cos] < 2 or not value or result.get(partner) != -value:
            continue
        del result[monomial], result[partner]
        lower[sin] += 2
        key = tuple(lower)
        total = result.get(key, fmpq(0)) + value * sign
        if total:
            result[key] = total
        else:
            result.pop(key, None)
    return result


def _high_pairs(terms: Terms, pairs: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """The pairs (cos, sin) in which a polynomial has a high degree."""
    return [
        (cos, sin) for cos, sin in pairs if any(m[cos] + m[sin] > _HIGHEST_DEGREE for m in terms)
    ]


def _multiple_angles(field: Tower, terms: Terms, pairs: list[tuple[int, int]]) -> Named:
    """The same sum with cos**a sin**b of these pairs replaced by cos(k x) and sin(k x)."""
    collected: dict[tuple[tuple[int, ...], tuple[tuple[int, bool], ...]], fmpq] = {}
    for monomial, value in terms.items():
        rest = list(monomial)
        products: list[tuple[fmpq, tuple[tuple[int, bool], ...]]] = [(value, ())]
        for cos, sin in pairs:
            # Products of powers of one angle are sums of its multiples; angles are independent.
            waves = _harmonics(monomial[cos], monomial[sin])
            rest[cos] = rest[sin] = 0
            products = [
                (v * share, (*mode, wave)) for v, mode in products for wave, share in waves.items()
            ]
        for share, mode in products:
            key = (tuple(rest), mode)
            collected[key] = collected.get(key, fmpq(0)) + share
    named: Named = []
    for (rest, mode), value in collected.items():
        if value:
            factors = [
                (_multiple(field, field.generators[sin if odd else cos], k), 1)
                for (cos, sin), (k, odd) in zip(pairs, mode, strict=True)
                if k
            ]
            named.append((value, (*factors, *polynomials.powers(field.generators, rest))))
    return named


@lru_cache(maxsize=4096)
def _harmonics(a: int, b: int) -> dict[tuple[int, bool], fmpq]:
    """cos**a sin**b as {(k, is a sine): coefficient}."""
    # With z = exp(i x): cos = (z + 1/z)/2 and sin = (z - 1/z)/(2 i).
    powers: dict[int, int] = {}
    for j in range(a + 1):
        for m in range(b + 1):
            k = a - 2 * j + b - 2 * m
            powers[k] = powers.get(k, 0) + comb(a, j) * comb(b, m) * (-1) ** m
    # 1/i**b is real for even b, where z**k pairs to cosines, else to sines.
    sign = (-1) ** (b // 2)
    waves: dict[tuple[int, bool], fmpq] = {}
    for k, value in powers.items():
        if k < 0 or not value:
            continue
        weight = 1 if k == 0 else 2
        waves[k, bool(b % 2)] = fmpq(sign * weight * value, 2 ** (a + b))
    return waves


def _multiple(field: Tower, generator: Generator, k: int) -> Generator:
    """cos or sin of k times the angle: for writing only, no generator of the field."""
    if k == 1:
        return generator
    multiples = field.tables.setdefault("multiples", {})
    key = (generator.name, k)
    if key not in multiples:
        angle = generator.argument[0] * k
        function = sympy.cos if generator.kind == "cos" else sympy.sin
        multiples[key] = Generator(
            generator.kind,
            f"{generator.name}_{k}",
            function(angle.sympy),
            generator.depends,
            argument=(angle, generator.argument[1]),
        )
    return multiples[key]


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
    used = {g for base, _ in written.powers for g in _generators(base)}
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


def _generators(base: Generator | Sum) -> Iterator[Generator]:
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
