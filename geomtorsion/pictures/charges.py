"""charges: mass inside a sphere over its radius, and charges and horizons in notebooks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.errors import ArgumentError, GravityError
from geomtorsion.gravity import Charge, Horizon
from geomtorsion.pictures.style import SERIES, captioned, new_figure
from geomtorsion.support import checks
from geomtorsion.support.outgoing import figure_text, html_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw_charge(
    charges: Charge | Sequence[Charge],
    parameters: Mapping[Any, Any] | None = None,
    radii: Sequence[float] = (2.0, 20.0),
    points: int = 200,
) -> Figure:
    """Charges inside a surface over the coordinate of its radius.

    Parameters
    ----------
    charges
        One closed form in the radius, or several, one line for each.
    parameters
        Numbers for the other symbols, {"M": 1}; names that a charge does not contain are skipped.
    radii
        First and last radius. Parts without a real value are left empty.
    points
        Number of points on each line.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    ArgumentError
        The argument is not a charge, a charge is a number, or radii are not two increasing numbers.
    GravityError
        A symbol has no number.
    MissingExtraError
        matplotlib is not installed.
    """
    several = [charges] if isinstance(charges, Charge) else checks.entries(charges, "charges")
    given = checks.by_name(parameters or {}, "parameters", ArgumentError)
    low, high = checks.numbers(radii, 2, "radii", ArgumentError)
    checks.count(points, "points", ArgumentError, 2)
    if not low < high:
        checks.refuse(ArgumentError, "radii", "a smaller and a larger number", radii)
    figure = new_figure(6.4, 4.0)
    axes = figure.subplots()
    places = np.linspace(low, high, points)
    for k, one in enumerate(several):
        checks.instance(one, Charge, "charges")
        if not one.is_exact:
            raise ArgumentError(
                f"charges: expected closed forms in {one.radius}, got the number {one.value:.6g}. "
                "Omit the value of the radius and of parameters in gravity.charge."
            )
        own = {name: x for name, x in given.items() if name in one.symbols}
        missing = sorted(one.symbols - {*own, one.radius.name})
        if missing:
            raise GravityError(
                f"parameters: expected a number for {missing[0]}, got none. Give "
                f"parameters={{'{missing[0]}': 1}}."
            )
        values = [_value(one, own, float(r)) for r in places]
        series = SERIES[k % len(SERIES)]
        axes.plot(places, values, color=series.color, label=f"{one.name}, {one.kind}")
    axes.set_xlabel(figure_text(str(several[0].radius)))
    axes.set_ylabel("charge inside")
    axes.legend(frameon=False, fontsize=9)
    captioned(figure, [figure_text(checks.cut(f"outside: {several[0].outside}"))])
    return figure


def _value(one: Charge, own: Mapping[str, Any], r: float) -> float:
    """The value at a radius; not a number where it is not real."""
    put = {**own, one.radius.name: r} if one.radius.name in one.symbols else own
    try:
        return one.at(put)
    except GravityError:
        return float("nan")


def charge_html(one: Charge) -> str:
    """Text of a charge, for notebooks."""
    return f"<pre>{html_text(str(one))}</pre>"


def horizon_html(one: Horizon) -> str:
    """Text of a horizon, for notebooks."""
    return f"<pre>{html_text(str(one))}</pre>"
