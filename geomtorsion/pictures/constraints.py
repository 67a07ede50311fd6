"""Constraints: sizes of both constraints of initial data on a plane of the grid."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.errors import GridError
from geomtorsion.gravity import SampledConstraints
from geomtorsion.pictures.style import STYLE, captioned, new_figure
from geomtorsion.support import checks

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw_constraints(
    result: SampledConstraints,
    plane: Sequence[int] = (0, 1),
    at: Mapping[Any, Any] | None = None,
) -> Figure:
    """Sizes of the Hamiltonian and the momentum constraint on a plane of nodes, powers of ten.

    Parameters
    ----------
    plane
        The two axes of the plane.
    at
        Coordinates of the plane on the other axes, by name; the default is their middle. The
        nearest nodes are drawn. Unknown nodes and exact zeros are left empty.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    ArgumentError
        The argument is not a result of `constraints` on a grid.
    GridError
        The plane or a name does not exist.
    MissingExtraError
        matplotlib is not installed.
    """
    checks.instance(result, SampledConstraints, "result")
    frame = result.frame
    d, names = frame.dimension, frame.names
    entries = checks.entries(plane, "plane", GridError)
    pair = [checks.count(x, "plane", GridError, 0, d - 1) for x in entries]
    if len(pair) != 2 or pair[0] == pair[1]:
        raise GridError(f"plane: expected two different axes, got {checks.shown(plane)}.")
    given = checks.by_name(at or {}, "at", GridError)
    for name in given:
        checks.known_name(name, names, "at", GridError)
    index: list[Any] = [slice(None)] * d
    layer = []
    for k in (k for k in range(d) if k not in pair):
        axis = np.asarray(frame.axes[k])
        place = checks.number(given.get(names[k], (axis[0] + axis[-1]) / 2), "at", GridError)
        index[k] = int(np.abs(axis - float(place)).argmin())
        layer.append(f"{names[k]} = {axis[index[k]]:.4g}")
    figure = new_figure(2 * STYLE.panel + 1.6, STYLE.panel + 1.0)
    one, two = (np.asarray(frame.axes[k]) for k in pair)
    unit = f" / {frame.unit}" if frame.unit else ""
    titles = {"hamiltonian": "|H|", "momentum": "|M|"}
    for number, (name, residual) in enumerate(result.residuals.items()):
        section = residual.size[tuple(index)]
        values = section if pair[0] < pair[1] else section.T
        with np.errstate(divide="ignore"):
            logarithm = np.log10(np.where(values > 0, values, np.nan))
        axes = figure.add_subplot(1, 2, number + 1)
        mesh = axes.pcolormesh(
            one, two, np.ma.masked_invalid(logarithm).T, shading="nearest", rasterized=True
        )
        figure.colorbar(mesh, ax=axes, shrink=0.86).ax.tick_params(labelsize=8)
        axes.set_xlabel(f"{names[pair[0]]}{unit}")
        axes.set_ylabel(f"{names[pair[1]]}{unit}")
        axes.set_aspect("equal")
        size = f" in {residual.unit}" if residual.unit else ""
        axes.set_title(f"log10 {titles[name]}{size}", fontsize=11)
    place = ", ".join(layer)
    captioned(figure, [*([f"plane {place}"] if place else []), *repr(result).splitlines()[1:]])
    return figure
