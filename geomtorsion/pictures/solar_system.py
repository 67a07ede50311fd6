"""solar system: post-Newtonian numbers of a theory beside measurements."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import sympy

from geomtorsion.errors import ArgumentError
from geomtorsion.gravity.perturbed import PostNewtonian
from geomtorsion.gravity.perturbed.geometries import shown
from geomtorsion.gravity.perturbed.solar_system import CASSINI, MEASUREMENTS, STANDARD_ERRORS
from geomtorsion.pictures.formula import mathml
from geomtorsion.pictures.latex import latex_text
from geomtorsion.pictures.style import SERIES, captioned, mathematics, new_figure, visible
from geomtorsion.support import checks
from geomtorsion.support.outgoing import figure_text, html_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike

# Powers of ten that the axis of a wave number or a coupling spans without `over`.
NUMBERS, COUPLINGS = (-2, 2), (-2, 6)


def draw_post_newtonian(weak: PostNewtonian, over: ArrayLike | None = None) -> Figure:
    """gamma over the wave number or over a coupling, or gamma and beta beside measured values.

    over: positive values of the wave number, where a field has a mass, or of the one coupling that
    has no value.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    ArgumentError
        The argument is not the result of `post_newtonian`, more than one coupling has no value, or
        over is not a list of positive numbers.
    MissingExtraError
        matplotlib is not installed.
    """
    checks.instance(weak, PostNewtonian, "weak")
    gamma = weak.gamma_of_k
    wave = [x for x in gamma.free_symbols if x not in weak.couplings]
    free = sorted(gamma.free_symbols, key=str)
    if len(free) > 1:
        others = ", ".join(f"{x}=1" for x in free if x in weak.couplings)
        raise ArgumentError(
            f"plot: expected one symbol in gamma, got {', '.join(map(str, free))}. Give values: "
            f"subs({others})."
        )
    figure = new_figure(6.4, 4.2)
    axes = figure.add_subplot()
    if not free:
        _draw_tests(axes, weak)
    else:
        low, high = NUMBERS if wave else COUPLINGS
        values = np.geomspace(10.0**low, 10.0**high, 400) if over is None else _values(over)
        _draw_line(axes, gamma, values, is_wave=bool(wave))
    lines = str(weak).splitlines()
    captioned(figure, [figure_text(checks.cut(x)) for x in lines])
    return figure


def _values(over: ArrayLike) -> np.ndarray:
    values = checks.array(over, "over", ArgumentError, shape=(None,))
    if not (values > 0).all():
        checks.refuse(ArgumentError, "over", "positive numbers", over)
    return values


def _draw_line(axes: Axes, gamma: sympy.Expr, values: np.ndarray, *, is_wave: bool) -> None:
    """gamma over a wave number, or its distance from one over a coupling."""
    (symbol,) = gamma.free_symbols
    if is_wave:
        own = [float(gamma.xreplace({symbol: sympy.Float(x)})) for x in values]
        axes.semilogx(values, own, **SERIES[0].line)
        axes.axhline(1, label="general relativity", **SERIES[1].line)
        axes.set_xlabel("wave number k")
        axes.set_ylabel("γ(k)")
    else:
        own = [float((gamma - 1).xreplace({symbol: sympy.Float(x, 30)})) for x in values]
        axes.loglog(values, visible(own), **SERIES[0].line)
        low, high = (float(x - 1) for x in CASSINI.limits)
        for limit, words, stroke in (
            (low, "below: γ < 1 passes", SERIES[1]),
            (high, "below: γ > 1 passes", SERIES[2]),
        ):
            axes.axhline(abs(limit), label=f"Cassini, {words}", **stroke.line)
        axes.set_xlabel(mathematics(str(symbol)))
        axes.set_ylabel("|γ − 1|")
    axes.legend(frameon=False, fontsize=9)


def _draw_tests(axes: Axes, weak: PostNewtonian) -> None:
    """Predictions and measured intervals of two standard errors."""
    numbers = weak.numbers
    shown = [x for x in MEASUREMENTS if x.parameter in numbers and numbers[x.parameter].is_number]
    for row, one in enumerate(shown):
        value = float(numbers[one.parameter] - 1)
        unit = float(one.error)
        axes.errorbar(
            float(one.excess) / unit, row, xerr=STANDARD_ERRORS, fmt="o", capsize=4,
            color=SERIES[1].color, label="measured" if row == 0 else None,
        )  # fmt: skip
        axes.plot(value / unit, row, "D", color=SERIES[0].color, fillstyle="none", markersize=9,
                  label="predicted" if row == 0 else None)  # fmt: skip
    axes.set_yticks(range(len(shown)), [f"{x.parameter}\n{x.name}" for x in shown])
    axes.set_ylim(-0.6, len(shown) - 0.4)
    axes.set_xlabel("value minus 1, in standard errors of the measurement")
    axes.legend(frameon=False, fontsize=9)


def post_newtonian_html(weak: PostNewtonian) -> str:
    """Numbers as formulas, with the tests in the solar system, for notebooks.

    Examples
    --------
    >>> from geomtorsion.gravity import perturbed
    >>> post_newtonian_html(perturbed.post_newtonian("R/2", "riemannian")).count("passes")
    2
    """
    first, _, *tests = str(weak).splitlines()
    rows = [
        f"<tr><th>{html_text(name)}</th><td>{mathml(latex_text(shown(value)))}</td></tr>"
        for name, value in weak.numbers.items()
    ]
    lines = "".join(f"<p>{html_text(one)}</p>" for one in tests)
    return f"<div><p>{html_text(first)}</p><table>{''.join(rows)}</table>{lines}</div>"
