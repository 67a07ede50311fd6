"""Shapes: circle, ellipse, polygon, plaquette, spline and cycle as parts of a loop."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import scipy  # loads its parts when they are asked for

from geomtorsion.errors import LoopError
from geomtorsion.loops import planes
from geomtorsion.loops.arcs import (
    Cubic,
    Ellipse,
    Number,
    Part,
    Plane,
    Point,
    Segment,
    exact_number,
    shown,
)
from geomtorsion.loops.parametric import symbolic_ellipse

if TYPE_CHECKING:
    import networkx as nx

# Neighbours closer than this share of the loop's size are one point after rounding.
COINCIDE = 4 * float(np.finfo(float).eps)


def circle(centre: Point, radius: Number, plane: Plane) -> Part:
    """Circle of a radius about a centre; see Loop.circle."""
    if planes.is_symbolic(centre, radius):
        return symbolic_ellipse(centre, (radius, radius), plane, planes.exact_orthonormal)
    place = planes.vector(centre, "centre")
    u, v = planes.orthonormal(*planes.rows(plane, len(place)))
    size = planes.length(radius, "radius")
    meant = partial(planes.exact_orthonormal, plane, len(place))
    side = Ellipse(tuple(u.tolist()), tuple(v.tolist()), meant)
    return Part(place, size, (side,), given=(tuple(centre), radius))


def ellipse(centre: Point, axes: Sequence[Number], plane: Plane) -> Part:
    """Ellipse with two semi-axes along two directions; see Loop.ellipse."""
    if not hasattr(axes, "__len__") or isinstance(axes, str) or len(axes) != 2:
        raise LoopError(f"axes: two semi-axes were needed, but {axes!r} came.")
    if planes.is_symbolic(centre, axes):
        return symbolic_ellipse(centre, axes, plane, planes.exact_rows)
    place = planes.vector(centre, "centre")
    first, second = planes.rows(plane, len(place))
    a, b = (planes.length(axis, f"axes[{k}]") for k, axis in enumerate(axes))
    size = max(a, b)
    meant = partial(planes.exact_multiples, plane, tuple(axes), len(place))
    u, v = first * (a / size), second * (b / size)
    side = Ellipse(tuple(u.tolist()), tuple(v.tolist()), meant)
    return Part(place, size, (side,), given=(tuple(centre), axes[0] if a >= b else axes[1]))


def polygon(vertices: Sequence[Point] | np.ndarray, centre: Point | None, size: Number) -> Part:
    """Closed chain of straight sides; see Loop.polygon."""
    place, scale, offsets, given = _offsets(vertices, centre, size, "vertices", "vertex")
    meant = None if given else [tuple(vertices[k]) for k in range(len(offsets))]
    given = given or ((0,) * len(place), 1)
    return Part(place, scale, _straight([tuple(x) for x in offsets.tolist()], meant), given=given)


def _straight(
    corners: Sequence[tuple[float, ...]], meant: Sequence[tuple[Number, ...]] | None
) -> tuple[Segment, ...]:
    """Sides from corner to corner; meant: the corners as coordinates, as the user gave them."""
    following = [*range(1, len(corners)), 0]
    return tuple(
        Segment(corners[k], corners[j], (meant[k], meant[j]) if meant else None)
        for k, j in enumerate(following)
    )


def plaquette(corner: Point, steps: Sequence[Number], plane: Plane) -> Part:
    """Parallelogram from a corner; see Loop.plaquette."""
    place = planes.vector(corner, "corner")
    first, second = planes.rows(plane, len(place))
    if not hasattr(steps, "__len__") or isinstance(steps, str) or len(steps) != 2:
        raise LoopError(f"steps: two steps were needed, but {steps!r} came.")
    a, b = (planes.number(step, f"steps[{k}]") for k, step in enumerate(steps))
    if not (a and b):
        raise LoopError(f"steps: neither may be zero, but {tuple(steps)!r} came.")
    scale = max(abs(a), abs(b))
    u, v = first * (a / scale), second * (b / scale)
    middle = tuple((float(q) + scale * (x + y) / 2) for q, x, y in zip(place, u, v, strict=True))
    corners = [tuple(x.tolist()) for x in (-(u + v) / 2, (u - v) / 2, (u + v) / 2, (v - u) / 2)]
    ends = [(0, 0), (1, 0), (1, 1), (0, 1)]
    meant = [
        tuple(
            exact_number(q)
            + j * exact_number(a) * exact_number(x)
            + k * exact_number(b) * exact_number(y)
            for q, x, y in zip(corner, first.tolist(), second.tolist(), strict=True)
        )
        for j, k in ends
    ]
    return Part(middle, scale, _straight(corners, meant), given=((0,) * len(place), 1))


def spline(points: Sequence[Point] | np.ndarray, centre: Point | None, size: Number) -> Part:
    """Periodic cubic spline through points; see Loop.spline."""
    place, scale, offsets, _ = _offsets(points, centre, size, "points", "point")
    closed = np.vstack([offsets, offsets[:1]])
    chords = np.linalg.norm(np.diff(closed, axis=0), axis=1)
    knots = np.concatenate([[0.0], np.cumsum(chords)])
    pieces = scipy.interpolate.CubicSpline(knots, closed, bc_type="periodic").c
    # From powers of the chord length to powers of s in 0..1 on each piece.
    powers = chords[None, :] ** np.arange(3, -1, -1)[:, None]
    scaled = (pieces * powers[:, :, None]).transpose(1, 2, 0)
    sides = tuple(Cubic(tuple(tuple(row) for row in piece)) for piece in scaled.tolist())
    return Part(place, scale, sides)


def cycle(graph: nx.Graph, nodes: Sequence[Hashable], position: str) -> Part:
    """Polygon along a cycle of a graph; see Loop.from_cycle."""
    chain = list(nodes)
    if len(chain) > 1 and chain[0] == chain[-1]:
        chain.pop()
    corners = []
    for node in chain:
        if node not in graph:
            raise LoopError(f"cycle: node {node!r} is not in the graph.")
        if position not in graph.nodes[node]:
            raise LoopError(
                f"cycle: node {node!r} has no {position!r}. Give every node its coordinates with "
                f"networkx.set_node_attributes(graph, positions, {position!r})."
            )
        corners.append(graph.nodes[node][position])
    for one, two in zip(chain, chain[1:] + chain[:1], strict=True):
        if not graph.has_edge(one, two) and not graph.has_edge(two, one):
            raise LoopError(f"cycle: there is no edge between {one!r} and {two!r}.")
    return polygon(corners, None, 1)


def _offsets(
    points: Sequence[Point] | np.ndarray, centre: Point | None, size: Number, where: str, what: str
) -> tuple[tuple[float, ...], float, np.ndarray, tuple[tuple[Number, ...], Number] | None]:
    """Centre, size and offsets of points, closed and without neighbours that coincide."""
    if isinstance(points, str) or not hasattr(points, "__len__"):
        raise LoopError(f"{where}: a list of points was needed, but {points!r} came.")
    if len(points) == 0:
        raise LoopError(f"{where}: at least three points were needed, but none came.")
    dimension = len(points[0]) if hasattr(points[0], "__len__") else None
    rows = np.array(
        [planes.vector(row, f"{where}[{k}]", dimension) for k, row in enumerate(points)]
    )
    if len(rows) > 3 and (rows[0] == rows[-1]).all():
        rows = rows[:-1]
    if len(rows) < 3:
        raise LoopError(
            f"{where}: at least three points were needed, but {len(rows)} came: a path to and fro "
            "between two points encloses nothing."
        )
    if centre is None:
        if size != 1:
            raise LoopError(f"size {size} counts offsets from a centre; give the centre as well.")
        middle = rows.mean(axis=0)
        offsets = rows - middle
        scale = float(np.abs(offsets).max())
        place, given = tuple(middle.tolist()), None
        offsets = offsets / scale if scale else offsets
    else:
        place = planes.vector(centre, "centre", rows.shape[1])
        scale, offsets = planes.length(size, "size"), rows
        given = (tuple(centre), size)
    extent = np.abs(offsets).max()
    for k in range(len(rows)):
        step = np.abs(offsets[k] - offsets[k - 1]).max()
        if step <= COINCIDE * extent:
            raise LoopError(
                f"{where}: {what} {(k - 1) % len(rows)} and {what} {k} coincide at "
                f"{shown(rows[k])}. Leave one of them out."
            )
    return place, scale, offsets, given
