"""Cones: the directions of the angular velocity in the body roll on its directions in space."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.pictures.sphere import curve_on, globe, space_axes, towards
from geomtorsion.pictures.style import SERIES, captioned, legend, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d import Axes3D
    from numpy.typing import ArrayLike


def rolling_picture(
    omega: ArrayLike, matrices: ArrayLike, title: str = "", notes: Sequence[str] = ()
) -> Figure:
    """The cone of the body, as it is at the start, on the cone of space.

    Each cone is swept by the axis of rotation: seen from the body, and seen from space. They touch
    along the axis of rotation, and one rolls on the other without slipping (Poinsot).

    Parameters
    ----------
    omega
        angular velocity, body axes, shape (m, 3).
    matrices
        rotations from body to space, shape (m, 3, 3).

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    spin, turn = np.asarray(omega, dtype=float), np.asarray(matrices, dtype=float)
    sizes = np.linalg.norm(spin, axis=1)
    # A body at rest has no axis of rotation.
    moving = sizes > 0
    axis = spin[moving] / sizes[moving, None]
    body = axis @ turn[moving][0].T
    space = np.einsum("mij,mj->mi", turn[moving], axis)
    figure = new_figure(6.6, 6.4)
    axes: Axes3D = figure.add_subplot(projection="3d")
    viewer = globe(axes, 1.0, towards([body, space]))
    space_axes(axes, 1.0, viewer)
    cones = (
        ("cone of space", space, SERIES[1]),
        ("cone of the body", body, SERIES[0]),
    )
    for name, rim, stroke in cones:
        _draw_cone(axes, rim, stroke.color)
        curve_on(axes, rim, viewer, stroke, name)
    axes.plot(*np.array([np.zeros(3), 1.12 * space[0]]).T, color=SERIES[3].color, linewidth=2.2,
              label="axis of rotation")  # fmt: skip
    if title:
        axes.set_title(title, fontsize=12)
    legend(figure, axes, columns=3)
    lines = ["At the start. The cones touch along the axis of rotation; the body's cone rolls on"]
    lines.append("the cone of space without slipping. x, y, z are fixed in space.")
    captioned(figure, [*notes, *lines])
    return figure


def _draw_cone(axes: Axes3D, rim: np.ndarray, color: str) -> None:
    """The surface from the centre to a curve on the globe, transparent."""
    # A caller with axes has matplotlib.
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    few = rim[: _first_turn(rim)]
    sides = np.stack([np.zeros_like(few[1:]), few[:-1], few[1:]], axis=1)
    axes.add_collection3d(Poly3DCollection(sides, facecolor=color, alpha=0.16, linewidth=0))


def _first_turn(rim: np.ndarray) -> int:
    """How many points a curve has until it has encircled its mean direction once."""
    mean = rim.mean(axis=0)
    first = np.cross(mean, np.eye(3)[np.abs(mean).argmin()])
    second = np.cross(mean, first)
    size = np.linalg.norm(mean) or 1.0
    angle = np.unwrap(np.arctan2(size * (rim @ first), rim @ second))
    beyond = np.flatnonzero(np.abs(angle - angle[0]) > 2 * np.pi)
    return int(beyond[0]) + 1 if len(beyond) else len(rim)
