"""end maps: how motions end over two numbers of their start."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.ode import EndMap
from geomtorsion.pictures.style import SERIES, captioned, mathematics, new_figure, pictured, quiet
from geomtorsion.support import checks

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ON_THE_WAY, UNDECIDED = "0.92", "0.0"


def draw_ends(found: EndMap) -> Figure:
    """Draw a colour for each condition that ended a motion; uncertain ends are black.

    Motions on the way at the last time are light grey.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    ArgumentError
        It is not the result of `end_map`.
    MissingExtraError
        matplotlib is not installed.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> fall = gt.ODE.of({"z": "v", "v": "-10"}, [1, 0], events=[gt.When("z")])
    >>> ends = gt.end_map(fall, {"z": [1, 2], "v": [0, 1, 2]}, 0.5)
    >>> draw_ends(ends).axes[0].get_xlabel()
    '$z$'
    """
    checks.instance(found, EndMap, "found", expected="the result of gt.end_map")
    colours = [UNDECIDED, ON_THE_WAY]
    colours += [SERIES[k % len(SERIES)].color for k in range(len(found.conditions))]
    words = ["undecided", "on the way", *found.conditions]
    figure = new_figure(5.6, 5.2)
    # An extra: without matplotlib this module can still be imported.
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    axes = figure.subplots()
    axes.pcolormesh(
        found.first, found.second, found.fate, cmap=ListedColormap(colours), shading="nearest",
        vmin=-2.5, vmax=len(found.conditions) - 0.5, rasterized=True,
    )  # fmt: skip
    axes.set_xlabel(mathematics(found.names[0]))
    axes.set_ylabel(mathematics(found.names[1]), rotation=0, labelpad=14)
    quiet(axes)
    axes.grid(visible=False)
    patches = [
        Patch(color=colour, label=word)
        for k, (colour, word) in enumerate(zip(colours, words, strict=True), -2)
        if np.any(found.fate == k)
    ]
    # Conditions may be long, so that each has a line of its own.
    figure.legend(handles=patches, frameon=False, fontsize=9, loc="outside upper center")
    captioned(figure, [repr(found)])
    return figure


def ends_html(found: EndMap) -> str:
    """Text and figure, for notebooks."""
    return pictured(repr(found), lambda: draw_ends(found))
