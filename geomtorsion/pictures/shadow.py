"""shadow: the edge of a shadow, and its image with sky, redshift and uncertain pixels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.curves import ShadowEdge, ShadowImage
from geomtorsion.errors import ArgumentError, StartError
from geomtorsion.pictures.style import SERIES, captioned, new_figure, pictured, quiet
from geomtorsion.support import checks

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Stripes of the sky on half a turn.
STRIPES = 6


def draw_shadow(found: ShadowEdge | ShadowImage) -> Figure:
    """Draw the edge of a shadow in the image plane, or an image with its redshift.

    The sky of an image has stripes of 30 degrees of the first angle of the frame; pixels whose end
    depends on the error are red.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    ArgumentError
        It is neither an edge nor an image of a shadow.
    MissingExtraError
        matplotlib is not installed.

    Examples
    --------
    >>> from geomtorsion.curves import ShadowEdge
    >>> angles = np.linspace(0, 6, 20)
    >>> edge = ShadowEdge(angles, np.full(20, 0.2), np.full(20, 1e-8))
    >>> draw_shadow(edge).axes[0].get_xlabel()
    'to the right, tangent'
    """
    if isinstance(found, ShadowEdge):
        figure = new_figure(4.6, 4.8)
        axes = figure.subplots()
        _draw_edge(axes, found)
    elif isinstance(found, ShadowImage):
        figure = new_figure(9.6, 4.8)
        left, right = figure.subplots(1, 2)
        _draw_sky(left, found)
        reach = np.tan(found.field / 2)
        shown = np.where(found.dark, np.nan, found.redshift)
        mesh = right.imshow(shown, extent=(-reach, reach, -reach, reach), cmap="cividis")
        right.set_title("1 + z of the sky", fontsize=11)
        figure.colorbar(mesh, ax=right, shrink=0.8).ax.tick_params(labelsize=8)
        _labelled(right)
        right.set_ylabel("")
        for axes in (left, right):
            axes.grid(visible=False)
    else:
        raise ArgumentError(
            f"found: expected the edge or an image of a shadow, got {checks.shown(found)}. Give "
            "gt.shadow(...).edge() or gt.shadow(...).image()."
        )
    captioned(figure, [repr(found)])
    return figure


def _draw_edge(axes: Axes, edge: ShadowEdge) -> None:
    """The edge as a closed line, the axis of the camera as a cross."""
    points = np.concatenate((edge.points, edge.points[:1]))
    axes.fill(*points.T, color="0.15")
    axes.plot(*points.T, **SERIES[0].line)
    axes.plot(0, 0, "+", color="white")
    axes.set_aspect("equal")
    _labelled(axes)


def _draw_sky(axes: Axes, image: ShadowImage) -> None:
    """Captured pixels black, the sky in stripes, uncertain pixels red."""
    shades = np.where(image.dark, 0.0, 0.85)
    try:
        stripes = np.floor(image.turns * STRIPES) % 2
        shades = np.where(image.dark, 0.0, 0.6 + 0.35 * np.nan_to_num(stripes))
    except StartError:
        # A frame without an angle has a plain sky.
        pass
    colours = np.repeat(shades[..., None], 3, axis=2)
    colours[image.undecided] = (0.8, 0.1, 0.1)
    reach = np.tan(image.field / 2)
    axes.imshow(colours, extent=(-reach, reach, -reach, reach), interpolation="nearest")
    axes.set_title("captured: black; sky: stripes of 30 degrees", fontsize=11)
    _labelled(axes)


def _labelled(axes: Axes) -> None:
    """The image plane, in tangents of angles from the axis."""
    axes.set_xlabel("to the right, tangent")
    axes.set_ylabel("upwards, tangent")
    quiet(axes)


def shadow_html(found: ShadowEdge | ShadowImage) -> str:
    """Text and figure, for notebooks."""
    return pictured(repr(found), lambda: draw_shadow(found))
