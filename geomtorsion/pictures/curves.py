"""curves: both motions in space, in the chart, and coordinate by coordinate."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.pictures.sphere import curve_on, globe, space_axes, towards
from geomtorsion.pictures.style import (
    STROKES,
    Stroke,
    caption,
    captioned,
    clock,
    legend,
    mathematics,
    new_figure,
    quiet,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from geomtorsion.pictures.pair import Pair

# A direction in which both curves stretch less than this share is not drawn.
FLAT = 1e-6
ELEVATION = 24.0


def paths_picture(pair: Pair) -> Figure | None:
    """Both paths: in the space as it lies in ordinary space, and in the chart.

    None where there is nothing to be seen at once: more than three coordinates and no embedding.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    views = []
    embedding = pair.embedding
    if embedding is not None and embedding.place:
        places = {
            name: embedding.places(points, pair.parameters)
            for name, points in pair.coordinates.items()
        }
        views.append((places, list(embedding.axes), embedding.title, embedding.isometric))
    names = [symbol.name for symbol in pair.symbols]
    if len(names) == 1:
        graphs = {
            name: _beside(pair.curves[name].times, points)
            for name, points in continued(pair).items()
        }
        views.append((graphs, [clock(pair), *names], "", False))
    elif len(names) <= 3:
        views.append((continued(pair), names, f"in the chart {pair.chart}", False))
    if not views:
        return None
    figure = new_figure(10.0 if len(views) > 1 else 6.6, 5.2)
    shown: Any = None
    for k, (paths, labels, title, equal) in enumerate(views):
        shown = _view(figure, (1, len(views), k + 1), paths, labels, title, equal)
    legend(figure, shown)
    captioned(figure, [*caption(pair), "Dot: start; square and triangle: ends."])
    return figure


def coordinates_picture(pair: Pair) -> Figure:
    """Each coordinate against t, both curves in one panel.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    points = continued(pair)
    names = [symbol.name for symbol in pair.symbols]
    columns = 1 if len(names) == 1 else 2 if len(names) in (2, 4) else 3
    rows = math.ceil(len(names) / columns)
    figure = new_figure(3.1 * columns if columns > 1 else 6.0, 1.2 + 2.3 * rows)
    shown: Any = None
    for k, name in enumerate(names):
        shown = figure.add_subplot(rows, columns, k + 1, sharex=shown)
        for curve, stroke in STROKES.items():
            shown.plot(pair.curves[curve].times, points[curve][:, k], **stroke.line, label=curve)
        shown.set_ylabel(mathematics(name), rotation=0, labelpad=12)
        if k < len(names) - columns:
            shown.tick_params(labelbottom=False)
        else:
            shown.set_xlabel(clock(pair))
        quiet(shown)
    legend(figure, shown)
    captioned(figure, caption(pair))
    return figure


def continued(pair: Pair) -> dict[str, np.ndarray]:
    """Coordinates with angles carried on beyond a full turn instead of jumping back."""
    atlas = pair.problem.atlas
    angles: set[int] = set()
    for other in atlas.makers:
        route = atlas.route(other, pair.chart) if other != pair.chart else []
        if route:
            angles |= set(route[-1].angles)
    found = {}
    for name, points in pair.coordinates.items():
        smooth = np.array(points, dtype=float)
        for k in angles:
            smooth[:, k] = np.unwrap(smooth[:, k])
        found[name] = smooth
    return found


def _beside(times: Any, points: Any) -> Any:
    return np.column_stack([times, points])


def _view(figure: Any, place: Any, paths: Any, labels: Any, title: str, equal: bool) -> Any:
    """One panel: on a globe, in space or in a plane, as the points demand."""
    every = np.concatenate(list(paths.values()))
    radius = np.linalg.norm(every, axis=1)
    if equal and len(labels) == 3 and np.ptp(radius) < FLAT * radius.max():
        return _on_globe(figure, place, paths, float(radius.max()), title)
    stretch = np.ptp(every, axis=0)
    seen = [k for k in range(len(labels)) if stretch[k] > FLAT * stretch.max()]
    if len(labels) == 3 and len(seen) == 3:
        return _in_space(figure, place, paths, labels, title, equal)
    # What does not change leaves room for what does; two directions are drawn in any case.
    seen = (seen + [k for k in range(len(labels)) if k not in seen])[:2]
    axes = figure.add_subplot(*place)
    first, second = sorted(seen)
    for name, stroke in STROKES.items():
        points = paths[name][:, [first, second]]
        axes.plot(*points.T, **stroke.line, label=name)
    for name, stroke in STROKES.items():
        _ends(axes, paths[name][:, [first, second]], stroke, {})
    axes.set_xlabel(mathematics(labels[first]))
    axes.set_ylabel(mathematics(labels[second]), rotation=0, labelpad=12)
    axes.set_title(title, fontsize=11)
    if equal or "flat space" in title:
        axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.08)
    quiet(axes)
    return axes


def _on_globe(figure: Any, place: Any, paths: Any, radius: float, title: str) -> Any:
    axes = figure.add_subplot(*place, projection="3d")
    viewer = globe(axes, radius, towards(list(paths.values())))
    space_axes(axes, radius, viewer)
    for name, stroke in STROKES.items():
        curve_on(axes, paths[name], viewer, stroke, name)
    axes.set_title(title, fontsize=11)
    return axes


def _in_space(figure: Any, place: Any, paths: Any, labels: Any, title: str, equal: bool) -> Any:
    axes = figure.add_subplot(*place, projection="3d")
    for name, stroke in STROKES.items():
        axes.plot(*paths[name].T, **stroke.line, label=name)
    for name, stroke in STROKES.items():
        _ends(axes, paths[name], stroke, {"depthshade": False})
    setters = (axes.set_xlabel, axes.set_ylabel, axes.set_zlabel)
    for axis, setter, label in zip(
        (axes.xaxis, axes.yaxis, axes.zaxis), setters, labels, strict=True
    ):
        axis.set_rotate_label(False)
        setter(mathematics(label), labelpad=11 if axis is axes.zaxis else 7, rotation=0)
        axis.set_pane_color((1, 1, 1, 0))
        axis.set_major_locator(_few())
        axis._axinfo["grid"]["color"] = "#e3e5e8"
    axes.tick_params(labelsize=8, pad=1)
    axes.set_title(title, fontsize=11)
    every = np.concatenate(list(paths.values()))
    low, high = every.min(axis=0), every.max(axis=0)
    size = high - low
    if equal:
        # One unit is equally long on all axes; the box is not flatter than two fifths.
        size = np.maximum(size, size.max() / 2.5)
    centre = (low + high) / 2
    limits = (axes.set_xlim, axes.set_ylim, axes.set_zlim)
    for setter, c, s in zip(limits, centre, size * 1.06, strict=True):
        setter(c - s / 2, c + s / 2)
    zoom = 0.84 if place[1] > 1 else 0.92
    axes.set_box_aspect(tuple(size) if equal else (1, 1, 0.85), zoom=zoom)
    axes.view_init(elev=ELEVATION, azim=_azimuth((every - centre) / (1 if equal else size)))
    return axes


def _azimuth(points: Any) -> float:
    """The side from which curves spread over the largest area."""
    e = np.radians(ELEVATION)
    best, where = -1.0, -58.0
    for azimuth in range(-75, -10, 5):
        a = np.radians(azimuth)
        right = np.array([-np.sin(a), np.cos(a), 0])
        up = np.array([-np.sin(e) * np.cos(a), -np.sin(e) * np.sin(a), np.cos(e)])
        area = float(np.linalg.det(np.cov(np.array([points @ right, points @ up]))))
        if area > best * 1.02:
            best, where = area, float(azimuth)
    return where


def _few() -> Any:
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(4)


def _ends(axes: Any, points: Any, stroke: Stroke, more: dict[str, Any]) -> None:
    """A dot at the start, the stroke's own mark at the end."""
    look = {"color": stroke.color, "edgecolors": "white", "linewidths": 0.8, "zorder": 5} | more
    axes.scatter(*points[-1], marker=stroke.end, s=46, **look)
    axes.scatter(*points[0], marker="o", s=40, **(look | {"color": "#222222"}))
