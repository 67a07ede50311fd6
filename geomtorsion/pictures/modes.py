"""modes: speeds of waves and other numbers on a cosmos over time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from geomtorsion.gravity.perturbed import Evolution
from geomtorsion.pictures.style import SERIES, captioned, new_figure
from geomtorsion.support import checks
from geomtorsion.support.outgoing import figure_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Numbers of one axis, and how they are written.
SPEEDS = {"speed2": "speed$^2$"}
OTHERS = {
    "kinetic": "kinetic factor",
    "alpha_M": "$\\alpha_M$",
    "alpha_T": "$\\alpha_T$",
    "G": "G",
    "slip": "Φ/Ψ",
    "friedmann": "left side of the Friedmann equation",
}


def draw_evolution(evolution: Evolution) -> Figure:
    """The numbers of waves over time, the squared speed in an axis of its own.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    ArgumentError
        The argument is not the result of `over_time`.
    MissingExtraError
        matplotlib is not installed.
    """
    checks.instance(evolution, Evolution, "evolution")
    groups = [
        {name: label for name, label in one.items() if name in evolution.values}
        for one in (SPEEDS, OTHERS)
    ]
    groups = [one for one in groups if one]
    figure = new_figure(6.8, 1.2 + 2.2 * len(groups))
    axes = figure.subplots(len(groups), 1, sharex=True, squeeze=False)[:, 0]
    for place, (own, labels) in enumerate(zip(axes, groups, strict=True)):
        for number, (name, label) in enumerate(labels.items()):
            stroke = SERIES[(number + place) % len(SERIES)]
            own.plot(evolution.times, evolution.values[name], label=label, **stroke.line)
        if "speed2" in labels:
            own.axhline(1, color="0.6", linewidth=1, zorder=0)
        own.legend(frameon=False, fontsize=9, loc="center left", bbox_to_anchor=(1, 0.5))
    axes[-1].set_xlabel("time t")
    captioned(figure, [figure_text(checks.cut(str(evolution).splitlines()[0]))])
    return figure
