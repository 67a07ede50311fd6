"""costs: error against time for the case of another tab, measured on request."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

import numpy as np

from geomtorsion.errors import LoopError
from geomtorsion.loops import Loop
from geomtorsion.pictures.style import SERIES, number, visible
from geomtorsion.prices import PriceList, PriceRow, price
from geomtorsion.spaces import pair_problems
from geomtorsion.spaces.first_motion import first_motion
from geomtorsion.support.outgoing import duration_text, size_text
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab.numbers import table
from geomtorsion.teaching.lab.plot import key, plane, svg
from geomtorsion.teaching.lab.space_info import is_around_the_axis, space_of
from geomtorsion.teaching.lab.top import made, scene_of
from geomtorsion.teaching.texts import ENGLISH, Texts, texts


def costs(kind: str, case: Json, language: str = ENGLISH) -> Json:
    """Error against time for a loop or a motion.

    Parameters
    ----------
    kind
        "loop", "straightest", "shortest" or "top".
    case
        Settings of the page: the arguments of `closure_failure`, of `paths` or of `top`.
    language
        of the words in picture and tables.

    Returns
    -------
    picture: svg. table, advice: HTML and text. truth: what errors are measured against.
    rows: [name, requested error, error, seconds].

    Examples
    --------
    >>> found = costs("loop", dict(space="so3", centre=[0.3, 1, 0.2], radius=0.1, plane=[0, 1]))
    >>> min(row[2] for row in found["rows"]) < 1e-13
    True
    """
    text = texts("figures", "costs", language)
    if kind == "loop":
        return _of_loop(text, **case)
    return _of_top(text, **case) if kind == "top" else _of_motion(text, kind, **case)


def _of_loop(
    text: Texts, space: str, centre: Sequence[float], radius: float, plane: Sequence[int]
) -> Json:
    """Numbers, formula and proofs of a circle."""
    frame = space_of(space).frame
    first, second = plane
    if is_around_the_axis(space, centre, plane):
        raise LoopError(
            "expected a circle in the coordinates r and φ, got a circle around the axis. Move its "
            "centre away from the axis."
        )
    loop = Loop.circle([float(x) for x in centre], float(radius), (first, second))
    values = dict(first_motion(frame).parameters)
    title = text("loop", radius=number(radius), space=space)
    return _shown(title, price(frame, loop, parameters=values), text)


def _of_motion(
    text: Texts,
    kind: str,
    space: str,
    velocity: Sequence[float],
    t: float,
    moments: Sequence[float] | None = None,
) -> Json:
    """Engines along one of the two curves; a proof could take longer than a reader waits."""
    problems, _, last = pair_problems(
        space_of(space), frame_velocity=list(velocity), t=float(t), moments=moments
    )
    name = "autoparallel" if kind == "straightest" else "geodesic"
    title = text(kind, space=space, last=number(last))
    return _shown(title, price(problems[name], last, proofs=[]), text)


def _of_top(
    text: Texts,
    moments: Sequence[float],
    omega: Sequence[float],
    tilt: float,
    t: float,
    effects: Sequence[str] = (),
    watch: Sequence[str] = ("nutation",),
) -> Json:
    """Engines on the equations of a body that turns."""
    scene = scene_of(moments, omega, tilt, t, made(effects), watch)
    named = texts("figures", "top", text.language)
    acting = "; ".join(named(f"effects.{name}") for name in effects) or text("free")
    return _shown(text("top", effects=acting, last=number(t)), price(scene, proofs=[]), text)


def _shown(title: str, prices: PriceList, text: Texts) -> Json:
    """Figure and table of the rows that have a result."""
    rows: list[list[Any]] = [
        [_method(row, text), row.requested or None, row.true.high, row.seconds]
        for row in prices.rows
        if row.measured and row.true is not None
    ]
    proofs = {_method(row, text) for row in prices.rows if row.certainty == "proof"}
    figure, axes = plane(title, (text("error"), text("time")), height=4.6)
    # Errors of proofs are far below those that a double can show.
    names = [name for name in dict.fromkeys(row[0] for row in rows) if name not in proofs]
    for name, stroke in zip(names, SERIES, strict=False):
        errors, seconds = np.array([row[2:4] for row in rows if row[0] == name]).T
        axes.plot(visible(errors), 1e3 * seconds, **stroke.line, marker=stroke.end, label=name)
    axes.set_xscale("log")
    axes.set_yscale("log")
    # Better is further right, as in work-precision diagrams of the field.
    axes.invert_xaxis()
    key(figure, axes)
    body = [
        [
            row[0],
            "–" if row[1] is None else size_text(row[1], 0),
            size_text(row[2]),
            duration_text(row[3]),
        ]
        for row in rows
    ]
    heads = [text(key) for key in ("method", "requested", "errors", "times")]
    listed = table(heads, body, text("caption"))
    summary = escape(text("count", count=len(rows)))
    return {
        "picture": svg(figure, text.language),
        "table": f"<details><summary>{summary}</summary>{listed}</details>",
        # Also true for a page without a server, and for a case that was measured before.
        "advice": escape(" ".join([*_advice(prices, text), text("measured")])),
        "rows": rows,
        "truth": text.named("truths", prices.truth),
    }


def _method(row: PriceRow, text: Texts) -> str:
    """The way of a row in words."""
    if row.certainty == "plain" and row.engine not in ("", row.way):
        return text("plain", method=text.named("methods", row.engine))
    return text.named("methods", row.way)


def _advice(prices: PriceList, text: Texts) -> list[str]:
    """The fastest method to the finest accuracy, and what less and more cost, in sentences."""
    chosen = prices.choice
    best = chosen.best
    proofs = [_bought(row) for row in chosen.proofs]
    if best is None:
        each = ", ".join(text("bought", **values) for values in proofs)
        return [text("proofs", proofs=each) if each else text("none")]

    def share(row: PriceRow) -> str:
        return f"{100 * row.seconds / best.seconds:.0f} %"

    take = {"method": _method(best, text), **_bought(best)}
    if chosen.second:
        ratio = f"{chosen.second.seconds / best.seconds:.2g}"
        other = _method(chosen.second, text)
        sentences = [text("take_faster", **take, ratio=ratio, other=other)]
    else:
        sentences = [text("take", **take)]
    if loose := chosen.loose:
        accuracy = size_text(loose.requested, 0)
        sentences.append(text("loose", accuracy=accuracy, share=share(loose)))
    if chosen.plain:
        sentences.append(text("unchecked", share=share(chosen.plain)))
    if proofs:
        ratio = f"{chosen.proofs[0].seconds / best.seconds:.2g}"
        sentences.append(text("proof", accuracy=proofs[0]["accuracy"], ratio=ratio))
    return sentences


def _bought(row: PriceRow) -> dict[str, str]:
    """The accuracy of a row and its time."""
    return {"accuracy": size_text(row.requested, 0), "time": duration_text(row.seconds)}
