"""solutions: solutions over time, and the path of a curve in its chart."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.curves import CurveProblem
from geomtorsion.errors import ArgumentError, ShapeError
from geomtorsion.ode import Ensemble, Solution
from geomtorsion.pictures.style import (
    SERIES,
    STYLE,
    Stroke,
    captioned,
    ends,
    mathematics,
    new_figure,
    number,
    quiet,
)
from geomtorsion.support import checks

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# A line each; shapes (number of motions, number of times).
Lines = Mapping[str, np.ndarray]


def draw_solution(found: Solution | Ensemble) -> Figure:
    """Draw every coordinate or state over time, and a path in two coordinates.

    found: a solution, or an ensemble with more than one time, of which every motion is a line.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    ShapeError
        There are less than two times.
    ArgumentError
        found is neither.
    MissingExtraError
        matplotlib is not installed.

    Examples
    --------
    >>> from geomtorsion.ode import ODE, solve
    >>> swing = solve(ODE.of({"x": "v", "v": "-x"}, [1, 0]), 10.0)
    >>> [axes.get_ylabel() for axes in draw_solution(swing).axes]
    ['$x$', '$v$']
    """
    if not isinstance(found, Solution | Ensemble):
        raise ArgumentError(
            f"found: expected a Solution or an Ensemble, got {checks.shown(found)}."
        )
    times, lines = _finely(found) if isinstance(found, Solution) else _members(found)
    if len(times) < 2:
        raise ShapeError(
            f"expected a solution at two or more times, got {len(times)}. Solve for a list of "
            "times."
        )
    path = _path(found, lines)
    count = len(lines)
    columns = 1 if count <= 3 else 2
    rows = math.ceil(count / columns)
    figure = new_figure(4.6 * columns + 4.2 * (path is not None), 1.0 + 1.7 * max(rows, 2))
    panels = figure
    if path is not None:
        panels, beside = np.asarray(figure.subfigures(1, 2, width_ratios=(4.6 * columns, 4.2)))
        _draw_path(beside.subplots(), path)
    first: Axes | None = None
    for place, (name, values) in enumerate(lines.items()):
        axes: Axes = panels.add_subplot(rows, columns, place + 1, sharex=first)
        first = first or axes
        for line in values[: STYLE.members]:
            axes.plot(times, line, **_stroke(len(values)).line)
        axes.set_ylabel(mathematics(name), rotation=0, labelpad=14)
        if place < count - columns:
            axes.tick_params(labelbottom=False)
        else:
            axes.set_xlabel(mathematics(found.problem.time_name))
        quiet(axes)
        axes.margins(x=0.01)
    captioned(figure, [_caption(found)])
    return figure


def _stroke(count: int) -> Stroke:
    """One line is bold; many are thin."""
    return SERIES[0] if count == 1 else Stroke(SERIES[0].color, "-", 0.7)


def _caption(found: Solution | Ensemble) -> str:
    error = number(float(f"{found.error:.1e}"))
    if isinstance(found, Solution):
        ended = "" if found.outcome == "done" else f"; {found.outcome}"
        return f"By {found.engine}; error below {error}, {number(found.accuracy)} requested{ended}."
    shown = min(len(found), STYLE.members)
    return f"{shown} of {len(found)} motions, by {found.engine}; error below {error}."


def _finely(found: Solution) -> tuple[np.ndarray, Lines]:
    """Times close enough for smooth lines, and the values at them."""
    if not len(found.times):
        return found.times, {}
    times = np.linspace(0.0, float(found.times[-1]), STYLE.samples)
    moment, problem = found.at(times), found.problem
    if isinstance(problem, CurveProblem) and problem.start is not None:
        smooth = problem.continued(moment.coordinates, problem.atlas.home).astype(float)
        columns: dict[str, np.ndarray] = dict(zip(problem.coordinates, smooth.T, strict=True))
    else:
        columns = dict(problem.columns(moment))
        columns.pop(problem.time_name, None)
    return times, {name: np.asarray(x, dtype=float)[None, :] for name, x in columns.items()}


def _members(found: Ensemble) -> tuple[np.ndarray, Lines]:
    """Times of an ensemble, and the lines drawn over them."""
    problem = found.problem
    names = problem.coordinates if isinstance(problem, CurveProblem) else problem.states
    if isinstance(problem, CurveProblem) and problem.start is None:
        names = [name for name, x in found.values.items() if x.ndim == 2]
    return np.asarray(found.times), {name: np.asarray(found[name], dtype=float) for name in names}


def _path(found: Solution | Ensemble, lines: Lines) -> Lines | None:
    """The two coordinates of a curve, or nothing."""
    problem = found.problem
    is_curve = isinstance(problem, CurveProblem) and problem.start is not None
    return lines if is_curve and len(lines) == 2 else None


def _draw_path(axes: Axes, path: Lines) -> None:
    """Paths in the chart, each from its dot on."""
    names, points = list(path), np.stack(list(path.values()), axis=-1)
    for member in points[: STYLE.members]:
        axes.plot(*member.T, **_stroke(len(points)).line)
        if len(points) == 1:
            ends(axes, member, SERIES[0])
    axes.set_xlabel(mathematics(names[0]))
    axes.set_ylabel(mathematics(names[1]), rotation=0, labelpad=12)
    quiet(axes)
