"""Radical denominators: cleared by conjugates, and restored where that is exact.

1/(A + B w) is kept as (A - B w)/(A**2 - B**2 P).  The norm below may vanish where A + B w
does not; written and evaluated, the quotient is therefore turned back where that is exact.
"""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

from flint.utils.flint_exceptions import DomainError

from geomtorsion.exact import polynomials
from geomtorsion.exact.limits import LARGEST_PRODUCT, MOST_AT_ONCE
from geomtorsion.exact.roots import square_root_inside

if TYPE_CHECKING:
    from flint import fmpq, fmpq_mpoly

    from geomtorsion.exact.element import Denominator, Element
    from geomtorsion.exact.tower import Tower

    # Factors with roots below the line, by their text: polynomial and exponent.
    Below = dict[str, tuple[fmpq_mpoly, int]]


def inverse(field: Tower, element: Element, largest: int = LARGEST_PRODUCT) -> Element | None:
    """1/element = den/num, with num freed of algebraic generators first.

    None where a product of more than `largest` pairs of terms would be needed for that.
    """
    num = field.lift(element)
    den = field.cofactor(element._den, ())
    multiplier = field.ctx.constant(1)
    degrees = num.degrees()
    # A quotient by several terms with roots reads better as it was: the denominator is noted.
    rooted = len(num) > 1 and any(
        g.degree and d > 0 for g, d in zip(field.generators, degrees, strict=True)
    )
    given = num
    for position, generator in enumerate(field.generators):
        if generator.degree and degrees[position] > 0:
            if generator.degree > 2:
                found = _conjugate(field, num, position, largest)
                if found is None or len(multiplier) * len(found[1]) > largest:
                    return None
                num, conjugate = found
                multiplier = field.reduced(multiplier * conjugate)
                # A conjugate may bring in roots that stand below this one; later rounds clear them.
                degrees = num.degrees()
                continue
            assert generator.tail is not None
            tail = field.lift(generator.tail)
            w = field.ctx.gen(position)
            below, above = polynomials.split(num, position)
            # 1/(B w) = w/(B P): no conjugate is needed.
            if not below:
                num = field.reduced(above * tail)
                multiplier = field.reduced(multiplier * w)
            else:
                most = max(len(num), len(multiplier)) * len(num)
                if most > largest or len(above) ** 2 * len(tail) > largest:
                    return None
                num = field.reduced(below * below - above * above * tail)
                multiplier = field.reduced(multiplier * (below - above * w))
            degrees = num.degrees()
    # Where roots depend on one another, the norm may vanish of what does not.
    if not num or (not field.all_sure and field.polynomial(num).is_zero):
        return None
    # The time of factoring grows at least as fast as that of squaring.
    if len(num) ** 2 > largest or len(multiplier) * len(den) > largest:
        return None
    if rooted:
        field.note_rooted(field.polynomial(given))
    content, factors = field.factored(num)
    # Irreducible factors are registered once, so that later sums share them.
    return field.over_factors(multiplier * den * (1 / content), factors)


def coefficients(field: Tower, poly: fmpq_mpoly, position: int, degree: int) -> list[fmpq_mpoly]:
    """The coefficients of 1, w, ..., w**(degree - 1) for the generator at a position."""
    parts: list[dict[tuple[int, ...], fmpq]] = [{} for _ in range(degree)]
    for monomial, value in poly.to_dict().items():
        exponents = list(monomial)
        power, exponents[position] = int(exponents[position]), 0
        parts[power][tuple(exponents)] = value
    return [field.ctx.from_dict(part) for part in parts]


def _conjugate(
    field: Tower, num: fmpq_mpoly, position: int, largest: int
) -> tuple[fmpq_mpoly, fmpq_mpoly] | None:
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
    minors: dict[tuple[int, ...], fmpq_mpoly] = {(): field.ctx.constant(1)}
    for size in range(1, n):
        row = n - size
        larger = {}
        for chosen in combinations(range(n), size):
            minor = _expanded(field, [columns[k][row] for k in chosen], chosen, minors, largest)
            if minor is None:
                return None
            larger[chosen] = minor
        minors = larger
    norm = conjugate = field.ctx.constant(0)
    for k in range(n):
        minor = minors[tuple(j for j in range(n) if j != k)]
        cofactor = -minor if k % 2 else minor
        if len(columns[k][0]) * len(cofactor) > largest:
            return None
        norm = norm + columns[k][0] * cofactor
        conjugate = conjugate + cofactor * w**k
    return field.reduced(norm), field.reduced(conjugate)


def _expanded(
    field: Tower,
    row: list[fmpq_mpoly],
    chosen: tuple[int, ...],
    minors: dict[tuple[int, ...], fmpq_mpoly],
    largest: int,
) -> fmpq_mpoly | None:
    """A determinant expanded along its first row; None where a product would be too large."""
    total = field.ctx.constant(0)
    for place, entry in enumerate(row):
        if entry:
            minor = minors[chosen[:place] + chosen[place + 1 :]]
            if len(entry) * len(minor) > largest:
                return None
            product = entry * minor
            total = total - product if place % 2 else total + product
    return field.reduced(total)


class Norms:
    """The denominators with roots met so far, each with conjugates and norm.

    units: those whose norm is a number, such as sqrt(x**2 + 1) + x, without a minus.
    """

    def __init__(self, field: Tower) -> None:
        self.level: int = field.level
        self.count: int = len(field.rooted)
        self.table: list[tuple[list[fmpq_mpoly], Denominator]] = []
        self.units: list[fmpq_mpoly] = []
        self._seen: set[str] = set()
        for element in tuple(field.rooted):
            for factor, _ in field.factored(field.lift(element))[1]:
                self._enter(field, factor)

    def _enter(self, field: Tower, factor: fmpq_mpoly) -> None:
        """Notes one factor, if it has roots and its norm is a product of known factors."""
        key = str(factor)
        if key in self._seen or len(factor) < 2:
            return
        self._seen.add(key)
        conjugates, norm = [factor], factor
        for place, generator in enumerate(field.generators):
            # The norm over one root may bring in those that stand below it.
            if generator.degree != 2 or not norm.degrees()[place]:
                continue
            below, above = polynomials.split(norm, place)
            assert generator.tail is not None
            norm = field.reduced(below * below - above * above * field.lift(generator.tail))
            if factor.degrees()[place]:
                w = field.ctx.gen(place)
                halves = [polynomials.split(poly, place) for poly in conjugates]
                conjugates += [low - high * w for low, high in halves]
        if norm == factor:
            return
        powers: dict[int, int] = {}
        factors = field.factored(norm)[1]
        # The norm of a square is one; as a polynomial it has no factors, for its roots are reduced.
        if len(factor) ** 2 <= MOST_AT_ONCE and all(exponent % 2 == 0 for _, exponent in factors):
            inside = square_root_inside(field, field.polynomial(factor), by_its_own=True)
            if inside is not None and not inside._den:
                for part, _ in field.factored(field.lift(inside))[1]:
                    self._enter(field, part)
                return
        for part, exponent in factors:
            index = field.factor_index.get(str(part))
            # Only norms that stand below some element can be replaced.
            if index is None:
                return
            powers[index] = powers.get(index, 0) + exponent
        if powers:
            self.table.append((conjugates, tuple(sorted(powers.items()))))
        elif not _mixed(factor):
            self.units.append(factor)


def norms(field: Tower) -> Norms:
    """The table of norms, made anew when the field has grown."""
    known = field.tables.get("norms")
    if known is None or known.level != field.level or known.count != len(field.rooted):
        known = field.tables["norms"] = Norms(field)
    return known


def roots_restored(element: Element) -> tuple[fmpq_mpoly, Denominator, Below]:
    """(num, den, {key: (polynomial, exponent)}): the element with roots below where exact."""
    field = element.field
    num, den = field.lift(element), element._den
    below: Below = {}
    if not field.rooted:
        return num, den, below
    # Whole norms first; what several inverses share, or one of them in part, may be left.
    for whole in (True, False):
        for conjugates, powers in norms(field).table:
            while part := _shared(den, powers, whole):
                found = _divided(field, num, conjugates, part)
                if found is None:
                    break
                # num/part = quotient/divisor, and what was cleared is gone from below.
                num, divisor = found
                den = _without(den, part)
                if divisor.leading_coefficient() < 0:
                    num, divisor = -num, -divisor
                _enter_below(below, divisor)
        if whole and den and not below and (found := _reciprocal(field, num, den)) is not None:
            return field.ctx.constant(1), (), {str(found): (found, 1)}
    for unit in norms(field).units:
        # sqrt(x**2 + 1) - x has no right digit for large x; 1/(sqrt(x**2 + 1) + x) has them all.
        while _mixed(num) and len(product := field.reduced(num * unit)) < len(num):
            num = product
            _enter_below(below, unit)
    return num, den, below


def _mixed(poly: fmpq_mpoly) -> bool:
    """Whether terms of both signs are there, which may cancel."""
    signs = {value > 0 for value in poly.coeffs()}
    return len(signs) == 2


def _enter_below(below: Below, divisor: fmpq_mpoly) -> None:
    """Notes one more factor with roots below the line."""
    key = str(divisor)
    below[key] = (divisor, below.get(key, (None, 0))[1] + 1)


def _shared(den: Denominator, powers: Denominator, whole: bool) -> Denominator:
    """What a denominator and a norm have in common; nothing where all of its factors have to."""
    have = dict(den)
    part = tuple((i, min(e, have[i])) for i, e in powers if i in have)
    return part if not whole or len(part) == len(powers) else ()


def _without(den: Denominator, part: Denominator) -> Denominator:
    """The quotient of two denominators."""
    cleared = dict(part)
    return tuple((i, e - cleared.get(i, 0)) for i, e in den if e > cleared.get(i, 0))


def _reciprocal(field: Tower, num: fmpq_mpoly, den: Denominator) -> fmpq_mpoly | None:
    """den/num where that is a polynomial with roots: what was inverted shared a norm with more."""
    norm = field.cofactor(den, ())
    # What is cleared from below is no shorter than the conjugate above.
    if len(num) > len(norm) or len(num) < 2:
        return None
    other, own = field.ctx.constant(1), num
    for place, generator in enumerate(field.generators):
        if generator.degree == 2 and own.degrees()[place]:
            below, above = polynomials.split(own, place)
            flipped = below - above * field.ctx.gen(place)
            # A norm that is long is that of a long polynomial, which nobody would read.
            if max(len(other), len(own)) * len(flipped) > MOST_AT_ONCE:
                return None
            other, own = field.reduced(other * flipped), field.reduced(own * flipped)
    if own == num:
        return None
    try:
        return other / (own / norm)
    except (DomainError, ZeroDivisionError):
        return None


def _divided(
    field: Tower, num: fmpq_mpoly, conjugates: list[fmpq_mpoly], part: Denominator
) -> tuple[fmpq_mpoly, fmpq_mpoly] | None:
    """(q, c) with num/part = q/c for a conjugate c, or None."""
    divided_by = field.cofactor(part, ())
    for conjugate in conjugates:
        try:
            return field.reduced(num * conjugate) / divided_by, conjugate
        except DomainError:
            continue
    return None
