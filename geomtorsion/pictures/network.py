"""Network: graphs laid into a frame with the cycles that miss, and dislocation networks."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.errors import ArgumentError, LimitError, NetworkError
from geomtorsion.geometry import Frame
from geomtorsion.loops import Loop, Network
from geomtorsion.materials.lines import DislocationNetwork, LineArrays
from geomtorsion.materials.lines.line_families import LineFamily, line_families, named_families
from geomtorsion.materials.lines.reactions import size, written
from geomtorsion.pictures.loops import GAP, PATH, START
from geomtorsion.pictures.style import (
    FLAT,
    PALE,
    SERIES,
    STYLE,
    arrow,
    new_figure,
    number,
    quiet,
    space_box,
)
from geomtorsion.support import checks
from geomtorsion.support.outgoing import count_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d import Axes3D

SOFT, GOOD = "#9ca5b6", "#1c7a43"


def draw_network(net: Network, basis: str = "minimum", plane: tuple[int, int] = (0, 1)) -> Figure:
    """A network in two of its coordinates; cycles that do not close are filled by |b|.

    Parameters
    ----------
    basis
        Which cycles are drawn: "minimum" (small networks) or "fundamental".
    plane
        The two coordinates that are drawn.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    LimitError
        The network has too many edges for a picture, or for a minimum basis.
    MissingExtraError
        matplotlib is not installed.
    """
    checks.instance(net, Network, "net")
    plane = _checked_plane(plane, net.edges.positions.shape[1])
    if len(net.edges.pairs) > STYLE.edges:
        raise LimitError(
            f"expected at most {STYLE.edges} edges for a picture, got {len(net.edges.pairs)}. Draw "
            "a part of the network."
        )
    gaps = net.basis_burgers(basis)
    sizes = [float(np.linalg.norm(gap.vector)) for gap in gaps]
    largest = max(sizes, default=0.0)
    figure = new_figure(7.6, 6.2)
    axes = figure.subplots()
    places = net.edges.positions[:, list(plane)]
    edges = places[net.edges.pairs]
    axes.plot(edges[..., 0].T, edges[..., 1].T, color=SOFT, lw=1, zorder=1)
    axes.plot(*places.T, "o", color=START, ms=4, zorder=3)
    shades = _shades(figure, axes, largest)
    for gap, length in zip(gaps, sizes, strict=True):
        if length > max(FLAT * largest, gap.error):
            corners = np.array([places[net.edges.numbers[node]] for node in gap.cycle])
            axes.fill(*corners.T, color=shades(length), alpha=0.85, zorder=2, lw=0)
            axes.annotate(
                f"{length:.3g}",
                corners.mean(axis=0),
                ha="center",
                va="center",
                fontsize=9,
                zorder=4,
            )
    missed = sum(
        length > max(FLAT * largest, gap.error) for gap, length in zip(gaps, sizes, strict=True)
    )
    frame = net.frame
    exact = isinstance(frame, Frame)
    names = [symbol.name for symbol in frame.coordinates] if exact else list(frame.names)
    axes.set_xlabel(names[plane[0]])
    axes.set_ylabel(names[plane[1]])
    axes.set_title(f"{len(gaps)} cycles of a {basis} basis, {missed} do not close", fontsize=11)
    axes.set_aspect("equal")
    quiet(axes)
    return figure


def _shades(figure: Figure, axes: Axes, largest: float) -> Any:
    """A scale of colours from 0 to the largest |b|, with its bar."""
    # Only who draws needs the extra.
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LinearSegmentedColormap, Normalize

    ramp = LinearSegmentedColormap.from_list("b", ["#fff4e6", "#f2a65e", GAP])
    mapped = ScalarMappable(Normalize(0, largest or 1.0), ramp)
    if largest:
        figure.colorbar(mapped, ax=axes, label="|b|", shrink=0.8)
    return mapped.to_rgba


def draw_dislocations(
    net: DislocationNetwork,
    positions: Mapping[Hashable, Sequence[float]] | None = None,
    plane: tuple[int, int] = (0, 1),
) -> Figure:
    """Dislocation lines with sense (arrow), Burgers vector and strength (width), and their nodes.

    Green junctions conserve b, orange ones do not and show the excess; open circles are at the
    surface.

    Parameters
    ----------
    positions
        Positions of the nodes; their attribute `position`, or a spring layout, if not given.
    plane
        The two coordinates that are drawn.

    Returns
    -------
    A matplotlib figure.
    """
    checks.instance(net, DislocationNetwork, "net")
    places = _places(net, positions, plane)
    figure = new_figure(7.6, 6.2)
    axes = figure.subplots()
    strongest = max((size(b) for *_, b in net.lines), default=1.0)
    seen: dict[frozenset[Hashable], int] = {}
    for start, end, _, b in net.lines:
        pair = frozenset((start, end))
        rank = seen.get(pair, 0)
        seen[pair] = rank + 1
        # Lines between the same nodes bend to either side in turn.
        bend = 0.22 * ((rank + 1) // 2) * (-1 if rank % 2 else 1)
        bend = bend if str(start) <= str(end) else -bend
        _draw_line(
            axes, places[start], places[end], bend, 1.2 + 2 * size(b) / strongest, written(b)
        )
    violations = {one.node: one.excess for one in net.node_rule()}
    for node, data in net.graph.nodes(data=True):
        x, y = places[node]
        if node in violations:
            axes.plot(x, y, "o", color=GAP, ms=13, zorder=4)
            axes.annotate(
                f"{node}: {written(violations[node])} too much", (x, y), (12, -14),
                textcoords="offset points", color=GAP, fontsize=10,
            )  # fmt: skip
        elif data.get("surface"):
            axes.plot(x, y, "o", mfc="white", mec=START, ms=8, zorder=4)
        else:
            axes.plot(x, y, "o", color=GOOD, ms=9, zorder=4)
    rule = "b is conserved at every inner node"
    broken = f"b is not conserved at {count_text(len(violations), 'node')}"
    axes.set_title(broken if violations else rule, fontsize=11)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.15)
    axes.axis("off")
    return figure


def _places(
    net: DislocationNetwork,
    positions: Mapping[Hashable, Sequence[float]] | None,
    plane: tuple[int, int],
) -> dict[Hashable, tuple[float, float]]:
    """Where the nodes are drawn."""
    import networkx as nx  # 0.15 s; only networks without positions need it

    # A layout is invented only if no node has a position: a mixture would mislead.
    placed: dict[Hashable, Any] = {n: net.graph.nodes[n].get("position") for n in net.graph}
    places = positions or placed
    if all(place is None for place in places.values()):
        layout = nx.kamada_kawai_layout(nx.Graph(net.graph))
        return {node: (float(x), float(y)) for node, (x, y) in layout.items()}
    missing = [node for node in net.graph if places.get(node) is None]
    if missing:
        raise NetworkError(
            f"node {missing[0]!r}: expected a position, got none. Give all nodes positions, or "
            "none."
        )
    one, two = _checked_plane(plane, min(len(place) for place in places.values()))
    return {node: (float(place[one]), float(place[two])) for node, place in places.items()}


def _checked_plane(plane: Sequence[int], dimension: int) -> tuple[int, int]:
    """Two different coordinates, by number."""
    chosen = checks.entries(plane, "plane")
    axes = [checks.count(k, "plane", ArgumentError, 0, dimension - 1) for k in chosen]
    if len(set(axes)) != 2 or len(axes) != 2:
        raise ArgumentError(
            f"plane: expected two coordinates, got {checks.shown(plane)}. Give two numbers "
            f"from 0 to {dimension - 1}, such as (0, 1)."
        )
    return axes[0], axes[1]


def _draw_line(
    axes: Axes,
    start: tuple[float, float],
    end: tuple[float, float],
    bend: float,
    width: float,
    label: str,
) -> None:
    """One line: a curve with an arrow half way and its Burgers vector next to it."""
    one, two = np.array(start), np.array(end)
    across = np.array([one[1] - two[1], two[0] - one[0]])
    middle = (one + two) / 2 + bend * across
    t = np.linspace(0, 1, 41)[:, None]
    curve = (1 - t) ** 2 * one + 2 * t * (1 - t) * (2 * middle - (one + two) / 2) + t**2 * two
    axes.plot(*curve.T, color=PATH, lw=width, zorder=2, solid_capstyle="round")
    arrow(axes, curve[19], curve[23], PATH, width)
    side = across / max(float(np.linalg.norm(across)), 1e-300) * (1 if bend >= 0 else -1)
    axes.annotate(
        label, tuple(curve[20]), tuple(13 * side), textcoords="offset points",
        ha="left" if side[0] > 0.3 else "right" if side[0] < -0.3 else "center",
        va="bottom" if side[1] > 0.3 else "top" if side[1] < -0.3 else "center", fontsize=10,
        zorder=5,
    )  # fmt: skip


# The circuits, which no family of lines looks like.
CIRCUIT = "#d01c8b"


def draw_lines(
    net: DislocationNetwork,
    loops: Sequence[Loop] = (),
    symmetry: str = "cubic",
    unit: str = "",
) -> Figure:
    """Lines in their box, coloured by family, with circuits; beside them length by family.

    Each line is drawn in the image whose middle is in the box. Bars are divided into screw (full)
    and edge (pale); nodes at which b is not conserved are marked.

    Parameters
    ----------
    loops
        Circuits, in the coordinates of the nodes.
    symmetry
        As for `DislocationNetwork.families`; lines of a crystal have their families already.
    unit
        Of the positions; without it the axes name the unit of the positions.

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
    lines = checks.instance(net, DislocationNetwork, "net").arrays
    if not len(lines.pairs):
        raise NetworkError("expected a network with lines, got none to draw.")
    figure = new_figure(10.5, 6.0)
    names = net.names
    if names is None:
        families, family = line_families(lines, symmetry)
    else:
        families, family = named_families(lines, names)
    grid = figure.add_gridspec(1, 2, width_ratios=(2.3, 1))
    space = figure.add_subplot(grid[0], projection="3d")
    _draw_space(space, lines, family, loops, unit or "unit of the positions")
    broken = {one.node for one in net.node_rule()}
    wrong = [k for k, label in enumerate(lines.labels) if label in broken]
    if wrong:
        space.scatter(*lines.positions[wrong].T, color=CIRCUIT, s=26, depthshade=False, zorder=6)
    _draw_shares(figure.add_subplot(grid[1]), families)
    rule = "b is conserved at every inner node"
    count = f"b is not conserved at {count_text(len(broken), 'node')}"
    figure.suptitle(
        f"{count_text(len(net.graph), 'node')}, {count_text(len(net.lines), 'line')}; "
        f"{count if broken else rule}",
        fontsize=11,
    )
    return figure


def _draw_space(
    axes: Axes3D, lines: LineArrays, family: np.ndarray, loops: Sequence[Loop], unit: str
) -> None:
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
    # A flat network also has a box.
    least = 0.02 * float((high - low).max())
    space_box(axes, [f"{name} / {unit}" for name in "xyz"], low - least, high + least)
    axes.tick_params(axis="z", pad=4)
    axes.set_box_aspect(high - low + 2 * least, zoom=0.95)


def _draw_shares(axes: Axes, families: Sequence[LineFamily]) -> None:
    """Length of the longest families, screw and edge."""
    shown = families[: len(SERIES)]
    whole = sum(kind.length for kind in families) or 1.0
    for k, kind in enumerate(shown):
        share, color = 100 * kind.length / whole, SERIES[k].color
        axes.barh(k, share * kind.screw, color=color, height=0.62)
        axes.barh(
            k, share * kind.edge, left=share * kind.screw, color=color, alpha=0.35, height=0.62
        )
        text = f"b = {kind.name}: {number(round(share, 2))} %, screw {100 * kind.screw:.0f} %"
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
