"""Chains: nodes and weights on closed curves and on what they bound, level by level."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Protocol

import numpy as np

from geomtorsion.loops.arcs import Arc, Ellipse
from geomtorsion.loops.quadrature import (
    GROWTH,
    LEVELS,
    MOST_AT_ONCE,
    equidistant,
    gauss_rule,
    places,
    ray_rule,
)
from geomtorsion.support.caching import read_only


@dataclass(frozen=True, eq=False)
class Chain:
    """Nodes and weights for forms of one degree, in d coordinates about the centre.

    points: shape (d, k).
    weights: for each coordinate or pair of them, shape (d, k) or (d (d - 1) / 2, k): the integral
        of a form is the sum of its components times these.
    rule: which rule it is, in words.
    """

    points: np.ndarray
    weights: np.ndarray
    rule: str


class Shape(Protocol):
    """Common shape of many loops: a rim, its inside, and rules of rising level for both."""

    @property
    def levels(self) -> tuple[int, int]:
        """How many levels there are along the loop, and over the surface."""
        ...

    def rim(self, level: int) -> Chain:
        """A rule along the loop."""
        ...

    def inside(self, level: int) -> Chain:
        """A rule over a surface that it bounds."""
        ...


@dataclass(frozen=True)
class ClosedCurve:
    """A smooth closed curve and the cone over it: spectral in both directions.

    arc: the curve, about the tip of the cone.
    first: points of the first level, as long as the curve itself needs no more.
    """

    arc: Arc
    first: int = 16

    @property
    def levels(self) -> tuple[int, int]:
        """As many levels as fit in memory; an integrand that needs more has a narrow peak."""
        return _levels(self.arc.waves, self.first)

    def rim(self, level: int) -> Chain:
        """The trapezoid rule."""
        x, v = self._nodes(level)
        return Chain(x, v / x.shape[1], f"trapezoid, {x.shape[1]} points")

    def inside(self, level: int) -> Chain:
        """The trapezoid rule times Gauss along the rays from the tip."""
        x, v = self._nodes(level)
        count = _rays(self.first, level)
        # Opposite points cancel odd powers: on an ellipse only even ones need to be exact.
        s, w = even_ray_rule(count) if isinstance(self.arc, Ellipse) else ray_rule(count)
        a, b = pairs_of(len(x))
        area = (x[a] * v[b] - x[b] * v[a]) / x.shape[1]
        points = (x[:, None, :] * s[:, None]).reshape(len(x), -1)
        weights = (area[:, None, :] * w[:, None]).reshape(len(area), -1)
        rule = f"trapezoid, {x.shape[1]} points times {count} Gauss points"
        return Chain(points, weights, rule)

    def _nodes(self, level: int) -> tuple[np.ndarray, np.ndarray]:
        """Equidistant points of a level, and slopes there."""
        count = equidistant(self.arc.waves, level, self.first)
        return self.arc.shape(places(count, level))


@dataclass(frozen=True)
class Strip:
    """A smooth curve that closes modulo periods, and the strip from a straight line to it.

    arc: the curve, s from 0 to 1; gap: the periods between its ends, shape (n,).

    The strip is s gap + u (x(s) - s gap), u from 0 to 1: at both ends it is the same but for the
    periods, so that its boundary is the curve less the straight line.
    """

    arc: Arc
    gap: tuple[float, ...]

    @property
    def levels(self) -> tuple[int, int]:
        """As of a closed curve."""
        return ClosedCurve(self.arc).levels

    def rim(self, level: int) -> Chain:
        """The trapezoid rule along the curve."""
        return ClosedCurve(self.arc).rim(level)

    def inside(self, level: int) -> Chain:
        """The trapezoid rule along the strip times Gauss across it."""
        first = ClosedCurve(self.arc).first
        count = equidistant(self.arc.waves, level, first)
        s = places(count, level)
        x, v = self.arc.shape(s)
        along = np.array(self.gap)[:, None]
        out = x - along * s
        u, w = gauss_rule(_rays(first, level))
        steps = along[:, :, None] + (v - along)[:, :, None] * u
        points = (along * s)[:, :, None] + out[:, :, None] * u
        a, b = pairs_of(len(x))
        area = out[a][:, :, None] * steps[b] - out[b][:, :, None] * steps[a]
        weights = (area * w / count).reshape(len(a), -1)
        rule = f"trapezoid, {count} points times {len(u)} Gauss points across a strip"
        return Chain(points.reshape(len(x), -1), weights, rule)


@dataclass(frozen=True)
class Square:
    """The square of side 1 about the centre, by Gauss along its sides and over its area.

    Copies of it along two steps are parallelograms.

    first: points of the first level on each side; half as many across the area.
    """

    first: int = 8

    @property
    def levels(self) -> tuple[int, int]:
        """Ten times the points of the first; what needs more has a narrow peak."""
        return 6, 6

    def rim(self, level: int) -> Chain:
        """Gauss on each side, counterclockwise."""
        x, w = gauss_rule(int(self.first * GROWTH**level))
        x, half, zero = x - 0.5, np.full(len(x), 0.5), np.zeros(len(x))
        sides = ((x, -half), (half, x), (-x, half), (-half, -x))
        steps = ((w, zero), (zero, w), (-w, zero), (zero, -w))
        points, weights = (
            np.concatenate([np.stack(side) for side in each], axis=1) for each in (sides, steps)
        )
        return Chain(points, weights, f"Gauss, {len(x)} points a side")

    def inside(self, level: int) -> Chain:
        """Gauss times Gauss."""
        x, w = gauss_rule(int(self.first / 2 * GROWTH**level))
        points = np.stack(np.meshgrid(x - 0.5, x - 0.5)).reshape(2, -1)
        rule = f"Gauss, {len(x)} times {len(x)} points"
        return Chain(points, np.outer(w, w).reshape(1, -1), rule)


@cache
def even_ray_rule(points: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes on (0, 1) and weights for the weight s, exact for even powers to 4 points - 2."""
    x, w = gauss_rule(points)
    return read_only(np.sqrt(x)), read_only(w / 2)


@cache
def _levels(waves: int, first: int) -> tuple[int, int]:
    """Levels along a curve and over the cone that have no more points than allowed."""
    rims = [equidistant(waves, level, first) for level in range(LEVELS)]
    insides = [rim * _rays(first, level) for level, rim in enumerate(rims)]
    return sum(rim <= MOST_AT_ONCE for rim in rims), sum(area <= MOST_AT_ONCE for area in insides)


def _rays(first: int, level: int) -> int:
    """Gauss points along each ray: as many as suit the points along the curve."""
    return int(first / 4 * GROWTH**level)


@cache
def pairs_of(n: int) -> np.ndarray:
    """Both members of each pair of n coordinates, the first below the second, (2, pairs)."""
    return read_only(np.array(np.triu_indices(n, 1)))
