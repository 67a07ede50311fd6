"""scene over time: outputs over time, and how far their numbers can be trusted."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.pictures.style import (
    NOTHING,
    SERIES,
    STYLE,
    captioned,
    new_figure,
    number,
    plot_sizes,
    quiet,
    visible,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike

# A quantity that changes by less than this share of its size counts as constant.
STILL = 1e-8


def watched_picture(
    times: ArrayLike,
    watched: Mapping[str, ArrayLike],
    units: Mapping[str, str] | None = None,
    labels: Mapping[str, Sequence[str]] | None = None,
    meanings: Mapping[str, str] | None = None,
    title: str = "",
    notes: Sequence[str] = (),
) -> Figure:
    """Each quantity against time in its own panel; parts of a vector share one panel.

    Parameters
    ----------
    times
        shape (m,), seconds.
    watched
        name -> values, shape (m,), (m, k) or (m, 3, 3).
    units
        name -> unit, written on the axis.
    labels
        name -> names of its components; numbers from 1, if not given.
    meanings
        name -> description in words; the name, if not given.
    notes
        lines for below the picture.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.

    Examples
    --------
    >>> figure = watched_picture([0, 1, 2], {"energy": [1.0, 1.0, 1.0]})
    >>> len(figure.axes)
    1
    """
    panels = {name: np.asarray(values, dtype=float) for name, values in watched.items()}
    columns = 1 if len(panels) <= 3 else 2
    rows = math.ceil(len(panels) / columns)
    figure = new_figure(8.6 if columns == 1 else 11.0, 1.1 + 2.2 * rows)
    first: Axes | None = None
    for place, (name, values) in enumerate(panels.items()):
        axes = figure.add_subplot(rows, columns, place + 1, sharex=first)
        first = first or axes
        heading = (meanings or {}).get(name, name.replace("_", " "))
        count = values[0].size if len(values) else 1
        parts = (labels or {}).get(name) or [str(k + 1) for k in range(count)]
        unit = (units or {}).get(name, "")
        _panel(axes, heading, np.asarray(times, dtype=float), values, unit, parts)
        if place < len(panels) - columns:
            axes.tick_params(labelbottom=False)
        else:
            axes.set_xlabel("$t$ / s")
    if title:
        figure.suptitle(title, fontsize=12)
    captioned(figure, notes)
    return figure


def _panel(
    axes: Axes, heading: str, times: np.ndarray, values: np.ndarray, unit: str, parts: Sequence[str]
) -> None:
    """One quantity; one that keeps its value is drawn on a scale that shows it so."""
    flat = values.reshape(len(values), -1)
    for part, stroke in zip(range(flat.shape[1]), SERIES * 2, strict=False):
        axes.plot(times[: len(flat)], flat[:, part], **stroke.line, label=parts[part])
    axes.set_title(heading, fontsize=10.5, loc="left")
    axes.set_ylabel(unit, fontsize=9)
    finite = flat[np.isfinite(flat)]
    size = float(np.abs(finite).max()) if finite.size else 0.0
    change = float(np.ptp(finite)) if finite.size else 0.0
    if flat.shape[1] == 1 and change <= STILL * size:
        value = float(finite[0])
        # An axis fitted to rounding would show it as large waves.
        half = 0.5 * abs(value) or 1.0
        axes.set_ylim(value - half, value + half)
        axes.text(
            0.99, 0.95, f"constant: {number(value)}", ha="right", va="top",
            transform=axes.transAxes, fontsize=9, color="#444444",
        )  # fmt: skip
    quiet(axes)
    axes.margins(x=0.01)
    axes.ticklabel_format(axis="y", useOffset=False, style="plain" if _plain(size) else "sci")
    if flat.shape[1] > 1:
        axes.legend(
            loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize=9,
            handlelength=2.6, ncols=1 if flat.shape[1] <= 4 else 3,
        )  # fmt: skip


def _plain(size: float) -> bool:
    return 1e-3 <= size < 1e5 or size == 0


def trust_picture(
    times: ArrayLike,
    drifts: Mapping[str, ArrayLike],
    error: float,
    asked: float,
    errors: ArrayLike | None = None,
    title: str = "",
    notes: Sequence[str] = (),
) -> Figure:
    """Drift of every quantity that should be constant, with the error and requested accuracy.

    Parameters
    ----------
    times
        shape (m,), seconds.
    drifts
        name -> change since the start, relative, shape (m,).
    error, asked
        largest error estimate, and requested accuracy, relative.
    errors
        error estimate over time, shape (m,), where it is known.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    clock = np.asarray(times, dtype=float)
    figure = new_figure(8.6, 4.8)
    axes: Axes = figure.add_subplot()
    drawn = False
    for (name, values), stroke in zip(drifts.items(), SERIES[1:] * 4, strict=False):
        label = f"drift of {name.replace('_', ' ')}"
        drawn |= plot_sizes(axes, clock, values, stroke.line, label)
    if errors is not None:
        shown = visible(errors)
        axes.plot(clock[: len(shown)], shown, **SERIES[0].line, label="error estimate")
    else:
        axes.axhline(
            max(error, NOTHING), color=SERIES[0].color, linewidth=1.6, label="error estimate"
        )
    axes.axhline(
        asked, color="#666b73", linestyle=(0, (1, 1.6)), linewidth=1.5,
        label=f"requested accuracy, {number(asked)}",
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
    captioned(figure, [*notes, *["Single zeros are drawn at the bottom, at 1e−17."] * drawn])
    return figure


def change_picture(
    times: ArrayLike,
    kept: Mapping[str, Mapping[str, ArrayLike]],
    title: str = "",
    notes: Sequence[str] = (),
) -> Figure:
    """Constants of motion from several equations of motion, each relative to its start.

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
    first: Axes | None = None
    for place, (quantity, laws) in enumerate(kept.items()):
        axes: Axes = figure.add_subplot(len(kept), 1, place + 1, sharex=first)
        first = first or axes
        largest = 0.0
        for (law, values), stroke in zip(laws.items(), SERIES * 2, strict=False):
            data = np.asarray(values, dtype=float)
            data = data.reshape(len(data), -1)
            size = float(np.linalg.norm(data[0])) or 1.0
            change = np.linalg.norm(data - data[0], axis=1) / size
            axes.plot(clock[: len(change)], change, **stroke.line, label=law)
            largest = max(largest, float(change.max()))
        if largest < STILL:
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


def sweep_picture(
    varied: Sequence[tuple[str, ArrayLike]],
    measured: tuple[str, ArrayLike],
    known: tuple[str, ArrayLike, ArrayLike] | None = None,
    title: str = "",
    notes: Sequence[str] = (),
) -> Figure:
    """One thing varied: points, and a known curve; two: a field of colours.

    Parameters
    ----------
    varied
        (name with unit, values): one of shape (m,), or two of shapes (m,) and (k,).
    measured
        (name with unit, values), shape (m,) or (m, k).
    known
        (name, x, y) of a curve to compare with, for one thing varied.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    figure = new_figure(7.6, 5.0)
    axes: Axes = figure.add_subplot()
    values = np.asarray(measured[1], dtype=float)
    if len(varied) == 1:
        name, places = varied[0][0], np.asarray(varied[0][1], dtype=float)
        if known is not None:
            label, x, y = known
            axes.plot(x, y, color=SERIES[1].color, linewidth=1.8, label=label)
        axes.plot(
            places, values, linestyle="", marker="o", markersize=6, color=SERIES[0].color,
            markeredgecolor="white", markeredgewidth=0.7, label="computed", zorder=4,
        )  # fmt: skip
        if known is not None:
            axes.legend(frameon=False, fontsize=10)
        _scaled(axes.set_xscale, places)
        _scaled(axes.set_yscale, values)
        axes.set_ylabel(measured[0])
        axes.grid(axis="both", which="major")
        quiet(axes)
    else:
        (name, first), (second_name, second) = varied
        # cividis reads the same with every colour vision and in grey.
        mesh = axes.pcolormesh(first, second, values.T, cmap="cividis", shading="nearest")
        figure.colorbar(mesh, ax=axes, label=measured[0])
        _scaled(axes.set_xscale, np.asarray(first, dtype=float))
        _scaled(axes.set_yscale, np.asarray(second, dtype=float))
        axes.set_ylabel(second_name)
    axes.set_xlabel(name)
    if title:
        axes.set_title(title, fontsize=12)
    captioned(figure, notes)
    return figure


def _scaled(setter: Callable[[str], object], values: np.ndarray) -> None:
    """A logarithmic axis where the values need one."""
    finite = values[np.isfinite(values)]
    if finite.size and finite.min() > 0 and finite.max() > STYLE.wide * finite.min():
        setter("log")
