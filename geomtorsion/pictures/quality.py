"""quality: how far apart the motions are, and how far each can be trusted, over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.pictures.drift import drift_over_time, error_over_time
from geomtorsion.pictures.style import (
    SERIES,
    STROKES,
    caption,
    captioned,
    clock,
    legend,
    new_figure,
    quiet,
)
from geomtorsion.pictures.text import greek_name

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from geomtorsion.pictures.pair import Pair

# Below the rounding of doubles, and drawn at the bottom of a logarithmic scale.
NOTHING = 1e-17
# The distance is called none where it is within so many errors.
WITHIN = 10.0


def coincide(pair: Pair) -> bool:
    """Whether the two motions are the same as far as their errors can tell."""
    size = float(np.abs(pair.coordinates["geodesic"]).max()) or 1.0
    return float(pair.distance.max()) <= WITHIN * pair.straight.accuracy * size


def distance_picture(pair: Pair) -> Figure:
    """Distance of the two motions over time; logarithmic where there is next to none.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    figure = new_figure(6.6, 4.2)
    axes: Any = figure.add_subplot()
    times = pair.times[: len(pair.distance)]
    stroke = SERIES[3]
    line = stroke.line | {"linestyle": "-"}
    if coincide(pair):
        axes.plot(times, visible(pair.distance), **line, label="distance")
        asked = pair.straight.accuracy
        axes.axhline(
            asked, color="#666b73", linestyle=(0, (5, 1.6)), linewidth=1.2, label="accuracy asked"
        )
        axes.set_yscale("log")
        axes.set_title("The two motions are one, to the accuracy asked", fontsize=11)
        legend(figure, axes)
    else:
        axes.plot(times, pair.distance, **line)
        axes.set_ylim(bottom=0)
        axes.set_title("Distance between autoparallel and geodesic", fontsize=11)
    axes.set_xlabel(clock(pair))
    axes.set_ylabel("distance")
    quiet(axes)
    measure = "Measured by the coframe half way between the two: the true distance when small."
    captioned(figure, [*caption(pair), measure])
    return figure


def quality_picture(pair: Pair) -> Figure:
    """Error estimates of both motions, and the drift of every known invariant, over time.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    drifts = [
        (f"{curve}: {greek(name)}", solution.times, values)
        for curve, solution in pair.curves.items()
        for name, values in drift_over_time(solution).items()
    ]
    figure = new_figure(9.4, 4.6)
    left: Any = figure.add_subplot(1, 2, 1)
    for curve, stroke in STROKES.items():
        solution = pair.curves[curve]
        errors = error_over_time(solution)
        if errors is not None:
            label = curve if errors.any() else f"{curve}: no difference at all"
            left.plot(solution.times[: len(errors)], visible(errors), **stroke.line, label=label)
    left.axhline(
        pair.straight.accuracy,
        color="#666b73",
        linestyle=(0, (1, 1.6)),
        linewidth=1.4,
        label="accuracy asked",
    )
    left.set_title("Error estimate, relative", fontsize=11)
    right: Any = figure.add_subplot(1, 2, 2, sharey=left)
    for (label, times, values), stroke in zip(drifts, SERIES * 3, strict=False):
        shown = label if values[values == values].any() else f"{label}: none"
        right.plot(times, visible(values), **stroke.line, label=shown)
    right.set_title("Drift of what should be constant, relative", fontsize=11)
    if not drifts:
        right.set_axis_off()
        right.text(0.5, 0.5, "no invariant is known", ha="center", transform=right.transAxes)
    for axes in (left, right):
        axes.set_yscale("log")
        axes.set_xlabel(clock(pair))
        axes.tick_params(labelleft=True)
        quiet(axes)
        if axes.get_legend_handles_labels()[0]:
            axes.legend(
                loc="upper center", bbox_to_anchor=(0.5, -0.16), frameon=False, fontsize=8.5,
                handlelength=3.2, ncols=1,
            )  # fmt: skip
    captioned(figure, [*caption(pair), "Zero is drawn at the bottom, at 1e−17."])
    return figure


def greek(words: str) -> str:
    """Words with Greek letters for their names.

    Examples
    --------
    >>> greek("momentum of phi")
    'momentum of φ'
    """
    return " ".join(greek_name(word) for word in words.split())


def visible(values: Any) -> np.ndarray:
    """Values for a logarithmic scale: what is zero stands at its bottom.

    Examples
    --------
    >>> visible([0.0, 1e-12]).tolist()
    [1e-17, 1e-12]
    """
    return np.maximum(np.asarray(values, dtype=float), NOTHING)
