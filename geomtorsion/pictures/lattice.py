"""Lattice: an image of a lattice with a circuit, its amplitude, phases, strain and rotation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.materials.images import LatticeBurgers, LatticeImage, LatticePhases
from geomtorsion.pictures.style import SERIES, arrow, captioned, new_figure, number
from geomtorsion.support import checks

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# The circuit and the Burgers vector on grey and on colours.
CIRCUIT = SERIES[1].color


def draw_lattice(
    image: LatticeImage, phases: LatticePhases, b: LatticeBurgers | None = None
) -> Figure:
    """The image, amplitude, both phases, strain and rotation, with a circuit and its vector.

    Holes are grey. Strain and rotation count from the mean lattice.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    ArgumentError
        The argument is not an image, phases or a Burgers vector.
    """
    checks.instance(image, LatticeImage, "image")
    checks.instance(phases, LatticePhases, "phases")
    if b is not None:
        checks.instance(b, LatticeBurgers, "b")
    figure = new_figure(11.4, 7.6)
    panels = [figure.add_subplot(2, 3, k + 1) for k in range(6)]
    step, sizes = image.step, image.field.shape
    # Pixels are drawn about their coordinates.
    box = (-step / 2, step * (sizes[0] - 0.5), -step / 2, step * (sizes[1] - 0.5))

    def show(axes: Axes, values: np.ndarray, title: str, colours: str, bar: str = "", **look):
        shown = np.ma.masked_invalid(values.T)
        artist = axes.imshow(
            shown, origin="lower", extent=box, cmap=colours, interpolation="nearest", **look
        )
        axes.set_facecolor("#9aa0a6")
        axes.set_title(title, size=10.5)
        axes.tick_params(labelsize=8)
        if bar:
            figure.colorbar(artist, ax=axes, shrink=0.82, label=bar).ax.tick_params(labelsize=8)
        if b is not None:
            axes.plot(*(step * b.pixels.T), color=CIRCUIT, linewidth=1.6)

    show(panels[0], image.field, "image and circuit", "gray")
    seen = (phases.amplitude / phases.levels[:, None, None]).min(axis=0)
    show(panels[3], seen, "amplitude, the weaker of both", "viridis", "median = 1", vmin=0)
    for k in range(2):
        phase = np.where(phases.holes, np.nan, phases.phase[k])
        title = f"phase of spot {k + 1}"
        show(panels[1 + 3 * k], phase, title, "twilight", "radians", vmin=-np.pi, vmax=np.pi)
    for axes, values, title in (
        (panels[2], phases.strain[0, 0], r"strain $\epsilon_{xx}$"),
        (panels[5], phases.rotation, "rotation, in radians"),
    ):
        # Next to a core both grow without bound: a percentile keeps the rest visible.
        most = float(np.nanpercentile(np.abs(values), 98))
        show(axes, values, title, "RdBu_r", " ", vmin=-most, vmax=most)
    for k, axes in enumerate(panels):
        if k > 2:
            axes.set_xlabel(f"x / {image.unit}")
        if k % 3 == 0:
            axes.set_ylabel(f"y / {image.unit}")
    if b is not None:
        _vector(panels[0], b, step, step * min(sizes) / 8)
        parts = ", ".join(map(str, b.whole.tolist()))
        caption = (
            f"b = ({parts}) in lattice vectors, {number(round(b.magnitude, 4))} {b.unit} long; "
            f"chance that noise has changed it: {b.chance:.1g}. It is the integral of e along "
            f"the circuit, run {_sense(b.pixels)}; the arrow shows its direction, not its size. "
            "Grey: holes."
        )
        captioned(figure, [caption])
    return figure


def _vector(axes: Axes, b: LatticeBurgers, step: float, length: float) -> None:
    """The Burgers vector as an arrow of this length from the middle of its circuit."""
    if b.whole.any():
        middle = step * (b.pixels.min(axis=0) + b.pixels.max(axis=0)) / 2
        arrow(axes, middle, middle + b.vector / b.magnitude * length, CIRCUIT, 2.2)


def _sense(path: np.ndarray) -> str:
    """Sense of rotation of a path of pixels on the screen, from its signed area."""
    x, y = path.T
    area = float((x[:-1] * y[1:] - x[1:] * y[:-1]).sum())
    return "anticlockwise" if area > 0 else "clockwise" if area < 0 else "both ways"
