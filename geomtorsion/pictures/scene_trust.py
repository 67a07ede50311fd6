"""scene trust: how far a scene's numbers can be trusted, over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.pictures.style import SERIES, captioned, new_figure, number, quiet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Below the rounding of doubles, and drawn at the bottom of a logarithmic scale.
NOTHING = 1e-17
# What changes by less than this, relative, is kept.
KEPT = 1e-8


def trust_picture(
    times: Any,
    drifts: Mapping[str, Any],
    error: float,
    asked: float,
    errors: Any = None,
    title: str = "",
    notes: Sequence[str] = (),
) -> Figure:
    """The drift of every quantity that should be constant, beside the error and what was asked.

    Parameters
    ----------
    times
        shape (m,), seconds.
    drifts
        name -> change since the start, relative, shape (m,).
    error, asked
        largest error estimate, and accuracy asked for, relative.
    errors
        error estimate over time, shape (m,), where it is known.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    clock = np.asarray(times, dtype=float)
    figure = new_figure(8.6, 4.8)
    axes: Any = figure.add_subplot()
    for (name, values), stroke in zip(drifts.items(), SERIES[1:] * 4, strict=False):
        shown = _visible(values)
        label = f"drift of {name.replace('_', ' ')}"
        label += "" if shown.max() > NOTHING else ": none"
        axes.plot(clock[: len(shown)], shown, **stroke.line, label=label)
    if errors is not None:
        shown = _visible(errors)
        axes.plot(clock[: len(shown)], shown, **SERIES[0].line, label="error estimate")
    else:
        axes.axhline(
            max(error, NOTHING), color=SERIES[0].color, linewidth=1.6, label="error estimate"
        )
    axes.axhline(
        asked, color="#666b73", linestyle=(0, (1, 1.6)), linewidth=1.5,
        label=f"accuracy asked, {number(asked)}",
    )  # fmt: skip
    axes.set_yscale("log")
    axes.set_ylim(bottom=NOTHING / 2)
    axes.set_xlabel("$t$ / s")
    axes.set_ylabel("relative")
    axes.margins(x=0.01)
    quiet(axes)
    axes.legend(
        loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize=9, handlelength=3.0
    )
    if title:
        axes.set_title(title, fontsize=12, loc="left")
    captioned(figure, [*notes, "Zero is drawn at the bottom, at 1e−17."])
    return figure


def change_picture(
    times: Any,
    kept: Mapping[str, Mapping[str, Any]],
    title: str = "",
    notes: Sequence[str] = (),
) -> Figure:
    """What should be constant, by several equations of motion, each against its own start.

    Parameters
    ----------
    kept
        quantity -> {equations: values of shape (m,) or (m, k)}; vectors are compared by the size
        of their change.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    clock = np.asarray(times, dtype=float)
    figure = new_figure(8.6, 1.2 + 2.4 * len(kept))
    first: Any = None
    for place, (quantity, laws) in enumerate(kept.items()):
        axes: Any = figure.add_subplot(len(kept), 1, place + 1, sharex=first)
        first = first or axes
        largest = 0.0
        for (law, values), stroke in zip(laws.items(), SERIES * 2, strict=False):
            data = np.asarray(values, dtype=float).reshape(len(values), -1)
            size = float(np.linalg.norm(data[0])) or 1.0
            change = np.linalg.norm(data - data[0], axis=1) / size
            axes.plot(clock[: len(change)], change, **stroke.line, label=law)
            largest = max(largest, float(change.max()))
        if largest < KEPT:
            axes.set_ylim(-0.05, 1.0)
            axes.text(
                0.99, 0.93, f"kept: changes below {number(float(f'{largest:.0e}') or NOTHING)}",
                ha="right", va="top", transform=axes.transAxes, fontsize=9, color="#444444",
            )  # fmt: skip
        axes.set_title(
            f"change of the {quantity.replace('_', ' ')}, relative", fontsize=10.5, loc="left"
        )
        axes.margins(x=0.01)
        quiet(axes)
        if place == len(kept) - 1:
            axes.set_xlabel("$t$ / s")
        else:
            axes.tick_params(labelbottom=False)
    if first is not None:
        first.legend(
            loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize=9, handlelength=3.0
        )
    if title:
        figure.suptitle(title, fontsize=12)
    captioned(figure, notes)
    return figure


def _visible(values: Any) -> np.ndarray:
    """Sizes for a logarithmic scale; what is zero stands at its bottom."""
    return np.maximum(np.abs(np.asarray(values, dtype=float)), NOTHING)
