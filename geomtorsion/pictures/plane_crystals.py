"""Plane crystals: atoms coloured by grain, and dislocations with their Burgers vectors."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.materials.crystals import PlaneCrystal
from geomtorsion.pictures.network import CIRCUIT
from geomtorsion.pictures.style import FAINT, SERIES, arrow, captioned, new_figure, number
from geomtorsion.support import checks
from geomtorsion.support.outgoing import count_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw_plane_crystal(crystal: PlaneCrystal, unit: str = "") -> Figure:
    """Atoms in a plane, coloured by grain, and their dislocations with b as arrows.

    Parameters
    ----------
    unit
        Of the positions; without it the axes name the unit of the positions.

    Returns
    -------
    A matplotlib figure. Its legend names the lattice and the direction of the largest grains, and
    its caption the scale of the arrows.

    Raises
    ------
    CrystalError
        The atoms have no lattice.
    MissingExtraError
        matplotlib is not installed.

    Examples
    --------
    >>> import numpy as np
    >>> import geomtorsion as gt
    >>> x, y = (np.mgrid[-8:9, -8:9] + 0.5).reshape(2, -1)
    >>> slip = np.arctan2(y, x) / (2 * np.pi)
    >>> crystal = gt.crystals.Crystal(np.column_stack([x + slip, y]))
    >>> draw_plane_crystal(crystal, "nm").axes[0].get_xlabel()
    'x (nm)'
    """
    checks.instance(crystal, PlaneCrystal, "crystal")
    points = crystal.dislocations()
    figure = new_figure(7.6, 7.4)
    axes = figure.subplots()
    # So many atoms in a picture are small, few are large.
    size = float(np.clip(160 / np.sqrt(crystal.count), 0.8, 6.0))
    for k, grain in enumerate(crystal.grains):
        places, mark = crystal.positions[grain.atoms], SERIES[k % len(SERIES)]
        label = ""
        if k < len(SERIES):
            label = f"grain {grain.number}: {grain.lattice}, {number(round(grain.angle, 2))}°"
        axes.plot(*places.T, "o", color=mark.color, markersize=size, mew=0, alpha=0.55, label=label)
    if crystal.cell is not None:
        corners = np.array([(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)]) @ crystal.cell
        axes.plot(*corners.T, color=FAINT, linewidth=0.9)
    scale = _scale(crystal)
    for point in points:
        start = np.array(point.position)
        arrow(axes, start, start + scale * np.array(point.burgers), CIRCUIT, 1.6)
    if points:
        middles = np.array([point.position for point in points]).T
        axes.plot(*middles, "o", color=CIRCUIT, markersize=size, label="dislocation with b")
    axes.set_aspect("equal")
    axes.set_xlabel(f"x ({unit or 'unit of the positions'})")
    axes.set_ylabel(f"y ({unit or 'unit of the positions'})")
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="outside upper center", ncols=2, frameon=False, fontsize=9,
        markerscale=5 / size,
    )  # fmt: skip
    grains = len(crystal.grains)
    more = f" The legend has {len(SERIES)} of them." if grains > len(SERIES) else ""
    lengths = f" Arrows: b, drawn {number(scale)} times as long." if points else ""
    units = f" {unit}" if unit else ""
    counts = ((crystal.count, "atom"), (grains, "grain"), (len(points), "dislocation"))
    text = ", ".join(count_text(*one) for one in counts)
    lattice = f"{crystal.lattice}, a = {crystal.constant:.4g}{units}"
    captioned(figure, [f"{text}; {lattice}.{more}{lengths}"])
    return figure


def _scale(crystal: PlaneCrystal) -> float:
    """A whole number by which arrows are longer than b, so that they show among many atoms."""
    extent = float(np.ptp(crystal.positions, axis=0).max())
    return float(max(1, round(extent / (12 * crystal.constant))))
