"""Reduced confined: separated geodesics that stay away from every edge of their chart.

v_k^2 = Q_k (see `separated`): where Q_k < 0 on both sides of a start, the motion stays between.
If no edge is seen there, none is watched. And where the equations have an angle by its cosine
alone, z = cos q may be the state, z' = -sin(q) v / (h sigma): no sine is left. Near an axis q would
lose digits, but a motion that is confined does not get there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from geomtorsion.exact import Field
from geomtorsion.exact.cosine import by_cosine
from geomtorsion.exact.engine_code import Products
from geomtorsion.motion.reduced.split import Single, Written, free_name
from geomtorsion.motion.reduced.system import Reduced
from geomtorsion.motion.system import System

# Angles this near an axis lose three bits to their cosine.
AXIS = 1 / 8
# Places at which Q is looked at: of an angle; of others on both sides, in logarithms, of which the
# first is so far and each so many times as far as the one before. (None changes its sign.)
ANGLES = 65
NEAREST, GROWTH, PLACES = 1e-3, 1.4, 32
# A wall is where Q is below zero by this part of its largest value on the way there.
SOLID = 1e-6
# Places of each coordinate at which edges are looked for, and how many numbers at once.
LOOKS, MEMORY = 17, 2**18


@dataclass(frozen=True, eq=False)
class Confined:
    """The system for confined motions, and how to tell them.

    full_system: what it stands for; written: the smaller system.
    """

    full_system: System
    written: Written

    @cached_property
    def _turned(self) -> tuple[Reduced, tuple[int, ...]]:
        """The system without an edge, and the places of angles whose cosines are its states."""
        system, places = replace(self.written.system, edge=None), []
        for one in self.written.singles:
            turned = _with_cosine(system, one)
            if turned is not None:
                system = turned
                places.append(one.place)
        return system, tuple(places)

    @property
    def system(self) -> Reduced:
        """The equations, with nothing to watch."""
        return self._turned[0]

    @property
    def cosines(self) -> tuple[int, ...]:
        """Places of coordinates whose cosine is the state."""
        return self._turned[1]

    @cached_property
    def _squares(self) -> list[System]:
        """Q of each coordinate."""
        written = self.written
        names = (*self.full_system.parameters, *written.constants, *written.separators)
        return [System((x.symbol.name,), names, (x.square,), ()) for x in written.singles]

    @cached_property
    def _can_tell(self) -> bool:
        """Whether edges are of single coordinates only."""
        singles = {one.symbol.name for one in self.written.singles}
        states = {*self.full_system.states} - singles
        edge = self.full_system.edge or ()
        moving = {symbol.name for value, _ in edge for symbol in value.symbols} & states
        return bool(singles) and not moving

    def holds(self, start: Sequence[Any], numbers: Sequence[Any]) -> Any:
        """Whether motions stay away from all edges, as far as some looks around them can tell.

        start: of the full system, arrays of shape (n,); numbers: those of openings, the same.
        """
        import numpy as np

        count = len(start[0])
        if not self._can_tell:
            return np.full(count, False)
        share = max(1, MEMORY // LOOKS ** len(self.written.singles))
        parts = [slice(k, k + share) for k in range(0, count, share)]
        with np.errstate(all="ignore"):
            return np.concatenate(
                [self._hold([x[k] for x in start], [x[k] for x in numbers]) for k in parts]
            )

    def _hold(self, start: list[Any], numbers: list[Any]) -> Any:
        """The same of as many as memory has room for."""
        import numpy as np

        singles, rows = self.written.singles, list(start)
        sure = np.full(len(rows[0]), True)
        for axis, (one, square) in enumerate(zip(singles, self._squares, strict=True)):
            here, angle = rows[one.place], one.place in self.cosines
            places = _angles() if angle else _around(here)
            (values,) = square.array_rates(places, *numbers)
            low, high, walled = _room(here, *np.broadcast_arrays(places, values))
            sure &= walled
            # Between looks in proportion edges change evenly: they are near zero if anywhere.
            looks = np.linspace(low, high, LOOKS) if angle else _in_proportion(low, high)
            shape = [LOOKS if k == axis else 1 for k in range(len(singles))]
            rows[one.place] = looks.reshape(*shape, len(here))
        if self.full_system.edge is None:
            return sure
        count = len(self.full_system.parameters)
        return sure & _is_clear(self.full_system.edge_values(rows, numbers[:count]))


def _with_cosine(system: Reduced, one: Single) -> Reduced | None:
    """A system with the cosine of a coordinate as a state; None where that is not possible."""
    import sympy

    source = one.root.field
    sine = sympy.sin(one.symbol)
    if all(generator.shown != sine for generator in source.generators):
        return None
    names = {*system.states, *system.parameters, *(name for name, _ in system.given)}
    cosine = sympy.Symbol(free_name(f"cos_{one.symbol.name}", names), real=True)
    inside = next(value for row in system.rates for value, _ in row).field
    others = [symbol for symbol in inside.symbols if symbol != one.symbol]
    field = Field((*others, cosine))

    def turned(products: Products) -> Products | None:
        found = []
        for value, names in products:
            element = by_cosine(value, one.symbol, field, cosine)
            if element is None:
                return None
            found.append((element, names))
        return tuple(found)

    states, rates = list(system.states), list(system.rates)
    states[one.place] = cosine.name
    rates[one.place] = ()
    rows = [turned(row) for row in rates]
    rows[one.place] = turned(((source.read(-sine) / one.root, (one.state,)),))
    given = [turned(sums) for _, sums in system.given]
    scale = () if system.scale is None else turned(((system.scale, ()),))
    if scale is None or None in (*rows, *given):
        return None
    return replace(
        system,
        states=tuple(states),
        rates=tuple(row for row in rows if row is not None),
        given=tuple(
            (name, sums)
            for (name, _), sums in zip(system.given, given, strict=True)
            if sums is not None
        ),
        scale=scale[0][0] if scale else None,
    )


def _angles() -> Any:
    """Places of an angle, from near one end of the axis to near the other, shape (places, 1)."""
    import numpy as np

    nearest = math.asin(AXIS)
    return np.linspace(nearest, math.pi - nearest, ANGLES)[:, None]


def _around(start: Any) -> Any:
    """Places on both sides of starts, in proportion to them, of the same sign; (places, n)."""
    import numpy as np

    away = NEAREST * GROWTH ** np.arange(PLACES)
    steps = np.exp(np.concatenate((-away[::-1], away)))
    return np.where(start > 0, np.multiply.outer(steps, start), np.multiply.outer(1 / steps, start))


def _in_proportion(low: Any, high: Any) -> Any:
    """Looks between two places of the same sign, shape (looks, n)."""
    import numpy as np

    return low * (high / low) ** np.linspace(0.0, 1.0, LOOKS)[:, None]


def _room(start: Any, places: Any, squares: Any) -> tuple[Any, Any, Any]:
    """Between which walls coordinates stay, and whether there are any on both sides.

    start: shape (n,); places, squares: shape (places, n), places in rising order.
    """
    import numpy as np

    lanes, found, walled = np.arange(len(start)), [], np.full(len(start), True)
    for side, order in ((places < start, -1), (places > start, 1)):
        values = np.where(side, squares, 0.0)[::order]
        walls = values < -SOLID * np.maximum.accumulate(np.abs(values))
        nearest = walls.argmax(axis=0)
        walled &= walls[nearest, lanes]
        found.append(places[::order][nearest, lanes])
    return found[0], found[1], walled


def _is_clear(edge: Any) -> Any:
    """Whether edge functions are above zero at some looks, and so between: they change slowly.

    edge: shape (looks, ..., n).
    """
    import numpy as np

    edge = np.atleast_1d(edge)
    looked = tuple(range(edge.ndim - 1))
    lowest = edge.min(axis=looked)
    clear = lowest > 0
    for axis in looked:
        clear &= lowest > np.abs(np.diff(edge, axis=axis)).max(axis=looked, initial=0.0)
    return clear
