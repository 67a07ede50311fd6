"""Winding: how often a loop winds around a line, at any distance."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from geomtorsion.errors import GeomtorsionError, LoopError, SingularPointError
from geomtorsion.loops.arcs import Arc, Part, Segment, shown
from geomtorsion.support.precision import CALCULATED


def turns_round(
    parts: Sequence[Part],
    place: Sequence[float],
    across: np.ndarray,
    name: str,
    refusal: type[GeomtorsionError] = SingularPointError,
) -> int:
    """Winding number around the line through a point on which both covectors are constant.

    Parameters
    ----------
    across
        Two covectors, shape (2, n).
    name, refusal
        What the line is called, and the error for a loop that goes through it.

    Raises
    ------
    SingularPointError
        (or `refusal`) the loop goes through the line; the message has its name and the point.

    Examples
    --------
    >>> import numpy as np
    >>> from geomtorsion.loops import Loop
    >>> loop = Loop.circle([1 - 1e-9, 0, 0], 1)
    >>> turns_round(loop.parts, [0, 0, 0], np.eye(3)[:2], "axis")
    1
    """
    total = 0
    for part in parts:
        if part.gap:
            raise LoopError(
                f"a loop that closes modulo periods has no winding number around the {name}: give "
                "one that closes in the coordinates themselves."
            )
        offset = across @ ((np.array(part.centre) - np.array(place)) / part.size)
        angle = 0.0
        for arc in part.arcs:
            turned, met = _turned(arc, across, offset)
            if met is not None:
                raise refusal(_through(part, arc, met, name))
            angle += turned
        total += part.times * round(angle / (2 * np.pi))
    return total


def _turned(arc: Arc, across: np.ndarray, offset: np.ndarray) -> tuple[float, float | None]:
    """The angle by which one arc turns around the line, and the s at which it meets it."""

    def plane(s: np.ndarray) -> np.ndarray:
        return across @ arc.shape(s)[0] + offset[:, None]

    count = 2 if isinstance(arc, Segment) else 8 * max(4, arc.waves) + 1
    s = np.linspace(0, 1, count)
    low, high = s[:-1], s[1:]
    angle = 0.0
    # Intervals that turn too far are halved, down to the rounding of s.
    while (high - low).max() > np.finfo(float).eps:
        one, two = plane(low), plane(high)
        cross = one[0] * two[1] - one[1] * two[0]
        turned = np.arctan2(cross, (one * two).sum(axis=0))
        share, near = nearest(one, two)
        touching = near <= CALCULATED
        if touching.any() and (isinstance(arc, Segment) or (high - low).max() < 2.0**-20):
            k = int(np.flatnonzero(touching)[0])
            return angle, float(low[k] + share[k] * (high[k] - low[k]))
        if isinstance(arc, Segment):
            return float(turned.sum()), None
        good = (np.abs(turned) < np.pi / 4) & ~touching
        angle += float(turned[good].sum())
        if good.all():
            return angle, None
        middle = (low + high) / 2
        low, high = (
            np.concatenate([low[~good], middle[~good]]),
            np.concatenate([middle[~good], high[~good]]),
        )
    return angle, float(low[0])


def nearest(one: np.ndarray, two: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nearest points to the origin on straight lines from one to two, shape (2, k), and distances.

    Returns
    -------
    Share of the way, from 0 to 1, and largest component of the point there, shape (k,) each.
    """
    step = two - one
    square = np.maximum((step * step).sum(axis=0), np.finfo(float).tiny)
    share = np.clip(-(one * step).sum(axis=0) / square, 0, 1)
    return share, np.abs(one + share * step).max(axis=0)


def _through(part: Part, arc: Arc, s: float, name: str) -> str:
    """The message for a loop that goes through the line."""
    place = shown(part.points(arc, np.array([s]))[0][:, 0])
    return (
        f"the loop passes through the {name}, at {place}: it has no winding number around it. "
        "Lead it past that point."
    )
