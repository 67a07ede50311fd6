"""Measured: maps of |b| per area with their significance, and circuits on measured data."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.loops import Loop
from geomtorsion.materials import Backdrop, Burgers, Section, Source, Survey
from geomtorsion.pictures.loops import GAP, START
from geomtorsion.pictures.network import SOFT
from geomtorsion.pictures.style import (
    FAINT,
    STYLE,
    captioned,
    mathematics,
    new_figure,
    number,
)
from geomtorsion.support import checks
from geomtorsion.support.outgoing import count_text, measured_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Pale neighbours that differ: grains stay behind the marks drawn on them.
GRAINS = ("#cfe3f2", "#f6dcc4", "#d5ead9", "#e9d6e6", "#f5efc3", "#dcdfe4", "#f2d3d3", "#cfe8e8")


def draw_survey(survey: Survey, layer: int | None = None) -> Figure:
    """|b| per area with arrows of its part in the plane, and its significance beside it.

    Arrows appear where |b| is more than noise explains. In the second panel white is the
    significance that pure noise passes in one circuit of a thousand.

    Parameters
    ----------
    layer
        Number of the layer; without it the layer of the largest |b|.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    ArgumentError
        The argument is not a survey.
    MissingExtraError
        matplotlib is not installed.
    """
    checks.instance(survey, Survey, "survey")
    chosen = survey.strongest_layer if layer is None else layer
    points = None if survey.on_grid else survey.lines
    corners = _corners(survey.lines, points is not None)
    width = STYLE.panel * _ratio(corners) + 1.5
    figure = new_figure(2 * width, STYLE.panel + 1.7)
    left, right = figure.subplots(1, 2)
    density = survey.laid(survey.per_area)[..., chosen]
    shades = _shades(survey, density)
    if "norm" in shades:
        # Values below the noise level, zero included, get its colour.
        density = np.maximum(density, shades["norm"].vmin)
    mesh = _shaded(left, corners, points, density, cmap="viridis", **shades)
    unit = f" in {survey.density_unit}" if survey.density_unit else ""
    figure.colorbar(mesh, ax=left, shrink=0.86).ax.tick_params(labelsize=8)
    left.set_title(f"|b| per area{unit}", fontsize=11)
    has_arrows = _arrows(left, survey, chosen)
    top = 2 * survey.level
    significance = survey.laid(survey.significance)[..., chosen]
    mesh = _shaded(right, corners, points, significance, cmap="RdBu_r", vmin=0, vmax=top)
    above = bool((np.nan_to_num(significance) > top).any())
    bar = figure.colorbar(mesh, ax=right, shrink=0.86, extend="max" if above else "neither")
    bar.ax.tick_params(labelsize=8)
    right.set_title("|b| in units of its errors", fontsize=11)
    for axes in (left, right):
        _place(axes, survey.axes, survey.unit, corners, down=survey.down)
    captioned(figure, _said(survey, chosen, has_arrows=has_arrows))
    return figure


def draw_circuits(
    source: Source, vectors: Sequence[Burgers], refused: Sequence[Loop] = ()
) -> Figure:
    """Circuits on their source (grains, an image, |b| per cell), with b as arrows.

    In grids of three or more axes each section with circuits has its own panel. All arrows have one
    scale, set by the longest |b|, and show the part of b in the plane.

    Parameters
    ----------
    refused
        Loops that have no Burgers vector: dashed, so that the reason is visible. They are in the
        first panel, by their first two coordinates.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    ArgumentError
        An entry of `vectors` is not a Burgers vector of a circuit in measured data.
    MissingExtraError
        matplotlib is not installed.
    """
    for one in checks.entries(vectors, "vectors"):
        checks.instance(one, Burgers, "vectors")
    sections: dict[Section, list[Burgers]] = {} if vectors else {Section(): []}
    for one in vectors:
        sections.setdefault(one.section, []).append(one)
    backdrops = [source.backdrop(section) for section in sections]
    edges = [_corners(one.centres, one.kind == "points") for one in backdrops]
    across = math.ceil(math.sqrt(len(edges)))
    down = -(-len(edges) // across)
    width = STYLE.panel * max(map(_ratio, edges)) + 2.2
    figure = new_figure(across * width, down * STYLE.panel + 1.0)
    longest = max((one.magnitude for one in vectors), default=0.0)
    for k, (section, group) in enumerate(sections.items()):
        axes = figure.add_subplot(down, across, k + 1)
        _draw_backdrop(figure, axes, backdrops[k], edges[k])
        if group:
            _draw_group(axes, group, edges[k], longest, down=backdrops[k].down)
        for loop in refused if k == 0 else ():
            points = np.asarray(loop.points(), dtype=float)
            for colour, width, style in (("white", 3.4, "-"), (GAP, 1.6, "--")):
                closed = np.concatenate([points, points[:, :1]], axis=1)[:2]
                axes.plot(*closed, color=colour, linewidth=width, linestyle=style, zorder=4)
        one, two = section.plane
        names = (source.names[one], source.names[two])
        _place(axes, names, source.unit, edges[k], down=backdrops[k].down)
    note = "Arrows show the part of b in the plane of the map, all at one scale"
    arrows = [v for v in vectors if v.arrow is not None and np.any(v.arrow)]
    doubt = "" if all(v.is_significant for v in arrows) else "; grey arrows may be noise"
    lines = [f"{note}{doubt}."] if arrows else []
    if refused:
        lines.append("Dashed: circuits without a Burgers vector; the text gives the reason.")
    captioned(figure, lines)
    return figure


def _draw_group(
    axes: Axes,
    vectors: Sequence[Burgers],
    corners: tuple[np.ndarray, ...],
    longest: float,
    *,
    down: bool,
) -> None:
    """The circuits of one section; longest: |b| of all."""
    # The longest arrow is half as long as the widest circuit, and can be seen.
    widest = max(
        float(np.ptp(vector.path[:, np.isfinite(vector.path[0])], axis=1).max())
        for vector in vectors
    )
    extent = max(abs(float(line[-1] - line[0])) for line in corners)
    reach = max(widest, extent / STYLE.arrows * 4) / 2
    for vector in vectors:
        # A bright line below a dark one is visible on any background.
        for colour, width in (("white", 3.4), (START, 1.6)):
            axes.plot(*vector.path, color=colour, linewidth=width, solid_capstyle="round", zorder=4)
        low, high = np.nanmin(vector.path, axis=1), np.nanmax(vector.path, axis=1)
        middle = (low + high) / 2
        if vector.arrow is not None and longest > 0:
            step = vector.arrow / longest * reach
            colour = GAP if vector.is_significant else SOFT
            # Heads shrink with short arrows, so that these show their sense as well.
            axes.quiver(
                *middle,
                *step,
                color=colour,
                angles="xy",
                scale_units="xy",
                scale=1,
                width=0.006,
                minlength=0,
                zorder=5,
            )
        text = f"|b| = {measured_text(vector.magnitude, vector.error, vector.unit)}"
        if vector.whole.size:
            text = f"b = ({', '.join(map(str, vector.whole.tolist()))}) lattice vectors"
        axes.annotate(
            text,
            (middle[0], low[1] if down else high[1]),
            (0, 5),
            textcoords="offset points",
            ha="center",
            fontsize=8.5,
            zorder=6,
            bbox={"boxstyle": "round,pad=0.2", "fc": "white", "ec": FAINT, "alpha": 0.9},
        )


def _draw_backdrop(
    figure: Figure, axes: Axes, backdrop: Backdrop, corners: tuple[np.ndarray, ...]
) -> None:
    """Grains in pale colours, sizes in greys with a bar, or a picture as it is."""
    axes.set_facecolor("#8b8f96")
    if backdrop.kind == "image":
        axes.pcolormesh(*corners, backdrop.values.T, cmap="gray", rasterized=True)
    elif backdrop.kind == "grains":
        # An extra: without matplotlib this module can still be imported.
        from matplotlib.colors import ListedColormap

        shades = np.mod(backdrop.values, len(GRAINS))
        look: dict[str, Any] = {"cmap": ListedColormap(GRAINS), "vmin": -0.5, "vmax": 7.5}
        axes.pcolormesh(*corners, shades.T, rasterized=True, **look)
        _draw_boundaries(axes, backdrop.values, corners)
    else:
        points = backdrop.centres if backdrop.kind == "points" else None
        mesh = _shaded(axes, corners, points, backdrop.values, cmap="Greys", vmin=0)
        figure.colorbar(mesh, ax=axes, shrink=0.86).ax.tick_params(labelsize=8)
    axes.set_title(backdrop.title, fontsize=11)


def _shaded(
    axes: Axes,
    corners: tuple[np.ndarray, ...],
    points: tuple[np.ndarray, ...] | None,
    values: np.ndarray,
    **look: Any,
) -> Any:
    """Colours of pixels between corners, or of points, by their values."""
    if points is None:
        return axes.pcolormesh(*corners, values.T, rasterized=True, **look)
    return axes.scatter(*points, c=values.ravel(), s=12, linewidths=0, rasterized=True, **look)


def _draw_boundaries(axes: Axes, labels: np.ndarray, corners: tuple[np.ndarray, ...]) -> None:
    """Thin lines between pixels of different grains."""
    # A caller with axes has matplotlib.
    from matplotlib.collections import LineCollection

    x, y = corners
    grains = np.nan_to_num(labels, nan=-1.0)
    p, q = np.nonzero(grains[1:] != grains[:-1])
    upright = [np.stack([x[p + 1], y[q]], -1), np.stack([x[p + 1], y[q + 1]], -1)]
    p, q = np.nonzero(grains[:, 1:] != grains[:, :-1])
    level = [np.stack([x[p], y[q + 1]], -1), np.stack([x[p + 1], y[q + 1]], -1)]
    segments = np.concatenate([np.stack(upright, 1), np.stack(level, 1)])
    axes.add_collection(LineCollection(list(segments), colors=SOFT, linewidths=0.6, zorder=2))


def _shades(survey: Survey, density: np.ndarray) -> dict[str, Any]:
    """Limits of the colours: logarithmic from the noise floor where the largest is far above it."""
    mask = survey.known
    if not mask.any():
        return {}
    floor, largest = float(np.median(survey.floor[mask])), float(np.nanmax(density, initial=0.0))
    if floor > 0 and largest > STYLE.wide * floor:
        # An extra, as above.
        from matplotlib.colors import LogNorm

        return {"norm": LogNorm(floor, largest)}
    return {"vmin": 0.0, "vmax": largest or 1.0}


def _arrows(axes: Axes, survey: Survey, layer: int) -> bool:
    """The part of b in the plane, at some positions where it is significant; whether any is."""
    if survey.arrows is None or not survey.on_grid:
        return False
    mask = survey.laid(survey.significant & survey.known)[..., layer]
    spacing = -(-max(mask.shape) // STYLE.arrows)
    first = spacing // 2
    part = (slice(first, None, spacing), slice(first, None, spacing))
    vectors, shown = survey.laid(survey.arrows)[:, *part, layer], mask[part]
    lengths = np.where(shown, np.hypot(*vectors), 0.0)
    if lengths.max(initial=0.0) == 0:
        return False
    places = np.meshgrid(*(line[first::spacing] for line in survey.lines), indexing="ij")
    steps = [abs(float(line[1] - line[0])) if len(line) > 1 else 1.0 for line in survey.lines]
    # All are as long, and hardly reach to the next: colours show the size.
    far = lengths[shown] > 0
    scale = spacing * min(steps) / np.where(far, lengths[shown], 1.0)
    axes.quiver(
        *(place[shown] for place in places),
        *(vector[shown] * scale for vector in vectors),
        angles="xy",
        scale_units="xy",
        scale=1,
        color="white",
        edgecolor=START,
        linewidth=0.5,
        width=0.005,
        pivot="middle",
        zorder=5,
    )
    return True


def _corners(lines: Sequence[np.ndarray], scattered: bool) -> tuple[np.ndarray, ...]:
    """Edges between the middles along both axes, or the ends of scattered points."""
    if scattered:
        return tuple(np.array([line.min(), line.max()]) for line in lines)
    return tuple(map(_edges, lines))


def _edges(centres: np.ndarray) -> np.ndarray:
    """Edges between equally spaced middles."""
    step = float(centres[1] - centres[0]) if len(centres) > 1 else 1.0
    return np.append(centres, centres[-1] + step) - step / 2


def _ratio(corners: tuple[np.ndarray, ...]) -> float:
    """Width over height, within bounds."""
    wide, high = (abs(float(line[-1] - line[0])) for line in corners)
    return float(np.clip(wide / high, 1 / STYLE.broad, STYLE.broad)) if high and wide else 1.0


def _place(
    axes: Axes, names: tuple[str, str], unit: str, corners: tuple[np.ndarray, ...], *, down: bool
) -> None:
    """Equal scales, names of the axes, and y downwards where instruments show it so."""
    over = f" / {unit}" if unit else ""
    axes.set_xlabel(mathematics(names[0]) + over)
    axes.set_ylabel(mathematics(names[1]) + over)
    axes.set_aspect("equal")
    axes.set_xlim(*sorted((corners[0][0], corners[0][-1])))
    low, high = sorted((corners[1][0], corners[1][-1]))
    axes.set_ylim(*((high, low) if down else (low, high)))
    axes.locator_params(nbins=6)
    axes.set_facecolor("#8b8f96")


def _said(survey: Survey, layer: int, *, has_arrows: bool) -> list[str]:
    """Caption of the figure, with numbers; has_arrows: whether the figure shows directions."""
    mask = survey.laid(survey.known)[..., layer]
    count = int(mask.sum())
    significant = int((survey.laid(survey.significant)[..., layer] & mask).sum())
    where = f" at {survey.layers[layer]}" if survey.layers[layer] else ""
    lines = [
        (
            f"Circuits of {survey.extent}{where}: {significant:,} of {count:,} are more than noise "
            f"explains (red: above {number(round(survey.level, 2))}, which is white; noise exceeds "
            "it in 0.1 %)."
        )
    ]
    if survey.replaced:
        lines.append(f"Circuits: {survey.replaced}.")
    if count < mask.size:
        lines.append(f"Grey: {count_text(mask.size - count, 'circuit')} {survey.missing}.")
    if count:
        floor = float(np.median(survey.laid(survey.floor)[..., layer][mask]))
        unit = f" {survey.density_unit}" if survey.density_unit else ""
        arrows = "; arrows: the direction of b in the plane of the map" if has_arrows else ""
        lines.append(f"Noise only: {floor:.2g}{unit}{arrows}.")
    return lines
