"""Pieces: curves cut where they cross lines of nodes, so that an interpolant is smooth in each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geomtorsion.loops import Arc, Part
from geomtorsion.loops.quadrature import ROUNDING
from geomtorsion.materials.fields.grid import Grid
from geomtorsion.materials.fields.stencils import SLACK

# Halving an interval as often as a number has bits reaches its rounding.
HALVINGS = np.finfo(float).nmant + 1


def crossings(
    starts: np.ndarray, ends: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Crossings of straight steps with lines of nodes.

    starts, ends: places in units of the spacing, shape (d, k). Returns the number of the step, the
    axis, the place of the line along it, and the fraction of the step, one of each per crossing.
    """
    low, high = (np.floor(x + SLACK) for x in (starts, ends))
    counts = np.abs(high - low).astype(int)
    axis, step = np.nonzero(counts)
    number = counts[axis, step]
    owner = np.repeat(np.arange(len(step)), number)
    nth = np.arange(len(owner)) - np.repeat(np.cumsum(number) - number, number)
    axis, step = axis[owner], step[owner]
    line = np.minimum(low, high)[axis, step] + 1 + nth
    start, end = starts[axis, step], ends[axis, step]
    return step, axis, line, np.clip((line - start) / (end - start), 0.0, 1.0)


def cut(
    owner: np.ndarray, where: np.ndarray, count: int, close: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pieces of several curves between cuts: owner, start and length of each.

    owner, where: curve and parameter of each cut, from 0 to 1. count: number of curves. close: cuts
    of a curve within this distance of an earlier one, or of its end, are omitted, shape (count,).
    """
    every = np.concatenate([owner, np.arange(count), np.arange(count)])
    at = np.concatenate([where, np.zeros(count), np.ones(count)])
    order = np.lexsort((at, every))
    every, at = every[order], at[order]
    near = at - np.append(0.0, at[:-1]) < close[every]
    last = np.append(every[1:] != every[:-1], True)
    first = np.append(True, every[1:] != every[:-1])
    keep = (~near & (1.0 - at >= close[every])) | first | last
    every, at = every[keep], at[keep]
    inner = every[1:] == every[:-1]
    return every[:-1][inner], at[:-1][inner], np.diff(at)[inner]


def pieces_of_arc(grid: Grid, part: Part, arc: Arc, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Starts and lengths of pieces of an arc, within equal pieces and between lines of nodes."""
    path = _Path(grid, part, arc)
    equal = np.linspace(0.0, 1.0, count + 1)
    # Between its turning points, an arc crosses a line at most once.
    s = np.union1d(equal, path.turns(equal))
    places = path.at(s)[0]
    step, axis, line, fraction = crossings(places[:, :-1], places[:, 1:])
    chord = s[step] + fraction * (s[step + 1] - s[step])
    up = places[axis, step + 1] > places[axis, step]
    crossed = path.roots(False, axis, line, up, chord, s[step], s[step + 1])
    cuts = np.concatenate([crossed, equal[1:-1]])
    # Cuts closer than this do not change an integral.
    close = np.array([SLACK / count])
    _, starts, lengths = cut(np.zeros(len(cuts), dtype=int), cuts, 1, close)
    return starts, lengths


@dataclass(frozen=True, eq=False)
class _Path:
    """An arc in units of the spacing of a grid."""

    grid: Grid
    part: Part
    arc: Arc

    def at(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Places and their derivatives by s, shape (d, k) each."""
        steps = np.array(self.grid.steps)[:, None]
        origin = np.array([axis[0] for axis in self.grid.axes])[:, None]
        points, slopes = self.part.points(self.arc, s)
        return (points - origin) / steps, slopes / steps

    def turns(self, s: np.ndarray) -> np.ndarray:
        """Where the derivative of a place changes its sign between neighbours of s."""
        slopes = self.at(s)[1]
        axis, step = np.nonzero(slopes[:, :-1] * slopes[:, 1:] < 0)
        start, end = slopes[axis, step], slopes[axis, step + 1]
        chord = s[step] + start / (start - end) * (s[step + 1] - s[step])
        return self.roots(True, axis, np.zeros(len(axis)), end > 0, chord, s[step], s[step + 1])

    def roots(
        self,
        slopes: bool,
        axis: np.ndarray,
        level: np.ndarray,
        up: np.ndarray,
        first: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
    ) -> np.ndarray:
        """Where places (or their derivatives) reach levels, each between low and high.

        up: whether the value increases. first: first estimates, which the secant through the ends
        of the interval improves, or its middle where the secant is slow.
        """
        every, at = np.arange(len(first)), first
        ends = [np.full(len(first), np.nan), np.full(len(first), np.nan)]
        for number in range(HALVINGS if len(first) else 0):
            places, derivatives = self.at(at)
            values = (derivatives if slopes else places)[axis, every]
            away = np.where(up, values - level, level - values)
            if (np.abs(away) <= ROUNDING * (1 + np.abs(values))).all():
                break
            above = away > 0
            low, high = np.where(above, low, at), np.where(above, at, high)
            ends = [np.where(above, ends[0], away), np.where(above, away, ends[1])]
            with np.errstate(divide="ignore", invalid="ignore"):
                secant = low - ends[0] * (high - low) / (ends[1] - ends[0])
            usable = (secant > low) & (secant < high) & bool(number % 3)
            at = np.where(usable, secant, low + (high - low) / 2)
        return at


def pieces_of_edges(
    grid: Grid, starts: np.ndarray, ends: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pieces of straight edges between lines of nodes: edge, start and length of each."""
    steps, origin = np.array(grid.steps), np.array([axis[0] for axis in grid.axes])
    low, high = (((x - origin) / steps).T for x in (starts, ends))
    edge, _, _, fraction = crossings(low, high)
    close = SLACK / np.maximum(1.0, np.abs(high - low).sum(axis=0))
    return cut(edge, fraction, len(starts), close)


def halved(starts: np.ndarray, lengths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Both halves of each piece, in order."""
    half = lengths / 2
    return np.stack([starts, starts + half], axis=1).ravel(), np.repeat(half, 2)
