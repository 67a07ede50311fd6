"""Reduced confined: separated geodesics that stay away from every edge of their chart.

v_k^2 = Q_k (see `separated`): where Q_k < 0 on both sides of a start, the motion stays between.
If no edge is there, nothing has to be watched. And where the equations have an angle by its cosine
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
# Places at which Q is looked at, on both sides: of an angle; of others at distances that grow from
# the first part of their size, each so many times the one before.
ANGLES = 65
NEAREST, GROWTH, PLACES = 1e-3, 1.4, 32
# A wall is where Q is below zero by this part of its largest value on the way there.
SOLID = 1e-6
# Places of each coordinate at which edges are looked for.
LOOKS = 17


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

        singles, rows = self.written.singles, [*start]
        sure = np.full(len(rows[0]), self._can_tell)
        if not self._can_tell:
            return sure
        with np.errstate(all="ignore"):
            for axis, (one, square) in enumerate(zip(singles, self._squares, strict=True)):
                here = rows[one.place]
                places = _angles() if one.place in self.cosines else _around(here)
                (values,) = square.array_rates(places, *numbers)
                low, high, walled = _room(here, *np.broadcast_arrays(places, values))
                sure &= walled
                looks = np.linspace(low, high, LOOKS)
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

    def turned(products: Products) -> Products:
        found = [(by_cosine(value, one.symbol, field, cosine), names) for value, names in products]
        if any(value is None for value, _ in found):
            raise _Unturned
        return tuple((value, names) for value, names in found if value is not None)

    rates = list(system.rates)
    rates[one.place] = ()
    slope: Products = ((source.read(-sine) / one.root, (one.state,)),)
    try:
        rows = [turned(row) for row in rates]
        rows[one.place] = turned(slope)
        given = tuple((name, turned(sums)) for name, sums in system.given)
        scale = system.scale
        factor = None if scale is None else turned(((scale, ()),))[0][0]
    except _Unturned:
        return None
    states = list(system.states)
    states[one.place] = cosine.name
    return replace(system, states=tuple(states), rates=tuple(rows), given=given, scale=factor)


class _Unturned(Exception):
    """An element depends on an angle by more than its cosine."""


def _angles() -> Any:
    """Places of an angle, from near one end of the axis to near the other, shape (places, 1)."""
    import numpy as np

    nearest = math.asin(AXIS)
    return np.linspace(nearest, math.pi - nearest, ANGLES)[:, None]


def _around(start: Any) -> Any:
    """Places on both sides of starts, the more apart the further away, shape (places, n)."""
    import numpy as np

    away = NEAREST * GROWTH ** np.arange(PLACES)
    steps = np.concatenate((-away[::-1], away))
    return start + np.multiply.outer(steps, np.maximum(np.abs(start), NEAREST))


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
