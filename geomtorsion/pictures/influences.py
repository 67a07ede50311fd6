"""influences: the influence of each effect against the accuracy."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from geomtorsion.pictures.scene_plan import INK, OUT
from geomtorsion.pictures.style import (
    NOTHING,
    SERIES,
    captioned,
    new_figure,
    number,
    pictured,
    quiet,
)
from geomtorsion.prices import EffectBudget
from geomtorsion.support import checks

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# An effect, its influence, the quantity that changes most, and whether it is included.
Bar = tuple[str, float, str, bool]


def draw_effects(budget: EffectBudget) -> Figure:
    """The influence of each effect against the accuracy.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.

    Examples
    --------
    >>> from geomtorsion.scenes import load
    >>> figure = draw_effects(load("thrown_body").called_for(1e-3))
    >>> figure.axes[0].get_xscale()
    'log'
    """
    checks.instance(budget, EffectBudget, "budget")
    return influence_picture(
        [(row.effect, row.influence, row.quantity, row.included) for row in budget.rows],
        budget.accuracy,
        budget.title,
        [f"{budget.errors.capitalize()}.", budget.validity],
    )


def effects_html(budget: EffectBudget) -> str:
    """The table and its figure for a notebook.

    Examples
    --------
    >>> from geomtorsion.scenes import load
    >>> "thrust" in effects_html(load("missile").called_for(1e-3))
    True
    """
    return pictured(str(budget), budget.plot)


def influence_picture(
    bars: Sequence[Bar],
    accuracy: float,
    title: str = "",
    notes: Sequence[str] = (),
    *,
    label: str = "largest change without the effect, relative",
    outside: str = " (omitted)",
) -> Figure:
    """A bar for each effect on a logarithmic scale, with the accuracy as a line.

    Parameters
    ----------
    bars
        effect, influence (relative; infinite: the motion needs it), quantity, whether included.
    label, outside
        below the axis, and after the names of effects that are not included.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.

    Examples
    --------
    >>> figure = influence_picture([("drag", 1e-5, "velocity", False)], 1e-3)
    >>> figure.axes[0].get_xscale()
    'log'
    """
    figure = new_figure(7.4, 1.9 + 0.42 * max(len(bars), 1))
    axes: Axes = figure.add_subplot()
    finite = [size for _, size, _, _ in bars if NOTHING < size < math.inf]
    low = min([accuracy, *finite]) / 10
    high = max([accuracy, *finite]) * 10
    for place, (name, size, quantity, included) in enumerate(reversed(bars)):
        color = SERIES[0].color if included else OUT
        end = min(max(size, low), high)
        axes.barh(
            place, end - low, left=low, height=0.55, color=color, hatch=None if included else "///",
            edgecolor="white",
        )  # fmt: skip
        text = f"{number(float(f'{size:.1e}'))} of {quantity}"
        if math.isinf(size):
            text = "needed"
        elif size <= NOTHING:
            text = "none"
        axes.annotate(
            text, (end, place), (5, 0), textcoords="offset points", va="center", fontsize=9,
            color=INK, bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0},
        )  # fmt: skip
        axes.text(
            -0.015, place, f"{name}{'' if included else outside}", va="center", ha="right",
            fontsize=10, color=INK if included else OUT, transform=axes.get_yaxis_transform(),
        )  # fmt: skip
    axes.axvline(accuracy, color=SERIES[1].color, linestyle=SERIES[1].dashes)
    axes.text(
        accuracy, 1.01, f"accuracy {number(accuracy)}", ha="center", va="bottom",
        fontsize=9, color=SERIES[1].color, transform=axes.get_xaxis_transform(),
    )  # fmt: skip
    axes.set_xscale("log")
    # Room for the texts to the right of the bars.
    axes.set_xlim(low, high * (high / low) ** 0.35)
    axes.set_ylim(-0.6, len(bars) - 0.4)
    axes.set_yticks([])
    axes.set_xlabel(label)
    quiet(axes)
    axes.grid(visible=False, axis="y")
    if title:
        figure.suptitle(title, fontsize=12)
    captioned(figure, notes)
    return figure
