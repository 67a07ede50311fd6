"""Line network: dislocation lines of a simulation in their box, and how much of each family."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.errors import NetworkError
from geomtorsion.loops import DislocationNetwork, LineArrays, Loop
from geomtorsion.loops.line_families import LineFamily, line_families
from geomtorsion.pictures.style import PALE, SERIES, new_figure, number, quiet, space_box

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d import Axes3D

# The circuits, which no family of lines looks like.
CIRCUIT = "#d01c8b"


def draw_lines(
    net: DislocationNetwork, loops: Sequence[Loop] = (), symmetry: str = "cubic"
) -> Figure:
    """Lines in their box, coloured by family, with circuits; beside them length by family.

    Each line is drawn in the image whose middle lies in the box. Bars are divided into screw (full)
    and edge (pale); nodes at which b is not conserved are marked.

    Parameters
    ----------
    loops
        Circuits, in the coordinates of the nodes.
    symmetry
        As for `DislocationNetwork.families`.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    NetworkError
        Nodes have no positions, or there is no line.
    MissingExtraError
        matplotlib is not installed.
    """
    lines = net.arrays
    if not len(lines.pairs):
        raise NetworkError("a picture needs a line, but the network has none.")
    figure = new_figure(10.5, 6.0)
    families, family = line_families(lines, symmetry)
    grid = figure.add_gridspec(1, 2, width_ratios=(2.3, 1))
    space = figure.add_subplot(grid[0], projection="3d")
    _draw_space(space, lines, family, loops)
    broken = {one.node for one in net.node_rule()}
    wrong = [k for k, label in enumerate(lines.labels) if label in broken]
    if wrong:
        space.scatter(*lines.positions[wrong].T, color=CIRCUIT, s=26, depthshade=False, zorder=6)
    _draw_shares(figure.add_subplot(grid[1]), families)
    kept = "b is conserved at every inner node"
    count = f"b is not conserved at {len(broken)} node{'s' * (len(broken) > 1)}"
    figure.suptitle(
        f"{len(lines.positions):,} nodes, {len(lines.pairs):,} lines; {count if broken else kept}",
        fontsize=11,
    )
    return figure


def _draw_space(axes: Axes3D, lines: LineArrays, family: np.ndarray, loops: Sequence[Loop]) -> None:
    """Lines by family, the box, and circuits."""
    from mpl_toolkits.mplot3d.art3d import Line3DCollection  # only who draws needs the extra

    starts = lines.positions[lines.pairs[:, 0]]
    low, high = lines.positions.min(axis=0), lines.positions.max(axis=0)
    if lines.box is not None:
        middle = (starts + lines.steps / 2 - lines.box.origin) @ lines.box.inverse
        moved = np.where(lines.box.periodic, -np.floor(middle), 0)
        starts = starts + moved @ lines.box.vectors
        corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
        places = lines.box.origin + corners @ lines.box.vectors
        low, high = places.min(axis=0), places.max(axis=0)
        sides = [
            (a, b) for a in range(8) for b in range(a) if (corners[a] != corners[b]).sum() == 1
        ]
        edges = [places[list(side)] for side in sides]
        axes.add_collection3d(Line3DCollection(edges, colors="#9aa0a8", linewidths=0.7))
    segments = np.stack([starts, starts + lines.steps], axis=1)
    # So many lines in a picture are thin, few are strong.
    width = float(np.clip(40 / np.sqrt(len(segments)), 0.6, 2.4))
    for k in range(int(family.max()) + 1):
        color = SERIES[k % len(SERIES)].color
        drawn = Line3DCollection(segments[family == k], colors=color, linewidths=width)
        axes.add_collection3d(drawn)
    for loop in loops:
        points = loop.points()
        axes.plot(*points, color=CIRCUIT, lw=2.2, zorder=7)
        low, high = np.minimum(low, points.min(axis=1)), np.maximum(high, points.max(axis=1))
    # A flat network has a box, too.
    least = 0.02 * float((high - low).max())
    space_box(axes, ["x", "y", "z"], low - least, high + least)
    axes.tick_params(axis="z", pad=4)
    axes.set_box_aspect(high - low + 2 * least, zoom=0.95)


def _draw_shares(axes: Axes, families: Sequence[LineFamily]) -> None:
    """Length of the longest families, screw and edge."""
    shown = families[: len(SERIES)]
    whole = sum(one.length for one in families) or 1.0
    for k, one in enumerate(shown):
        share, color = 100 * one.length / whole, SERIES[k].color
        axes.barh(k, share * one.screw, color=color, height=0.62)
        axes.barh(k, share * one.edge, left=share * one.screw, color=color, alpha=0.35, height=0.62)
        text = f"b = {one.name}: {number(round(share, 2))} %, screw {100 * one.screw:.0f} %"
        axes.annotate(text, (0, k - 0.44), fontsize=9, va="bottom", color="#222222")
    left = len(families) - len(shown)
    axes.set_title("length by family" + (f", {left} more not shown" if left else ""), fontsize=10)
    axes.set_xlabel("% of the length; full: screw, pale: edge")
    axes.set_yticks([])
    axes.set_xlim(0, 105)
    axes.set_ylim(max(len(shown), 3) - 0.4, -0.7)
    axes.set_facecolor("white")
    quiet(axes)
    axes.grid(axis="y", visible=False)
    axes.spines["left"].set_color(PALE)
