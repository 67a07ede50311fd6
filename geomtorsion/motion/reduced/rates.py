"""Reduced rates: geodesics whose momenta along coordinates that do not occur are constants.

Legs along such coordinates alone have u^i = G^ik E_k^a p_a: no equations of their own. The rest is
written as q' = dH/dp, p' = -dH/dq with H = G^ij E_i^mu E_j^nu p_mu p_nu / 2. Where H = K / sigma,
p'_r = (-dK/dq^r + (N/2) dsigma/dq^r) / sigma with N = 2 H, which is a constant, too. Where K falls
apart into parts of one coordinate each, there is a constant for each of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import GeomtorsionError, MissingValueError
from geomtorsion.exact.engine_code import Products
from geomtorsion.motion.reduced.separated import separated, single_coordinates
from geomtorsion.motion.reduced.split import HALF, Split, Written
from geomtorsion.motion.reduced.system import Reduced, effort, gathered, names_in

if TYPE_CHECKING:
    from geomtorsion.exact import Element, Field
    from geomtorsion.motion.equations import Equations

# Names of constants that are multiplied, and a factor, for each term of a sum.
Mixture = tuple[tuple[tuple[str, ...], Fraction], ...]
# Rates that cost less than this, as those of polar planes, are not worth the way in and out.
SMALL = 50


def best(equations: Equations) -> Written | None:
    """The cheapest smaller system; None if there is none that is cheaper than the full one."""
    momenta = equations.momenta
    if momenta is None or equations.passengers:
        return None
    parts = Split.of(equations, momenta)
    if parts is None or not _is_straight(parts):
        return None
    try:
        most = effort(equations.system)
    except MissingValueError:
        # What has no value is told where it is needed.
        return None
    if most < SMALL:
        return None
    cheapest = _cheapest(parts)
    return cheapest if effort(cheapest.system) < most else None


def _is_straight(parts: Split) -> bool:
    """Whether each other leg is along one coordinate, and G diagonal there.

    Then its momentum is a multiple of its velocity: no digits are lost from one to the other.
    """
    lone = all(len(parts.leg(i)) == 1 for i in parts.others)
    return lone and all(i == j for i, j in parts.lower if i in parts.others)


def _cheapest(parts: Split) -> Written:
    """The common factor, and the legs to write as squares, by trial, one after the other."""
    one = parts.frame.field.one
    scales = [one]
    for i in parts.others:
        (value,) = parts.leg(i).values()
        scale = 1 / (value * value)
        if all(scale != other for other in scales):
            scales.append(scale)
    tried = [in_momenta(parts, scale, ()) for scale in scales]
    cheapest = min(tried, key=lambda written: effort(written.system))
    scale, squares = scales[tried.index(cheapest)], ()
    for i in parts.along:
        if len(parts.leg(i)) > 1 and sum(i in pair for pair in parts.lower) == 1:
            try:
                other = in_momenta(parts, scale, (*squares, i))
            except GeomtorsionError:
                continue
            if effort(other.system) < effort(cheapest.system):
                cheapest, squares = other, (*squares, i)
    apart = [in_parts(parts, other, squares) for other in scales]
    for other in apart:
        if other is not None and effort(other.system) < effort(cheapest.system):
            cheapest = other
    return cheapest


def in_parts(parts: Split, scale: Element, squares: Sequence[int]) -> Written | None:
    """The form with a constant for each coordinate; None where there is none for this sigma."""
    spread = _spread(parts, scale, range(parts.frame.dimension))
    singles = single_coordinates(parts, scale, spread)
    if singles is None:
        return None
    try:
        whole = in_momenta(parts, scale, squares)
    except GeomtorsionError:
        whole = in_momenta(parts, scale, ())
    return separated(parts, singles, whole)


def in_momenta(parts: Split, scale: Element, squares: Sequence[int]) -> Written:
    """Hamilton's equations; sigma, and legs of which K is to contain the square as it is."""
    equations, frame = parts.equations, parts.frame
    system, width = equations.system, equations.width
    along = {next(iter(parts.leg(i))): i for i in parts.others}
    names = parts.names
    pieces = [_square(parts, scale, i, names) for i in squares]
    spread = _spread(parts, scale, [i for i in range(frame.dimension) if i not in squares])
    mixing = _Mixing(parts.norm, frozenset((*parts.constants, parts.norm)))
    rates: list[Products] = []
    for mu in range(width):
        plain = [(value, (names[nu],)) for (row, nu), value in spread.items() if row == mu]
        own = [piece for piece in pieces if mu in piece.leg]
        squared = [(piece.leg[mu] * piece.weight, (piece.name,)) for piece in own]
        rates.append((*plain, *squared))
    for mu in along:
        symbol = frame.coordinates[mu]
        terms = [
            (value.diff(symbol) * -HALF, tuple(sorted((names[row], names[nu]))))
            for (row, nu), value in spread.items()
        ]
        terms.append((scale.diff(symbol) * HALF, (parts.norm,)))
        for piece in pieces:
            terms += piece.slope(symbol, names)
        rates.append(mixing.mixed(terms))
    given = {piece.name: piece.sums for piece in pieces}
    used = names_in([*rates, *given.values()])
    extra = [name for name in (*parts.constants, *mixing.table) if name in used]
    small = Reduced(
        (*system.states[:width], *(names[mu] for mu in along)),
        (*system.parameters, *extra),
        tuple(rates),
        (tuple(range(width)), tuple(range(width, width + len(along)))),
        system.edge,
        None,
        tuple(given.items()),
        None if scale == 1 else 1 / scale,
    )
    velocities = tuple(parts.velocity(i, names) for i in range(frame.dimension))
    constants = parts.constants | {parts.norm: parts.square}
    momenta = tuple(parts.momentum(mu) for mu in along)
    return Written(small, width, momenta, constants, mixing.table, velocities, parts.along)


def _spread(parts: Split, scale: Element, legs: Sequence[int]) -> dict[tuple[int, int], Element]:
    """sigma G^ij E_i^mu E_j^nu over some legs."""
    found: dict[tuple[int, int], list[Any]] = {}
    for (i, j), weight in parts.upper.items():
        if i in legs and j in legs:
            for mu, one in parts.leg(i).items():
                for nu, two in parts.leg(j).items():
                    found.setdefault((mu, nu), []).append((1, weight, one * scale, two))
    sums = {place: parts.frame.field.sum(terms) for place, terms in sorted(found.items())}
    return {place: value for place, value in sums.items() if not value.is_zero}


@dataclass(frozen=True, eq=False)
class _Piece:
    """A leg's part of K, weight (leg^mu p_mu)^2 / divisor, with w = leg^mu p_mu / divisor."""

    name: str
    leg: Mapping[int, Element]
    divisor: Element
    weight: Element
    sums: Products

    def slope(self, symbol: Any, names: Mapping[int, str]) -> Iterator[tuple[Element, Any]]:
        """-1/2 of its derivative, as sums of products with w."""
        for mu, value in self.leg.items():
            yield value.diff(symbol) * -self.weight, (names[mu], self.name)
        yield self.divisor.diff(symbol) * self.weight * HALF, (self.name, self.name)


def _square(parts: Split, scale: Element, i: int, names: Mapping[int, str]) -> _Piece:
    """The square of a leg over the denominator that its coefficients have in common."""
    exact = parts.frame.field
    leg = parts.leg(i)
    below: dict[int, int] = {}
    for one in leg.values():
        for two in leg.values():
            for index, exponent in (one * two * scale)._den:
                below[index] = max(below.get(index, 0), exponent)
    divisor = exact.one
    for index, exponent in below.items():
        divisor = divisor * exact.polynomial(exact.factors[index]) ** exponent
    try:
        root = (scale * divisor).sqrt()
    except GeomtorsionError:
        # Roots are of what is positive; which sign that is, factors do not tell.
        divisor = -divisor
        root = (scale * divisor).sqrt()
    cleared = {mu: value * root for mu, value in leg.items()}
    sums = tuple((value / divisor, (names[mu],)) for mu, value in cleared.items())
    return _Piece(f"{parts.norm}_w{i}", cleared, divisor, parts.upper[i, i], sums)


@dataclass(frozen=True, eq=False)
class _Mixing:
    """Products of constants in sums, each sum of like ones under one name.

    prefix: of new names; names: of the constants; table: name of a mixture -> what it is.
    known: the same as names of constants that are multiplied, each with a factor.
    """

    prefix: str
    names: frozenset[str]
    table: dict[str, Products] = field(default_factory=dict)
    known: dict[Mixture, str] = field(default_factory=dict)

    def mixed(self, terms: Sequence[tuple[Element, tuple[str, ...]]]) -> Products:
        """A sum of products in which constants have become one factor each."""
        collected: dict[tuple[str, ...], list[Any]] = {}
        for value, names in terms:
            collected.setdefault(names, []).append((1, value))
        plain, groups = [], []
        for value, names in gathered(collected):
            if not set(names) <= self.names:
                plain.append((value, names))
                continue
            for first, mixture in groups:
                ratio = value / first
                if ratio.is_rational:
                    mixture.append((names, ratio.as_fraction()))
                    break
            else:
                groups.append((value, [(names, Fraction(1))]))
        return (*((value, (self._name(tuple(m), value.field),)) for value, m in groups), *plain)

    def _name(self, mixture: Mixture, exact: Field) -> str:
        if mixture not in self.known:
            name = self.known[mixture] = f"{self.prefix}_mix{len(self.table)}"
            self.table[name] = tuple((exact.rational(x), names) for names, x in mixture)
        return self.known[mixture]
