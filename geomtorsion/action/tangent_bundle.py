"""TangentBundle: a frame over a field that also holds velocities, time and parameters."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import sympy as sp

from geomtorsion.errors import LagrangianError
from geomtorsion.exact import Element
from geomtorsion.geometry import Frame
from geomtorsion.support.caching import cached_property

if TYPE_CHECKING:
    from geomtorsion.exact import Field

_STEMS = ("u", "w", "Omega", "velocity")
_TIMES = ("t", "time", "tau", "clock")
_DOTS = ("dot", "_dot", "_prime")


@dataclass(frozen=True)
class MotionSymbols:
    """Symbols besides the coordinates q^mu and the parameters.

    velocities: u^i, quasi-velocities: u1 ... un, or w1 ... where the frame uses u1 itself.
    accelerations: u'^i.
    rates, second_rates: q'^mu and q''^mu.
    time: t, or another letter where the frame uses t itself.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> symbols = symbols_of(load("flat_polar").frame)
    >>> symbols.velocities, symbols.accelerations, symbols.rates, symbols.time
    ((u1, u2), (u1dot, u2dot), (rdot, phidot), t)
    """

    coordinates: tuple[sp.Symbol, ...]
    velocities: tuple[sp.Symbol, ...]
    accelerations: tuple[sp.Symbol, ...]
    rates: tuple[sp.Symbol, ...]
    second_rates: tuple[sp.Symbol, ...]
    time: sp.Symbol


def symbols_of(frame: Frame) -> MotionSymbols:
    """The symbols for a frame: u1 ... un and t where these names are free.

    Raises
    ------
    LagrangianError
        The frame uses every name that could be given.
    """
    taken = {symbol.name for symbol in (*frame.coordinates, *frame.parameters)}
    numbers = range(1, frame.dimension + 1)
    choices = ([f"{stem}{k}" for k in numbers] for stem in _STEMS)
    names = next((choice for choice in choices if not taken & set(choice)), None)
    time = next((name for name in _TIMES if name not in taken), None)
    if names is None or time is None:
        raise LagrangianError(
            "expected a free name for the velocities and the time, got a frame that uses all of "
            f"{', '.join([stem + '1' for stem in _STEMS] + list(_TIMES))}. Rename a coordinate."
        )
    coordinates = [symbol.name for symbol in frame.coordinates]
    dot = free_pattern(frame, [*names, *coordinates], [f"{{}}{dot}" for dot in _DOTS])
    twice = free_pattern(frame, coordinates, [f"{{}}d{dot}" for dot in _DOTS])
    return MotionSymbols(
        frame.coordinates,
        _symbols(names),
        _symbols(dot.format(name) for name in names),
        _symbols(dot.format(name) for name in coordinates),
        _symbols(twice.format(name) for name in coordinates),
        sp.Symbol(time),
    )


def free_pattern(frame: Frame, names: Sequence[str | int], forms: Sequence[str]) -> str:
    """The first form, as in "{}dot", that makes no name which the frame uses.

    Raises
    ------
    LagrangianError
        Each makes one.
    """
    taken = {symbol.name for symbol in (*frame.coordinates, *frame.parameters)}
    for form in forms:
        if not taken & {form.format(name) for name in names}:
            return form
    raise LagrangianError(
        "expected free names for changes and variations, got a frame that uses names of all the "
        f"forms {', '.join(forms)}. Rename a coordinate."
    )


def _symbols(names: Iterable[str]) -> tuple[sp.Symbol, ...]:
    return tuple(sp.Symbol(name) for name in names)


@dataclass(frozen=True, eq=False)
class TangentBundle:
    """The frame once more, over a field that also holds u^i, t and the parameters.

    The frame that a user gave keeps its own field: mechanics adds nothing to it.

    frame: coordinates q^mu and coframe e^i_mu of the given frame; all other symbols are parameters
    of it.
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
        """d_t f + q'^mu d_mu f: rate of f(q, u, t) at constant velocities."""
        pairs = zip(self.frame.coordinates, rates, strict=True)
        terms = [(1, rate, element.diff(symbol)) for symbol, rate in pairs]
        return self.field.sum([(1, element.diff(self.symbols.time)), *terms])


def bundle_over(frame: Frame, expressions: Sequence[sp.Expr]) -> TangentBundle:
    """A bundle over a frame whose field has a symbol for everything in the expressions."""
    symbols = symbols_of(frame)
    declared = {*frame.coordinates, *symbols.velocities, symbols.time}
    free: set[Any] = set().union(*(value.free_symbols for value in expressions))
    extra = sorted(free - declared - set(frame.parameters), key=str)
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
