"""Square factors: factors outside a root, modulo cos**2 + sin**2 = 1 and cosh**2 - sinh**2 = 1.

Polynomials in cos and sin have no unique factors: (1 - cos)(1 + cos) = sin**2. Forms in the cos C
and the sin S of half of each angle have: cos = C**2 - S**2, sin = 2 C S, 1 = C**2 + S**2. A form
that has an even degree in each angle is again a polynomial in cos and sin. The same holds for cosh
and sinh with exp(u/2) and exp(-u/2), which vanish nowhere.
"""

from __future__ import annotations

import random
from collections import defaultdict
from dataclasses import dataclass
from fractions import Fraction
from math import prod
from operator import itemgetter
from typing import TYPE_CHECKING

from flint import nmod_poly

from geomtorsion.exact.limits import FACTORED_HERE

if TYPE_CHECKING:
    from flint import fmpq_mpoly, fmpq_mpoly_ctx

    from geomtorsion.exact.generators import Generator
    from geomtorsion.exact.tower import Tower

# The largest prime of Mersenne in one word of FLINT; no result depends on it.
_PRIME = pow(2, 61) - 1
_PARTNERS = {"sin": "cos", "sinh": "cosh"}


@dataclass(frozen=True)
class Pair:
    """cos and sin of one angle, or cosh and sinh; t is the tangent of half of the angle, or exp(u).

    first, second: places of cos (cosh) and sin (sinh) among the generators.
    """

    is_circular: bool
    first: int
    second: int

    def degree(self, poly: fmpq_mpoly) -> int:
        """Degree in cos and sin together."""
        return max(int(m[self.first]) + int(m[self.second]) for m in poly.monoms())

    def in_t(self, poly: fmpq_mpoly, degree: int) -> fmpq_mpoly:
        """The form over C**(2 degree), or times (2 t)**degree; t has the place of cos or cosh."""
        ctx = poly.context()
        t, one = ctx.gen(self.first), ctx.constant(1)
        first, second, whole = one - t**2, 2 * t, one + t**2
        if not self.is_circular:
            first, second, whole = whole, -first, second
        parts: dict[tuple[int, int], dict] = defaultdict(dict)
        for monomial, value in poly.to_dict().items():
            exponents = list(monomial)
            powers = int(exponents[self.first]), int(exponents[self.second])
            exponents[self.first] = exponents[self.second] = 0
            parts[powers][tuple(exponents)] = value
        total = ctx.constant(0)
        for (i, j), terms in parts.items():
            total += ctx.from_dict(terms) * first**i * second**j * whole ** (degree - i - j)
        return total

    def numbers(self, terms: dict[tuple[int, int], int], degree: int) -> nmod_poly:
        """As `in_t`, of sums of numbers modulo the prime by powers of cos and sin."""
        first, second, whole = ([1, 0, -1], [0, 2], [1, 0, 1])
        if not self.is_circular:
            first, second, whole = whole, [-1, 0, 1], second
        bases = [nmod_poly([x % _PRIME for x in one], _PRIME) for one in (first, second, whole)]
        total = nmod_poly([], _PRIME)
        for (i, j), value in terms.items():
            total += value * bases[0] ** i * bases[1] ** j * bases[2] ** (degree - i - j)
        return total

    def at(self, t: int) -> tuple[int, int]:
        """cos and sin, or cosh and sinh, modulo the prime."""
        first, second, whole = 1 - t * t, 2 * t, 1 + t * t
        if not self.is_circular:
            first, second, whole = whole, -first, second
        below = pow(whole, -1, _PRIME)
        return first * below % _PRIME, second * below % _PRIME

    def back(self, field: Tower, poly: fmpq_mpoly, shift: int) -> fmpq_mpoly:
        """A polynomial in cos and sin from one in t, times C**(2 shift) or over t**shift."""
        ctx = field.ctx
        first, second, one = ctx.gen(self.first), ctx.gen(self.second), ctx.constant(1)
        parts: dict[int, dict] = defaultdict(dict)
        for monomial, value in poly.to_dict().items():
            exponents = list(monomial)
            power, exponents[self.first] = int(exponents[self.first]), 0
            parts[power][tuple(exponents)] = value
        total = ctx.constant(0)
        for power, terms in parts.items():
            if self.is_circular:
                square = (one - first) ** (power // 2) * (one + first) ** (shift - (power + 1) // 2)
                factor = square * (second if power % 2 else one) / 2**shift
            else:
                base = first + second if power > shift else first - second
                factor = base ** abs(power - shift)
            total += ctx.from_dict(terms) * factor
        return field.reduced(total)


def square_factors(field: Tower, poly: fmpq_mpoly) -> tuple[fmpq_mpoly, fmpq_mpoly] | None:
    """(p, q) with poly = p**2 q for a polynomial that is a square only by such relations, or None.

    A factor of odd degree in half of an angle, such as 1 - cos(x) = 2 S**2, stays under the root:
    S is not among the functions of x.
    """
    pairs = _pairs(field, poly)
    if not pairs:
        return None
    degrees = [pair.degree(poly) for pair in pairs]
    if len(poly) * prod(degree + 1 for degree in degrees) > FACTORED_HERE:
        return None
    if _has_no_square(poly, pairs, degrees):
        return None
    return _taken_out(field, poly, pairs, degrees)


def _pairs(field: Tower, poly: fmpq_mpoly) -> list[Pair]:
    """The pairs in a polynomial; none where it has other algebraic generators."""
    pairs: dict[str, Pair] = {}
    place = {generator.name: k for k, generator in enumerate(field.generators)}
    for generator, degree in zip(field.generators, poly.degrees(), strict=True):
        if not degree:
            continue
        second = _second_of(field, generator)
        if second is not None:
            first = second.argument[1]
            circular = second.kind == "sin"
            pairs[first] = Pair(circular, place[first], place[second.name])
        elif generator.degree:
            return []
    return list(pairs.values())


def _second_of(field: Tower, generator: Generator) -> Generator | None:
    """The sin of the pair to which a generator belongs, or its sinh; None if there is none."""
    if generator.kind in _PARTNERS:
        return generator
    if generator.kind in _PARTNERS.values():
        return field.by_name[generator.argument[1]]
    return None


def _has_no_square(poly: fmpq_mpoly, pairs: list[Pair], degrees: list[int]) -> bool:
    """Whether values of all other generators show that no square contains an angle.

    A square stays one there, and keeps its degree where the degree of the whole is kept.
    """
    numbers = random.Random(1)
    values = [numbers.randrange(1, _PRIME) for _ in range(poly.context().nvars())]
    for pair in pairs:
        values[pair.first], values[pair.second] = pair.at(values[pair.first])
    for pair, degree in zip(pairs, degrees, strict=True):
        terms: dict[tuple[int, int], int] = defaultdict(int)
        for monomial, ratio in poly.to_dict().items():
            value = int(ratio.p) * pow(int(ratio.q), -1, _PRIME)
            for place, exponent in enumerate(monomial):
                if exponent and place not in (pair.first, pair.second):
                    value = value * pow(values[place], int(exponent), _PRIME) % _PRIME
            terms[int(monomial[pair.first]), int(monomial[pair.second])] += value
        there = pair.numbers({powers: x % _PRIME for powers, x in terms.items()}, degree)
        # Missing degrees are powers of C, and exp(u) is a factor of everything.
        if pair.is_circular and 2 * degree - there.degree() > 1:
            return False
        if not pair.is_circular:
            while there and not there[0]:
                there = there // nmod_poly([0, 1], _PRIME)
        if there.gcd(there.derivative()).degree() != 0:
            return False
    return True


def _taken_out(
    field: Tower, poly: fmpq_mpoly, pairs: list[Pair], degrees: list[int]
) -> tuple[fmpq_mpoly, fmpq_mpoly] | None:
    """As `square_factors`, from the factors of the form."""
    ctx = field.ctx
    form = poly
    for pair, degree in zip(pairs, degrees, strict=True):
        form = pair.in_t(form, degree)
    missing = [
        2 * degree - int(form.degrees()[pair.first]) if pair.is_circular else 0
        for pair, degree in zip(pairs, degrees, strict=True)
    ]
    content, factors = field.factored(form)
    units = [_unit(ctx, pair) for pair in pairs]
    powers = {str(factor): exponent for factor, exponent in factors}
    factors = [(factor, exponent) for factor, exponent in factors if str(factor) not in units]
    halves = _even_in_each_angle(
        [
            *(
                (exponent // 2, [int(factor.degrees()[pair.first]) for pair in pairs])
                for factor, exponent in factors
            ),
            *(
                (count // 2, [int(pair is other) for other in pairs])
                for pair, count in zip(pairs, missing, strict=True)
            ),
        ]
    )
    outer, rest = ctx.constant(1), ctx.constant(content)
    for (factor, exponent), half in zip(factors, halves, strict=False):
        outer *= factor**half
        rest *= factor ** (exponent - 2 * half)
    ends = halves[len(factors) :]
    if not any(ends) and all(outer.degrees()[pair.first] == 0 for pair in pairs):
        return None
    for pair, unit, degree, count, end in zip(pairs, units, degrees, missing, ends, strict=True):
        above, below = (int(one.degrees()[pair.first]) for one in (outer, rest))
        if pair.is_circular:
            up, down = (above + end) // 2, (below + count - 2 * end) // 2
        else:
            # Both are written around exp(0), as far as the power of exp(u) is even.
            rest = rest / 2**degree
            whole = degree - powers.get(unit, 0) - above
            turn = round(Fraction(below - 2 * whole, 4))
            up, down = above // 2 - turn, whole + 2 * turn
        outer, rest = pair.back(field, outer, up), pair.back(field, rest, down)
    return outer, rest


def _unit(ctx: fmpq_mpoly_ctx, pair: Pair) -> str:
    """A factor without a zero, as a polynomial in t: C**2 + S**2, or exp(u)."""
    t = ctx.gen(pair.first)
    return str(t**2 + 1 if pair.is_circular else t)


def _even_in_each_angle(counts: list[tuple[int, list[int]]]) -> list[int]:
    """Exponents of factors, at most `most` each, with an even total degree in each angle.

    counts: (most, degrees in the angles) of each factor.
    """
    masks = [sum((degree % 2) << k for k, degree in enumerate(degrees)) for _, degrees in counts]
    odd = [k for k, (count, _) in enumerate(counts) if count % 2 and masks[k]]
    # Some whose sum has the parity of the total are omitted.
    basis: list[tuple[int, frozenset[int]]] = []
    total = 0
    for k in odd:
        total ^= masks[k]
        mask, members = _reduced(masks[k], frozenset((k,)), basis)
        if mask:
            basis = sorted([*basis, (mask, members)], reverse=True, key=itemgetter(0))
    _, left = _reduced(total, frozenset(), basis)
    return [count - (k in left) for k, (count, _) in enumerate(counts)]


def _reduced(
    mask: int, members: frozenset[int], basis: list[tuple[int, frozenset[int]]]
) -> tuple[int, frozenset[int]]:
    """A vector modulo 2 reduced by a basis with the highest first, and the sums that it needs."""
    for other, own in basis:
        if mask ^ other < mask:
            mask, members = mask ^ other, members ^ own
    return mask, members
