"""first motion: a start, a velocity and a time for a first look at a space."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import sympy as sp

from geomtorsion.errors import GeomtorsionError
from geomtorsion.geometry import Frame
from geomtorsion.geometry.relations import broken_relations
from geomtorsion.spaces.registry import shipped
from geomtorsion.spaces.space import FirstMotion
from geomtorsion.support import checks

# Directions of the legs, where nothing better is known.
DIRECTION = (3, 2, 1, 2, 1, 2, 1)


def first_motion(
    frame: Frame, parameters: Mapping[str, float] = MappingProxyType({})
) -> FirstMotion:
    """The motion chosen for a space of this name, or one from the point of the frame's region.

    The point is rounded to hundredths where that stays between the same walls. The direction is
    fixed, of length one, and in a Lorentzian frame timelike. Parameters that are given have these
    values, and the start is inside the resulting domain.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> first_motion(load("ax_plus_b").frame)
    FirstMotion(start=(0.77, 1.17), frame_velocity=(0.832, 0.555), t=2.0, parameters={})
    >>> [first_motion(load("schwarzschild").frame, {"M": m}).start[1] for m in (1, 6)]
    [10.0, 12.56]
    """
    motion = _first_motion(frame)
    if not parameters:
        return motion
    numbers = dict(motion.parameters) | dict(parameters)
    symbols = {symbol.name: symbol for symbol in (*frame.coordinates, *frame.parameters)}
    begin = zip([symbol.name for symbol in frame.coordinates], motion.start, strict=True)
    values = {symbols[name]: x for name, x in (*begin, *numbers.items()) if name in symbols}
    if not broken_relations(frame.domain, values):
        return replace(motion, parameters=numbers)
    exact = {symbol: checks.fraction(numbers[symbol.name]) for symbol in frame.parameters}
    try:
        inside = _first_motion(frame.subs(exact))
    except GeomtorsionError:
        # An impossible value: the caller gets the error.
        return replace(motion, parameters=numbers)
    return replace(motion, start=inside.start, parameters=numbers)


def _first_motion(frame: Frame) -> FirstMotion:
    """The same for parameters of its own."""
    space = shipped(frame)
    if space is not None and space.motion is not None and _fits(space.motion, frame):
        return space.motion
    region = frame.region
    point = {symbol: float(value) for symbol, value in region.point.items()}
    rounded = {symbol: round(value, 2) for symbol, value in point.items()}
    # Within the box there is no wall.
    if all(relation.subs(rounded) == sp.true for relation in region.box):
        point = rounded
    return FirstMotion(
        tuple(point[symbol] for symbol in frame.coordinates),
        _direction(frame),
        parameters={symbol.name: point[symbol] for symbol in frame.parameters},
    )


def _fits(motion: FirstMotion, frame: Frame) -> bool:
    """Whether the numbers are as many as this frame, which may only share the name, needs."""
    names = {symbol.name for symbol in frame.parameters}
    return len(motion.start) == frame.dimension and set(motion.parameters) == names


def _direction(frame: Frame) -> tuple[float, ...]:
    """A direction of length one, or timelike of length minus one."""
    n = frame.dimension
    signs = [float(frame.eta[i, i]) for i in range(n)]
    weights = [float(DIRECTION[i % len(DIRECTION)]) for i in range(n)]
    times = [i for i in range(n) if signs[i] < 0]
    spatial = [0.0 if i in times else weight for i, weight in enumerate(weights)]
    length = math.sqrt(sum(x * x for x in spatial)) or 1.0
    if len(times) != 1:
        return tuple(round(x / math.hypot(*weights), 3) for x in weights)
    speed = 0.75
    values = [speed * x / length for x in spatial]
    values[times[0]] = 1.25
    return tuple(round(x, 3) for x in values)
