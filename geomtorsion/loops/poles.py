"""Poles: where a denominator of the coframe vanishes on a loop, or nearly does."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from geomtorsion.errors import SingularPointError
from geomtorsion.loops.arcs import Arc, Part, at_arcs, shown
from geomtorsion.loops.forms import Poles
from geomtorsion.loops.quadrature import NARROWEST, PIECE, equidistant, graded
from geomtorsion.support.precision import CALCULATED

# A denominator goes with the square of the distance; as a share of its largest value on an arc:
ZERO = CALCULATED**2
# Points on an arc at which denominators are evaluated first, from the coarsest rule.
SAMPLES = equidistant(0, 0)


def steep(poles: Poles, points: np.ndarray) -> np.ndarray:
    """On which of many curves a denominator doubles from one place to the next, or is zero between.

    A peak that is narrower than the steps between the places shows in this way; shape (curves,).
    points: places in order along each curve, shape (n, curves, k).
    """
    values = poles.values(points.reshape(len(points), -1)).reshape(-1, *points.shape[1:])
    return np.asarray(_steep(values).any(axis=0))


def _steep(values: np.ndarray) -> np.ndarray:
    """The same for each denominator, from its values (poles, curves, k); shape (poles, curves)."""
    one, two = np.abs(values[..., 1:]), np.abs(values[..., :-1])
    is_steep = ~(2 * np.minimum(one, two) > np.maximum(one, two))
    if not np.iscomplexobj(values):
        is_steep |= _changes_sign(values)
    return np.asarray(is_steep.any(axis=-1))


def _changes_sign(values: np.ndarray) -> np.ndarray:
    """Where real values change their sign from one place to the next; products would overflow."""
    signs = np.sign(values)
    return signs[..., 1:] * signs[..., :-1] < 0


def refuse_poles(poles: Poles | None, part: Part) -> tuple[tuple[int, float], ...]:
    """Refuse a loop on which a denominator vanishes.

    Returns
    -------
    (number of the arc, s) in ascending order about each place where one nearly does, closer and
    closer: an integral whose intervals end there misses no peak.

    Raises
    ------
    SingularPointError
        The loop passes through a zero; the message names it.
    """
    if poles is None:
        return ()
    cuts: list[tuple[int, float]] = []
    for owner, s, points in arc_samples(part):
        values = poles.values(points).reshape(-1, len(owner), len(s))
        # Most arcs are far from all poles, and need no closer look.
        for j, k in np.argwhere(_steep(values).T).tolist():
            cuts += _cuts(poles, part, int(owner[j]), k, s, values[k, j])
    return tuple(cuts)


def arc_samples(part: Part, closer: int = 1) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Arcs by number, s on each, and points of shape (n, arcs * len(s)), as many as fit at once.

    closer: into how many parts each interval of the coarsest rule is divided.
    """
    counts = [closer * (max(SAMPLES, 4 * arc.waves + 1) - 1) + 1 for arc in part.arcs]
    for count in sorted(set(counts)):
        s = np.linspace(0, 1, count)
        alike = np.array([k for k, own in enumerate(counts) if own == count])
        for begin in range(0, len(alike), max(1, PIECE // count)):
            owner = alike[begin : begin + max(1, PIECE // count)]
            offsets, _ = at_arcs(part.arcs, owner, np.broadcast_to(s, (len(owner), count)))
            yield owner, s, np.array(part.centre)[:, None] + part.size * offsets


def _cuts(
    poles: Poles, part: Part, number: int, k: int, s: np.ndarray, row: np.ndarray
) -> Iterator[tuple[int, float]]:
    """Cuts about the places where denominator k is small on an arc; row: its values at s.

    Raises
    ------
    SingularPointError
        It vanishes there.
    """
    arc, count, sizes = part.arcs[number], len(s), np.abs(row)
    signs = np.flatnonzero(_changes_sign(row)) if not np.iscomplexobj(row) else ()
    # An arc that begins or ends nearest to a pole: the loop comes from there, or continues there.
    ends = {j for j, inner in ((0, 1), (count - 1, count - 2)) if sizes[j] <= sizes[inner]}
    dips = {int(sizes.argmin()), *_dips(sizes).tolist(), *map(int, signs), *ends}
    for start in sorted(dips):
        low, high = s[max(start - 1, 0)], s[min(start + 1, count - 1)]
        place, width = _minimum(poles, part, arc, k, low, high, sizes.max())
        if width == 0 and not _is_pole(poles, part, arc, place):
            continue
        if width == 0:
            point = part.points(arc, place)[0][:, 0]
            raise SingularPointError(
                f"the loop passes through {shown(point)}, where {poles.names[k]} "
                f"vanishes and the {poles.owner} has no finite value. "
                "Lead it past that point."
            )
        yield from ((number, cut) for cut in graded(place, width / 2, 1 / (2 * count)))


def _is_pole(poles: Poles, part: Part, arc: Arc, place: float) -> bool:
    """Whether forms grow towards a zero of a denominator."""
    sign = 1 if place < 0.5 else -1
    steps = CALCULATED**0.5, CALCULATED
    far, near = (part.points(arc, place + sign * step)[0][:, 0] for step in steps)
    return poles.grows(far, near)


def _dips(sizes: np.ndarray) -> np.ndarray:
    """Places of the local minima below half of a value beside them."""
    before, here, after = sizes[:-2], sizes[1:-1], sizes[2:]
    deep = 2 * here < np.maximum(before, after)
    return np.flatnonzero((here <= before) & (here <= after) & deep) + 1


def _minimum(
    poles: Poles, part: Part, arc: Arc, k: int, low: float, high: float, largest: float
) -> tuple[float, float]:
    """Where denominator k is smallest between two values of s, and how wide it is there.

    The width is 0 where it vanishes; elsewhere it is below twice that over which it doubles.
    """
    while True:
        s = np.linspace(low, high, 9)
        row = poles.one(k, part.points(arc, s)[0])
        best = int(np.abs(row).argmin())
        place, width = float(s[best]), float(high - low)
        crosses = not np.iscomplexobj(row) and row.min() < 0 < row.max()
        # An interval as short as the rounding of s ends the search as well.
        if np.abs(row[best]) <= ZERO * largest or crosses or width < NARROWEST:
            return place, 0.0
        if 2 * np.abs(row[best]) > np.abs(row).max():
            return place, width
        low, high = s[max(best - 1, 0)], s[min(best + 1, 8)]
