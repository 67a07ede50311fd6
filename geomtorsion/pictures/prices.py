"""prices: the three prices of a result, of its digits, its certainty and its effects."""

from __future__ import annotations

from typing import TYPE_CHECKING

from geomtorsion.geometry import notation
from geomtorsion.pictures.style import (
    NOTHING,
    SERIES,
    captioned,
    legend,
    new_figure,
    pictured,
    quiet,
)
from geomtorsion.prices import PriceList, PriceRow
from geomtorsion.support import checks
from geomtorsion.support.outgoing import duration_text, figure_text, html_text, size_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def draw_price(price: PriceList) -> Figure:
    """Cost of digits, of certainty and of effects, as far as it was measured.

    Digits: time against true error, lower and further right is better; for measured data, error
    against spacing with the noise floor. Certainty: times of the plain run, of the run with its
    error estimate, and of proofs. Effects: time of a scene with its effects added one by one.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.

    Examples
    --------
    >>> from geomtorsion.loops import Loop
    >>> from geomtorsion.prices import price
    >>> figure = draw_price(price("so3", Loop.circle([0.3, 1, 0.2], 0.1), proofs=[10]))
    >>> [axes.get_title() for axes in figure.axes]
    ['Digits', 'Certainty']
    """
    checks.instance(price, PriceList, "price")
    certain = _certainties(price)
    bars = [("Certainty", certain)] if len(certain) > 1 else []
    if price.effects:
        names = [f"{'+ ' * (k > 0)}{name}" for k, (name, _) in enumerate(price.effects)]
        times = [seconds for _, seconds in price.effects]
        bars.append(("Effects, one by one", list(zip(names, times, strict=True))))
    figure = new_figure(5.6 + 4.6 * len(bars), 4.2)
    panels = figure.subplots(1, 1 + len(bars), squeeze=False)[0]
    if price.unit == "spacing":
        _draw_spacing(panels[0], price)
    else:
        _draw_digits(panels[0], price)
    if panels[0].get_lines():
        legend(figure, panels[0])
    for axes, (title, values) in zip(panels[1:], bars, strict=True):
        _draw_bars(axes, title, values)
    captioned(figure, [figure_text(price.name), f"True errors against {price.truth}."])
    return figure


def _measured(price: PriceList) -> list[PriceRow]:
    return [row for row in price.rows if row.measured]


def _certainties(price: PriceList) -> list[tuple[str, float]]:
    """Names and seconds of the finest run of the best way: plain, with estimate, proved."""
    rows = _measured(price)
    if not rows or price.unit != "accuracy":
        return []
    best = price.of()[-1]
    plain = price.plain(best)
    shown = [] if plain is None else [("plain", plain)]
    if best.certainty == "estimate":
        shown.append(("with error estimate", best))
    shown += [
        (f"proof, {size_text(row.requested, 0)}", row) for row in rows if row.certainty == "proof"
    ]
    return [(name, row.seconds) for name, row in shown]


def _draw_digits(axes: Axes, price: PriceList) -> None:
    """Time against true error of each way without proofs."""
    rows = [row for row in _measured(price) if row.certainty != "proof"] or _measured(price)
    for number, way in enumerate(dict.fromkeys(row.way for row in rows)):
        stroke = SERIES[number % len(SERIES)]
        own = [row for row in rows if row.way == way]
        errors = [_error(row) for row in own]
        axes.plot(
            errors, [1e3 * (row.seconds) for row in own], **stroke.line,
            marker=stroke.end, markersize=5, label=figure_text(way),
        )  # fmt: skip
    axes.set_xscale("log")
    axes.set_yscale("log")
    # Better is further right, as in work-precision diagrams of the field.
    axes.invert_xaxis()
    _label(axes, "Digits", "true error, relative", "time in ms")


def _error(row: PriceRow) -> float:
    """The true error where it is known, otherwise the requested one, above zero."""
    shown = row.true.high if row.true is not None else row.claimed or row.requested
    return max(shown, NOTHING) if row.certainty != "proof" else max(row.requested, 1e-300)


def _draw_spacing(axes: Axes, price: PriceList) -> None:
    """Error against spacing, and the noise that no spacing goes below."""
    rows = _measured(price)
    spacings = [row.requested for row in rows]
    claimed = [max(row.claimed or 0.0, NOTHING) for row in rows]
    true = [_error(row) for row in rows]
    for stroke, values, label in zip(
        SERIES, (claimed, true), ("claimed", "upper bound of the true error"), strict=False
    ):
        axes.plot(spacings, values, **stroke.line, marker=stroke.end, label=label)
    if price.floor:
        axes.axhline(price.floor, color=SERIES[3].color, linestyle=":", label="noise floor")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.invert_xaxis()
    _label(axes, "Digits", "spacing", "error, relative")


def _draw_bars(axes: Axes, title: str, values: Sequence[tuple[str, float]]) -> None:
    """One bar for each name, with its time."""
    names = [figure_text(name) for name, _ in values]
    times = [1e3 * seconds for _, seconds in values]
    places = range(len(values))
    axes.barh(places, times, color=SERIES[0].color, height=0.55)
    for place, (_, seconds) in zip(places, values, strict=True):
        axes.annotate(
            duration_text(seconds), (1e3 * seconds, place), (4, 0), textcoords="offset points",
            va="center", fontsize=8,
        )  # fmt: skip
    axes.set_yticks(list(places), names)
    axes.invert_yaxis()
    if min(times) > 0 and max(times) > 30 * min(times):
        axes.set_xscale("log")
    axes.margins(x=0.25)
    _label(axes, title, "time in ms", "")


def _label(axes: Axes, title: str, x: str, y: str) -> None:
    axes.set_title(title, fontsize=11)
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.grid(axis="both", which="major")
    quiet(axes)


def price_html(price: PriceList) -> str:
    """The figure and the table of a price list.

    Examples
    --------
    >>> from geomtorsion.loops import Loop
    >>> from geomtorsion.prices import price
    >>> table = price("so3", Loop.circle([0.3, 1, 0.2], 0.1), [1e-9], proofs=[])
    >>> price_html(table).count("<tr>")
    4
    """
    head, *rows = price.table
    table = notation.html_table(head, rows, price.recommendation)
    drawn = pictured(price.name, lambda: draw_price(price))
    return f"<div>{drawn}<p>true errors against {html_text(price.truth)}</p>{table}</div>"
