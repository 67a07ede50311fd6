"""Adjust: states brought to length one, numbers moved by a hair."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import mpmath

from geomtorsion.motion.engines.protocol import Engine
from geomtorsion.motion.system import exact, mpf

if TYPE_CHECKING:
    from geomtorsion.motion.flows.flow import Flow


def moved_by(values: Sequence[Any], engine: Engine, part: float, *, exact_too: bool) -> list[Any]:
    """Numbers moved by a part, up and down in turn; zeros stay.

    exact_too: whether numbers that the engine holds exactly are moved.
    """
    found = []
    for k, value in enumerate(values):
        known, change = exact(value), Fraction((-1) ** k * part)
        if known is None:
            bits = 2 * engine.precision
            with mpmath.workprec(bits):
                found.append(mpf(value, bits) * (1 + mpf(change, bits)))
        elif exact_too or not _fits(known, engine.precision):
            found.append(known * (1 + change))
        else:
            found.append(value)
    return found


def _fits(value: Fraction, precision: int) -> bool:
    """Whether a number is held without rounding."""
    p, q = abs(value.numerator), value.denominator
    return q & (q - 1) == 0 and (p // (p & -p) if p else 0).bit_length() <= precision


def make_unit(state: list[Any], places: Sequence[int], engine: Engine) -> None:
    """Bring some of the states to length one, to rounding at any precision."""
    values = [state[k] for k in places]
    if engine.precision == 53:
        numbers = [float(value) for value in values]
        length = math.hypot(*numbers)
        scaled = [value / length for value in numbers]
    else:
        bits = engine.precision + 20
        with mpmath.workprec(bits):
            exact_values = [mpf(value, bits) for value in values]
            length = mpmath.sqrt(sum(value * value for value in exact_values))
            scaled = [value / length for value in exact_values]
    for place, value in zip(places, scaled, strict=True):
        state[place] = value


def unit_rows(flow: Flow, states: Any) -> Any:
    """The states with those of length one made so, on arrays of doubles."""
    import numpy as np

    if not flow.unit_places or not len(states):
        return states
    states = states.copy()
    for places in flow.unit_places:
        part = states[:, places]
        with np.errstate(all="ignore"):
            states[:, places] = part / np.sqrt((part * part).sum(axis=1))[:, None]
    return states
