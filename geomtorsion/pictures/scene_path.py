"""scene path: where a body goes in space, and how it points on its way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.pictures.style import (
    FLAT,
    SERIES,
    STYLE,
    Stroke,
    captioned,
    ends,
    legend,
    new_figure,
    quiet,
    space_box,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d import Axes3D
    from numpy.typing import ArrayLike

AXES = ("#b04a86", "#8a6d00", "#007a59")


def path_picture(
    paths: Mapping[str, ArrayLike],
    matrices: ArrayLike | None = None,
    title: str = "",
    notes: Sequence[str] = (),
) -> Figure:
    """One or several paths in space, the first with the axes of the body on its way.

    Parameters
    ----------
    paths
        name -> positions, shape (m, 3), metres.
    matrices
        rotations from body to space along the first path, shape (m, 3, 3).

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    places = {name: np.asarray(points, dtype=float) for name, points in paths.items()}
    every = np.concatenate(list(places.values()))
    stretch = np.ptp(every, axis=0)
    seen = [k for k in range(3) if stretch[k] > FLAT * max(stretch.max(), 1e-300)]
    turn = None if matrices is None else np.asarray(matrices, dtype=float)
    if len(seen) == 3:
        figure = new_figure(8.0, 6.6)
        axes: Axes3D = figure.add_subplot(projection="3d")
        _in_space(axes, places, turn, every)
    else:
        seen = sorted((seen + [k for k in (0, 2, 1) if k not in seen])[:2])
        wide, high = np.maximum(stretch[seen], 0.25 * stretch.max() or 1.0)
        figure = new_figure(min(1.4 + 5.2 * max(wide / high, 0.5), 9.4), _height(wide / high))
        axes = figure.add_subplot()
        _in_plane(axes, places, turn, seen)
    if title:
        axes.set_title(title, fontsize=12)
    if len(places) > 1:
        legend(figure, axes)
    lines = ["Dot: start; triangle and square: ends."]
    if turn is not None:
        lines.append("Short lines: axes of the body, 1 violet, 2 brown, 3 green and thicker.")
    captioned(figure, [*notes, *lines])
    return figure


def _height(ratio: float) -> float:
    """Height of a picture that is a plane this many times as wide as it is high."""
    return 6.6 if ratio <= 1.5 else 1.6 + 8.0 / ratio


def _strokes(places: Mapping[str, np.ndarray]) -> list[tuple[str, np.ndarray, Stroke]]:
    pairs = zip(places.items(), SERIES * len(places), strict=False)
    return [(name, points, stroke) for (name, points), stroke in pairs]


def _stations(points: np.ndarray) -> np.ndarray:
    """Samples at which the body is shown: at equal steps of the way, of time where it stands."""
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    if way[-1] == 0:
        return np.array([0])
    # Equal steps of the way, not of time: slow bodies would cover one another.
    wanted = np.linspace(0, way[-1], min(STYLE.stations, len(points)))
    return np.unique(np.searchsorted(way, wanted).clip(0, len(points) - 1))


def _in_space(
    axes: Axes3D, places: Mapping[str, np.ndarray], turn: np.ndarray | None, every: np.ndarray
) -> None:
    low, high = every.min(axis=0), every.max(axis=0)
    # One unit is equally long on all axes; the box is not flatter than a third.
    size = np.maximum(high - low, (high - low).max() / 3)
    for name, points, stroke in _strokes(places):
        axes.plot(*points.T, **stroke.line, label=name)
    if turn is not None:
        points = next(iter(places.values()))
        length = 0.08 * float(np.ptp(points, axis=0).max())
        for station in _stations(points[: len(turn)]):
            for k in range(3):
                tip = points[station] + length * turn[station][:, k]
                axes.plot(
                    *np.array([points[station], tip]).T, color=AXES[k], linewidth=1 + (k == 2)
                )
    for _, points, stroke in _strokes(places):
        ends(axes, points, stroke)
    centre = (low + high) / 2
    labels = [f"${letter}$ / m" for letter in "xyz"]
    space_box(axes, labels, centre - size / 2, centre + size / 2)
    axes.set_box_aspect(tuple(size), zoom=0.88 if size[2] == size.max() else 1.0)
    axes.view_init(elev=22.0, azim=-56.0)


def _in_plane(
    axes: Axes, places: Mapping[str, np.ndarray], turn: np.ndarray | None, seen: Sequence[int]
) -> None:
    for name, points, stroke in _strokes(places):
        axes.plot(*points[:, seen].T, **stroke.line, label=name)
    flat = np.concatenate([points[:, seen] for points in places.values()])
    size = float(np.ptp(flat, axis=0).max()) or 1.0
    if turn is not None:
        points = next(iter(places.values()))
        for station in _stations(points[: len(turn)]):
            place = points[station, seen]
            for k in range(3):
                tip = place + 0.05 * size * turn[station][seen, k]
                axes.plot(*np.array([place, tip]).T, color=AXES[k], linewidth=1 + (k == 2))
    for _, points, stroke in _strokes(places):
        ends(axes, points[:, seen], stroke)
    axes.set_xlabel(f"${'xyz'[seen[0]]}$ / m")
    axes.set_ylabel(f"${'xyz'[seen[1]]}$ / m")
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.06)
    quiet(axes)
