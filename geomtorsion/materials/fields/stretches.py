"""Stretches: parts of a loop between the holes of a grid, and ways around these holes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
import sympy as sp

from geomtorsion.loops import Arc, Loop, Part, Segment
from geomtorsion.materials.burgers import Section
from geomtorsion.materials.detours import too_large
from geomtorsion.materials.fields.grid import Grid
from geomtorsion.materials.fields.stencils import SLACK
from geomtorsion.materials.rings import Rings

# Points for each cell along a loop, for the search for lines of nodes.
DENSE = 8


@dataclass(frozen=True)
class Stretch:
    """A part of an arc, from `start` to `end` of its parameter."""

    arc: Arc
    start: float
    end: float
    is_periodic: bool = field(default=False, init=False)

    @property
    def waves(self) -> int:
        """The highest frequency of its offsets."""
        return self.arc.waves

    def shape(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Offsets and their derivatives by s."""
        width = self.end - self.start
        offsets, slopes = self.arc.shape(self.start + width * s)
        return offsets, width * slopes

    def exact(self, s: sp.Symbol) -> tuple[sp.Expr, ...]:
        """The offsets as exact expressions in s."""
        start, end = sp.Rational(self.start), sp.Rational(self.end)
        return tuple(x.subs(s, start + (end - start) * s) for x in self.arc.exact(s))


@dataclass(frozen=True, eq=False)
class Detoured:
    """A loop that goes around the holes of a grid.

    loop: along the rings of holes. rings: of the layer of the loop. passages: how often the loop
    passes each hole. around: number of a hole -> points of its ring, the first one also at the end,
    shape (k, d). plane: of the loop.
    """

    loop: Loop
    rings: Rings
    passages: dict[int, int]
    around: dict[int, np.ndarray]
    plane: tuple[int, int]


def detoured(grid: Grid, loop: Loop) -> Detoured | None:
    """A loop with ways around the holes that it meets; None where it needs none or has none.

    The loop must run in a plane of nodes, and the rings must cover at most half of its area.
    """
    if not grid.has_holes:
        return None
    area = loop.area
    plane = Section.of(loop.points(), area).plane
    layer = _layer(grid, loop, plane)
    if layer is None:
        return None
    rings = Rings.of(grid.holes[layer], periodic=[grid.periodic[k] for k in plane])
    ways = _Ways(grid, rings, plane, layer)
    parts = [ways.part(part) for part in loop.parts]
    if not ways.passages or any(part is None for part in parts):
        return None
    within = sum(times * rings.cells[hole] for hole, times in ways.passages.items())
    cell = abs(grid.steps[plane[0]] * grid.steps[plane[1]])
    if too_large(within, abs(float(area[plane])) / cell):
        return None
    around = {hole: ways.ring(hole) for hole in ways.passages}
    whole = replace(loop, parts=tuple(part for part in parts if part is not None))
    return Detoured(whole, rings, ways.passages, around, plane)


def _layer(grid: Grid, loop: Loop, plane: tuple[int, int]) -> tuple[slice | int, ...] | None:
    """Index of the plane of nodes that contains a loop; None if there is none."""
    points = loop.points()
    index: list[slice | int] = []
    for k, (axis, step) in enumerate(zip(grid.axes, grid.steps, strict=True)):
        places = (points[k] - axis[0]) / step
        node = round(float(places[0]))
        if k in plane:
            index.append(slice(None))
        elif np.abs(places - node).max() < SLACK:
            index.append(node % grid.shape[k] if grid.periodic[k] else node)
        else:
            return None
    # The axes of the plane are in order, as in a section.
    return tuple(index)


class _Ways:
    """Ways around holes in a layer of a grid, and how often each hole was passed."""

    def __init__(
        self,
        grid: Grid,
        rings: Rings,
        plane: tuple[int, int],
        layer: tuple[slice | int, ...],
    ):
        self.grid = grid
        self.rings = rings
        self.plane = plane
        self.layer = layer
        self.passages: dict[int, int] = {}

    # -- where a loop meets holes -----------------------------------------------------------------

    def holes(self, points: np.ndarray) -> np.ndarray:
        """Hole next to each point, -1 for none, -2 for a hole without a ring, shape (k,)."""
        grid, names = self.grid, self.rings.hole[..., 0]
        places = grid.places(points, "loop")[list(self.plane)]
        cells = np.floor(places + SLACK).astype(int)
        thin = np.abs(places - cells) < SLACK
        result = np.full(places.shape[1], -1)
        for shift in np.ndindex(2, 2):
            corner = []
            for k, (n, wraps) in enumerate(zip(names.shape, self.rings.periodic, strict=True)):
                row = cells[k] + np.where(thin[k], 0, shift[k])
                corner.append(row % n if wraps else np.minimum(row, n - 1))
            here = tuple(corner)
            hole = np.where(self.rings.missing[here] & (names[here] < 0), -2, names[here])
            result = np.where(hole != -1, hole, result)
        return result

    def part(self, part: Part) -> Part | None:
        """A part of a loop with ways around holes; None where a hole has no way around it."""
        pieces = [piece for arc in part.arcs for piece in self._pieces(part, arc)]
        holes = [hole for _, hole in pieces]
        if max(holes) < 0 and min(holes) > -2:
            return part
        if min(holes) < -1 or min(holes) >= 0 or (holes[0] >= 0 and any(part.gap)):
            return None
        # The way around a hole begins and ends beside it.
        first = holes.index(-1)
        pieces = pieces[first:] + pieces[:first]
        arcs: list[Arc] = []
        inside: list[Stretch] = []
        for k, (piece, hole) in enumerate(pieces):
            if hole < 0:
                arcs.append(piece)
                continue
            inside.append(piece)
            after = pieces[(k + 1) % len(pieces)][1]
            if after != hole:
                way = self._way(part, inside, hole)
                if way is None:
                    return None
                arcs += way
                self.passages[hole] = self.passages.get(hole, 0) + abs(part.times)
                inside = []
        return replace(part, arcs=tuple(arcs), given=None)

    def _pieces(self, part: Part, arc: Arc) -> list[tuple[Stretch, int]]:
        """Stretches of an arc with the hole that each one meets, -1 for none."""
        points = part.points(arc, np.linspace(0, 1, max(65, 16 * arc.waves + 1)))[0]
        steps = np.abs(np.diff(points, axis=1)) / np.abs(np.array(self.grid.steps))[:, None]
        count = max(16, DENSE * math.ceil(float(steps.sum(axis=1).max())))
        s = np.arange(count + 1) / count
        crossings = [self._crossings(part, arc, s, k) for k in (0, 1)]
        low, high = np.concatenate(crossings, axis=1)
        order = np.argsort(low, kind="stable")
        low, high = low[order], high[order]
        # From one crossing of a line of nodes to the next, the loop stays in one cell.
        starts, ends = np.append(0.0, high), np.append(low, 1.0)
        names = self.holes(part.points(arc, (starts + ends) / 2)[0])
        new = np.flatnonzero(np.diff(names))
        # A way around a hole begins and ends outside the cells of the hole.
        bounds = np.where(names[new] < 0, low[new], high[new])
        bounds = np.concatenate([[0.0], bounds, [1.0]])
        labels = np.append(names[new], names[-1])
        return [
            (Stretch(arc, begin, end), hole)
            for begin, end, hole in zip(
                bounds[:-1].tolist(), bounds[1:].tolist(), labels.tolist(), strict=True
            )
            if end > begin
        ]

    def _crossings(self, part: Part, arc: Arc, s: np.ndarray, axis: int) -> np.ndarray:
        """Parameters just before and after an arc crosses lines of nodes, shape (2, crossings).

        s: parameters that skip no cell.
        """

        def cells(at: np.ndarray) -> np.ndarray:
            points = part.points(arc, at)[0]
            return np.floor(self._places(points)[axis] + SLACK)

        here = cells(s)
        change = np.flatnonzero(np.diff(here))
        low, high = s[change], s[change + 1]
        # Bisection down to the rounding error of the parameter.
        for _ in range(60 if len(change) else 0):
            middle = (low + high) / 2
            same = cells(middle) == here[change]
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        return np.stack([low, high])

    # -- around them ------------------------------------------------------------------------------

    def _way(self, part: Part, inside: list[Stretch], hole: int) -> list[Arc] | None:
        """The way along a ring, from the start of the first stretch to the end of the last."""
        ends = [
            part.points(inside[0].arc, inside[0].start)[0][:, 0],
            part.points(inside[-1].arc, inside[-1].end)[0][:, 0],
        ]
        corners, closed = self._corners(hole, ends[0])
        at = [self._position(closed, self._places(end)) for end in ends]
        if at[0] is None or at[1] is None:
            return None
        numbers = np.arange(len(corners))
        low, high = sorted((at[0], at[1]))
        between = numbers[(numbers > low) & (numbers < high)]
        nodes = corners[between if at[0] <= at[1] else between[::-1]]
        points = np.array([ends[0], *(self._point(node, ends[0]) for node in nodes), ends[1]])
        offsets = (points - np.array(part.centre)) / part.size
        return [
            Segment(tuple(a), tuple(b))
            for a, b in zip(offsets[:-1].tolist(), offsets[1:].tolist(), strict=True)
            if a != b
        ]

    def _places(self, point: np.ndarray) -> np.ndarray:
        """A point in the plane, in steps."""
        return np.array(
            [(point[k] - self.grid.axes[k][0]) / self.grid.steps[k] for k in self.plane]
        )

    def _point(self, place: np.ndarray, beside: np.ndarray) -> np.ndarray:
        """Coordinates of a place in the layer of another point."""
        point = beside.copy()
        for k, x in zip(self.plane, place.tolist(), strict=True):
            point[k] = self.grid.axes[k][0] + self.grid.steps[k] * x
        return point

    def _corners(self, hole: int, beside: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Places of the nodes of a ring, (k, 2), and the same with the first node at the end.

        beside: a point of the loop; on periodic axes, the ring has the same period.
        """
        rings = self.rings
        rows = slice(rings.first[hole], rings.first[hole + 1])
        start = np.unravel_index(rings.nodes[rings.first[hole]], rings.hole.shape)[:2]
        corners = rings.places[:, rows].T + np.array(start, dtype=float)
        for k, wraps in enumerate(rings.periodic):
            if wraps:
                n = rings.hole.shape[k]
                away = self._places(beside)[k] - corners[:, k].mean()
                corners[:, k] += n * round(float(away) / n)
        return corners, np.concatenate([corners, corners[:1]])

    @staticmethod
    def _position(closed: np.ndarray, place: np.ndarray) -> float | None:
        """Position of a place along a ring, in steps; None where it is not on the ring."""
        steps = np.diff(closed, axis=0)
        share = np.clip(((place - closed[:-1]) * steps).sum(axis=1), 0.0, 1.0)
        away = np.abs(closed[:-1] + share[:, None] * steps - place).max(axis=1)
        nearest = int(away.argmin())
        return nearest + float(share[nearest]) if away[nearest] < 4 * SLACK else None

    def ring(self, hole: int) -> np.ndarray:
        """Points of the ring of a hole, the first one also at the end, shape (k, d)."""
        beside = np.zeros(self.grid.dimension)
        for k, index in enumerate(self.layer):
            if isinstance(index, int):
                beside[k] = self.grid.axes[k][index]
        for k in self.plane:
            beside[k] = self.grid.axes[k][0]
        _, closed = self._corners(hole, beside)
        return np.array([self._point(place, beside) for place in closed])
