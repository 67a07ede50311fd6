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

# Field and parity of a wave -> its mark.
MARKS = {
    ("gravity", "axial"): "o",
    ("gravity", "polar"): "x",
    ("scalar", "polar"): "^",
    ("scalar", ""): "^",
    ("Maxwell", ""): "s",
}


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
    kinds = dict.fromkeys((one.field, one.parity) for one in rings.modes)
    for number, (field, parity) in enumerate(kinds):
        own = [one.frequency for one in rings.modes if (one.field, one.parity) == (field, parity)]
        plane.plot(
            [w.real for w in own], [-w.imag for w in own], MARKS[field, parity],
            color=SERIES[number].color, label=_label(field, parity), markersize=7,
            fillstyle="none",
        )  # fmt: skip
    plane.set_xlabel("oscillation, real part of ω")
    plane.set_ylabel("damping, -imaginary part of ω")
    plane.margins(0.2)
    plane.set_ylim(bottom=0)
    plane.legend(frameon=False, fontsize=9, loc="lower center", bbox_to_anchor=(0.5, 1), ncols=3)
    slowest = max(rings.modes, key=lambda one: one.frequency.imag).frequency
    times = np.linspace(0, 5 / -slowest.imag, 600)
    wave.plot(times, np.exp(slowest.imag * times) * np.cos(slowest.real * times),
              color=SERIES[0].color)  # fmt: skip
    wave.set_xlabel("time")
    wave.set_title("least damped mode", fontsize=11)
    captioned(figure, [figure_text(checks.cut(str(rings).splitlines()[0]))])
    return figure


def _label(field: str, parity: str) -> str:
    return ", ".join(x for x in (f"{field} field" * (field != "gravity"), parity) if x)


def ringing_html(rings: Ringing) -> str:
    """Text and figure of the modes, for notebooks."""
    return pictured(str(rings), lambda: draw_ringing(rings))
