"""space info: facts of a space that controls need: names, a start, and the ranges of sliders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from itertools import combinations
from typing import TYPE_CHECKING

import sympy as sp
from sympy.core.relational import Relational

from geomtorsion.exact import unknown_functions
from geomtorsion.pictures.text import plain_text
from geomtorsion.spaces import load, titles
from geomtorsion.spaces.first_motion import first_motion
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.texts import ENGLISH, texts

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame
    from geomtorsion.spaces import Space

# Shown first, because a lesson begins with them.
FIRST = ("so3", "s2", "flat_polar", "heisenberg", "screw_dislocation", "r3xso3", "schwarzschild")
# Complex, or with unknown functions: there is nothing to draw.
_UNDRAWN = ("kerr_kinnersley", "frw", "frw_flat", "frw_closed", "frw_open", "pp_wave", "s7")
# Too many coordinates, or complex: these have no typed form either.
_UNTYPED = ("kerr_kinnersley", "s7")
# Centre of the first loop in spaces with a line: on it, so that the circle encloses it.
_LINES: Mapping[str, tuple[float, ...]] = dict.fromkeys(
    (
        *("screw_dislocation", "screw_core", "edge_dislocation", "edge_dislocation_elastic"),
        *("wedge_disclination", "wedge_disclination_periodic"),
    ),
    (0.0, 0.0, 0.0),
)
# These spaces have polar coordinates about the line: radius and angle come first.
POLAR = ("wedge_disclination", "wedge_disclination_periodic")


@cache
def space_of(name: str) -> Space:
    """A shipped space from the cache: results derived for one request serve the next."""
    return load(name)


def space_titles(language: str = ENGLISH) -> dict[str, str]:
    """Name of each shipped space -> its title in a language.

    Examples
    --------
    >>> space_titles("de")["heisenberg"]
    'die Heisenberg-Gruppe (Nil)'
    """
    text = texts("spaces", "titles", language)
    return {name: text(name) for name in titles()}


def drawable(language: str = ENGLISH) -> dict[str, str]:
    """Title of each space with drawable loops and motions -> name, the usual ones first.

    Examples
    --------
    >>> list(drawable().values())[:2]
    ['so3', 's2']
    """
    named = space_titles(language)
    drawn = {name: title for name, title in named.items() if name not in _UNDRAWN}
    order = [*FIRST, *(name for name in drawn if name not in FIRST)]
    return {f"{name}: {drawn[name]}": name for name in order if name in drawn}


def typable(language: str = ENGLISH) -> dict[str, str]:
    """Title of each space with a tetrad that can be typed -> name, the drawable ones first.

    Examples
    --------
    >>> "frw" in typable().values(), "frw" in drawable().values()
    (True, False)
    """
    more = {
        f"{name}: {title}": name
        for name, title in space_titles(language).items()
        if name in _UNDRAWN and name not in _UNTYPED
    }
    return {**drawable(language), **more}


def space_form(space: str) -> Json:
    """The exact facts of a shipped space: its names and its tetrad as text.

    Examples
    --------
    >>> found = space_form("flat_polar")
    >>> found["coordinates"], found["coframe"], found["signature"]
    (['r', 'phi'], [['1', '0'], ['0', 'r']], '++')
    """
    chosen = space_of(space)
    frame = chosen.frame
    n = frame.dimension
    return {
        "name": chosen.name,
        "title": chosen.title,
        "coordinates": [symbol.name for symbol in frame.coordinates],
        "parameters": [symbol.name for symbol in frame.parameters],
        "functions": _functions(frame),
        "signature": _signature(frame),
        "coframe": [[plain_text(frame.coframe[i, k]) for k in range(n)] for i in range(n)],
        "planes": [list(pair) for pair in combinations(range(n), 2)],
        "radius": radius_name(frame),
    }


def space_info(space: str) -> Json:
    """All facts of a shipped space that its controls need.

    Examples
    --------
    >>> found = space_info("so3")
    >>> found["coordinates"], found["start"], found["planes"][0]
    (['phi1', 'phi2', 'phi3'], [0.3, 1.0, 0.2], [0, 1])
    """
    chosen = space_of(space)
    frame = chosen.frame
    first = first_motion(frame)
    values = dict(first.parameters)
    ranges = _ranges(frame, list(first.start), values)
    centre = _LINES.get(chosen.name)
    return {
        **space_form(space),
        "values": values,
        "start": list(first.start),
        "ranges": ranges,
        "loop_centre": list(centre or first.start),
        # The domain covers one side of a line only, but a loop may surround the line.
        "loop_ranges": _loop_ranges(chosen.name, len(centre)) if centre else ranges,
        "velocity": list(first.frame_velocity),
        "t": first.t,
    }


def radius_name(frame: Frame) -> str:
    """Name of the radius of a circle that no symbol of the space has."""
    return "rho" if any(symbol.name == "R" for symbol in frame.field.symbols) else "R"


def is_around_the_axis(space: str, centre: Sequence[object], plane: Sequence[int]) -> bool:
    """Whether a circle is centred on the axis of polar coordinates: it is not a circle in them.

    Examples
    --------
    >>> [is_around_the_axis("wedge_disclination", [r, 0, 0], [0, 1]) for r in (0, 1)]
    [True, False]
    """
    return space in POLAR and centre[0] == 0 and set(plane) == {0, 1}


def _loop_ranges(name: str, count: int) -> list[list[float]]:
    """Ranges for the centre of a loop, relative to a line; a radius has positive values only."""
    ranges = [[-1.0, 1.0, PAGE.step] for _ in range(count)]
    if name in POLAR:
        ranges[0][0] = 0.0
    return ranges


def _functions(frame: Frame) -> list[str]:
    """Unknown functions in the coframe, with their arguments."""
    entries = frame.coframe.components.independent.values()
    return sorted(plain_text(function) for function in unknown_functions(entries))


def _signature(frame: Frame) -> str:
    """The frame metric as signs, or empty if it is not diagonal with plus or minus ones."""
    n = frame.dimension
    if any(frame.eta[i, k] != 0 for i in range(n) for k in range(i)):
        return ""
    signs = {1: "+", -1: "-"}
    return "".join(signs.get(frame.eta[i, i], "?") for i in range(n))


def _ranges(frame: Frame, start: list[float], values: dict[str, float]) -> list[list[float]]:
    """The range of a slider for each coordinate, both ways, within the domain."""
    point = dict(zip(frame.coordinates, start, strict=True))
    point |= {symbol: values[symbol.name] for symbol in frame.parameters if symbol.name in values}
    ranges = []
    for symbol, value in zip(frame.coordinates, start, strict=True):
        # The start may be on the boundary of a relation for another coordinate.
        own = [relation for relation in frame.domain if symbol in relation.free_symbols]
        step = PAGE.step * max(1.0, round(abs(value) / 2))
        ends = []
        for sign in (-1, 1):
            count = 0
            while count < PAGE.reach and _inside(
                own, point, symbol, value + sign * (count + 1) * step
            ):
                count += 1
            ends.append(round(value + sign * count * step, 9))
        ranges.append([*ends, step])
    return ranges


def _inside(
    own: list[Relational], point: dict[sp.Symbol, float], symbol: sp.Symbol, value: float
) -> bool:
    """Whether the relations of one coordinate hold at this value."""
    return all(relation.subs(point | {symbol: value}) != sp.false for relation in own)
