"""attitude: the axes of a turning body, traced on the unit sphere of space."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from geomtorsion.pictures.sphere import curve_on, globe, numbered, space_axes, towards
from geomtorsion.pictures.style import SERIES, caption, captioned, legend, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from geomtorsion.pictures.pair import Pair

NAMES = ("first axis of the body, 1", "second axis, 2", "third axis, 3")


def attitude_picture(pair: Pair) -> Figure:
    """Two globes side by side: where the body's axes point, as it turns by each of the curves.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    figure = new_figure(9.2, 5.4)
    embedding = pair.embedding
    assert embedding is not None
    first = None
    turns = {
        name: embedding.attitudes(points, pair.parameters)
        for name, points in pair.coordinates.items()
    }
    facing = towards([turn[:, :, axis] for turn in turns.values() for axis in range(3)])
    for k, (name, turn) in enumerate(turns.items()):
        axes: Any = figure.add_subplot(1, 2, k + 1, projection="3d")
        first = first or axes
        viewer = globe(axes, 1.0, facing)
        space_axes(axes, 1.0, viewer)
        for axis, stroke in enumerate(SERIES[:3]):
            curve_on(axes, turn[:, :, axis], viewer, stroke, NAMES[axis])
            # Where a curve goes round often its dashes fill up: the number stays legible.
            numbered(axes, turn[0, :, axis], viewer, str(axis + 1), stroke)
        axes.set_title(name, fontsize=11)
    legend(figure, first)
    lines = caption(pair)
    captioned(figure, [*lines, "Dots: start; pale: behind the globe; x, y, z are fixed in space."])
    return figure
