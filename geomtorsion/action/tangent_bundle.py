"""TangentBundle: a frame over a field that also holds velocities, time and parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import sympy as sp

from geomtorsion.action.symbols import MotionSymbols, symbols_of
from geomtorsion.exact import Element
from geomtorsion.geometry import Frame

if TYPE_CHECKING:
    from geomtorsion.exact import Field


@dataclass(frozen=True, eq=False)
class TangentBundle:
    """The frame once more, over a field that also holds u^i, t and the parameters.

    The frame that a user gave keeps its own field: mechanics adds nothing to it.

    frame: coordinates q^mu and coframe e^i_mu of the given frame; all else is a parameter of it.
    symbols: the symbols of velocities and time.
    """

    frame: Frame
    symbols: MotionSymbols

    @property
    def field(self) -> Field:
        """The exact field of everything below."""
        return self.frame.field

    @property
    def dimension(self) -> int:
        """Number of coordinates, and of quasi-velocities."""
        return self.frame.dimension

    @cached_property
    def velocities(self) -> tuple[Element, ...]:
        """u^i as elements."""
        return tuple(self.field.symbol(symbol) for symbol in self.symbols.velocities)

    def over(self, frame: Frame) -> TangentBundle:
        """The same symbols and field, over another frame in that field."""
        return TangentBundle(frame, self.symbols)

    def rates(self, velocities: Sequence[Element]) -> list[Element]:
        """q'^mu = E_i^mu u^i."""
        rows = self.frame.legs.components.rows
        return [self.field.sum([(1, value, velocities[i]) for i, value in row]) for row in rows]

    def along(self, leg: int, element: Element) -> Element:
        """E_i(f) = E_i^mu d_mu f: the derivative along one leg."""
        columns = self.frame.legs.components.columns[leg]
        pairs = [(value, element.diff(self.frame.coordinates[mu])) for mu, value in columns]
        return self.field.sum([(1, value, slope) for value, slope in pairs])

    def change(self, element: Element, rates: Sequence[Element]) -> Element:
        """d_t f + q'^mu d_mu f: what f(q, u, t) changes by while the velocities stay."""
        pairs = zip(self.frame.coordinates, rates, strict=True)
        terms = [(1, rate, element.diff(symbol)) for symbol, rate in pairs]
        return self.field.sum([(1, element.diff(self.symbols.time)), *terms])


def bundle_over(frame: Frame, expressions: Sequence[sp.Expr]) -> TangentBundle:
    """A bundle over a frame whose field has a symbol for everything in the expressions."""
    symbols = symbols_of(frame)
    known = {*frame.coordinates, *symbols.velocities, symbols.time}
    free: set[Any] = set().union(*(value.free_symbols for value in expressions))
    extra = sorted(free - known - set(frame.parameters), key=str)
    own = Frame(
        frame.coordinates,
        frame.coframe.to_sympy(),
        parameters=frame.parameters,
        domain=frame.domain,
        complex=frame.complex,
        name=frame.name,
        branches=frame.field.chosen,
    )
    # Later than the frame: the domain then fixes no velocity at which roots are looked at.
    own.field.declare((*extra, symbols.time, *symbols.velocities))
    return TangentBundle(own, symbols)
