"""Gaps: a path and its variation, closed in the image and open in the space."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from sympy import latex

from geomtorsion.action import Variation
from geomtorsion.errors import ArgumentError, ShapeError, UnknownNameError
from geomtorsion.ode import Solution
from geomtorsion.pictures.loops import GAP, IMAGE, PATH, START
from geomtorsion.pictures.style import STYLE, arrow, captioned, new_figure, number, quiet
from geomtorsion.support import checks

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def draw_gap(variation: Variation, solution: Solution, *, size: float = 1.0) -> Figure:
    """A path and its varied path: in the image of the frame, and in the coordinates.

    The variation dPhi^i, dq^mu is of first order, so that `size` times it is drawn.

    Parameters
    ----------
    variation
        gt.variation(frame, "closed_in_image").
    solution
        of variation.gap_ode(motion, images).

    Returns
    -------
    A matplotlib figure. Left: the images, X^i = integral of u^i. Right: the coordinates, with the
    gap at the end as an arrow.

    Raises
    ------
    ArgumentError, UnknownNameError
        The solution is not of `gap_ode`.
    ShapeError
        The frame has only one coordinate.
    MissingExtraError
        matplotlib is not installed.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> bar = gt.variation(gt.spaces.load("so3").frame, "closed_in_image")
    >>> turning = gt.ODE.of({"phi1": 1, "phi2": 0, "phi3": 0}, [0, 1, 0])
    >>> figure = draw_gap(bar, gt.solve(bar.gap_ode(turning, ["sin(pi*t/2)", 0, 0]), 2.0))
    >>> [axes.get_title() for axes in figure.axes]
    ['images in the frame', 'in the space: |b| = 1.157']
    """
    checks.instance(variation, Variation, "variation")
    checks.instance(solution, Solution, "solution")
    scale = checks.positive(size, "size", ArgumentError)
    frame = variation.frame
    if frame.dimension < 2:
        raise ShapeError("expected a frame of two or more dimensions for a figure, got one.")
    names = [symbol.name for symbol in frame.coordinates]
    gaps = [symbol.name for symbol in variation.gaps]
    times = np.linspace(0.0, float(solution.times[-1]), STYLE.samples)
    moment = solution.at(times)
    needed = [*names, *gaps, "frame_velocity", "image", "moved"]
    missing = [name for name in needed if name not in moment.values]
    if missing:
        raise UnknownNameError(
            f"solution: expected one of variation.gap_ode(motion, images), got one without "
            f"{', '.join(missing)}."
        )
    speeds = moment["frame_velocity"]
    steps = np.diff(times)[:, None] * (speeds[1:] + speeds[:-1]) / 2
    image = np.vstack([np.zeros(frame.dimension), np.cumsum(steps, axis=0)])
    path = np.column_stack([moment[name] for name in names])
    figure = new_figure(10.0, 4.8)
    left, right = figure.subplots(1, 2)
    _pair(left, image, image + scale * moment["image"], [f"X^{k + 1}" for k in range(len(names))])
    left.set_title("images in the frame", fontsize=11)
    moved = path + scale * moment["moved"]
    a, b = _pair(right, path, moved, [latex(symbol) for symbol in frame.coordinates])
    width = max(float(np.ptp(moved)), float(np.ptp(path)))
    if np.hypot(*(moved[-1] - path[-1])[[a, b]]) > 1e-3 * width:
        arrow(right, path[-1, [a, b]], moved[-1, [a, b]], GAP, 2.4)
    end = np.array([moment[name][-1] for name in gaps])
    right.set_title(f"in the space: |b| = {np.linalg.norm(end):.4g}", fontsize=11)
    error = number(float(f"{solution.error:.1e}"))
    lines = ["Blue: the path; green: the varied path. The images close where dPhi ends at zero."]
    lines.append(f"In the space the gap b stays open. Error below {error}.")
    captioned(figure, lines)
    return figure


def _pair(axes: Axes, path: np.ndarray, moved: np.ndarray, names: list[str]) -> tuple[int, int]:
    """Path and varied path in the two directions in which they extend most."""
    both = np.vstack([path, moved])
    a, b = sorted(int(k) for k in np.argsort(-np.ptp(both, axis=0), kind="stable")[:2])
    for points, ink in ((path, PATH), (moved, IMAGE)):
        axes.plot(points[:, a], points[:, b], color=ink, linewidth=2)
        axes.plot(*points[-1, [a, b]], "o", color=ink, markersize=5)
    axes.plot(*path[0, [a, b]], "o", color=START, markersize=7)
    axes.set_xlabel(f"${names[a]}$")
    axes.set_ylabel(f"${names[b]}$")
    axes.set_aspect("equal", adjustable="datalim")
    quiet(axes)
    return a, b
