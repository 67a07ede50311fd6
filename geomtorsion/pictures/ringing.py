"""ringing: the modes of a hole in the plane of frequencies, and its sound."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.gravity.perturbed import Ringing
from geomtorsion.pictures.style import SERIES, captioned, new_figure, pictured
from geomtorsion.support import checks
from geomtorsion.support.outgoing import figure_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MARKS = {"axial": "o", "polar": "x", "": "o"}


def draw_ringing(rings: Ringing) -> Figure:
    """Frequencies of the modes, and the wave of the mode that is damped least.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    ArgumentError
        The argument is not the result of `ringing`.
    MissingExtraError
        matplotlib is not installed.
    """
    checks.instance(rings, Ringing, "rings")
    figure = new_figure(9.2, 3.8)
    plane, wave = figure.subplots(1, 2)
    for number, parity in enumerate(dict.fromkeys(one.parity for one in rings.modes)):
        own = [one.frequency for one in rings.modes if one.parity == parity]
        plane.plot(
            [w.real for w in own], [-w.imag for w in own], MARKS[parity],
            color=SERIES[number].color, label=parity or None, markersize=7, fillstyle="none",
        )  # fmt: skip
    plane.set_xlabel("oscillation, real part of ω")
    plane.set_ylabel("damping, -imaginary part of ω")
    plane.margins(0.2)
    plane.set_ylim(bottom=0)
    if any(one.parity for one in rings.modes):
        plane.legend(
            frameon=False, fontsize=9, loc="lower center", bbox_to_anchor=(0.5, 1), ncols=2
        )
    slowest = max(rings.modes, key=lambda one: one.frequency.imag).frequency
    times = np.linspace(0, 5 / -slowest.imag, 600)
    wave.plot(times, np.exp(slowest.imag * times) * np.cos(slowest.real * times),
              color=SERIES[0].color)  # fmt: skip
    wave.set_xlabel("time")
    wave.set_title("least damped mode", fontsize=11)
    captioned(figure, [figure_text(checks.cut(str(rings).splitlines()[0]))])
    return figure


def ringing_html(rings: Ringing) -> str:
    """Text and figure of the modes, for notebooks."""
    return pictured(str(rings), lambda: draw_ringing(rings))
