"""scene plan: the steps that a scene computes or omits, as a graph."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from geomtorsion.pictures.style import STYLE, captioned, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INK, OUT = "#1d2330", "#9aa0aa"
FILLS = ("#dcebf7", "#fbe6d6", "#d9efe4", "#efe3ee", "#f3ecd2")


def plan_picture(
    columns: Mapping[str, Sequence[str]],
    edges: Iterable[tuple[str, str]],
    left_out: Mapping[str, str] | None = None,
    title: str = "",
    notes: Sequence[str] = (),
) -> Figure:
    """Boxes in columns, arrows from each box to its needs; omitted boxes grey, with reason.

    Parameters
    ----------
    columns
        heading -> boxes below it, for instance watched, effects, states.
    edges
        pairs of boxes (from, to).
    left_out
        box -> why it is omitted; it is drawn dashed.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.

    Examples
    --------
    >>> figure = plan_picture({"watched": ["energy"], "states": ["omega"]}, [("energy", "omega")])
    >>> [text.get_text() for text in figure.axes[0].texts if text.get_text()]
    ['watched', 'energy', 'states', 'omega']
    """
    reasons = left_out or {}
    tallest = max((len(boxes) for boxes in columns.values()), default=1)
    figure = new_figure(1.2 + STYLE.column * len(columns), 1.3 + STYLE.row * (tallest + 1))
    axes: Axes = figure.add_subplot()
    places: dict[str, tuple[float, float]] = {}
    for k, (heading, boxes) in enumerate(columns.items()):
        axes.text(
            k * STYLE.column,
            STYLE.row,
            heading,
            ha="center",
            va="center",
            fontsize=11,
            weight="bold",
        )
        offset = (tallest - len(boxes)) / 2
        for row, box in enumerate(boxes):
            place = (k * STYLE.column, -STYLE.row * (row + offset))
            places.setdefault(box, place)
            _box(axes, place, box, FILLS[k % len(FILLS)], reasons.get(box))
    for start, end in edges:
        if start in places and end in places:
            _arrow(axes, places[start], places[end], start in reasons or end in reasons)
    axes.set_xlim(-1.2, (len(columns) - 1) * STYLE.column + 1.7)
    axes.set_ylim(-STYLE.row * (tallest - 0.3), 1.5 * STYLE.row)
    axes.set_aspect("equal", adjustable="box")
    axes.set_axis_off()
    if title:
        figure.suptitle(title, fontsize=12)
    lines = [f"Omitted: {box}: {reason}" for box, reason in reasons.items()]
    captioned(figure, [*notes, *lines])
    return figure


def layers_picture(layers: Sequence[Sequence[str]], edges: Iterable[tuple[str, str]]) -> Figure:
    """Boxes in layers from top to bottom, arrows from each box to the boxes that need it.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.

    Examples
    --------
    >>> figure = layers_picture([["metric"], ["christoffel"]], [("metric", "christoffel")])
    >>> [text.get_text() for text in figure.axes[0].texts if text.get_text()]
    ['metric', 'christoffel']
    """
    widest = max((len(boxes) for boxes in layers), default=1)
    # Arrows over several layers pass beside the boxes.
    wide, high = STYLE.column * (widest + 1), STYLE.row * 1.4 * len(layers)
    figure = new_figure(wide, high)
    axes: Axes = figure.add_subplot()
    places = {
        box: (STYLE.column * (k - (len(boxes) - 1) / 2), -STYLE.row * 1.4 * depth)
        for depth, boxes in enumerate(layers)
        for k, box in enumerate(boxes)
    }
    for depth, boxes in enumerate(layers):
        for box in boxes:
            _box(axes, places[box], box, FILLS[depth % len(FILLS)], None)
    for start, end in edges:
        (x, y), (u, v) = places[start], places[end]
        near = y - v < 1.5 * STYLE.row * 1.4
        side = 1 if x >= 0 else -1
        half = side * (STYLE.box / 2 + 0.03)
        ends = ((x, y - 0.21), (u, v + 0.21)) if near else ((x + half, y), (u + half, v))
        look = {
            "arrowstyle": "-|>", "color": INK, "linewidth": 0.9, "shrinkA": 0, "shrinkB": 0,
            "mutation_scale": 10, "connectionstyle": f"arc3,rad={0 if near else -0.35 * side}",
        }  # fmt: skip
        axes.annotate("", xy=ends[1], xytext=ends[0], arrowprops=look, zorder=0)
    axes.set_xlim(-wide / 2, wide / 2)
    axes.set_ylim(0.7 * STYLE.row - high, 0.7 * STYLE.row)
    axes.set_aspect("equal", adjustable="box")
    axes.set_axis_off()
    return figure


def _box(axes: Axes, place: tuple[float, float], text: str, fill: str, reason: str | None) -> None:
    # A caller with axes has matplotlib.
    from matplotlib.patches import FancyBboxPatch

    x, y = place
    gone = reason is not None
    axes.add_patch(
        FancyBboxPatch(
            (x - STYLE.box / 2, y - 0.19), STYLE.box, 0.38,
            boxstyle="round,pad=0.02,rounding_size=0.08",
            facecolor="white" if gone else fill, edgecolor=OUT if gone else INK,
            linewidth=0.9, linestyle="--" if gone else "-",
        )
    )  # fmt: skip
    size = 9.5 if len(text) <= 24 else 7.5
    axes.text(x, y, text, ha="center", va="center", fontsize=size, color=OUT if gone else INK)


def _arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float], gone: bool) -> None:
    """From the right edge of one box to the left edge of another, or bent within a column."""
    (x, y), (u, v) = start, end
    look = {
        "arrowstyle": "-|>", "color": OUT if gone else INK, "linewidth": 0.9,
        "linestyle": "--" if gone else "-", "shrinkA": 0, "shrinkB": 0, "mutation_scale": 10,
    }  # fmt: skip
    half = STYLE.box / 2 + 0.03
    if abs(x - u) < 1e-9:
        # Bent outwards, whether the arrow runs up or down.
        look["connectionstyle"] = f"arc3,rad={0.6 if v > y else -0.6}"
        ends = ((x + half, y), (u + half, v))
    elif u > x:
        if u - x > STYLE.column * 1.01:
            # Around the boxes between them.
            look["connectionstyle"] = f"arc3,rad={-0.22 if v >= y else 0.22}"
        ends = ((x + half, y), (u - half, v))
    else:
        ends = ((x - half, y), (u + half, v))
    axes.annotate("", xy=ends[1], xytext=ends[0], arrowprops=look, zorder=0)
