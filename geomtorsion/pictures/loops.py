"""Loops: a loop and its image that does not close, the density of Burgers vectors, and costs."""

from __future__ import annotations

import math
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
from sympy import Symbol, latex

from geomtorsion.errors import LoopError, ShapeError
from geomtorsion.loops import BurgersMap, BurgersVector, Hodograph, Loop, hodograph, outline
from geomtorsion.pictures.style import FLAT, arrow, new_figure, quiet, sense
from geomtorsion.support import checks
from geomtorsion.support.outgoing import measured_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Colours that differ in print and for every eye (Okabe and Ito).
PATH, IMAGE, GAP, START = "#0072B2", "#007a59", "#D55E00", "#222222"


def draw_closure(b: BurgersVector) -> Figure:
    """The loop in coordinates, and its image in the frame with the gap as an arrow.

    The image is the curve X^i(s), integral of e^i_mu dq^mu along the loop so far. A gap too small
    to see is magnified, together with everything nonlinear; the title then reports it.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    ArgumentError
        b is not the Burgers vector of a frame, but for example one of measured data.
    MissingExtraError
        matplotlib is not installed.
    """
    checks.instance(b, BurgersVector, "b")
    drawn = hodograph(b)
    figure = new_figure(9.6, 4.6)
    names = [latex(symbol) for symbol in b.frame.coordinates]
    _draw_path(panel(figure, 121, drawn.path), drawn.path, drawn.centre, drawn.unit, names)
    _draw_image(panel(figure, 122, drawn.image), drawn, b)
    return figure


def draw_loop(loop: Loop, names: Sequence[str] | None = None) -> Figure:
    """A loop in coordinates, with its base point and its sense.

    names: of the coordinates; q^1, q^2, ... if not given.

    Raises
    ------
    MissingValueError
        The loop has symbols without values; `loop.at` takes them.
    ShapeError
        There are not as many names as coordinates.
    MissingExtraError
        matplotlib is not installed.
    """
    checks.instance(loop, Loop, "loop")
    if names is not None:
        checks.check_one_each(names, loop.dimension, "coordinates", "names", ShapeError)
    path, _, unit = outline(loop)
    figure = new_figure(4.8, 4.6)
    symbols = [f"q^{{{k + 1}}}" for k in range(loop.dimension)]
    labels = symbols if names is None else [latex(Symbol(name)) for name in names]
    _draw_path(panel(figure, 111, path), path, loop.centre, unit, labels)
    return figure


def extents(points: np.ndarray) -> list[int]:
    """The two or three directions in which there is something to see, in order."""
    widths = np.ptp(points, axis=1)
    wide = [int(k) for k in np.argsort(-widths, kind="stable") if widths[k] > FLAT * widths.max()]
    chosen = wide[:3]
    for k in range(len(widths)):
        if len(chosen) < 2 and k not in chosen:
            chosen.append(k)
    return sorted(chosen)


def panel(figure: Figure, place: int, points: np.ndarray) -> Axes:
    """Axes in two or three dimensions, as the points need."""
    if len(extents(points)) > 2:
        import_module("mpl_toolkits.mplot3d")
        axes = figure.add_subplot(place, projection="3d")
        axes.view_init(elev=24, azim=-60)
        axes.set_proj_type("ortho")
        for side in (axes.xaxis, axes.yaxis, axes.zaxis):
            side.set_pane_color((1, 1, 1, 0))
        axes.locator_params(nbins=4)
        axes.tick_params(labelsize=8, pad=0)
        axes.set_aspect("equal")
        axes.set_box_aspect(None, zoom=0.82)
        return axes
    axes = figure.add_subplot(place)
    # A circle has to look like one: only so is the gap seen in its true size.
    axes.set_aspect("equal", adjustable="datalim")
    quiet(axes)
    return axes


def _draw_path(
    axes: Axes, path: np.ndarray, centre: Sequence[float], unit: str, names: Sequence[str]
) -> None:
    """The loop in coordinates, with its base point and its sense."""
    chosen = extents(path)
    points = path[chosen]
    axes.plot(*points, color=PATH, linewidth=2)
    if len(points) == 2:
        sense(axes, points, PATH)
    axes.plot(*points[:, :1], "o", color=START, markersize=5)
    labels = [_offset_label(names[k], centre[k], unit) for k in chosen]
    label(axes, labels)
    axes.set_title("the loop, in coordinates: closed", fontsize=11)


def _offset_label(name: str, centre: float, unit: str) -> str:
    """Name of an axis that counts from the centre."""
    shift = "" if centre == 0 else f" {'-' if centre > 0 else '+'} {abs(centre):.4g}"
    inner = f"({name}{shift})" if shift and unit else f"{name}{shift}"
    return f"${inner}${_over(unit)}"


def _over(unit: str) -> str:
    """The unit of an axis."""
    return f" / {unit}" if unit else ""


def _power(value: float) -> str:
    """A power of ten, or a short number."""
    exponent = round(math.log10(value))
    return f"$10^{{{exponent}}}$" if exponent > 3 else f"{value:g}"


def _draw_image(axes: Axes, drawn: Hodograph, b: BurgersVector) -> None:
    """The image in the frame, and the gap as an arrow from its start to its end."""
    chosen = extents(drawn.image)
    points = drawn.image[chosen]
    axes.plot(*points, color=IMAGE, linewidth=2)
    if len(points) == 2:
        sense(axes, points, IMAGE)
    start, end = points[:, 0], points[:, -1]
    step = end - start
    if abs(step).max() > 1e-9 * abs(points).max():
        if len(chosen) == 3:
            axes.quiver(*start, *step, color=GAP, linewidth=2.4, arrow_length_ratio=0.16, zorder=5)
        else:
            arrow(axes, start, end, GAP, 2.4)
        # In space it takes one coordinate more.
        write: Any = axes.text
        write(*(start + 0.55 * step), "  b", color=GAP, fontsize=13, va="bottom")
    axes.plot(*points[:, :1], "o", color=START, markersize=5)
    label(axes, [f"$X^{k + 1}${_over(drawn.unit)}" for k in chosen])
    size = f"|b| = {measured_text(b.magnitude, 0.0 if b.vanishes else b.error)}"
    grown = "" if drawn.magnified == 1 else f", gap enlarged {_power(drawn.magnified)} times"
    axes.set_title(f"its image in the frame{grown}\n{size}", fontsize=11, color=START)


def label(axes: Axes, labels: list[str]) -> None:
    """Names of the axes."""
    for name, label in zip("xyz", labels, strict=False):
        getattr(axes, f"set_{name}label")(label)


def draw_map(survey: BurgersMap, *, relative: bool = False) -> Figure:
    """Burgers vectors per area over a grid, one panel for each component that does not vanish.

    If there are more than three, the first three are drawn, and the title reports it. Components
    are counted from 1, as in all formulas. Cells that enclose a defect are ringed. relative: show
    instead by how much the density differs from 2 S_{mn}^i at the centre of each cell.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    LoopError
        The survey is not a grid.
    ArgumentError
        The argument is not a survey of a frame, but for example a map of measured data.
    MissingExtraError
        matplotlib is not installed.
    """
    checks.instance(survey, BurgersMap, "survey")
    if survey.areas.ndim != 2:
        raise LoopError(
            "expected a survey over a grid (burgers_map), got other loops. Use burgers_map to "
            "draw a map."
        )
    density = np.real(survey.density)
    if relative:
        density = density - np.real(survey.expected) / survey.areas
    sizes = np.nanmax(np.abs(np.where(survey.enclosed, np.nan, density)), axis=(1, 2), initial=0.0)
    strong = np.nanmax(np.abs(density), axis=(1, 2), initial=0.0)
    shown = [k for k in range(len(strong)) if strong[k] > FLAT * strong.max()] or [0]
    figure = new_figure(min(4.7 * len(shown) + 0.6, 15), 4.3)
    if len(shown) > 3:
        figure.suptitle(f"the first 3 of {len(shown)} components", fontsize=11)
    names = [f"${latex(symbol)}$" for symbol in survey.frame.coordinates]
    corners, labels = _corners(survey, names)
    for place, k in enumerate(shown[:3]):
        axes = figure.add_subplot(1, len(shown[:3]), place + 1)
        limit = sizes[k] if sizes[k] > FLAT * strong[k] else strong[k] or 1.0
        mesh = axes.pcolormesh(*corners, density[k].T, cmap="RdBu_r", vmin=-limit, vmax=limit)
        axes.set_aspect("equal" if _similar(corners) else "auto")
        bar = figure.colorbar(mesh, ax=axes, shrink=0.86, extend=_extend(strong[k], limit))
        bar.ax.tick_params(labelsize=8)
        what = "per area, minus $2S$ at the centre" if relative else "per area"
        axes.set_title(f"$b^{k + 1}$ {what}", fontsize=11)
        axes.locator_params(nbins=5)
        axes.set_xlabel(labels[0])
        axes.set_ylabel(labels[1] if not place else "")
        _ring(axes, survey, corners, k)
    return figure


def _extend(largest: float, limit: float) -> str:
    """Whether a colour bar ends in arrows."""
    return "both" if largest > 1.0000001 * limit else "neither"


def _corners(
    survey: BurgersMap, names: list[str]
) -> tuple[tuple[np.ndarray, np.ndarray], list[str]]:
    """Corners of the cells, and the labels of the two axes."""
    labels, lines = [], []
    for axis in (0, 1):
        direction = survey.plane[axis]
        middles = np.tensordot(direction, survey.centres, axes=(0, 0)) / (direction @ direction)
        row = middles[:, 0] if axis == 0 else middles[0]
        lines.append(_edges(row, survey.areas, axis))
        units = np.flatnonzero(direction)
        labels.append(names[int(units[0])] if len(units) == 1 else f"direction {axis + 1}")
    return (lines[0], lines[1]), labels


def _edges(middles: np.ndarray, areas: np.ndarray, axis: int) -> np.ndarray:
    """Edges of cells from their middles, from the widths that follow from the areas."""
    widths = np.abs(areas.sum(axis=1 - axis))
    if len(middles) > 1:
        span = middles[-1] - middles[0]
        widths = widths * span / (widths.sum() - (widths[0] + widths[-1]) / 2)
    edges = np.concatenate([[0.0], np.cumsum(widths)])
    return edges + middles[0] - widths[0] / 2


def _similar(corners: tuple[np.ndarray, np.ndarray]) -> bool:
    """Whether both axes have comparable lengths."""
    spans = [float(side[-1] - side[0]) for side in corners]
    return max(spans) < 5 * min(spans)


def _ring(axes: Axes, survey: BurgersMap, corners: tuple[np.ndarray, np.ndarray], k: int) -> None:
    """Rings around the cells that enclose a defect, with its strength."""
    for row, column in np.argwhere(survey.enclosed)[:40]:
        x = (corners[0][row] + corners[0][row + 1]) / 2
        y = (corners[1][column] + corners[1][column + 1]) / 2
        strength = float(np.real(survey.vectors[k, row, column]))
        axes.plot(x, y, "o", markersize=13, fillstyle="none", color=START, markeredgewidth=1.4)
        axes.annotate(f"b = {strength:.3g}", (x, y), (9, 7), textcoords="offset points", fontsize=9)
