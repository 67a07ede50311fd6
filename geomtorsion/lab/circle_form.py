"""circle form: the Burgers vector of a circle in closed form, as the page shows it."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import sympy as sp

from geomtorsion.errors import LoopError
from geomtorsion.exercises.worker_pool import Json
from geomtorsion.geometry import Frame
from geomtorsion.lab.as_typed import read_typed
from geomtorsion.lab.numbers import names_text, raised
from geomtorsion.lab.space_info import is_round_the_axis, radius_name, space_of
from geomtorsion.loops.exact_circle import exact_circle
from geomtorsion.pictures.formula import expression_mathml
from geomtorsion.pictures.text import greek_name


def circle_form(
    space: str, centre: Sequence[str], radius: str = "", plane: Sequence[int] = (0, 1)
) -> Json:
    """b^i of a circle in a shipped space, and twice the torsion times the area at its centre.

    Parameters
    ----------
    centre, radius
        Exact expressions as text, in the parameters of the space and R, the radius (rho where the
        space has an R of its own), which is what an empty radius stands for.
    plane
        Two coordinates, by number.

    Returns
    -------
    html: a table with mathematics. b: the components as text. sentence: what they say.

    Examples
    --------
    >>> circle_form("screw_dislocation", ["0", "0", "0"])["b"]
    ['0', '0', 'b']
    """
    frame = space_of(space).frame
    if len(centre) != frame.dimension:
        raise LoopError(
            f"the centre needs {frame.dimension} coordinates, {len(centre)} came. Give one for "
            f"each of {names_text([symbol.name for symbol in frame.coordinates])}."
        )
    symbols = {symbol.name: symbol for symbol in frame.parameters}
    own = radius_name(frame)
    symbols[own] = sp.Symbol(own, positive=True)
    places = zip(centre, frame.coordinates, strict=True)
    at = [_read(text, symbols, f"centre, {symbol}") for text, symbol in places]
    size = _read(radius.strip() or own, symbols, "radius")
    if is_round_the_axis(space, at, plane):
        raise LoopError(
            "a circle about the axis is none in r and phi: these forms are for circles in "
            "coordinates. Put its centre off the axis."
        )
    first, second = plane
    b = exact_circle(frame, at, size, (first, second))
    small = _small(frame, at, size, (first, second))
    rows = "".join(
        f'<tr><th scope="row">b{raised(k)}</th><td>{_shown(value)}</td>'
        f"<td>{_shown(other)}</td></tr>"
        for k, (value, other) in enumerate(zip(b, small, strict=True))
    )
    names = names_text([greek_name(frame.coordinates[k].name) for k in (first, second)])
    caption = f"Burgers vector of the circle in {names}, frame components"
    head = '<th scope="col"></th><th scope="col">b</th><th scope="col">2 S A at the centre</th>'
    return {
        "html": f'<div class="scroll"><table id="loop-form"><caption>{escape(caption)}</caption>'
        f"<thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>",
        "b": [str(value) for value in b],
        "sentence": _sentence(b, small),
    }


def _read(text: str, symbols: dict[str, sp.Symbol], where: str) -> sp.Expr:
    return read_typed(text, symbols, {}, where)


def _shown(value: sp.Expr | None) -> str:
    return "–" if value is None else expression_mathml(value)


def _small(
    frame: Frame, centre: Sequence[sp.Expr], radius: sp.Expr, plane: tuple[int, int]
) -> list[sp.Expr | None]:
    """2 S_{mn}^i A with the exact curl of the coframe; None where it has no value."""
    m, n = plane
    table = dict(zip(frame.coordinates, centre, strict=True))
    found: list[sp.Expr | None] = []
    for i in range(frame.dimension):
        curl = sp.diff(frame.coframe[i, n], frame.coordinates[m])
        curl -= sp.diff(frame.coframe[i, m], frame.coordinates[n])
        value = sp.simplify(curl.subs(table, simultaneous=True) * sp.pi * radius**2)
        found.append(None if value.has(sp.nan, sp.zoo, sp.oo) else value)
    return found


def _sentence(b: Sequence[sp.Expr], small: Sequence[sp.Expr | None]) -> str:
    """What the closed form says."""
    if not any(b):
        return "The image of this circle closes: b = 0, exactly."
    if None in small:
        return (
            "At the centre the torsion has no value: the circle runs round a line, and b is what "
            "sits on it."
        )
    if all(x == y for x, y in zip(b, small, strict=True)):
        return "Torsion is the same all over the circle: b is 2 S A, exactly."
    return "The smaller the circle, the closer b comes to 2 S A."
