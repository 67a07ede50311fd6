"""orientations: Burgers vectors of an orientation map, and its grains with a circuit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.orientations import Circuit, CircuitMap, MapBurgers, OrientationMap
from geomtorsion.pictures.style import FAINT, arrow, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Colours of circuit and arrow, as for all loops (Okabe and Ito).
PATH, GAP = "#0072B2", "#D55E00"


def draw_orientations(crystal: OrientationMap, found: CircuitMap) -> Figure:
    """|b| per area of all squares of a size, and how many times its noise that is.

    White: circuits that would cross a boundary, or start where nothing is known.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    figure = new_figure(*_size(crystal, 2))
    middle = found.size / 2
    density = _axes(figure, 121, crystal)
    _mesh(density, crystal, found.per_area, middle, "viridis", "log", f"1/{crystal.unit}")
    side = found.size * crystal.steps[0]
    density.set_title(f"|b| per area, squares of {side:g} {crystal.unit}", fontsize=11)
    ratio = _axes(figure, 122, crystal)
    # Noise alone gives three components of length one.
    shares = found.significance / np.sqrt(3)
    _mesh(ratio, crystal, shares, middle, "magma", "linear", "times its noise")
    floor = np.nanmedian(found.floor) if found.clean.any() else np.nan
    ratio.set_title(f"significance; noise {floor:.2g} 1/{crystal.unit}", fontsize=11)
    return figure


def draw_grains(crystal: OrientationMap, b: MapBurgers | None = None) -> Figure:
    """Grains in colours, with a circuit and the part of its Burgers vector in the plane.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    figure = new_figure(*_size(crystal, 1))
    axes = _axes(figure, 111, crystal)
    # Multiples of the golden section: numbers that follow each other get distant colours.
    hue = crystal.grain * (5**0.5 - 1) / 2 % 1
    colours = np.where(crystal.grain < 0, np.nan, hue)
    corners = _corners(crystal, colours.shape, 0.0)
    mesh = axes.pcolormesh(*corners, colours, cmap="twilight", alpha=0.5, vmin=0, vmax=1)
    mesh.set_rasterized(True)
    _draw_boundaries(axes, crystal)
    count = crystal.grains.count
    title = f"{count} grain{'s' * (count != 1)} at {crystal.threshold:g} degrees"
    if b is not None:
        _draw_circuit(axes, crystal, b.circuit)
        plane = b.specimen[:2]
        centre = _places(crystal, b.circuit.pixels).mean(axis=0)
        reach = np.sqrt(abs(b.area))
        if np.linalg.norm(plane) > b.sigma:
            # Only its direction: on the scale of the map its length would not be seen.
            half = plane / np.linalg.norm(plane) * reach / 2
            arrow(axes, centre - half, centre + half, GAP, 2.4)
        title += f"\n|b| = {b.size:.3g} ± {b.sigma:.1g} {b.unit} in grain {b.grain}"
        if b.size <= b.sigma:
            title += " (no more than noise)"
    axes.set_title(title, fontsize=11)
    return figure


def _size(crystal: OrientationMap, panels: int) -> tuple[float, float]:
    """Width and height in inches of so many panels side by side."""
    rows, columns = crystal.shape
    shape = rows * crystal.steps[1] / (columns * crystal.steps[0])
    return 5.2 * panels, float(np.clip(4.2 * shape, 2.2, 7)) + 1.0


def _axes(figure: Figure, place: int, crystal: OrientationMap) -> Axes:
    """Axes with y downwards, as such maps are shown."""
    axes = figure.add_subplot(place)
    axes.set_aspect("equal")
    axes.set_facecolor("white")
    axes.set_xlabel(f"x / {crystal.unit}")
    axes.set_ylabel(f"y / {crystal.unit}")
    rows, columns = crystal.shape
    dx, dy = crystal.steps
    axes.set_xlim(-dx / 2, (columns - 0.5 + abs(crystal.shift)) * dx)
    axes.set_ylim((rows - 0.5) * dy, -dy / 2)
    axes.spines[["top", "right"]].set_color(FAINT)
    return axes


def _corners(
    crystal: OrientationMap, shape: tuple[int, ...], middle: float
) -> tuple[np.ndarray, np.ndarray]:
    """x and y of the corners of pixels whose numbers are shifted by a part of a circuit."""
    x = (np.arange(shape[1] + 1) - 0.5 + middle) * crystal.steps[0]
    return x, (np.arange(shape[0] + 1) - 0.5 + middle) * crystal.steps[1]


def _mesh(
    axes: Axes,
    crystal: OrientationMap,
    values: np.ndarray,
    middle: float,
    colours: str,
    scale: str,
    label: str,
) -> None:
    """A map of numbers, each at the middle of its circuit, with its scale."""
    from matplotlib.colors import LogNorm, Normalize  # only who draws needs the extra

    seen = values[np.isfinite(values)]
    positive = seen[seen > 0]
    norm: Normalize | None = Normalize(0, np.quantile(seen, 0.995)) if len(seen) else None
    if scale == "log" and len(positive):
        low, high = np.quantile(positive, [0.01, 0.995])
        norm = LogNorm(low, high) if high > 1.5 * low else Normalize(0, 1.2 * high)
    shown = np.where(np.isfinite(values), values, np.nan)
    corners = _corners(crystal, values.shape, middle)
    mesh = axes.pcolormesh(*corners, shown, cmap=colours, norm=norm)
    mesh.set_rasterized(True)
    bar = axes.figure.colorbar(mesh, ax=axes, shrink=0.86)
    bar.set_label(label)
    bar.ax.tick_params(labelsize=8)


def _places(crystal: OrientationMap, pixels: np.ndarray) -> np.ndarray:
    """x and y of pixels, shape (k, 2)."""
    rows, columns = pixels.T
    x = (columns + crystal.shift * (rows % 2)) * crystal.steps[0]
    return np.stack([x, rows * crystal.steps[1]], axis=1)


def _draw_circuit(axes: Axes, crystal: OrientationMap, circuit: Circuit) -> None:
    """Each step as a line."""
    from matplotlib.collections import LineCollection  # only who draws needs the extra

    ends = [_places(crystal, pixels) for pixels in (circuit.starts, circuit.ends)]
    steps = list(np.stack(ends, axis=1))
    axes.add_collection(LineCollection(steps, colors=PATH, linewidths=2, capstyle="projecting"))


def _draw_boundaries(axes: Axes, crystal: OrientationMap) -> None:
    """Lines between pixels that no circuit joins."""
    from matplotlib.collections import LineCollection  # only who draws needs the extra

    dx, dy = crystal.steps
    sides = []
    for joined, way, half in (
        (crystal.grains.right, (0, 1), (0, dy / 2)),
        (crystal.grains.down, (1, 0), (dx / 2, 0)),
    ):
        pixels = np.argwhere(~joined)
        middle = (_places(crystal, pixels) + _places(crystal, pixels + np.array(way))) / 2
        sides.append(np.stack([middle - half, middle + half], axis=1))
    lines = LineCollection(list(np.concatenate(sides)), colors="#444444", linewidths=0.5)
    lines.set_rasterized(True)
    axes.add_collection(lines)
