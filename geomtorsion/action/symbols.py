"""Symbols of mechanics over a frame, in names that the frame has not taken."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.errors import LagrangianError

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame

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
    names = next((found for found in choices if not taken & set(found)), None)
    time = next((name for name in _TIMES if name not in taken), None)
    if names is None or time is None:
        raise LagrangianError(
            "the frame uses all names for velocities or time: "
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
        f"the frame uses names of all the forms {', '.join(forms)}, which are needed for changes "
        "and variations. Rename a coordinate."
    )


def _symbols(names: Iterable[str]) -> tuple[sp.Symbol, ...]:
    return tuple(sp.Symbol(name) for name in names)
