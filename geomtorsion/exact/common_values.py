"""Common values: whether elements of one field can take the values that others take.

The elements of the second field are restricted to a random slice, on which as many symbols vary as
there are independent elements. Each demand "numerator = value * denominator" is a polynomial there,
modulo a large prime; resultants remove one variable after the other. Where no root is left over
none of the demands can hold together, at real or complex points.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from itertools import combinations
from math import prod
from typing import TYPE_CHECKING, Any

import sympy
from flint import Ordering, fmpz_mod_mpoly_ctx

from geomtorsion.exact.element import in_order
from geomtorsion.exact.limits import NoPointError
from geomtorsion.exact.modular import ModularPoint, _PrimeError
from geomtorsion.exact.relations import Echelon
from geomtorsion.support.allowance import check_limits

if TYPE_CHECKING:
    from geomtorsion.exact.element import Element
    from geomtorsion.exact.generators import Generator

# A polynomial over the numbers modulo a prime, in several variables; and a fraction of two.
Poly = Any
Ratio = tuple[Poly, Poly]
# Longer polynomials take minutes.
LONGEST = 4_000
# The largest degree of a resultant, for the same reason.
HIGHEST = 3_000


class _TooLongError(Exception):
    """A polynomial is too long, or a slice is of a kind that cannot be treated."""


def can_agree(
    one: Sequence[Element], two: Sequence[Element], symbols: Sequence[sympy.Symbol]
) -> bool | None:
    """False where no point gives elements the values that others have at a generic point.

    Parameters
    ----------
    one
        elements of one field, at a random point modulo a prime.
    two
        as many elements of another field.
    symbols
        the symbols of the second field that may vary.

    Returns
    -------
    False: they cannot agree, with a chance of error below 1e-60. None: not decided. It is never
    True: that values agree has to be shown by a point.

    Examples
    --------
    >>> import sympy
    >>> from geomtorsion.exact import Field
    >>> x, y = sympy.symbols("x y")
    >>> first, second = Field([x]), Field([y])
    >>> curve = [first.read(x**2), first.read(x**3)]
    >>> print(can_agree(curve, [second.read(y**4), second.read(y**6)], [y]))
    None
    >>> can_agree(curve, [second.read(y**2), second.read(2 * y**3)], [y])
    False
    """
    try:
        moving = _independent_symbols(two, symbols)
        if len(moving) > 2:
            return None
        slice_ = _Slice(two, moving)
        point = ModularPoint(one[0].field)
        remainders = []
        for _ in range(2):
            values = point.images(list(one))
            if point._prime != slice_.prime:
                return None
            remainders.append(slice_.common(values))
            point._settle()
    except (_TooLongError, _PrimeError, NoPointError, ZeroDivisionError):
        return None
    # Roots that do not move with the values are points where all fractions are 0/0.
    rest, fixed = remainders
    while True:
        shared = rest.gcd(fixed)
        if shared.is_constant():
            break
        rest, _ = divmod(rest, shared)
    return False if rest.is_constant() and not rest.is_zero() else None


def _independent_symbols(
    elements: Sequence[Element], symbols: Sequence[sympy.Symbol]
) -> list[sympy.Symbol]:
    """As many symbols as there are independent elements, on which they stay independent."""
    field: Any = elements[0].field
    echelon = Echelon(field, len(symbols))
    echelon.extend([[x.diff(q) for q in symbols] for x in elements])
    for columns in combinations(range(len(symbols)), echelon.rank):
        if echelon.rank_of_columns(columns) == echelon.rank:
            return [symbols[k] for k in columns]
    return list(symbols)


class _Slice:
    """Elements as fractions of polynomials in what depends on some symbols; the rest is random."""

    def __init__(self, elements: Sequence[Element], symbols: Sequence[sympy.Symbol]) -> None:
        self._field = field = elements[0].field
        generators = field.generators
        point = ModularPoint(field)
        # At its first place symbols of equal names have the values of the other field.
        point._settle()
        point._fill(range(len(generators)))
        self.prime, self._ring = point._prime, point._ring
        moving = set(symbols)
        names: list[str] = []
        # The newest generators come first: they are removed first.
        self._places: dict[int, int | Any] = {}
        self._algebraic: list[tuple[int, Generator]] = []
        for k, generator in enumerate(generators):
            if not moving & generator.depends:
                self._places[k] = point._values[len(generators) - 1 - k]
                continue
            if field.meanings.get(generator.name) is not None:
                raise _TooLongError
            if generator.degree:
                self._algebraic.append((len(names), generator))
            self._places[k] = len(names)
            names.append(f"x{len(names)}")
        self._count = len(names)
        made: Any = fmpz_mod_mpoly_ctx.get  # its stubs are older than FLINT's binding
        self._ctx: Any = made(names, self.prime, Ordering.lex)
        self._gens: Any = self._ctx.gens()
        self._one = self._ctx.from_dict({(0,) * self._count: 1})
        self._zero = self._one - self._one
        self._relations: list[tuple[int, Poly]] = []
        for place, generator in reversed(self._algebraic):
            assert generator.tail is not None
            num, den = self._ratio(generator.tail)
            power = den * self._gens[place] ** generator.degree
            for exponent, number in generator.middle:
                power = power + den * self._gens[place] ** exponent * self._number(number)
            self._relations.append((place, power - num))
        self._ratios = [self._ratio(x) for x in elements]

    def common(self, values: Sequence[Any]) -> Poly:
        """A polynomial in one variable with the points at which the elements have these values."""
        demands = [
            num - den * int(value) for (num, den), value in zip(self._ratios, values, strict=True)
        ]
        used = self._used()
        relations = [(place, row) for place, row in reversed(self._relations) if place in used]
        free = sorted(used - {place for place, _ in relations})
        if not free or len(free) > 2:
            raise _TooLongError
        # A random sum vanishes where all demands do, and at few other points.
        degree = prod(row.degrees()[place] for place, row in relations)
        rows: list[Any] = [
            sum((d * self._weight(k, j) for j, d in enumerate(demands)), self._zero)
            for k in range(len(free) + 2 + degree)
        ]
        for place, relation in relations:
            rows = [self._resultant(row, relation, place) for row in rows]
        if len(free) == 2:
            # A sheared plane: no two curves meet at infinity in the direction that is removed.
            place, other = free
            sheared = list(self._gens)
            sheared[other] = sheared[other] + sheared[place] * self._weight(0, -1)
            rows = [row.compose(*sheared) for row in rows]
            rows = [self._resultant(rows[0], row, place) for row in rows[1:]]
        result = self._zero
        for row in rows:
            result = result.gcd(row)
        return result

    def _used(self) -> set[int]:
        """The variables of the elements, and those on which they rest."""
        used: set[int] = set()
        for poly in (poly for ratio in self._ratios for poly in ratio):
            used |= {k for k, degree in enumerate(poly.degrees()) if degree > 0}
        for place, relation in reversed(self._relations):
            if place in used:
                used |= {k for k, degree in enumerate(relation.degrees()) if degree > 0}
        return used

    def _weight(self, k: int, j: int) -> int:
        return int.from_bytes(hashlib.sha512(f"weight {k} {j}".encode()).digest()[:16], "big")

    def _resultant(self, one: Poly, two: Poly, place: int) -> Poly:
        check_limits()
        if one.degrees()[place] == 0:
            return one
        if len(one) > LONGEST or one.total_degree() * two.total_degree() > HIGHEST:
            raise _TooLongError
        return one.resultant(two, place)

    # -- fractions -------------------------------------------------------------------------------

    def _number(self, value: Any) -> int:
        """A rational number modulo the prime."""
        ratio = sympy.Rational(str(value))
        return int(self._ring(int(ratio.p)) / self._ring(int(ratio.q)))

    def _polynomial(self, poly: Any) -> Poly:
        """A polynomial of the field, on the slice."""
        terms: dict[tuple[int, ...], int] = {}
        prime, powers = int(self.prime), {}
        for monomial, coefficient in poly.to_dict().items():
            exponents, number = [0] * self._count, self._number(coefficient)
            for k, exponent in enumerate(monomial):
                if not exponent:
                    continue
                place = self._places[k]
                if isinstance(place, int):
                    exponents[place] = int(exponent)
                else:
                    if (k, exponent) not in powers:
                        powers[k, exponent] = int(place ** int(exponent))
                    number = number * powers[k, exponent] % prime
            key = tuple(exponents)
            terms[key] = (terms.get(key, 0) + number) % prime
        return self._reduced(self._ctx.from_dict(terms))

    def _reduced(self, poly: Poly) -> Poly:
        """A polynomial modulo the relations."""
        if len(poly) > LONGEST:
            raise _TooLongError
        check_limits()
        for place, relation in reversed(self._relations):
            if poly.degrees()[place] >= relation.degrees()[place]:
                _, poly = divmod(poly, relation)
        return poly

    def _simple(self, num: Poly, den: Poly) -> Ratio:
        num, den = self._reduced(num), self._reduced(den)
        if den.is_zero():
            raise ZeroDivisionError
        shared = num.gcd(den)
        if not shared.is_constant():
            num, den = divmod(num, shared)[0], divmod(den, shared)[0]
        return num, den

    def _sum(self, one: Ratio, two: Ratio) -> Ratio:
        if one[1] == two[1]:
            return self._simple(one[0] + two[0], one[1])
        return self._simple(one[0] * two[1] + two[0] * one[1], one[1] * two[1])

    def _canonical(self, element: Element) -> Ratio:
        num, den = self._polynomial(self._field.lift(element)), self._one
        for index, exponent in element._den:
            den = den * self._polynomial(self._field.factors[index]) ** exponent
        return self._simple(num, den)

    def _ratio(self, element: Element) -> Ratio:
        """An element as a fraction on the slice, part by part."""
        if not element.is_kept:
            return self._canonical(element)
        done: dict[int, Ratio] = {}

        def ratio(part: Element) -> Ratio:
            if id(part) not in done:
                done[id(part)] = self._canonical(part)
            return done[id(part)]

        for node in in_order(element, lambda x: id(x) in done):
            recipe = node._recipe
            total = (self._zero, self._one)
            for coefficient, *factors in recipe.terms:
                num, den = self._one * self._number(coefficient), self._one
                for factor in factors:
                    other = ratio(factor)
                    num, den = num * other[0], den * other[1]
                total = self._sum(total, (num, den))
            if recipe.below:
                if total[0].is_zero():
                    raise ZeroDivisionError
                total = total[1], total[0]
            done[id(node)] = total
        return done[id(element)]
