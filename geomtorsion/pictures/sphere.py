"""sphere: a transparent globe, and curves on it that are pale on its far side."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.pictures.style import FAINT, STYLE, Stroke

if TYPE_CHECKING:
    from mpl_toolkits.mplot3d import Axes3D


def globe(axes: Axes3D, radius: float, facing: np.ndarray, elevation: float = 22.0) -> np.ndarray:
    """Draw a globe seen from above a direction; return the unit vector towards the viewer."""
    azimuth = float(np.degrees(np.arctan2(facing[1], facing[0])))
    axes.view_init(elev=elevation, azim=azimuth)
    axes.set_proj_type("ortho")
    a, e = np.radians(azimuth), np.radians(elevation)
    viewer = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    turn = np.linspace(0, 2 * np.pi, 121)
    for phi in np.arange(STYLE.meridians // 2) * 2 * np.pi / STYLE.meridians:
        ring = [np.sin(turn) * np.cos(phi), np.sin(turn) * np.sin(phi), np.cos(turn)]
        _ring(axes, radius * np.array(ring).T, viewer)
    for theta in np.arange(1, STYLE.parallels + 1) * np.pi / (STYLE.parallels + 1):
        ring = [np.sin(theta) * np.cos(turn), np.sin(theta) * np.sin(turn)]
        _ring(axes, radius * np.array([*ring, np.full_like(turn, np.cos(theta))]).T, viewer)
    # The edge of the ball as it is seen: a circle square to the line of sight.
    across = np.cross(viewer, [0, 0, 1])
    across /= np.linalg.norm(across)
    edge = np.outer(np.cos(turn), across) + np.outer(np.sin(turn), np.cross(viewer, across))
    axes.plot(*(radius * edge).T, color="#8b9098", linewidth=1.0)
    axes.set_axis_off()
    axes.set_box_aspect((1, 1, 1), zoom=1.36)
    for setter in (axes.set_xlim, axes.set_ylim, axes.set_zlim):
        setter(-radius, radius)
    return viewer


def _ring(axes: Axes3D, points: np.ndarray, viewer: np.ndarray) -> None:
    for part, front in parted(points, viewer):
        axes.plot(*part.T, color=FAINT, linewidth=0.7, alpha=0.9 if front else 0.35)


def curve_on(
    axes: Axes3D, points: np.ndarray, viewer: np.ndarray, stroke: Stroke, label: str = ""
) -> None:
    """A curve on a globe, with a dot where it starts and a mark where it ends."""
    for part, front in parted(points, viewer):
        axes.plot(*part.T, **stroke.line, alpha=1.0 if front else STYLE.behind)
    if label:
        axes.plot([], [], [], **stroke.line, label=label)
    for place, mark, size in ((points[0], "o", 36), (points[-1], stroke.end, 40)):
        alpha = 1.0 if place @ viewer >= 0 else STYLE.behind
        axes.scatter(
            *place, marker=mark, s=size, color=stroke.color, alpha=alpha, depthshade=False,
            edgecolors="white", linewidths=0.7, zorder=5,
        )  # fmt: skip


def numbered(
    axes: Axes3D, place: np.ndarray, viewer: np.ndarray, text: str, stroke: Stroke
) -> None:
    """A number beside a point of a unit globe, on the side of the point's own direction."""
    front = float(place @ viewer)
    # Seen from the side a step outwards is enough; in the middle of the disc it is a step up.
    step = 0.13 * place + 0.13 * max(front, 0.0) * _upwards(viewer)
    look = {"color": stroke.color, "alpha": 1.0 if front >= 0 else 0.6, "weight": "bold"}
    axes.text(*(place + step), text, ha="center", va="center", fontsize=11, zorder=6, **look)


def _upwards(viewer: np.ndarray) -> np.ndarray:
    """The direction that is up in the picture."""
    up = np.array([0.0, 0.0, 1.0]) - viewer[2] * viewer
    return up / np.linalg.norm(up)


def space_axes(axes: Axes3D, radius: float, viewer: np.ndarray) -> None:
    """Short pins on the globe where the axes of space leave it."""
    for letter, pin in zip("xyz", np.eye(3), strict=True):
        look = {"alpha": 1.0 if pin @ viewer >= 0 else STYLE.behind, "color": "#555555"}
        axes.plot(*np.array([pin, 1.09 * pin]).T * radius, linewidth=1.4, **look)
        axes.text(*(1.17 * radius * pin), f"${letter}$", ha="center", va="center", **look)


def towards(paths: Sequence[np.ndarray]) -> np.ndarray:
    """The side from which most of some curves on a globe, their ends above all, is seen.

    Examples
    --------
    >>> import numpy as np
    >>> bool(towards([np.array([[1.0, 0.0, 0.0], [0.9, 0.1, 0.0]])])[0] > 0.5)
    True
    """
    turns = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    sides = np.column_stack([np.cos(turns), np.sin(turns), np.full_like(turns, 0.4)])
    score = np.zeros(len(sides))
    for path in paths:
        unit = path / np.linalg.norm(path, axis=1, keepdims=True)
        # A soft step: a point on the very edge of the globe counts for half.
        seen = np.clip(0.5 + 2 * unit @ sides.T, 0, 1)
        score += seen.mean(axis=0) + 0.5 * seen[0] + 0.25 * seen[-1]
    return sides[int(np.argmax(score))]


def parted(points: np.ndarray, viewer: np.ndarray) -> list[tuple[np.ndarray, bool]]:
    """Pieces of a curve in front of the globe and behind it, those behind first.

    Examples
    --------
    >>> import numpy as np
    >>> turn = np.linspace(0, 2 * np.pi, 9)[:, None]
    >>> ring = np.hstack([np.cos(turn), np.sin(turn), 0 * turn])
    >>> [(len(part), front) for part, front in parted(ring, np.array([0.9, 0.1, 0.4]))]
    [(5, False), (3, True), (3, True)]
    """
    front = points @ viewer >= 0
    cuts = np.flatnonzero(front[1:] != front[:-1]) + 1
    bounds = [0, *cuts.tolist(), len(points)]
    pieces = [
        # A piece begins on the last point of the one before, so that no gap is left.
        (points[max(low - 1, 0) : high], bool(front[low]))
        for low, high in pairwise(bounds)
    ]
    return sorted(pieces, key=lambda piece: piece[1])
