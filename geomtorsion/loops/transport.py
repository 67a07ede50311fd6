"""Transport: path-ordered integrals along the arcs of a loop, adaptive, with an error estimate."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from geomtorsion.errors import LoopError
from geomtorsion.loops.affine_map import AffineMap
from geomtorsion.loops.arcs import Arc, at_arcs, shown
from geomtorsion.loops.quadrature import MOST_AT_ONCE, NARROWEST, PIECE, ROUNDING, intervals
from geomtorsion.support.caching import read_only
from geomtorsion.support.precision import HALF

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
    owner, low, width = intervals(arcs, cuts, each=1)
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
        combined = one + two + one @ two
        change = np.abs(combined - waiting.motion)
        gaps = np.stack([change[:, :-1, :-1].max(axis=(1, 2)), change[:, :-1, -1].max(axis=1)], 1)
        total = np.maximum(total, waiting.size.sum(axis=0))
        allowed = np.maximum(
            accuracy * total * waiting.width[:, None] / len(arcs), 4 * ROUNDING * waiting.size
        )
        slow = (gaps > before / GAIN) & (before > earlier / GAIN)
        stalled = slow & (gaps <= HALF * waiting.size)
        good = np.asarray(((gaps <= allowed) | stalled).all(axis=1))
        narrow = ~good & (waiting.width < NARROWEST)
        if narrow.any() or len(waiting.owner) > MOST_AT_ONCE or not np.isfinite(gaps).all():
            worst = int(np.argmax(np.where(np.isfinite(gaps[:, 1]), gaps.max(axis=1), np.inf)))
            raise _stuck(arcs, waiting, worst)
        done.append(_chosen(waiting, good, combined))
        errors.append(gaps[good] + ROUNDING / 2 * waiting.size[good])
        waiting = _chosen(halves, np.repeat(~good, 2))
        before, earlier = (np.repeat(x[~good], 2, axis=0) for x in (gaps, before))
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
        "frame is singular there, or rotates without end. Move the loop away from that point."
    )


@cache
def collocation(stages: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes and weights of Gauss on (0, 1), integrals of the node polynomials up to each node."""
    x, w = np.polynomial.legendre.leggauss(stages)
    # Integrals of Lagrange polynomials through their expansion in Legendre polynomials.
    values = np.polynomial.legendre.legvander(x, stages)
    k = np.arange(stages)
    expansion = values[:, :stages].T * w * (2 * k[:, None] + 1) / 2
    integrals = np.empty((stages, stages))
    integrals[:, 0] = x + 1
    integrals[:, 1:] = (values[:, 2:] - values[:, :-2]) / (2 * k[1:] + 1)
    return read_only((x + 1) / 2), read_only(w / 2), read_only(integrals @ expansion / 2)


def inner_turns(omega: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Y - 1 at the nodes for Y' = Y omega, Y = 1 at the start; shapes (m, stages, n, n).

    weights: the integrals of `collocation`.
    """
    # Matrices as rows: a product of weights with all stretches at once, much faster than einsum.
    flat = (*omega.shape[:2], -1)
    first = (weights @ omega.reshape(flat)).reshape(omega.shape)
    turns, before = first, np.inf
    while True:
        after = first + (weights @ (turns @ omega).reshape(flat)).reshape(omega.shape)
        change = np.abs(after - turns).max(initial=0.0)
        turns = after
        if change <= np.finfo(float).eps / 4 * np.abs(turns).max(initial=0.0):
            return turns
        # Where a sweep no longer halves the change, one linear system is cheaper.
        if not change < before / 2:
            return _solved(omega, weights)
        before = change


def _solved(omega: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """The same by one linear system for each stretch, where the fixed point is too far."""
    m, stages, n, _ = omega.shape
    system = np.eye(stages * n) - np.einsum("kl,mlij->mkjli", weights, omega).reshape(
        m, stages * n, stages * n
    )
    first = np.einsum("kl,mlij->mkji", weights, omega).reshape(m, stages * n, n)
    solution = np.linalg.solve(system, first)
    return solution.reshape(m, stages, n, n).transpose(0, 1, 3, 2)


def increments(omega: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """G - 1 over stretches for G' = G [[omega, theta], [0, 0]], shape (m, n + 1, n + 1).

    Order 2 * stages; quadratic invariants (lengths) are kept.

    Parameters
    ----------
    omega, theta
        Values at the nodes times the width of the stretch, shapes (m, stages, n, n) and
        (m, stages, n).
    """
    m, stages, n = theta.shape
    _, weights, integrals = collocation(stages)
    result = np.zeros((m, n + 1, n + 1), dtype=np.result_type(omega, theta))
    result[:, :n, n] = np.einsum("l,mli->mi", weights, theta)
    if omega.any():
        inner = inner_turns(omega, integrals)
        result[:, :n, :n] = np.einsum("l,mlij->mij", weights, omega + inner @ omega)
        result[:, :n, n] += np.einsum("l,mlij,mlj->mi", weights, inner, theta)
    return result


def product(increments: np.ndarray, errors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Ordered product of 1 + increments, minus 1, and the error carried along.

    Parameters
    ----------
    increments
        Shape (m, n + 1, n + 1), in the order of the path.
    errors
        Errors of the rotation and of the translation of each, shape (m, 2).
    """
    while len(increments) > 1:
        odd = len(increments) % 2
        last, last_error = increments[-1:], errors[-1:]
        end = len(increments) - odd
        one, two = increments[0:end:2], increments[1:end:2]
        size = np.linalg.norm(one[:, :-1, :-1] + np.eye(one.shape[1] - 1), 2, axis=(1, 2))
        second_size = np.linalg.norm(two[:, :-1, :-1] + np.eye(one.shape[1] - 1), 2, axis=(1, 2))
        shift = np.linalg.norm(two[:, :-1, -1], axis=1)
        a, b = errors[0:end:2], errors[1:end:2]
        turn = a[:, 0] * second_size + size * b[:, 0]
        errors = np.stack([turn, a[:, 1] + a[:, 0] * shift + size * b[:, 1]], axis=1)
        increments = one + two + one @ two
        if odd:
            increments = np.concatenate([increments, last])
            errors = np.concatenate([errors, last_error])
    return increments[0], errors[0]
