"""Development: a loop rolled out, with the frames along it, the gap and the turn."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp
from sympy import latex

from geomtorsion.loops import DevelopedPath, Loop, develop, developed_path
from geomtorsion.pictures.loops import GAP, IMAGE, PATH, START
from geomtorsion.pictures.style import arrow, new_figure, quiet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from geomtorsion.geometry.connections import ConnectionLike
    from geomtorsion.loops import Development

SOFT = "#5c6475"


def draw_development(
    connection: ConnectionLike,
    loop: Loop,
    *,
    parameters: Mapping[str | sp.Symbol, float] | None = None,
    frames: int = 12,
) -> Figure:
    """A loop in coordinates, and its development into the frame at its base point.

    The developed path does not close: the gap is the Burgers vector. The transported frame at its
    end (orange) is rotated against the frame at its start (black).

    Parameters
    ----------
    frames
        Number of frames drawn along the path.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    return draw_rolled_out(develop(connection, loop, parameters=parameters), frames=frames)


def draw_rolled_out(turn: Development, *, frames: int = 12) -> Figure:
    """A development, drawn as `draw_development` draws it; see `Development.plot`."""
    connection, loop = turn.connection, turn.loop
    path = developed_path(connection, loop, 600, parameters=turn.parameters)
    figure = new_figure(10.4, 5.0)
    left, right = figure.subplots(1, 2)
    _draw_loop(left, path, [latex(symbol) for symbol in connection.frame.coordinates], frames)
    _draw_rolled(right, path, frames)
    _state_gap(right, turn)
    figure.suptitle(f"{loop.name}, rolled out: {connection.name}", color=START)
    return figure


def _plane(points: np.ndarray) -> tuple[int, int]:
    """The two directions with the largest extent, one of them the direction of the gap."""
    widths, gap = np.ptp(points, axis=1), np.abs(points[:, -1] - points[:, 0])
    order = [int(k) for k in np.argsort(-widths, kind="stable")]
    first = int(gap.argmax()) if gap.max() > 0.01 * widths.max() else order[0]
    second = next(k for k in order if k != first)
    return min(first, second), max(first, second)


def _marks(count: int, frames: int) -> list[int]:
    """Numbers of the points at which frames are drawn, without the ends."""
    return [round(k * (count - 1) / frames) for k in range(1, frames)]


def _draw_loop(axes: Axes, path: DevelopedPath, names: list[str], frames: int) -> None:
    """The loop in coordinates, with the points at which frames are drawn."""
    a, b = _plane(path.points)
    x, y = path.points[a], path.points[b]
    axes.plot(x, y, color=PATH, lw=2)
    marks = _marks(len(x), frames)
    axes.plot(x[marks], y[marks], "o", color=PATH, ms=4)
    axes.plot(x[0], y[0], "o", color=START, ms=8)
    ahead = len(x) // 14
    arrow(axes, (x[ahead], y[ahead]), (x[ahead + 4], y[ahead + 4]), PATH)
    axes.set_xlabel(f"${names[a]}$")
    axes.set_ylabel(f"${names[b]}$")
    axes.set_title("the loop, closed in the coordinates", fontsize=11)
    axes.set_aspect("equal", adjustable="datalim")
    quiet(axes)


def _draw_rolled(axes: Axes, path: DevelopedPath, frames: int) -> None:
    """The rolled-out path, the frames along it, and the gap."""
    a, b = _plane(path.places)
    x, y = path.places[a], path.places[b]
    span = max(float(np.ptp(x)), float(np.ptp(y)))
    axes.plot(x, y, color=IMAGE, lw=2)
    for k in _marks(len(x), frames):
        _draw_frame(axes, path, k, (a, b), 0.07 * span, SOFT, 1.0)
    _draw_frame(axes, path, 0, (a, b), 0.15 * span, START, 2.2)
    _draw_frame(axes, path, len(x) - 1, (a, b), 0.15 * span, GAP, 2.2)
    if np.hypot(x[-1] - x[0], y[-1] - y[0]) > 0.01 * span:
        arrow(axes, (x[0], y[0]), (x[-1], y[-1]), GAP, 2.4)
        across = np.array([y[0] - y[-1], x[-1] - x[0]])
        across *= 14 / np.linalg.norm(across)
        axes.annotate(
            "$b$",
            ((x[-1] + x[0]) / 2, (y[-1] + y[0]) / 2),
            tuple(across),
            textcoords="offset points",
            color=GAP,
            fontsize=15,
            ha="center",
            va="center",
        )
    axes.set_xlabel(f"$e^{{{a + 1}}}$ at the start")
    axes.set_ylabel(f"$e^{{{b + 1}}}$ at the start")
    axes.margins(0.12)
    axes.set_aspect("equal", adjustable="datalim")
    quiet(axes)


def _draw_frame(
    axes: Axes,
    path: DevelopedPath,
    k: int,
    plane: tuple[int, int],
    size: float,
    ink: str,
    width: float,
) -> None:
    """The vectors of one frame that are in the plane of the figure."""
    a, b = plane
    x, y = path.places[a, k], path.places[b, k]
    for vector, style in ((a, "-"), (b, (0, (2, 1.2)))):
        u, v = size * path.legs[k, a, vector], size * path.legs[k, b, vector]
        axes.plot([x, x + u], [y, y + v], color=ink, lw=width, ls=style, solid_capstyle="round")
    axes.plot(x, y, "o", color=ink, ms=2.5 * width)


def _state_gap(axes: Axes, turn: Development) -> None:
    """Gap and turn in numbers, and the content of the loop."""
    size = float(np.linalg.norm(turn.burgers))
    title = f"|b| = {size:.4g}" if size > turn.error else "b = 0"
    rotated = float(np.abs(turn.motion.turn).max())
    if rotated > max(turn.turn_error, 1e-13):
        if turn.connection.metric_compatible and len(turn.burgers) in (2, 3):
            title += f",  turn = {np.degrees(turn.angle):.4g}°"
        else:
            title += f",  |R - 1| = {rotated:.4g}"
    else:
        title += ",  no turn"
    if turn.enclosed:
        title += f";  encloses {len(turn.enclosed)} defect{'s' * (len(turn.enclosed) > 1)}"
    axes.set_title(title, fontsize=11)
