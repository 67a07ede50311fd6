"""Parallelogram: two steps in both orders, the second carried parallel along the first."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.curves import autoparallel, parallel_transport
from geomtorsion.errors import ShapeError
from geomtorsion.geometry.connections import as_connection
from geomtorsion.ode import solve
from geomtorsion.pictures.loops import IMAGE, START, extents, label, panel
from geomtorsion.pictures.style import SERIES, arrow, captioned, mathematics, new_figure, number

if TYPE_CHECKING:
    import sympy as sp
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from geomtorsion.geometry import Connection
    from geomtorsion.geometry.connections import ConnectionLike
    from geomtorsion.ode.numbers import Numbers, Real

    Start = Numbers | Mapping[str, Real]

# Points of each side: between the ends of the step, which has length one in its parameter.
SIDE = np.linspace(0.0, 1.0, 61)


def draw_parallelogram(
    connection: ConnectionLike,
    start: Start,
    first: Numbers,
    second: Numbers,
    *,
    parameters: Mapping[str | sp.Symbol, float] | None = None,
) -> Figure:
    """Two steps in both orders: with torsion, the parallelogram stays open.

    Each side is an autoparallel. The first step carries the second step parallel to its end, where
    the second side begins.

    Equation
    --------
    gap^c = q^c(second, first) - q^c(first, second) = 2 S_ab^c u^a v^b + terms of third order
    u and v are the first and the second step (J. A. Schouten, Ricci-Calculus, 1954, chapter III)

    Parameters
    ----------
    start
        q^mu, shape (n,), or {"r": 1, "theta": 0}.
    first, second
        the steps in the frame, lengths along its legs, shape (n,).

    Returns
    -------
    A matplotlib figure in the coordinates: both ways, and the gap as an arrow.

    Raises
    ------
    ShapeError
        The frame has only one coordinate.
    StartError, ChartEdgeError
        The start is singular, or a step leaves the domain.
    MissingExtraError
        matplotlib is not installed.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> polar = gt.Frame("r theta", [["1", "0"], ["0", "r"]], domain="r > 0")
    >>> figure = draw_parallelogram(gt.cartan(polar), [1, 0], [0.5, 0], [0, 0.5])
    >>> figure.axes[0].get_title()  # 0.5/1 - 0.5/1.5
    'gap = (0, 0.166667)'
    """
    connection = as_connection(connection)
    frame = connection.frame
    if frame.dimension < 2:
        raise ShapeError("expected a frame of two or more dimensions for a figure, got one.")
    values = {str(name): value for name, value in (parameters or {}).items()}
    blue, along, one = _way(connection, start, first, second, values)
    orange, across, other = _way(connection, start, second, first, values)
    every = np.concatenate([blue, orange])
    bound = (one + other) * max(float(np.abs(every).max()), 1.0)
    gap = orange[-1] - blue[-1]
    gap[np.abs(gap) <= bound] = 0.0
    point = dict(zip((q.name for q in frame.coordinates), blue[0].tolist(), strict=True))
    torsion = connection.torsion.T.at(point | values)
    linear = np.einsum("abc,a,b->c", torsion, along, across)
    figure = new_figure(6.4, 5.6)
    axes = panel(figure, 111, every.T)
    chosen = extents(every.T)
    _draw(axes, blue[:, chosen], orange[:, chosen], gap[chosen])
    label(axes, [mathematics(frame.coordinates[k].name) for k in chosen])
    axes.set_title(f"gap = {_vector(gap)}" if gap.any() else "closed: no gap", fontsize=11)
    error = number(float(f"{bound:.1e}"))
    expected = (
        f"2 S(first, second) at the start: {_vector(linear)}; error of the gap below {error}."
    )
    ways = "Blue: the first step, then the second; orange: the second, then the first."
    captioned(figure, [ways, expected])
    return figure


def _way(
    connection: Connection,
    start: Start,
    first: Numbers,
    second: Numbers,
    values: Mapping[str, float],
) -> tuple[np.ndarray, np.ndarray, float]:
    """Points of both sides, shape (m, n), the first velocity in coordinates, and the error."""
    along = autoparallel(connection, start, frame_velocity=first, parameters=values)
    side = solve(parallel_transport(along, second, connection), SIDE)
    here, carried = side.coordinates[-1], side.transported[-1].reshape(-1)
    across = autoparallel(connection, here, frame_velocity=carried, parameters=values)
    opposite = solve(across, SIDE)
    points = np.concatenate([side.coordinates, opposite.coordinates]).astype(float)
    return points, np.asarray(side.velocity[0], float), side.error + opposite.error


def _draw(axes: Axes, blue: np.ndarray, orange: np.ndarray, gap: np.ndarray) -> None:
    """Both ways from the start, a dot at each corner, and the gap."""
    for points, stroke in ((blue, SERIES[0]), (orange, SERIES[1])):
        axes.plot(*points.T, color=stroke.color, linewidth=2.2)
        for corner in (points[len(SIDE) - 1], points[-1]):
            axes.plot(*corner[:, None], "o", color=stroke.color, markersize=5)
    axes.plot(*blue[:1].T, "o", color=START, markersize=6)
    if not gap.any():
        return
    if len(gap) > 2:
        axes.quiver(*blue[-1], *gap, color=IMAGE, linewidth=2.4, arrow_length_ratio=0.16)
    else:
        arrow(axes, blue[-1], orange[-1], IMAGE, 2.4)


def _vector(values: np.ndarray) -> str:
    """Components for people."""
    return f"({', '.join(number(float(value) + 0.0) for value in values)})"
