"""Transport: path-ordered integrals along the arcs of a loop, adaptive, with an error estimate."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.errors import LoopError
from geomtorsion.loops.affine_map import AffineMap
from geomtorsion.loops.arcs import Arc, at_arcs, shown
from geomtorsion.loops.collocation import collocation, increments, product
from geomtorsion.loops.quadrature import MOST_AT_ONCE, NARROWEST, PIECE, ROUNDING, SMALL, intervals

if TYPE_CHECKING:
    from geomtorsion.loops.arcs import Arc

# From offsets and slopes, shape (n, k), to omega (k, n, n) and theta (k, n).
Integrand = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]

# Points of Gauss in each interval; halving it gains a factor of 2**(2 * STAGES) where it is smooth.
# One that gains less than a quarter of these digits twice, and whose error is small, has come to
# the rounding of its points.
STAGES = 8
GAIN = 2.0 ** (STAGES // 2)


@dataclass(frozen=True, eq=False)
class Transported:
    """A path-ordered integral.

    motion: rotation and translation, as increments.
    error: of the translation; turn_error: of the rotation.
    scale: integral of |theta|, the length of the image.
    points: how many points were evaluated.
    """

    motion: AffineMap
    error: float
    turn_error: float
    scale: float
    points: int


@dataclass(frozen=True, eq=False)
class _Stretches:
    """Intervals on arcs, with their motions."""

    owner: np.ndarray
    low: np.ndarray
    width: np.ndarray
    motion: np.ndarray
    size: np.ndarray


def transported(
    arcs: Sequence[Arc],
    integrand: Integrand,
    accuracy: float,
    cuts: Sequence[tuple[int, float]] = (),
) -> Transported:
    """Path-ordered product of 1 + [[omega, theta], [0, 0]] ds along arcs, s from 0 to 1 on each.

    cuts: where intervals are to end at first, as (number of the arc, s).

    Raises
    ------
    LoopError
        It does not converge near some point of the path; the message names it.
    """

    owner, low, width = intervals(arcs, cuts)
    waiting = _measured(arcs, integrand, owner, low, width)
    points = len(owner) * STAGES
    done: list[_Stretches] = []
    errors: list[np.ndarray] = []
    total = np.maximum(waiting.size.sum(axis=0), np.finfo(float).tiny)
    before = earlier = np.full((len(owner), 2), np.inf)
    while len(waiting.owner):
        halves = _halved(arcs, integrand, waiting)
        points += len(halves.owner) * STAGES
        one, two = halves.motion[0::2], halves.motion[1::2]
        joined = one + two + one @ two
        change = np.abs(joined - waiting.motion)
        found = np.stack([change[:, :-1, :-1].max(axis=(1, 2)), change[:, :-1, -1].max(axis=1)], 1)
        total = np.maximum(total, waiting.size.sum(axis=0))
        allowed = np.maximum(
            accuracy * total * waiting.width[:, None] / len(arcs), 4 * ROUNDING * waiting.size
        )
        slow = (found > before / GAIN) & (before > earlier / GAIN)
        stalled = slow & (found <= SMALL * waiting.size)
        good = np.asarray(((found <= allowed) | stalled).all(axis=1))
        narrow = ~good & (waiting.width < NARROWEST)
        if narrow.any() or len(waiting.owner) > MOST_AT_ONCE or not np.isfinite(found).all():
            worst = int(np.argmax(np.where(np.isfinite(found[:, 1]), found.max(axis=1), np.inf)))
            raise _stuck(arcs, waiting, worst)
        done.append(_chosen(waiting, good, joined))
        errors.append(found[good] + ROUNDING / 2 * waiting.size[good])
        waiting = _chosen(halves, np.repeat(~good, 2))
        before, earlier = (np.repeat(x[~good], 2, axis=0) for x in (found, before))
    return _assembled(done, errors, points)


def _assembled(done: list[_Stretches], errors: list[np.ndarray], points: int) -> Transported:
    """All stretches in the order of the path, multiplied."""
    owner = np.concatenate([part.owner for part in done])
    low = np.concatenate([part.low for part in done])
    order = np.lexsort((low, owner))
    motion = np.concatenate([part.motion for part in done])[order]
    size = np.concatenate([part.size for part in done])
    increment, error = product(motion, np.concatenate(errors)[order])
    scale = float(size[:, 1].sum())
    return Transported(AffineMap(increment), float(error[1]), float(error[0]), scale, points)


def _chosen(
    stretches: _Stretches, which: np.ndarray, motion: np.ndarray | None = None
) -> _Stretches:
    """Some of the stretches, with better motions if there are any."""
    better = stretches.motion if motion is None else motion
    return _Stretches(
        stretches.owner[which], stretches.low[which], stretches.width[which], better[which],
        stretches.size[which],
    )  # fmt: skip


def _halved(arcs: Sequence[Arc], integrand: Integrand, stretches: _Stretches) -> _Stretches:
    """Both halves of each stretch, one after the other."""
    owner, width = np.repeat(stretches.owner, 2), np.repeat(stretches.width / 2, 2)
    low = np.repeat(stretches.low, 2)
    low[1::2] += width[1::2]
    return _measured(arcs, integrand, owner, low, width)


def _measured(
    arcs: Sequence[Arc],
    integrand: Integrand,
    owner: np.ndarray,
    low: np.ndarray,
    width: np.ndarray,
) -> _Stretches:
    """Motions over stretches, in pieces that fit in memory."""
    nodes, weights, _ = collocation(STAGES)
    most = max(1, PIECE // STAGES)
    motions, sizes = [], []
    for start in range(0, len(owner), most):
        part = slice(start, start + most)
        s = low[part, None] + width[part, None] * nodes
        offsets, slopes = at_arcs(arcs, owner[part], s)
        omega, theta = integrand(offsets, slopes)
        n, count = theta.shape[1], len(s)
        omega = omega.reshape(count, STAGES, n, n) * width[part, None, None, None]
        theta = theta.reshape(count, STAGES, n) * width[part, None, None]
        motions.append(increments(omega, theta))
        lengths = np.stack([np.abs(omega).max(axis=(2, 3)), np.abs(theta).max(axis=2)])
        sizes.append((lengths @ weights).T)
    return _Stretches(owner, low, width, np.concatenate(motions), np.concatenate(sizes))


def _stuck(arcs: Sequence[Arc], stretches: _Stretches, worst: int) -> LoopError:
    """The error for a path along which the integral does not converge."""
    arc = arcs[int(stretches.owner[worst])]
    middle = float(stretches.low[worst] + stretches.width[worst] / 2)
    place = shown(arc.shape(np.array([middle]))[0][:, 0])
    return LoopError(
        f"the development does not converge near offset {place} from the centre of the loop: the "
        "frame is singular there, or turns without end. Move the loop away from that point."
    )
