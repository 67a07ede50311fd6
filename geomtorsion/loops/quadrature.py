"""Quadrature: integrals along arcs, by the trapezoid rule or by Gauss and Kronrod, adaptive."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from geomtorsion.loops.arcs import Arc

Integrand = Callable[[np.ndarray, np.ndarray], np.ndarray]

# How many points an integral may take, and how many are evaluated at once.
MOST_POINTS = 2**25
PIECE = 2**15
# Trapezoid rules are compared with one of 1.6 times the points, shifted by the golden section:
# no frequency hides from both.
GROWTH = 1.6
SHIFT = 0.3819660112501051
FIRST_TRAPEZOID = 16
# Beyond this many times the points that the curve needs, the integrand has a narrow peak.
PATIENCE = 100
NARROWEST = 2.0**-44
# Errors of an interval below this share of its integral are rounding; so are those below SMALL
# that halving does not reduce.
FLOOR, SMALL = 1e-15, 1e-8

# Kronrod's 15 nodes on (0, 1) with the 7 of Gauss among them (QUADPACK, routine qk15).
KRONROD_NODES = (
    0.991455371120812639206854697526329, 0.949107912342758524526189684047851,
    0.864864423359769072789712788640926, 0.741531185599394439863864773280788,
    0.586087235467691130294144691693013, 0.405845151377397166906606412076961,
    0.207784955007898467600689403773245, 0.0,
)  # fmt: skip
KRONROD_WEIGHTS = (
    0.022935322010529224963732008058970, 0.063092092629978553290700663189204,
    0.104790010322250183839876322541518, 0.140653259715525918745189590510238,
    0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
    0.204432940075298892414161999234649, 0.209482141084727828012999174891714,
)  # fmt: skip
GAUSS_WEIGHTS = (
    0.129484966168869693270611432679082, 0.279705391489276667901467771423780,
    0.381830050505118944950369775488975, 0.417959183673469387755102040816327,
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Integral:
    """What an integral came to.

    value: shape (m,).
    truncation: estimate of the error by comparison with a coarser rule, norm of a vector.
    points: how many points were evaluated.
    converged: whether truncation is below the accuracy or the floor asked for.
    rule: which rule it was.
    worst: where it converged worst, (number of the arc, s); None if it converged.
    """

    value: np.ndarray
    truncation: float
    points: int
    converged: bool
    rule: str
    worst: tuple[int, float] | None = None


def integrate(
    arcs: Sequence[Arc],
    integrand: Integrand,
    accuracy: float,
    floor: float = 0.0,
    most: int = MOST_POINTS,
) -> Integral:
    """Integral over s along all arcs of integrand(offsets, slopes).

    Parameters
    ----------
    integrand
        From offsets and slopes, shape (n, k) each, to values of shape (m, k).
    accuracy, floor
        It ends when the truncation is below accuracy * |value|, or below the floor.
    most
        Largest number of points.
    """

    # What is not finite is looked at, and never counts as converged.
    with np.errstate(all="ignore"):
        if len(arcs) == 1 and arcs[0].is_periodic:
            found = trapezoid(arcs[0], integrand, accuracy, floor, most)
            if found.converged:
                return found
        return kronrod(arcs, integrand, accuracy, floor, most)


def trapezoid(
    arc: Arc, integrand: Integrand, accuracy: float, floor: float, most: int = MOST_POINTS
) -> Integral:
    """The trapezoid rule on a closed smooth arc: spectral, compared with fewer points."""

    few = max(FIRST_TRAPEZOID, 3 * arc.waves + 1)
    last = min(most, PATIENCE * few)
    many = _next(few)
    s = np.concatenate([np.arange(few) / few, (np.arange(many) + SHIFT) / many])
    values = _values(arc, integrand, s)
    coarse, fine = values[:, :few].mean(axis=1), values[:, few:].mean(axis=1)
    points = few + many
    while True:
        truncation = _norm(fine - coarse)
        done = math.isfinite(truncation) and truncation <= max(accuracy * _norm(fine), floor)
        if done or _next(many) > last:
            return Integral(fine, truncation, points, done, f"trapezoid, {many} points")
        many = _next(many)
        coarse, fine = fine, _mean(arc, integrand, many)
        points += many


def _next(points: int) -> int:
    """The next odd number of points."""
    return int(points * GROWTH) | 1


def _mean(arc: Arc, integrand: Integrand, points: int) -> np.ndarray:
    """Mean over equidistant points, in pieces that fit in memory."""

    total = 0.0
    for start in range(0, points, PIECE):
        s = (np.arange(start, min(points, start + PIECE)) + SHIFT) / points
        total = total + _values(arc, integrand, s).sum(axis=1)
    return np.asarray(total / points)


def _values(arc: Arc, integrand: Integrand, s: np.ndarray) -> np.ndarray:
    """The integrand on an arc."""
    return integrand(*arc.shape(s))


def _norm(vector: np.ndarray) -> float:
    """Largest component; what is not finite counts as infinite."""

    largest = float(np.abs(vector).max(initial=0.0))
    return float("inf") if np.isnan(largest) else largest


@cache
def kronrod_rule() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes on (0, 1), Kronrod's weights and Gauss's weights on the same nodes."""

    half = np.array(KRONROD_NODES)
    nodes = np.concatenate([-half[:-1], half[::-1]])
    weights = np.array(KRONROD_WEIGHTS)
    coarse = np.zeros(8)
    coarse[1::2] = GAUSS_WEIGHTS
    fine, coarse = (np.concatenate([w[:-1], w[::-1]]) / 2 for w in (weights, coarse))
    return (1 + nodes) / 2, fine, coarse


def kronrod(
    arcs: Sequence[Arc],
    integrand: Integrand,
    accuracy: float,
    floor: float,
    most: int = MOST_POINTS,
) -> Integral:
    """Gauss and Kronrod on every arc, the worst intervals halved until the sum is accurate."""

    owner = np.arange(len(arcs))
    low, width = np.zeros(len(arcs)), np.ones(len(arcs))
    pieces = max((1 + arc.waves // 2 for arc in arcs), default=1)
    if pieces > 1:
        owner, low = np.repeat(owner, pieces), np.tile(np.arange(pieces) / pieces, len(arcs))
        width = np.full(len(owner), 1 / pieces)
    values, errors, sizes = _panels(arcs, integrand, owner, low, width)
    stuck = np.zeros(len(owner), dtype=bool)
    points = 15 * len(owner)
    while True:
        fine, truncation = values.sum(axis=1), float(errors.sum())
        finite = np.isfinite(errors)
        allowed = max(accuracy * _norm(values[:, finite].sum(axis=1)), floor)
        rule = f"Gauss-Kronrod, {len(owner)} intervals"
        bad = ~finite | ((errors > allowed / (2 * len(owner))) & (errors > FLOOR * sizes) & ~stuck)
        if (truncation <= allowed and finite.all()) or not bad.any():
            return Integral(fine, truncation, points, True, rule)
        narrow = width[bad].min() < NARROWEST
        if narrow or points + 30 * int(bad.sum()) > most:
            worst = int(np.argmax(np.where(np.isfinite(errors), errors, np.inf)))
            place = (int(owner[worst]), float(low[worst] + width[worst] / 2))
            return Integral(fine, truncation, points, False, rule, place)
        halves = np.repeat(width[bad] / 2, 2)
        starts = np.repeat(low[bad], 2)
        starts[1::2] += halves[1::2]
        owners = np.repeat(owner[bad], 2)
        new_values, new_errors, new_sizes = _panels(arcs, integrand, owners, starts, halves)
        # Halving that helps no more, where the error is small, has met rounding.
        pairs = new_errors.reshape(-1, 2).sum(axis=1)
        held = (pairs > errors[bad] / 2) & (pairs < SMALL * new_sizes.reshape(-1, 2).sum(axis=1))
        points += 15 * len(owners)
        good = ~bad
        owner, low = np.append(owner[good], owners), np.append(low[good], starts)
        width, errors = np.append(width[good], halves), np.append(errors[good], new_errors)
        sizes = np.append(sizes[good], new_sizes)
        stuck = np.append(stuck[good], np.repeat(held, 2))
        values = np.concatenate([values[:, good], new_values], axis=1)


def _panels(
    arcs: Sequence[Arc],
    integrand: Integrand,
    owner: np.ndarray,
    low: np.ndarray,
    width: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Value, shape (m, panels), error, and integral of the absolute value over each interval."""

    nodes, fine, coarse = kronrod_rule()
    most = max(1, PIECE // len(nodes))
    found = []
    for start in range(0, len(owner), most):
        chosen = slice(start, start + most)
        s = low[chosen, None] + width[chosen, None] * nodes
        offsets, slopes = _at(arcs, owner[chosen], s)
        values = integrand(offsets, slopes).reshape(-1, *s.shape) * width[chosen, None]
        errors = np.abs(values @ (fine - coarse)).max(axis=0)
        found.append((values @ fine, errors, (np.abs(values) @ fine).max(axis=0)))
    values, errors, sizes = (np.concatenate(parts, axis=-1) for parts in zip(*found, strict=True))
    return values, np.where(np.isfinite(errors), errors, np.inf), sizes


def _at(arcs: Sequence[Arc], owner: np.ndarray, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Offsets and slopes on several arcs at once, shape (n, points)."""

    if (owner == owner[0]).all():
        return arcs[owner[0]].shape(s.ravel())
    order = np.argsort(owner, kind="stable")
    numbers, starts = np.unique(owner[order], return_index=True)
    parts = [
        arcs[k].shape(s[rows].ravel())
        for k, rows in zip(numbers, np.split(order, starts[1:]), strict=True)
    ]
    offsets, slopes = (np.concatenate(arrays, axis=1) for arrays in zip(*parts, strict=True))
    back = np.empty_like(order)
    back[order] = np.arange(len(order))
    shape = (len(offsets), *s.shape)
    first, second = (x.reshape(shape)[:, back].reshape(len(x), -1) for x in (offsets, slopes))
    return first, second
