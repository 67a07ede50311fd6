"""degrees_of_freedom: numbers of free coefficients over the order, and the phase space they fit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.errors import ArgumentError
from geomtorsion.gravity.perturbed import DegreesOfFreedom
from geomtorsion.pictures.style import SERIES, captioned, new_figure
from geomtorsion.support import checks
from geomtorsion.support.outgoing import figure_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def draw_degrees_of_freedom(answer: DegreesOfFreedom) -> Figure:
    """Free coefficients less gauge over the order q, with the fitted polynomial, and differences.

    Filled markers are numbers that are the same with one order less. Hollow ones may fall with
    the order of the series.

    Parameters
    ----------
    answer
        The result of `gravity.perturbed.degrees_of_freedom`.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    ArgumentError
        The argument is another object.
    MissingExtraError
        matplotlib is not installed.
    """
    checks.instance(answer, DegreesOfFreedom, "answer", ArgumentError)
    figure = new_figure(8.0, 3.6)
    numbers, sizes = figure.subplots(1, 2)
    _draw(numbers, answer.reduced, answer.confirmed)
    n = answer.dimension
    _draw(sizes, answer.differences, max(answer.confirmed - n + 1, 0))
    if answer.place is not None:
        orders = np.arange(answer.place, len(answer.reduced))
        fit = answer.polynomial(orders.tolist())
        numbers.plot(orders, fit, color=SERIES[1].color, label="fitted polynomial")
        size = answer.differences[answer.place]
        sizes.axhline(size, color=SERIES[1].color, label=f"{size} functions of {n - 1} variables")
    # From zero, so that a change by one function is small.
    sizes.set_ylim(min(0, *answer.differences) - 1, max(answer.differences) + 1)
    numbers.set_ylabel("free coefficients less gauge")
    sizes.set_ylabel("phase space functions")
    for axes in (numbers, sizes):
        axes.set_xlabel("order q")
        axes.xaxis.get_major_locator().set_params(integer=True)
        axes.legend(frameon=False, fontsize=9, loc="best")
    count = "not settled" if answer.number is None else str(answer.number)
    title = f"L = {answer.lagrangian}, {n} dimensions: degrees of freedom: {count}"
    captioned(figure, [figure_text(checks.cut(title))])
    return figure


def _draw(axes: Axes, values: tuple[int, ...], confirmed: int) -> None:
    """Numbers over the order: the confirmed ones filled."""
    orders, color = np.arange(len(values)), SERIES[0].color
    draw = axes.plot
    draw(orders[:confirmed], values[:confirmed], "o", color=color, label="the same, one order less")
    if confirmed < len(values):
        draw(orders[confirmed:], values[confirmed:], "o", color=color, fillstyle="none",
             label="an upper bound")  # fmt: skip
