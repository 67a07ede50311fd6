"""Cells: rules on the unit disk and the unit square and on their rims, for many loops at once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

# Each level is compared with the one before; the last is followed by one loop at a time.
LEVELS = 5


@dataclass(frozen=True, eq=False)
class Rule:
    """Points and weights in the plane of a cell.

    points: shape (2, k), in units of the two half-axes or steps.
    weights: shape (k,), for an integral over the area; for a rim shape (2, k): weights of dx, dy.
    """

    points: np.ndarray
    weights: np.ndarray


@dataclass(frozen=True)
class Cell:
    """A shape that many loops share.

    name: what it is; area: its area in units of the product of both axes.
    inside, rim: rules of a level, from 0.
    """

    name: str
    area: float
    inside: Callable[[int], Rule]
    rim: Callable[[int], Rule]


@cache
def _disk(level: int) -> Rule:
    """Gauss in the squared radius times equidistant angles: exact to degree 4 level + 7."""

    rings, spokes = level + 2, 4 * (level + 2)
    x, w = np.polynomial.legendre.leggauss(rings)
    radius = np.sqrt((1 + x) / 2)[:, None]
    angle = 2 * np.pi * (np.arange(spokes) + 0.5) / spokes
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle)]).reshape(2, -1)
    return Rule(points, np.repeat(w / 4, spokes) * (2 * np.pi / spokes))


@cache
def _circle(level: int) -> Rule:
    """The trapezoid rule with an odd number of points."""

    count = (9, 15, 25, 41, 67)[level]
    angle = 2 * np.pi * (np.arange(count) + 0.382 * level) / count
    points = np.stack([np.cos(angle), np.sin(angle)])
    return Rule(points, np.stack([-points[1], points[0]]) * (2 * np.pi / count))


@cache
def _square(level: int) -> Rule:
    """Gauss times Gauss on (-1/2, 1/2) squared."""

    x, w = np.polynomial.legendre.leggauss(2 * level + 2)
    points = np.stack(np.meshgrid(x / 2, x / 2)).reshape(2, -1)
    return Rule(points, np.outer(w, w).ravel() / 4)


@cache
def _rim(level: int) -> Rule:
    """Gauss on each side, against the clock."""

    x, w = np.polynomial.legendre.leggauss(3 * level + 3)
    x, w = x / 2, w / 2
    half, zero = np.full(len(x), 0.5), np.zeros(len(x))
    points = np.concatenate(
        [np.stack(side) for side in ((x, -half), (half, x), (-x, half), (-half, -x))], axis=1
    )
    sides = ((w, zero), (zero, w), (-w, zero), (zero, -w))
    return Rule(points, np.concatenate([np.stack(side) for side in sides], axis=1))


DISK = Cell("circle", 3.141592653589793, _disk, _circle)
SQUARE = Cell("plaquette", 1.0, _square, _rim)
