"""scene sweep: a measure of a motion against what was varied, with a known curve on top."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.pictures.style import SERIES, STYLE, captioned, new_figure, quiet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike


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
        (name, first), (other, second) = varied
        # cividis reads the same with every colour vision and in grey.
        mesh = axes.pcolormesh(first, second, values.T, cmap="cividis", shading="nearest")
        figure.colorbar(mesh, ax=axes, label=measured[0])
        _scaled(axes.set_xscale, np.asarray(first, dtype=float))
        _scaled(axes.set_yscale, np.asarray(second, dtype=float))
        axes.set_ylabel(other)
    axes.set_xlabel(name)
    if title:
        axes.set_title(title, fontsize=12)
    captioned(figure, notes)
    return figure


def _scaled(setter: Callable[[str], object], values: np.ndarray) -> None:
    """A logarithmic axis where the values ask for one."""
    finite = values[np.isfinite(values)]
    if finite.size and finite.min() > 0 and finite.max() > STYLE.wide * finite.min():
        setter("log")
