"""costs: error against time for the case of another tab, measured on request."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

import numpy as np

from geomtorsion.errors import LoopError
from geomtorsion.loops import Loop
from geomtorsion.pictures.style import SERIES, number, visible
from geomtorsion.prices import PriceList, price
from geomtorsion.spaces import pair_problems
from geomtorsion.spaces.first_motion import first_motion
from geomtorsion.support.outgoing import duration_text, size_text
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab.numbers import table
from geomtorsion.teaching.lab.plot import key, plane, svg
from geomtorsion.teaching.lab.space_info import is_around_the_axis, space_of
from geomtorsion.teaching.lab.top import made, scene_of

# True also of a page without a server, and of a case that the server has measured before.
_CAPTION = "All times were measured on the computer that made this page."


def costs(kind: str, case: Json) -> Json:
    """Error against time for a loop or a motion.

    Parameters
    ----------
    kind
        "loop", "straightest", "shortest" or "top".
    case
        Settings of the page: the arguments of `closure_failure`, of `paths` or of `top`.

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
    if kind == "loop":
        return _of_loop(**case)
    return _of_top(**case) if kind == "top" else _of_motion(kind, **case)


def _of_loop(space: str, centre: Sequence[float], radius: float, plane: Sequence[int]) -> Json:
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
    title = f"A circle of radius {number(radius)} in {space}"
    return _shown(title, price(frame, loop, parameters=values))


def _of_motion(
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
    title = f"The {kind} path in {space}, to t = {number(last)}"
    return _shown(title, price(problems[name], last, proofs=[]))


def _of_top(
    moments: Sequence[float],
    omega: Sequence[float],
    tilt: float,
    t: float,
    effects: Sequence[str] = (),
    watch: Sequence[str] = ("nutation",),
) -> Json:
    """Engines on the equations of a body that turns."""
    scene = scene_of(moments, omega, tilt, t, made(effects), watch)
    acting = ", ".join(effects) or "free"
    return _shown(f"The top ({acting}), to t = {number(t)} s", price(scene, proofs=[]))


def _shown(title: str, prices: PriceList) -> Json:
    """Figure and table of the rows that have a result."""
    rows: list[list[Any]] = [
        [row.way, row.requested or None, row.true.high, row.seconds]
        for row in prices.rows
        if row.measured and row.true is not None
    ]
    proofs = {row.way for row in prices.rows if row.certainty == "proof"}
    figure, axes = plane(title, ("error, relative", "time in ms"), height=4.6)
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
    listed = table(("method", "requested error", "error", "time"), body, "All measurements")
    return {
        "picture": svg(figure),
        "table": f"<details><summary>{len(rows)} measurements</summary>{listed}</details>",
        "advice": escape(f"{prices.recommendation} {_CAPTION}"),
        "rows": rows,
        "truth": prices.truth,
    }
