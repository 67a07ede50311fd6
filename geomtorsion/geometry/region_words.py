"""Region words: walls as the fewest inequalities that a reader expects."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from geomtorsion.geometry.real_points import numbers_of, side
from geomtorsion.support.caching import cached_property

if TYPE_CHECKING:
    from geomtorsion.geometry.real_points import RealPoints


class Condition:
    """Relations that hold on one side of a wall.

    relations: one inequality, or two that bound an angle.
    arguments: the symbols of the columns at which it is checked.
    """

    def __init__(self, relations: tuple[Any, ...], arguments: Sequence[sp.Expr]) -> None:
        self.relations = relations
        self._arguments = arguments

    @cached_property
    def _numbers(self) -> Any:
        return numbers_of([side(relation) for relation in self.relations], self._arguments)

    def holds(self, columns: np.ndarray) -> np.ndarray:
        """Where all relations hold."""
        return np.all(self._numbers(columns).real > 0, axis=0)

    @property
    def length(self) -> int:
        """How long it is to read: a bound of a symbol is short."""
        parts = sum(int(sp.count_ops(relation)) for relation in self.relations)
        solved = all(r.gts.is_Symbol or r.lts.is_Symbol for r in self.relations)
        return parts + (0 if solved else 10)


def conditions_of(
    walls: Iterable[tuple[sp.Expr, int]],
    point: Mapping[sp.Expr, Any],
    symbols: Sequence[sp.Symbol],
    source: RealPoints,
    arguments: Sequence[sp.Expr],
) -> list[Condition]:
    """Conditions for walls with signs, in the order of their symbols, parameters first."""
    relations: list[tuple[Any, ...]] = []
    for wall, sign in walls:
        beside = _beside_vertex(wall, sign, symbols, point, source.coordinates)
        solved = _solved(wall, sign, symbols)
        # Another wall may make one of two bounds needless.
        relations += [(one,) for one in (*solved, *beside)]
    used = {s for some in relations for r in some for s in r.free_symbols}
    # Sizes and masses: a region is described for the signs that parameters have at its point.
    positive = [
        (s > 0,) if point[s] > 0 else (s < 0,)
        for s in source.parameters
        if s in used and s.is_positive is None and s.is_negative is None
    ]
    relations.sort(key=lambda some: _first(some, symbols))
    unique = dict.fromkeys((*positive, *relations))
    return [
        Condition(some, arguments) for some in unique if all(r not in (True, sp.true) for r in some)
    ]


def fewest(conditions: list[Condition], columns: np.ndarray) -> list[Condition]:
    """The fewest conditions that select the same columns; long ones are dropped first."""
    holds = {id(one): one.holds(columns) for one in conditions}

    def size(some: list[Condition]) -> int:
        return int(np.logical_and.reduce([holds[id(one)] for one in some]).sum())

    kept = sorted(conditions, key=lambda one: -one.length)
    for one in list(kept):
        rest = [other for other in kept if other is not one]
        if (rest and size(rest) == size(kept)) or (not rest and holds[id(one)].all()):
            kept = rest
    return [one for one in conditions if one in kept]


def in_words(relations: Iterable[Any]) -> str:
    """Relations as text, two bounds of one symbol as one: "M > 0, r > 2*M, 0 < theta < pi"."""
    relations = list(relations)
    texts: dict[object, str] = {}
    for relation in relations:
        symbol, _ = _bounded(relation)
        if symbol is None:
            texts[relation] = str(relation)
            continue
        if symbol in texts:
            continue
        same = [r for r in relations if _bounded(r)[0] == symbol]
        lower = [r.lts for r in same if _bounded(r)[1]]
        upper = [r.gts for r in same if not _bounded(r)[1]]
        if len(lower) == 1 and len(upper) == 1:
            strict = [
                " < " if isinstance(r, sp.StrictGreaterThan | sp.StrictLessThan) else " <= "
                for above_first in (True, False)
                for r in same
                if _bounded(r)[1] is above_first
            ]
            texts[symbol] = f"{lower[0]}{strict[0]}{symbol}{strict[1]}{upper[0]}"
        else:
            texts[symbol] = ", ".join(map(_bound_text, same))
    return ", ".join(texts.values())


def _bound_text(relation: Any) -> str:
    """A bound with its symbol first."""
    symbol, above = _bounded(relation)
    sign = "" if isinstance(relation, sp.StrictGreaterThan | sp.StrictLessThan) else "="
    return f"{symbol} >{sign} {relation.lts}" if above else f"{symbol} <{sign} {relation.gts}"


def _bounded(relation: Any) -> tuple[sp.Symbol | None, bool]:
    """The symbol that a relation bounds, and whether from below."""
    greater: Any = getattr(relation, "gts", None)
    less: Any = getattr(relation, "lts", None)
    # r > 2*M bounds r, and so does 2*M < r.
    written_first = relation.args[0] if relation.args else None
    for symbol, other, above in ((greater, less, True), (less, greater, False)):
        if (
            symbol is not None
            and symbol.is_Symbol
            and not (other.is_Symbol and other == written_first)
        ):
            return symbol, above
    return None, True


def _first(relations: tuple[Any, ...], symbols: Sequence[sp.Symbol]) -> int:
    """Position of the first symbol of relations."""
    free = set().union(*(r.free_symbols for r in relations if hasattr(r, "free_symbols")))
    return min((k for k, s in enumerate(symbols) if s in free), default=len(symbols))


def _solved(wall: sp.Expr, sign: int, symbols: Sequence[sp.Symbol]) -> tuple[Any, ...]:
    """wall * sign > 0, as bounds of a symbol where it is linear in one, or of an angle."""
    if isinstance(wall, sp.sin | sp.cos | sp.sinh):
        bounds = _of_angle(wall, sign)
        if bounds is not None:
            return bounds
    if isinstance(wall, sp.log):
        return _solved(wall.args[0] - 1, sign, symbols)
    if isinstance(wall, sp.asin | sp.atan | sp.asinh | sp.atanh):
        return _solved(wall.args[0], sign, symbols)
    for symbol in symbols:
        if symbol in wall.free_symbols and wall.is_polynomial(symbol):
            poly = sp.Poly(wall, symbol)
            if poly.degree() == 1 and poly.LC().is_number:
                bound = sp.expand(-poly.nth(0) / poly.LC())
                return (symbol > bound,) if (poly.LC() > 0) == (sign > 0) else (symbol < bound,)
    return (wall > 0,) if sign > 0 else (wall < 0,)


def _of_angle(wall: sp.Expr, sign: int) -> tuple[Any, ...] | None:
    """Bounds of an angle between zeros of sin or cos of its multiple."""
    (inside,) = wall.args
    if len(inside.free_symbols) != 1:
        return None
    (symbol,) = inside.free_symbols
    poly = sp.Poly(inside, symbol) if inside.is_polynomial(symbol) else None
    if poly is None or poly.degree() != 1 or not poly.LC().is_positive:
        return None
    if isinstance(wall, sp.sinh):
        zero = -poly.nth(0) / poly.LC()
        return (symbol > zero,) if sign > 0 else (symbol < zero,)
    start = 0 if isinstance(wall, sp.sin) else -sp.pi / 2
    if sign < 0:
        start = start + sp.pi if isinstance(wall, sp.cos) else -sp.pi
    low, high = ((end - poly.nth(0)) / poly.LC() for end in (start, start + sp.pi))
    return symbol > low, symbol < high


def _beside_vertex(
    wall: sp.Expr,
    sign: int,
    symbols: Sequence[sp.Symbol],
    point: Mapping[sp.Expr, Any],
    coordinates: Sequence[sp.Symbol],
) -> tuple[Any, ...]:
    """The side of the vertex of a parabola: its outside has two parts, as beyond two horizons.

    Whether there are horizons may depend on parameters: a region holds for all their values.
    """
    for symbol in symbols:
        if symbol not in wall.free_symbols or not wall.is_polynomial(symbol):
            continue
        poly = sp.Poly(wall, symbol)
        if poly.degree() != 2 or not poly.LC().is_number:
            continue
        a, b, c = (poly.nth(k) for k in (2, 1, 0))
        gap = b**2 - 4 * a * c
        vertex = sp.expand(-b / (2 * a))
        has_parts = not gap.free_symbols & set(coordinates) or gap.subs(point).is_positive is True
        if (a > 0) != (sign > 0) or not has_parts:
            return ()
        above = (symbol - vertex).subs(point) > 0
        return (symbol > vertex,) if above == sp.true else (symbol < vertex,)
    return ()
