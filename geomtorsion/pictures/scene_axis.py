"""scene axis: the way that the tip of a body's axis takes on the sphere."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.pictures.sphere import curve_on, globe, numbered, parted, space_axes, towards
from geomtorsion.pictures.style import SERIES, Stroke, captioned, legend, new_figure, quiet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TRACE = Stroke("#0072B2", "-", 1.7, "^")
LIMIT = "#D55E00"
# Beyond so many turns about the vertical the first ones only are drawn on the globe.
TURNS = 3.0
# An axis that stays within this angle of the vertical (radians) is seen best from above.
UPRIGHT = 0.35


def axis_picture(
    times: Any,
    axis: Any,
    limits: Sequence[float] | None = None,
    title: str = "",
    notes: Sequence[str] = (),
) -> Figure:
    """The tip of a unit vector on the sphere of space, and its height unrolled along its way round.

    Parameters
    ----------
    times
        shape (m,), seconds.
    axis
        shape (m, 3): a unit vector fixed in the body, seen from space; z points up.
    limits
        angles from the vertical between which it nutates, in radians; those reached, if not given.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    tip = np.asarray(axis, dtype=float)
    tip = tip / np.linalg.norm(tip, axis=1, keepdims=True)
    theta = np.arccos(np.clip(tip[:, 2], -1, 1))
    bounds = (float(theta.min()), float(theta.max())) if limits is None else tuple(limits)
    figure = new_figure(10.4, 5.2)
    grid = figure.add_gridspec(1, 2, width_ratios=(1, 1))
    shown = tip[: _first_turns(tip)]
    ball: Any = figure.add_subplot(grid[0], projection="3d")
    tilted = float(np.median(tip[:, 2]))
    viewer = globe(ball, 1.0, towards([shown]), elevation=42.0 if abs(tilted) > 0.5 else 24.0)
    space_axes(ball, 1.0, viewer)
    for bound in bounds:
        _parallel(ball, bound, viewer)
    curve_on(ball, shown, viewer, TRACE)
    ball.set_title("on the sphere", fontsize=11)
    flat: Any = figure.add_subplot(grid[1])
    if max(bounds) < UPRIGHT:
        _from_above(flat, tip, theta, bounds)
    else:
        _unrolled(flat, tip, theta, bounds)
    if title:
        figure.suptitle(title, fontsize=12)
    lines = ["Dot: start; triangle: end; dashed: the angles between which the axis nutates."]
    if len(shown) < len(tip):
        end = float(np.asarray(times, dtype=float)[len(shown) - 1])
        lines.append(f"The sphere shows the first {TURNS:g} turns, to t = {end:.4g} s.")
    captioned(figure, [*notes, *lines])
    return figure


def _azimuth(tip: np.ndarray) -> np.ndarray:
    """Angle about the vertical, carried on beyond full turns."""
    return np.unwrap(np.arctan2(tip[:, 1], tip[:, 0]))


def _first_turns(tip: np.ndarray) -> int:
    """How many samples the first turns about the vertical have."""
    phi = _azimuth(tip)
    beyond = np.flatnonzero(np.abs(phi - phi[0]) > 2 * np.pi * TURNS)
    return int(beyond[0]) + 1 if len(beyond) else len(tip)


def _parallel(axes: Any, theta: float, viewer: Any) -> None:
    """A circle of constant angle from the vertical."""
    turn = np.linspace(0, 2 * np.pi, 181)
    ring = np.column_stack(
        [np.sin(theta) * np.cos(turn), np.sin(theta) * np.sin(turn), np.full(181, np.cos(theta))]
    )
    for part, front in parted(ring, viewer):
        axes.plot(
            *part.T, color=LIMIT, linewidth=1.1, linestyle=(0, (4, 2)), alpha=0.9 if front else 0.3
        )


def _unrolled(axes: Any, tip: np.ndarray, theta: np.ndarray, bounds: Any) -> None:
    """Angle from the vertical against the angle about it, upright as on the sphere."""
    phi, tilt = np.degrees(_azimuth(tip)), np.degrees(theta)
    axes.plot(phi, tilt, **TRACE.line)
    axes.scatter(phi[0], tilt[0], s=36, color="#222222", zorder=5, edgecolors="white")
    axes.scatter(phi[-1], tilt[-1], s=44, marker="^", color=TRACE.color, zorder=5, edgecolors="w")
    for bound in bounds:
        axes.axhline(np.degrees(bound), color=LIMIT, linewidth=1.1, linestyle=(0, (4, 2)))
    low, high = (float(np.degrees(bound)) for bound in (min(bounds), max(bounds)))
    pad = max(0.12 * (high - low), 0.5)
    axes.set_ylim(min(high + pad, 180.0), max(low - pad, 0.0))
    axes.set_xlabel("angle about the vertical / degrees")
    axes.set_ylabel("angle from the vertical / degrees")
    axes.set_title("unrolled", fontsize=11)
    quiet(axes)


def _from_above(axes: Any, tip: np.ndarray, theta: np.ndarray, bounds: Any) -> None:
    """The tip seen from above: the radius is the angle from the vertical."""
    phi, tilt = np.arctan2(tip[:, 1], tip[:, 0]), np.degrees(theta)
    place = np.column_stack([tilt * np.cos(phi), tilt * np.sin(phi)])
    axes.plot(*place.T, **TRACE.line)
    axes.scatter(*place[0], s=36, color="#222222", zorder=5, edgecolors="white")
    axes.scatter(*place[-1], s=44, marker="^", color=TRACE.color, zorder=5, edgecolors="w")
    turn = np.linspace(0, 2 * np.pi, 181)
    for bound in bounds:
        ring = np.degrees(bound) * np.array([np.cos(turn), np.sin(turn)])
        axes.plot(*ring, color=LIMIT, linewidth=1.1, linestyle=(0, (4, 2)))
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("towards $x$ / degrees")
    axes.set_ylabel("towards $y$ / degrees")
    axes.set_title("from above", fontsize=11)
    quiet(axes)


def axes_picture(
    matrices: Any,
    title: str = "",
    notes: Sequence[str] = (),
    names: Sequence[str] = ("1", "2", "3"),
) -> Figure:
    """Where all three axes of a body point, as it turns, on the unit sphere of space.

    Parameters
    ----------
    matrices
        shape (m, 3, 3): rotations from body to space.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    turn = np.asarray(matrices, dtype=float)
    figure = new_figure(6.6, 6.4)
    axes: Any = figure.add_subplot(projection="3d")
    viewer = globe(axes, 1.0, towards([turn[:, :, k] for k in range(3)]))
    space_axes(axes, 1.0, viewer)
    for k, stroke in enumerate(SERIES[:3]):
        curve_on(axes, turn[:, :, k], viewer, stroke, f"axis {names[k]} of the body")
        numbered(axes, turn[0, :, k], viewer, names[k], stroke)
    if title:
        axes.set_title(title, fontsize=12)
    legend(figure, axes)
    captioned(figure, [*notes, "Dots: start; pale: behind the globe; x, y, z are fixed in space."])
    return figure
