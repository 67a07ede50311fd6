"""Quadrature: sums over arcs and surfaces, refined until two of them agree."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.loops.arcs import Arc, at_arcs
from geomtorsion.support.caching import read_only
from geomtorsion.support.precision import GOLDEN, HALF

# From offsets and slopes, shape (n, k) each, to values of shape (m, k).
Integrand = Callable[[np.ndarray, np.ndarray], np.ndarray]
# From arcs by number, shape (p,), and s on each, shape (p, k), to values of shape (m, p, k).
Sampler = Callable[[np.ndarray, np.ndarray], np.ndarray]

# Points that are evaluated at once, which fit in the cache: more or fewer change only the time. An
# integral may take many such pieces, and one level of a rule a few.
PIECE = 2**15
MOST_POINTS, MOST_AT_ONCE = 1024 * PIECE, 4 * PIECE
# Each level of a rule has more points than the one before by the golden ratio, shifted by the
# golden section of a step: no frequency hides from both.
GROWTH, SHIFT = 1 + GOLDEN, 1 - GOLDEN
# Beyond some 100 times the points that the curve needs, the integrand has a narrow peak, and
# halving intervals is cheaper.
LEVELS = 11
# A few units in the last place: what rounding does to a number, and to a sum of some.
ROUNDING = 4 * float(np.finfo(float).eps)
# Intervals shorter than this, as share of an arc, have ends that rounding moves too much.
NARROWEST = 64 * ROUNDING

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
class Rule:
    """A rule on (0, 1) with a coarser one, against which its error is estimated.

    nodes: of both; fine, coarse: their weights, zero where a node belongs to the other one.
    """

    nodes: np.ndarray
    fine: np.ndarray
    coarse: np.ndarray


@dataclass(frozen=True, eq=False)
class Integral:
    """Result of an integral.

    value: shape (m,).
    truncation: estimate of the error by comparison with a coarser rule, norm of a vector.
    points: how many points were evaluated.
    converged: whether truncation is below the requested accuracy or floor.
    rule: which rule it was.
    worst: where it converged worst, (number of the arc, s); None if it converged.
    """

    value: np.ndarray
    truncation: float
    points: int
    converged: bool
    rule: str
    worst: tuple[int, float] | None = None


@dataclass(frozen=True, eq=False)
class Integrals:
    """Results of several integrals, along the last axis.

    values: shape (m, k); truncation, converged: shape (k,), as of `Integral`.
    points: how many points were evaluated; intervals: how many intervals there were in the end,
        or the highest level.
    sizes: integrals of the largest absolute value, shape (k,), where these are known.
    worst: where the first that did not converge did worst.
    """

    values: np.ndarray
    truncation: np.ndarray
    converged: np.ndarray
    points: int
    intervals: int
    sizes: np.ndarray | None = None
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
    # Values that are not finite never count as converged.
    with np.errstate(all="ignore"):
        if len(arcs) == 1 and arcs[0].is_periodic:
            integral = trapezoid(arcs[0], integrand, accuracy, floor, most)
            if integral.converged:
                return integral
        return kronrod(arcs, integrand, accuracy, floor, most)


def trapezoid(
    arc: Arc, integrand: Integrand, accuracy: float, floor: float, most: int = MOST_POINTS
) -> Integral:
    """The trapezoid rule on a closed smooth arc: spectral, compared with fewer points."""
    counts = [equidistant(arc.waves, level) for level in range(LEVELS)]

    def mean(level: int, _: np.ndarray | None = None) -> np.ndarray:
        total = np.zeros(1)
        for start in range(0, counts[level], PIECE):
            s = places(counts[level], level, start, PIECE)
            total = total + integrand(*arc.shape(s)).sum(axis=1)
        return total[:, None] / counts[level]

    levels = max(2, sum(count <= most for count in counts))
    integral = refined([mean(0), mean(1)], mean, accuracy, np.array([floor]), levels)
    points = sum(counts[: integral.intervals + 1])
    rule = f"trapezoid, {counts[integral.intervals]} points"
    done = bool(integral.converged[0])
    return Integral(integral.values[:, 0], float(integral.truncation[0]), points, done, rule)


def equidistant(waves: int, level: int, first: int = 16) -> int:
    """How many points the trapezoid rule of a level has: odd, and enough for the curve itself."""
    return int(max(first, 3 * waves + 1) * GROWTH**level) | 1


def places(count: int, level: int, start: int = 0, most: int = MOST_POINTS) -> np.ndarray:
    """The equidistant s of a level, or those from `start` on."""
    return (np.arange(start, min(count, start + most)) + SHIFT * level) / count


def refined(
    first: Sequence[np.ndarray],
    evaluate: Callable[[int, np.ndarray], np.ndarray],
    accuracy: float,
    floor: np.ndarray,
    levels: int,
) -> Integrals:
    """Several integrals by rules of rising level, each until it agrees with the level before.

    Parameters
    ----------
    first
        Values of the first two levels, shape (m, k) each.
    evaluate
        From a level and the numbers of the integrals that need it, to their values.
    floor
        Truncation below which each is good enough anyway, shape (k,).
    """
    before, better = first
    count = better.shape[1]
    todo = np.arange(count)
    values = np.empty_like(better)
    truncation, converged = np.empty(count), np.empty(count, dtype=bool)
    level = 1
    while True:
        change = np.abs(better - before).max(axis=0)
        size = np.abs(better).max(axis=0)
        good = np.isfinite(change) & (change <= np.maximum(accuracy * size, floor[todo]))
        values[:, todo], truncation[todo], converged[todo] = better, change, good
        level += 1
        if level >= levels or good.all():
            break
        before, todo = better[:, ~good], todo[~good]
        better = evaluate(level, todo)
    truncation[np.isnan(truncation)] = np.inf
    return Integrals(values, truncation, converged, 0, level - 1)


def norm(vector: np.ndarray) -> float:
    """Largest component; infinite if one is not finite."""
    largest = float(np.abs(vector).max(initial=0.0))
    return math.inf if math.isnan(largest) else largest


@cache
def kronrod_rule() -> Rule:
    """Kronrod's 15 nodes, with the rule of Gauss on 7 of them."""
    half = np.array(KRONROD_NODES)
    nodes = np.concatenate([-half[:-1], half[::-1]])
    weights = np.array(KRONROD_WEIGHTS)
    coarse = np.zeros(8)
    coarse[1::2] = GAUSS_WEIGHTS
    fine, coarse = (np.concatenate([w[:-1], w[::-1]]) / 2 for w in (weights, coarse))
    return Rule(read_only((1 + nodes) / 2), read_only(fine), read_only(coarse))


@cache
def gauss_pair(few: int, many: int) -> Rule:
    """Two rules of Gauss: fewer points than Kronrod's where most integrals are easy."""
    (x, w), (y, u) = (gauss_rule(k) for k in (many, few))
    zeros = np.zeros
    columns = ([x, y], [w, zeros(few)], [zeros(many), u])
    return Rule(*(read_only(np.concatenate(column)) for column in columns))


@cache
def gauss_rule(points: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes on (0, 1) and weights of Gauss and Legendre."""
    x, w = np.polynomial.legendre.leggauss(points)
    return read_only((1 + x) / 2), read_only(w / 2)


@cache
def ray_rule(points: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes on (0, 1) and weights for the weight s: Gauss and Jacobi."""
    x, w = scipy.special.roots_jacobi(points, 0, 1)
    return read_only((1 + x) / 2), read_only(w / 4)


def kronrod(
    arcs: Sequence[Arc],
    integrand: Integrand,
    accuracy: float,
    floor: float,
    most: int = MOST_POINTS,
    cuts: Sequence[tuple[int, float]] = (),
) -> Integral:
    """Gauss and Kronrod on every arc, the worst intervals halved until the sum is accurate.

    Parameters
    ----------
    cuts
        Where the intervals are to end at first, as (number of the arc, s): a narrow peak there
        would be missed.
    """
    owner, low, width = intervals(arcs, cuts)

    def sampler(owner: np.ndarray, s: np.ndarray) -> np.ndarray:
        return integrand(*at_arcs(arcs, owner, s)).reshape(-1, *s.shape)

    floors = np.array([floor])
    group = np.zeros(len(arcs), dtype=np.int64)
    total = halved(sampler, group, (owner, low, width), kronrod_rule(), accuracy, floors, most=most)
    return Integral(
        total.values[:, 0],
        float(total.truncation[0]),
        total.points,
        bool(total.converged[0]),
        f"Gauss-Kronrod, {total.intervals} intervals",
        total.worst,
    )


def intervals(
    arcs: Sequence[Arc], cuts: Sequence[tuple[int, float]] = (), each: float = 0.5
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The first intervals on arcs, some for each wave: owner, start and width, shape (p,)."""
    counts = np.array([1 + int(each * arc.waves) for arc in arcs])
    owner = np.repeat(np.arange(len(arcs)), counts)
    low = (np.arange(len(owner)) - (np.cumsum(counts) - counts)[owner]) / counts[owner]
    return cut(owner, low, cuts)


def cut(
    owner: np.ndarray, low: np.ndarray, cuts: Sequence[tuple[int, float]]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Intervals that start where they did, and at the cuts: owner, start and width."""
    if cuts:
        starts = sorted({*zip(owner.tolist(), low.tolist(), strict=True), *cuts})
        owner, low = np.array([k for k, _ in starts]), np.array([s for _, s in starts])
    high = np.append(low[1:], 1.0)
    high[:-1][owner[1:] != owner[:-1]] = 1.0
    return owner, low, high - low


def graded(place: float, width: float, step: float) -> list[float]:
    """Cuts in (0, 1) on both sides of a narrow peak: from its width on, each twice as far.

    width: how far from its top it has half its height. step: half the way between two points of a
    rule, which would not miss a peak of this width or more.
    """
    if width >= step:
        return []
    distances = [0.0, *(width * 2.0**k for k in range(math.ceil(math.log2(step / width)) + 2))]
    return [s for d in distances for s in (place - d, place + d) if 0 < s < 1]


def halved(
    sampler: Sampler,
    group: np.ndarray,
    start: tuple[np.ndarray, np.ndarray, np.ndarray],
    rule: Rule,
    accuracy: float,
    floor: np.ndarray,
    noise: float | np.ndarray = 0.0,
    most: int = MOST_POINTS,
) -> Integrals:
    """Sums over intervals, the worst of which are halved until the sum of each group is accurate.

    Parameters
    ----------
    group
        To which sum each arc belongs, shape (arcs,).
    start
        The first intervals: arc, start and width, each of shape (p,).
    accuracy, floor
        A group ends when its truncation is below accuracy * |value|, or below its floor, shape
        (groups,).
    noise
        Or when it is below this share of the integral of the absolute value.
    """
    owner, low, width = start
    values, errors, sizes = _panels(sampler, rule, owner, low, width)
    stuck = np.zeros(len(owner), dtype=bool)
    points = len(rule.nodes) * len(owner)
    worst = None
    while True:
        member = group[owner]
        finite = np.isfinite(errors)
        total = _summed(np.where(finite, values, 0) if not finite.all() else values, member, floor)
        truncation = _summed(errors[None], member, floor)[0]
        absolute = _summed(sizes[None], member, floor)[0]
        allowed = np.maximum(accuracy * np.abs(total).max(axis=0), floor)
        allowed = np.maximum(allowed, noise * absolute)
        share = allowed / (2 * np.bincount(member, minlength=len(floor)))
        bad = ~finite | ((errors > share[member]) & (errors > ROUNDING * sizes) & ~stuck)
        converged = np.isfinite(truncation) & (truncation <= allowed)
        bad &= ~converged[member]
        if not bad.any():
            break
        narrow = width[bad].min() < NARROWEST
        if narrow or points + 2 * len(rule.nodes) * int(bad.sum()) > most:
            unsettled = np.where(bad, np.where(finite, errors, np.inf), -np.inf)
            place = int(np.argmax(unsettled))
            worst = (int(owner[place]), float(low[place] + width[place] / 2))
            break
        halves = np.repeat(width[bad] / 2, 2)
        starts = np.repeat(low[bad], 2)
        starts[1::2] += halves[1::2]
        owners = np.repeat(owner[bad], 2)
        new_values, new_errors, new_sizes = _panels(sampler, rule, owners, starts, halves)
        # Halving that helps no more, where the error is small, has met rounding.
        pairs = new_errors.reshape(-1, 2).sum(axis=1)
        rounded = (pairs > errors[bad] / 2) & (pairs < HALF * new_sizes.reshape(-1, 2).sum(axis=1))
        points += len(rule.nodes) * len(owners)
        good = ~bad
        owner, low = np.append(owner[good], owners), np.append(low[good], starts)
        width, errors = np.append(width[good], halves), np.append(errors[good], new_errors)
        sizes = np.append(sizes[good], new_sizes)
        stuck = np.append(stuck[good], np.repeat(rounded, 2))
        values = np.concatenate([values[:, good], new_values], axis=1)
    done = np.ones(len(floor), dtype=bool)
    if worst is not None:
        done[group[owner[bad]]] = False
    values = _summed(values, group[owner], floor)
    return Integrals(values, truncation, done, points, len(owner), absolute, worst)


def _summed(values: np.ndarray, member: np.ndarray, floor: np.ndarray) -> np.ndarray:
    """Sums over the intervals of each group, shape (m, groups)."""
    if len(floor) == 1:
        return values.sum(axis=1, keepdims=True)
    return np.stack([np.bincount(member, row, len(floor)) for row in values])


def _panels(
    sampler: Sampler, rule: Rule, owner: np.ndarray, low: np.ndarray, width: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Value, shape (m, p), error, and integral of the absolute value over each interval."""
    most = max(1, PIECE // len(rule.nodes))
    panels = []
    for start in range(0, len(owner), most):
        chosen = slice(start, start + most)
        s = low[chosen, None] + width[chosen, None] * rule.nodes
        values = sampler(owner[chosen], s) * width[chosen, None]
        errors = np.abs(values @ (rule.fine - rule.coarse)).max(axis=0)
        panels.append((values @ rule.fine, errors, (np.abs(values) @ rule.fine).max(axis=0)))
    values, errors, sizes = (np.concatenate(parts, axis=-1) for parts in zip(*panels, strict=True))
    return values, np.where(np.isfinite(errors), errors, np.inf), sizes
