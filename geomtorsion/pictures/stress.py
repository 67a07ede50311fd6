"""Stress: a section through the stress of a torsion, with the lines that make it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.errors import GridError
from geomtorsion.materials.elasticity import Stresses
from geomtorsion.materials.lines import DislocationNetwork
from geomtorsion.pictures.loops import START
from geomtorsion.pictures.style import STYLE, captioned, new_figure, pictured
from geomtorsion.support import checks
from geomtorsion.support.outgoing import measured_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

NAMES = "xyz"
COMPONENTS = ("mises", *(a + b for a in NAMES for b in NAMES))


def draw_stress(
    result: Stresses,
    component: str = "mises",
    plane: str | Sequence[int] = "xy",
    layer: int | None = None,
) -> Figure:
    """One component of the stress in a layer of nodes, and the dislocation lines there.

    Lines in the layer are drawn as lines, lines that cross it as dots.

    Parameters
    ----------
    component
        "xx", "yy", "zz", "yz", "xz", "xy", or "mises" for von Mises' stress.
    plane
        The two edges of the cell that span the layer: "xy", "xz", "yz", or numbers of axes.
    layer
        Number of the layer; without it the layer with the largest value.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    ArgumentError
        The argument is not a stress.
    GridError
        The component, the plane or the layer does not exist.
    MissingExtraError
        matplotlib is not installed.
    """
    checks.instance(result, Stresses, "result")
    one, two, normal = _plane(plane)
    values = _values(result, component)
    ordered = values.transpose(one, two, normal)
    if layer is None:
        layer = int(np.abs(ordered).max(axis=(0, 1)).argmax())
    chosen = checks.count(layer, "layer", GridError, 0, ordered.shape[2] - 1)
    section = ordered[:, :, chosen]
    points = result.cell.points().transpose(0, one + 1, two + 1, normal + 1)[..., chosen]
    x, y = points[one], points[two]
    sides = np.ptp(x), np.ptp(y)
    ratio = float(np.clip(sides[0] / sides[1], 1 / STYLE.broad, STYLE.broad)) if sides[1] else 1.0
    figure = new_figure(STYLE.panel * ratio + 1.6, STYLE.panel + 1.2)
    axes = figure.add_subplot()
    signed = component != "mises"
    top = float(np.percentile(np.abs(section), STYLE.spanned)) or 1.0
    mesh = axes.pcolormesh(
        x, y, section, shading="nearest", rasterized=True, vmin=-top if signed else 0.0, vmax=top,
        cmap="RdBu_r" if signed else "viridis",
    )  # fmt: skip
    extend = "neither" if np.abs(section).max() <= top else "both" if signed else "max"
    figure.colorbar(mesh, ax=axes, shrink=0.86, extend=extend).ax.tick_params(labelsize=8)
    if isinstance(result.source, DislocationNetwork):
        _draw_lines(axes, result, (one, two, normal), chosen)
    unit = f" / {result.length_unit}" if result.length_unit else ""
    axes.set_xlabel(f"${NAMES[one]}${unit}")
    axes.set_ylabel(f"${NAMES[two]}${unit}")
    axes.set_aspect("equal")
    axes.set_xlim(x.min(), x.max())
    axes.set_ylim(y.min(), y.max())
    stress = f" / {result.unit}" if result.unit else ""
    title = "von Mises stress" if not signed else rf"$\sigma_{{{component}}}$"
    axes.set_title(f"{title}{stress}", fontsize=11)
    captioned(figure, _caption(result, NAMES[normal], points[normal]))
    return figure


def stress_html(result: Stresses) -> str:
    """Text and figure of a stress, for notebooks."""
    return pictured(str(result), lambda: draw_stress(result))


def _plane(plane: object) -> tuple[int, int, int]:
    """The two edges of a plane, and the third."""
    entries = list(plane) if isinstance(plane, str) else checks.entries(plane, "plane", GridError)
    numbers = [NAMES.find(x) if isinstance(x, str) else x for x in entries]
    if len(numbers) != 2 or not {*numbers} < {0, 1, 2} or numbers[0] == numbers[1]:
        raise GridError(f"plane: expected two of x, y, z, got {checks.shown(plane)}.")
    return numbers[0], numbers[1], 3 - sum(numbers)


def _values(result: Stresses, component: str) -> np.ndarray:
    """The values of a component at the nodes."""
    if checks.choice(component, COMPONENTS, "component", GridError) == "mises":
        return result.mises
    return result.stress[NAMES.index(component[0]), NAMES.index(component[1])]


def _draw_lines(axes: Axes, result: Stresses, plane: tuple[int, int, int], layer: int) -> None:
    """Pieces of lines in a layer, and dots where lines cross it."""
    assert isinstance(result.source, DislocationNetwork)
    lines, cell, (one, two, normal) = result.source.arrays, result.cell, plane
    starts = lines.positions[lines.pairs[:, 0]]
    shares = (starts - np.asarray(cell.box.origin)) @ cell.box.inverse
    steps = lines.steps @ cell.box.inverse
    # Distances from the layer, in steps of the grid and to its nearest image.
    count = cell.shape[normal]
    away = shares[:, normal] * count - layer
    away -= count * np.rint(away / count)
    reach = steps[:, normal] * count
    inside = (np.abs(away) < 0.5) & (np.abs(reach) < 0.5)
    edges, origin = np.asarray(cell.box.vectors), np.asarray(cell.box.origin)
    for start, step in zip(shares[inside] % 1, steps[inside], strict=True):
        path = np.array([start, start + step]) @ edges + origin
        axes.plot(path[:, one], path[:, two], color=START, linewidth=1.2)
    crosses = ~inside & (np.minimum(away, away + reach) <= 0) & (np.maximum(away, away + reach) > 0)
    along = -away[crosses] / reach[crosses]
    dots = ((shares[crosses] + along[:, None] * steps[crosses]) % 1) @ edges + origin
    axes.plot(dots[:, one], dots[:, two], "o", color=START, markersize=4, clip_on=False)


def _caption(result: Stresses, axis: str, places: np.ndarray) -> list[str]:
    """Position of the layer, error and corrections."""
    length = f" {result.length_unit}" if result.length_unit else ""
    at = f"Layer {axis} = {float(places.mean()):.4g}{length}. "
    if result.cell.shape[NAMES.index(axis)] == 1:
        at = f"Nothing depends on {axis}. "
    size = measured_text(result.largest, result.error, result.unit)
    return [f"{at}Largest stress {size}.", *result.corrections]
