"""costs: error against time for the case of another tab, measured on request."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.accuracy import accuracy_cost
from geomtorsion.accuracy.loops import loop_costs
from geomtorsion.errors import LoopError
from geomtorsion.loops import Loop
from geomtorsion.outgoing import size_text
from geomtorsion.pictures.style import SERIES, number, visible
from geomtorsion.scenes.solve import scene_accuracy
from geomtorsion.spaces import pair_problems
from geomtorsion.spaces.first_motion import first_motion
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab.numbers import table
from geomtorsion.teaching.lab.plot import key, plane, svg
from geomtorsion.teaching.lab.space_info import is_around_the_axis, space_of
from geomtorsion.teaching.lab.top import made, scene_of

if TYPE_CHECKING:
    from geomtorsion.accuracy import CostTable

_RULES = ("trapezoid", "Gauss", "flux", "burgers_vector")
_POINTS = (4, 8, 12, 16, 24, 32, 48)
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
    picture: svg. table, advice: HTML and text. rows: [name, requested error, error, seconds].

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
    """Quadrature rules around a circle, against fifty digits."""
    frame = space_of(space).frame
    first, second = plane
    if is_around_the_axis(space, centre, plane):
        raise LoopError(
            "expected a circle in the coordinates r and φ, got a circle around the axis. Move its "
            "centre away from the axis."
        )
    loop = Loop.circle([float(x) for x in centre], float(radius), (first, second))
    values = dict(first_motion(frame).parameters)
    cost_table = loop_costs(frame, loop, parameters=values, rules=_RULES, points=_POINTS)
    rows = [[row.rule, row.asked, row.error, row.seconds] for row in cost_table.rows]
    best = cost_table.cheapest(1e-12)
    advice = (
        f"Take {best.rule}: its error is {size_text(best.error, 0)}, after {_time(best.seconds)}."
        if best
        else "No rule has an error below 1e-12 here."
    )
    return _shown(f"A circle of radius {number(radius)} in {space}", rows, advice)


def _of_motion(
    kind: str,
    space: str,
    velocity: Sequence[float],
    t: float,
    moments: Sequence[float] | None = None,
) -> Json:
    """Engines along one of the two curves, against a closed form or quadruple precision."""
    problems, _, last = pair_problems(
        space_of(space), frame_velocity=list(velocity), t=float(t), moments=moments
    )
    name = "autoparallel" if kind == "straightest" else "geodesic"
    cost_table = accuracy_cost(problems[name], last)
    return _of_table(f"The {kind} path in {space}, to t = {number(last)}", cost_table)


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
    return _of_table(f"The top ({acting}), to t = {number(t)} s", scene_accuracy(scene))


def _of_table(title: str, found: CostTable) -> Json:
    """A table of engines and accuracies, as far as there are answers."""
    rows = [
        [row.engine, row.asked, row.achieved, row.total_seconds]
        for row in found.rows
        if row.achieved is not None and row.total_seconds is not None
    ]
    return {**_shown(title, rows, found.recommendation), "truth": found.truth}


def _shown(title: str, rows: list[list[Any]], advice: str) -> Json:
    """Picture and table of measured rows."""
    figure, axes = plane(title, ("error, relative", "time in ms"), height=4.6)
    names = list(dict.fromkeys(row[0] for row in rows))
    for name, stroke in zip(names, SERIES, strict=False):
        errors, seconds = np.array([row[2:4] for row in rows if row[0] == name]).T
        axes.plot(visible(errors), 1e3 * seconds, **stroke.line, marker=stroke.end, label=name)
    axes.set_xscale("log")
    axes.set_yscale("log")
    # Better is further right, as in work-precision diagrams of the field.
    axes.invert_xaxis()
    key(figure, axes)
    body = [
        [row[0], "–" if row[1] is None else size_text(row[1], 0), size_text(row[2]), _time(row[3])]
        for row in rows
    ]
    listed = table(("method", "requested error", "error", "time"), body, "All measurements")
    return {
        "picture": svg(figure),
        "table": f"<details><summary>{len(rows)} measurements</summary>{listed}</details>",
        "advice": escape(f"{advice} {_CAPTION}"),
        "rows": rows,
    }


def _time(seconds: float) -> str:
    """Seconds as a person reads them.

    >>> _time(0.00125)
    '1.25 ms'
    """
    return f"{seconds:.3g} s" if seconds >= 1 else f"{seconds * 1e3:.3g} ms"
