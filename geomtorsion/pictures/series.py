"""Series: densities and junctions of dislocation networks over time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.materials.lines import DislocationSeries
from geomtorsion.pictures.style import SERIES, new_figure
from geomtorsion.support import checks

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw_series(series: DislocationSeries, symmetry: str = "cubic", unit: str = "") -> Figure:
    """Density by family over time, and below it the junctions that exist, form and dissolve.

    Parameters
    ----------
    symmetry
        As for `DislocationNetwork.families`.
    unit
        Of lengths; without it the axes name the unit of the positions.

    Raises
    ------
    NetworkError
        Nodes have no positions, or there is no box.
    MissingExtraError
        matplotlib is not installed.
    """
    checks.instance(series, DislocationSeries, "series")
    figure = new_figure(8.0, 6.0)
    above, below = figure.subplots(2, 1, sharex=True)
    above.plot(series.times, series.density, color="#33383f", marker="o", ms=3, label="all lines")
    for k, (name, density) in enumerate(series.densities(symmetry).items()):
        above.plot(series.times, density, color=SERIES[k % len(SERIES)].color, label=f"b = {name}")
    above.set_ylabel(f"density [1/{unit or 'unit of the positions'}^2]")
    above.set_ylim(bottom=0)
    above.legend(fontsize=8)
    below.plot(series.times, series.junctions, color="#33383f", marker="o", ms=3, label="junctions")
    counts = list(series.reactions().values())
    times = np.asarray(series.times)
    middles = (times[1:] + times[:-1]) / 2
    for k, name in enumerate(("formed", "dissolved")):
        sums = np.sum([one[k] for one in counts], axis=0) if counts else np.zeros(len(middles))
        below.plot(middles, sums, color=SERIES[k].color, marker=".", ls="--", label=name)
    below.set_xlabel("time")
    below.set_ylabel("number")
    below.set_ylim(bottom=0)
    below.legend(fontsize=8)
    return figure
