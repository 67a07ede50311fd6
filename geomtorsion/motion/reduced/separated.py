"""Reduced separated: geodesics that fall apart into motions in one coordinate each.

Where 2 K - sigma N = sum A_k p_k^2 + W_k with A_k and W_k of one coordinate each (Hamilton, Jacobi,
Staeckel; Carter's constant of Kerr's space is one of these), c_k = A_k p_k^2 + W_k are constants
that add up to zero. With v_k = h_k A_k p_k, h_k of that coordinate, too:

v_k^2 = Q_k = h_k^2 A_k (c_k - W_k),  sigma q'_k = v_k / h_k,  sigma v'_k = Q'_k / (2 h_k),

in which no momentum is squared; v_k has no pole where h_k vanishes, nor where A_k does.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from geomtorsion.exact.engine_code import Products
from geomtorsion.exact.separate import additive_parts, by_powers, clearing
from geomtorsion.motion.reduced.split import HALF, Pairs, Single, Split, Written, free_name
from geomtorsion.motion.reduced.system import gathered, names_in

if TYPE_CHECKING:
    from geomtorsion.exact import Element


def separated(parts: Split, singles: Sequence[Single], whole: Written) -> Written:
    """The smaller system with a constant for each coordinate.

    singles: see `single_coordinates`; whole: Hamilton's equations with the same sigma.
    """
    system, width = whole.system, whole.width
    mixing = _Collecting(parts.norm)
    rates = list(system.rates[:width])
    for one in singles:
        rates[one.place] = ((1 / one.root, (one.state,)),)
        slopes = [(x.diff(one.symbol) / one.root * HALF, names) for x, names in one.square]
        rates.append(mixing.collected(slopes, one.symbol))
    given = system.given
    used = names_in([*rates, *(sums for _, sums in given)])
    known = (*whole.constants, *mixing.table)
    small = replace(
        system,
        states=(*system.states[:width], *(one.state for one in singles)),
        parameters=(*parts.equations.system.parameters, *(x for x in known if x in used)),
        rates=tuple(rates),
    )
    back = {parts.names[one.place]: one for one in singles}
    return Written(
        small,
        width,
        tuple(_times(parts.momentum(one.place), one.factor) for one in singles),
        whole.constants,
        mixing.table,
        tuple(_renamed(row, back) for row in whole.velocities),
        whole.along,
        tuple(singles),
    )


def single_coordinates(parts: Split, scale: Element, spread: Pairs) -> list[Single] | None:
    """A, W and h of each coordinate that occurs; None where K does not fall apart.

    spread: sigma G^ij E_i^mu E_j^nu of all legs.
    """
    frame = parts.frame
    places = [next(iter(parts.leg(i))) for i in parts.others]
    symbols = [frame.coordinates[mu] for mu in places]
    rest: dict[tuple[str, ...], list[Any]] = {(parts.norm,): [(-1, scale)]}
    for (mu, nu), value in spread.items():
        if mu not in places and nu not in places:
            names = tuple(sorted((parts.names[mu], parts.names[nu])))
            rest.setdefault(names, []).append((1, value))
    shares: dict[int, list[tuple[Element, tuple[str, ...]]]] = {mu: [] for mu in places}
    for value, names in gathered(rest):
        split = additive_parts(value, symbols)
        if split is None:
            return None
        for mu, part in zip(places, split, strict=True):
            if not part.is_zero:
                shares[mu].append((part, names))
    found = []
    system = parts.equations.system
    used = {*system.states, *system.parameters, *parts.names.values(), parts.norm}
    for mu, symbol in zip(places, symbols, strict=True):
        weight, others = spread[mu, mu], set(symbols) - {symbol}
        if weight.symbols & others:
            return None
        root = clearing([weight, *(weight * part for part, _ in shares[mu])], [symbol])
        if root is None:
            return None
        names = [free_name(f"{letter}_{symbol.name}", used) for letter in ("v", "c")]
        found.append(Single(mu, symbol, weight, tuple(shares[mu]), root, *names))
    return found


def _times(products: Products, factor: Element) -> Products:
    return tuple((value * factor, names) for value, names in products)


def _renamed(products: Products, back: Mapping[str, Single]) -> Products:
    """v / (h A) in the place of p."""
    found = []
    for value, names in products:
        for name in names:
            if name in back:
                value = value / back[name].factor
        found.append((value, tuple(back[n].state if n in back else n for n in names)))
    return tuple(found)


@dataclass(frozen=True, eq=False)
class _Collecting:
    """Coefficients of powers of a coordinate, all that is constant in them under one name.

    prefix: of new names; table: name -> sum of products of constants.
    """

    prefix: str
    table: dict[str, Products] = field(default_factory=dict)

    def collected(self, terms: list[tuple[Element, tuple[str, ...]]], symbol: Any) -> Products:
        """A sum of products with constants, as a sum over powers of a coordinate."""
        powers: list[Element] = []
        collected: list[dict[tuple[str, ...], list[Any]]] = []
        for value, names in terms:
            for coefficient, power in by_powers(value, [symbol]):
                if power not in powers:
                    powers.append(power)
                    collected.append({})
                place = collected[powers.index(power)]
                place.setdefault(names, []).append((1, coefficient))
        sums = zip(powers, collected, strict=True)
        return tuple((power, (self._name(gathered(terms)),)) for power, terms in sums)

    def _name(self, mixture: Products) -> str:
        name = f"{self.prefix}_mix{len(self.table)}"
        self.table[name] = mixture
        return name
