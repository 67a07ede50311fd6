"""Describe: loops from plain data, as they come from JSON or the command line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

import sympy as sp

from geomtorsion.errors import FileFormatError, LoopError
from geomtorsion.exact import parse_expression
from geomtorsion.loops.loop import Loop

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame

# Kind of loop -> keys that are needed, keys that may be there.
KINDS: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "circle": (("centre", "radius"), ("plane",)),
    "ellipse": (("centre", "axes"), ("plane",)),
    "polygon": (("vertices",), ("centre", "size")),
    "plaquette": (("corner", "steps"), ("plane",)),
    "curve": (("expressions",), ("parameter", "interval", "centre", "size")),
    "spline": (("points",), ("centre", "size")),
}
COMMON = ("name", "times")


def loop_from_data(frame: Frame, data: Any, where: str = "loop") -> Loop:
    """A loop from a mapping such as {"circle": {"centre": [0, 0], "radius": "1/2"}, "times": 2}.

    Exactly one key names the kind: circle (centre, radius, plane), ellipse (centre, axes, plane),
    polygon (vertices, centre, size), plaquette (corner, steps, plane), curve (expressions,
    parameter, interval, centre, size), spline (points, centre, size); name and times may stand
    beside it. Numbers may be text such as "pi/2"; a plane is two coordinates, by number or name,
    or two vectors.

    Raises
    ------
    FileFormatError
        A key is missing, unknown or of the wrong kind; the message names it.
    LoopError
        The loop is none: it does not close, has no length, or is not finite.
    ExpressionError
        An expression cannot be read.

    Examples
    --------
    >>> from geomtorsion.geometry import Frame
    >>> plane = Frame("x y", [[1, 0], [0, 1]])
    >>> loop = loop_from_data(plane, {"circle": {"centre": [0, 0], "radius": "1/2"}, "times": 2})
    >>> loop.size, loop.winding([0, 0])
    (0.5, 2)
    """
    _check_keys(data, (*KINDS, *COMMON), where)
    kinds = [key for key in data if key in KINDS]
    if len(kinds) != 1:
        came = " and ".join(kinds) or "none"
        raise FileFormatError(
            f"{where}: exactly one of {', '.join(KINDS)} was needed, but {came} came."
        )
    (kind,) = kinds
    inner, place = data[kind], f"{where}: {kind}"
    needed, others = KINDS[kind]
    _check_keys(inner, (*needed, *others), place)
    for key in needed:
        if key not in inner:
            raise FileFormatError(f"{place}: the key {key!r} is missing.")
    values = {key: _value(frame, kind, key, value, place) for key, value in inner.items()}
    name = data.get("name", kind)
    if not isinstance(name, str):
        raise FileFormatError(f"{where}: name: a text was needed, but {name!r} came.")
    maker = {"curve": Loop.parametric}.get(kind) or getattr(Loop, kind)
    try:
        loop = maker(**values, name=name)
        return loop.times(data["times"]) if "times" in data else loop
    except LoopError as error:
        raise LoopError(f"{where}: {error}") from None


def _check_keys(data: Any, known: Sequence[str], where: str) -> None:
    """Refuse what is no mapping, and unknown keys."""
    if not isinstance(data, Mapping):
        raise FileFormatError(f"{where}: a mapping was needed, but {data!r} came.")
    for key in data:
        if key not in known:
            near = get_close_matches(str(key), known, 1)
            hint = f"Did you mean {near[0]}? " if near else ""
            raise FileFormatError(
                f"{where}: unknown key {key!r}. {hint}Known are {', '.join(known)}."
            )


def _value(frame: Frame, kind: str, key: str, value: Any, where: str) -> Any:
    """The value of one key: expressions stay text, a plane may name coordinates."""
    if key in ("expressions", "parameter"):
        return value
    if key == "interval" or kind == "curve":
        return _numbers(value, f"{where}: {key}")
    if key == "plane":
        return plane_of(frame, value, where)
    return _numbers(value, f"{where}: {key}")


def plane_of(frame: Frame, value: Any, where: str) -> tuple[Any, Any]:
    """Two coordinates, by number or name, or two vectors."""
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise FileFormatError(
            f"{where}: plane: two coordinates or two vectors were needed, but {value!r} came."
        )
    names = [symbol.name for symbol in frame.coordinates]
    found = []
    for side in value:
        if isinstance(side, str) and side in names:
            found.append(names.index(side))
        elif isinstance(side, str) and not side.isdigit():
            raise FileFormatError(
                f"{where}: plane: {side!r} is no coordinate; they are {', '.join(names)}."
            )
        else:
            found.append(int(side) if isinstance(side, str) else _numbers(side, f"{where}: plane"))
    return found[0], found[1]


def _numbers(value: Any, where: str) -> Any:
    """Numbers at any depth of lists; text is read as an exact number."""
    if isinstance(value, list | tuple):
        return [_numbers(part, f"{where}[{k}]") for k, part in enumerate(value)]
    if isinstance(value, str):
        return number_of(value, where)
    if isinstance(value, int | float) and not isinstance(value, bool):
        return value
    raise FileFormatError(f"{where}: a number was needed, but {value!r} came.")


def number_of(text: str, where: str) -> Any:
    """A number from text: decimal, or an exact expression such as pi/2.

    Raises
    ------
    ExpressionError
        The text is no number.

    Examples
    --------
    >>> number_of("0.25", "radius"), number_of("2*pi/3", "angle")
    (0.25, 2*pi/3)
    """
    try:
        return int(text) if text.strip().lstrip("+-").isdigit() else float(text)
    except ValueError:
        value = parse_expression(text, {}, {}, where=where)
    if isinstance(value, sp.Expr) and value.is_real is not False:
        return value
    raise FileFormatError(f"{where}: a real number was needed, but {text!r} came.")
