"""first motions: a start, a velocity and a time with which to have a first look at a space."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import sympy as sp

from geomtorsion import checks
from geomtorsion.errors import GeomtorsionError
from geomtorsion.geometry import Frame
from geomtorsion.geometry.validation import broken_relations

# Directions of the legs, where nothing better is known.
DIRECTION = (3, 2, 1, 2, 1, 2, 1)


@dataclass(frozen=True)
class FirstMotion:
    """Where a motion begins, how, and for how long.

    start: coordinates q^mu.
    frame_velocity: u^i = e^i_mu q'^mu.
    t: last value of the curve parameter; 2 where nothing better is known.
    parameters: name -> number.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> first_motion(load("s2").frame).parameters
    {'R': 1.0}
    """

    start: tuple[float, ...]
    frame_velocity: tuple[float, ...]
    t: float = 2.0
    parameters: Mapping[str, float] = field(default_factory=dict)


_RING = (0.0, 10.0, 1.5707963267948966, 0.0)

_TILTED = (0.802, 0.535, 0.267)
_BESIDE = (4.14, -1.36, -1.07)

# Chosen so that the two kinds of curves part visibly, or agree on a long way; the later ones lie
# well inside domains that are wider than what one looks at first.
MOTIONS: dict[str, FirstMotion] = {
    "so3": FirstMotion((0.3, 1.0, 0.2), (0.4, 0.3, 1.0), 5.0),
    "r3xso3": FirstMotion((0.4, 1.0, 0.5, 0.0, 0.0, 0.0), (0.0, 0.6, 2.0, 0.8, 0.2, 0.8), 10.0),
    "flat_polar": FirstMotion((1.0, 0.0), (0.3, 1.0), 8.0),
    "flat_cylindrical": FirstMotion((1.0, 0.0, 0.0), (0.1, 1.0, 0.2), 9.0),
    "flat_spherical": FirstMotion((2.0, 1.9, 0.0), (0.1, -0.3, 1.0), 9.0),
    "s2": FirstMotion((1.9, 0.0), (-0.2, 1.0), 6.0, {"R": 1.0}),
    "s3": FirstMotion((0.5, 0.0, 0.0), (0.5, 1.0, 0.3), 5.0),
    "heisenberg": FirstMotion((0.0, 0.0, 0.0), (1.0, 0.3, 1.0), 9.0),
    "schwarzschild": FirstMotion(_RING, (1.0628, 0.0, 0.0, 0.36), 700.0, {"M": 1.0}),
    "kerr": FirstMotion(_RING, (1.0284, 0.0, 0.0, 0.24), 700.0, {"M": 1.0, "a": 0.9}),
    "so3_quaternion": FirstMotion((-0.09, 0.23, -0.27), _TILTED),
    "so3_rodrigues": FirstMotion((-0.17, 0.45, -0.54), _TILTED),
    "s7": FirstMotion(
        (-0.17, 0.45, -0.54, 0.27, -0.37, 0.19, -0.76),
        (0.612, 0.408, 0.204, 0.408, 0.204, 0.408, 0.204),
    ),
    "screw_dislocation": FirstMotion((4.14, 2.27, -1.07), _TILTED, parameters={"b": 0.48}),
    "edge_dislocation": FirstMotion(_BESIDE, _TILTED, parameters={"b": 0.48}),
    "edge_dislocation_elastic": FirstMotion(_BESIDE, _TILTED, parameters={"b": 0.48, "nu": 0.16}),
    "wedge_disclination": FirstMotion((1.66, 4.57, -1.07), _TILTED, parameters={"alpha": 0.48}),
    "schwarzschild_isotropic": FirstMotion(
        (-1.72, 0.63, 0.73, 0.93), (1.25, 0.5, 0.25, 0.5), parameters={"M": 0.43}
    ),
    "frw": FirstMotion((-0.34, 0.73, 0.73, 4.0), (1.25, 0.5, 0.25, 0.5), parameters={"k": -0.37}),
}


def first_motion(
    frame: Frame, parameters: Mapping[str, float] = MappingProxyType({})
) -> FirstMotion:
    """The motion chosen for a space of this name, or one from the frame's own sample point.

    The sample point is rounded to hundredths where that stays inside the domain. The direction is
    fixed, of length one, and in a Lorentzian frame timelike. Parameters that are given have these
    values, and the start lies inside the domain that follows from them.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> first_motion(load("ax_plus_b").frame)
    FirstMotion(start=(1.66, 0.91), frame_velocity=(0.832, 0.555), t=2.0, parameters={})
    >>> [first_motion(load("schwarzschild").frame, {"M": m}).start[1] for m in (1, 6)]
    [10.0, 14.91]
    """
    found = _first_motion(frame)
    if not parameters:
        return found
    numbers = dict(found.parameters) | dict(parameters)
    symbols = {symbol.name: symbol for symbol in (*frame.coordinates, *frame.parameters)}
    begin = zip([symbol.name for symbol in frame.coordinates], found.start, strict=True)
    values = {symbols[name]: x for name, x in (*begin, *numbers.items()) if name in symbols}
    if not broken_relations(frame.domain, values):
        return replace(found, parameters=numbers)
    exact = {symbol: checks.fraction(numbers[symbol.name]) for symbol in frame.parameters}
    try:
        inside = _first_motion(frame.subs(exact))
    except GeomtorsionError:
        # A value that cannot be: whoever uses it is told so.
        return replace(found, parameters=numbers)
    return replace(found, start=inside.start, parameters=numbers)


def _first_motion(frame: Frame) -> FirstMotion:
    """The same for parameters of its own."""
    chosen = MOTIONS.get(frame.name or "")
    if chosen is not None and _fits(chosen, frame):
        return chosen
    point = {symbol: float(value) for symbol, value in frame.sample_point.items()}
    rounded = {symbol: round(value, 2) for symbol, value in point.items()}
    if all(relation.subs(rounded) == sp.true for relation in frame.domain):
        point = rounded
    point = _usual(frame, point)
    return FirstMotion(
        tuple(point[symbol] for symbol in frame.coordinates),
        _direction(frame),
        parameters={symbol.name: point[symbol] for symbol in frame.parameters},
    )


def _usual(frame: Frame, point: dict[sp.Symbol, float]) -> dict[sp.Symbol, float]:
    """The point without signs where that turns coframe entries positive: r, theta as usual.

    Without a domain nothing says that a radius is positive, or that theta lies between the poles;
    that r and sin(theta) stand in the coframe does.
    """
    plain = {symbol: abs(value) for symbol, value in point.items()}
    inside = all(relation.subs(plain) == sp.true for relation in frame.domain)
    if not inside or frame.complex:
        return point
    try:
        here, there = (frame.coframe.at(values).diagonal() for values in (point, plain))
    except (ArithmeticError, KeyError):
        return point
    return plain if (there > 0).sum() > (here > 0).sum() else point


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
