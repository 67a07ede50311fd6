"""Roundings: how far the roundings of all steps move an answer, from their covariance.

Each step rounds each state at random, and the motion carries these roundings on as it carries all
small errors: v' = J v along the answer, J the derivative of the rates. SETS independent sets of
roundings are carried at once; their mean squares are the variances.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Protocol

import numpy as np

from geomtorsion.ode.numbers import floats
from geomtorsion.ode.system import STEPS_AT_ONCE, Batch, System, Track
from geomtorsion.ode.trajectory import Segment, Stage, Trajectory
from geomtorsion.support.caching import read_only
from geomtorsion.support.precision import EPS

# Mean squares of so many sets are right to some 18 %.
SETS = 16
# Half a unit in the last place is the largest rounding; all below it are as likely.
EVEN = 1 / math.sqrt(3)
# Relative change for difference quotients.
SMALL = math.sqrt(EPS)
# Largest rate times a step of which the third power leaves half of the digits.
STIFF = EPS ** (-1 / 6)
# Nodes and weights of Lobatto's rule of order six, on [-1/2, 1/2].
NODES = np.array([-0.5, -math.sqrt(0.05), math.sqrt(0.05), 0.5])
WEIGHTS = np.array([1, 5, 5, 1]) / 12


class Comparable(Protocol):
    """What knows how to read states of a motion for comparison."""

    def rows(self, segment: Segment, states: np.ndarray, label: str) -> np.ndarray:
        """States of a segment in the coordinates of a label, shape (m, size)."""
        ...

    def read_gaps(
        self, one: Trajectory, two: Trajectory, count: int, accuracy: float, /
    ) -> list[tuple[np.ndarray, float]]:
        """What a reader gets at the first samples: differences at each, and the size of all.

        accuracy: the part of a size below which differences do not count.
        """
        ...

    def first_stage(self, precision: int, perturbation: float, /) -> Stage:
        """The equations with their start; perturbation: the part by which numbers are changed."""
        ...


def rounded(problem: Comparable, answer: Trajectory, deviations: float) -> Trajectory:
    """The answer, moved by so many standard deviations of its roundings at each sample.

    All states are moved at once, with the signs that they have in one set of roundings.
    """
    scale = deviations * 2.0**-answer.engine.precision
    first = answer.segments[0].stage
    moved = problem.first_stage(53, SMALL)
    sets = np.abs(first.first)[:, None] * EVEN * _signs(0, len(first.first))[0]
    segments: list[Segment] = []
    for k, segment in enumerate(answer.segments):
        stage = segment.stage
        if k:
            moved, sets = _after(problem, answer.segments[k - 1], stage, moved, sets)
        track, numbers = answer.track(k), floats(stage.parameters)
        inexact = np.array(floats(moved.parameters)) != numbers
        along, sets = carried(stage.system, track, numbers, inexact, sets, segment.run.steps)
        sign = 1.0 if track.times[-1] >= track.times[0] else -1.0
        place = np.searchsorted(sign * track.times, sign * segment.times.astype(float))
        away = scale * along[np.minimum(place, len(along) - 1)]
        segments.append(_moved(segment, away, scale * along[-1]))
    return replace(answer, segments=tuple(segments))


def _moved(segment: Segment, away: np.ndarray, last: np.ndarray) -> Segment:
    """A segment with other states, and with the end that follows for a guard."""
    run, stage = segment.run, segment.stage
    reached = run.reached
    if run.outcome == "edge" and run.reached != 0:
        state, numbers = np.array(floats(run.last)), floats(stage.parameters)
        rates = np.asarray(stage.system.scalar_rates(numbers)(0.0, state))
        across, along = (_slope(stage.system, state, x, numbers) for x in (last, rates))
        with np.errstate(all="ignore"):
            # A guard that overflows has no slope.
            known = across and math.isfinite(across) and math.isfinite(along)
            later = -across / np.float64(along) if known else 0.0
            last = last + later * rates
        reached = reached + type(reached)(later)
    result = segment.resampled(segment.times, _sum(segment.states, away))
    moved = _sum(segment.last[None, :], last[None, :])[0]
    return replace(result, run=replace(result.run, last=moved, reached=reached))


def _slope(
    system: System, state: np.ndarray, direction: np.ndarray, numbers: Sequence[float]
) -> float:
    """Derivative of the guard in a direction."""
    size = float(np.abs(direction).max())
    if not 0 < size < math.inf:
        return size
    step = SMALL * (float(np.abs(state).max()) or 1.0) / size * direction
    there, back = (system.guard_at((state + x).tolist(), numbers) for x in (step, -step))
    return (there - back) / 2 * size / (SMALL * (float(np.abs(state).max()) or 1.0))


def _sum(states: np.ndarray, changes: np.ndarray) -> np.ndarray:
    """Changed states in numbers of their own kind."""
    if states.dtype not in (np.float64, np.longdouble):
        kind = states.dtype.type
        rows = [kind(x) for x in changes.ravel().tolist()]
        changes = np.array(rows, dtype=states.dtype).reshape(states.shape)
    return states + changes


def _after(
    problem: Comparable, before: Segment, stage: Stage, moved: Stage, sets: np.ndarray
) -> tuple[Stage, np.ndarray]:
    """The stage with changed numbers, and the sets of roundings, at the beginning of a stage."""
    old, last = before.stage, np.array(floats(before.last))
    if stage.parameters is old.parameters and stage.label == old.label:
        # It was only cut.
        return moved, sets
    event = moved.timed if before.run.outcome == "done" else moved.boundary
    if event is not None and event.then is not None:
        moved = event.then(before.run.reached, before.last) or stage
    if stage.label == old.label:
        return moved, unless_jumped(last, stage.first, sets)
    largest = np.abs(sets / np.maximum(np.abs(last), np.abs(last).max() * SMALL)[:, None]).max()
    if not 0 < largest < math.inf:
        return moved, np.full((len(stage.first), SETS), largest)
    part = SMALL / largest
    points = np.concatenate((last[None, :], last + part * sets.T))
    there = problem.rows(before, points, stage.label)
    return moved, (there[1:] - there[0]).T / part


def unless_jumped(before: np.ndarray, after: np.ndarray, sets: np.ndarray) -> np.ndarray:
    """Sets of roundings; states that an event sets to a value have none."""
    near = np.abs(after - before) <= SMALL * np.abs(before).max(axis=-1, keepdims=True)
    return np.where(near[..., None], sets, 0.0)


def carried(
    system: System,
    track: Track,
    numbers: Sequence[float],
    inexact: np.ndarray,
    sets: np.ndarray,
    steps: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Standard deviation of each state along a track, (k + 1, size), and the sets at its end.

    In units of half a unit in the last place of 1; with the signs of the first set.

    numbers: of the parameters; inexact: which of them are rounded.
    sets: at the beginning, shape (size, SETS); steps: how many there are.
    """
    along = [_deviations(sets[None])]
    sizes, values = _sizes(system, track.states), np.array(numbers)
    for k in range(0, len(track.times) - 1, STEPS_AT_ONCE):
        part = Track(
            track.times[k : k + STEPS_AT_ONCE + 1], track.states[k : k + STEPS_AT_ONCE + 1]
        )
        begins = np.arange(len(part.times) - 1)
        signs = _signs(k // STEPS_AT_ONCE + 1, system.size)[begins]
        share = signs * math.sqrt(steps / (len(track.times) - 1))
        made = _steps(system, part, begins, values, inexact, share, sizes)
        rows = _followed(*made, sets / sizes[:, None]) * sizes[:, None]
        sets = rows[-1]
        along.append(_deviations(rows))
    return np.concatenate(along), sets


@dataclass(frozen=True, eq=False)
class Carried:
    """Roundings of the members of a batch so far.

    sets: of their states, shape (number, size, SETS); inexact: which parameters are rounded.
    """

    sets: np.ndarray
    inexact: np.ndarray

    @classmethod
    def at_start(cls, states: np.ndarray, inexact: np.ndarray) -> Carried:
        """Roundings of the starts."""
        return cls(np.abs(states)[:, :, None] * EVEN * _signs(0, states.shape[1])[0], inexact)

    def of(self, members: slice | np.ndarray) -> Carried:
        """The roundings of some members."""
        return replace(self, sets=self.sets[members])

    def scaled(self, sizes: np.ndarray) -> Carried:
        """The same in other units of the states, shape (number, size)."""
        return replace(self, sets=self.sets * sizes[:, :, None])


def along_members(batch: Batch, carried: Carried) -> tuple[np.ndarray, np.ndarray]:
    """Standard deviations of the states of a batch at its times, and the sets at their end."""
    away, sets = np.zeros_like(batch.result), carried.sets.copy()
    inexact = np.zeros(batch.parameters.shape[1], bool)
    inexact[: len(carried.inexact)] = carried.inexact
    left = [k for k in sorted(batch.tracks) if batch.finished[k]]
    while left:
        points = np.cumsum([len(batch.tracks[k].times) for k in left])
        some = left[: max(1, int(np.searchsorted(points, STEPS_AT_ONCE)))]
        left = left[len(some) :]
        tracks = [batch.tracks[k] for k in some]
        rows, sets[some] = carried_together(
            batch.system, tracks, batch.parameters[some], inexact, sets[some], batch.steps[0, some]
        )
        for k, track, along in zip(some, tracks, rows, strict=True):
            place = np.searchsorted(np.abs(track.times), np.abs(batch.times * batch.units[k]))
            away[k] = along[np.minimum(place, len(along) - 1)]
    return away, sets


def carried_together(
    system: System,
    tracks: Sequence[Track],
    numbers: np.ndarray,
    inexact: np.ndarray,
    sets: np.ndarray,
    steps: np.ndarray,
) -> tuple[list[np.ndarray], np.ndarray]:
    """The same for many motions at once.

    numbers: of the parameters of each, shape (number, parameters); sets: (number, size, SETS);
        steps: of each, shape (number,).
    """
    counts = np.array([len(track.times) for track in tracks])
    if len(tracks) == 1 or counts.max() > STEPS_AT_ONCE:
        each = zip(tracks, numbers, sets, steps, strict=True)
        every = [carried(system, one, row, inexact, own, k) for one, row, own, k in each]
        return [along for along, _ in every], np.stack([last for _, last in every])
    ends = np.cumsum(counts)
    points = Track(*map(np.concatenate, zip(*tracks, strict=True)))
    begins = np.delete(np.arange(ends[-1]), ends - 1)
    shares = np.sqrt(steps / np.maximum(counts - 1, 1))
    signs = [x * _signs(1, system.size)[: k - 1] for k, x in zip(counts, shares, strict=True)]
    sizes = np.array([_sizes(system, track.states) for track in tracks])
    each = np.repeat(sizes, counts - 1, axis=0)
    values = np.repeat(numbers, counts, axis=0)
    propagators, kicks = _steps(
        system, points, begins, values, inexact, np.concatenate(signs), each
    )
    moving = np.flatnonzero(counts > 1)
    firsts = (ends - counts - np.arange(len(counts)))[moving]
    with np.errstate(all="ignore"):
        own = sets / sizes[:, :, None]
        kicks[firsts] += np.matmul(propagators[firsts], own[moving])
        propagators[firsts] = 0.0
        rows = _followed(propagators, kicks, np.zeros(sets.shape[1:])) * each[:, :, None]
    last = sets.copy()
    last[moving] = rows[firsts + counts[moving] - 2]
    parts = np.split(_deviations(rows), np.cumsum(counts[:-1] - 1))
    starts = _deviations(sets)
    return [np.concatenate((a[None], b)) for a, b in zip(starts, parts, strict=True)], last


def _deviations(sets: np.ndarray) -> np.ndarray:
    """Root of the mean square, with the sign of the first set, shape (k, size)."""
    with np.errstate(all="ignore"):
        result = np.sqrt((sets**2).mean(axis=2)) * np.sign(sets[:, :, 0])
    return np.where(np.isnan(result), math.inf, result)


def _sizes(system: System, states: np.ndarray) -> np.ndarray:
    """Size of each state along the way; a state near zero takes the size of its group."""
    sizes = np.abs(states).max(axis=0)
    for group in map(list, system.groups):
        sizes[group] = np.maximum(sizes[group], SMALL * sizes[group].max())
    return np.where((sizes > 0) & (sizes < math.inf), sizes, 1.0)


@lru_cache(maxsize=32)
def _signs(block: int, size: int) -> np.ndarray:
    """Random signs for each step of a block, the same in each call, shape (k, size, SETS)."""
    count = STEPS_AT_ONCE if block else 1
    random = np.random.Generator(np.random.PCG64(block))
    bits = np.frombuffer(random.bytes(count * size * SETS // 8), np.uint8)
    return read_only((2 * np.unpackbits(bits).astype(np.int8) - 1).reshape(count, size, SETS))


def _steps(
    system: System,
    points: Track,
    begins: np.ndarray,
    numbers: np.ndarray,
    inexact: np.ndarray,
    signs: np.ndarray,
    sizes: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Propagators of some steps, (k, size, size), and their roundings, (k, size, SETS).

    Of states in units of their sizes, (size,) or (k, size).

    begins: the points at which steps begin, each of which ends at the next one.
    numbers: of the parameters, or of those at each point.
    """
    n, ends = system.size, begins + 1
    states = points.states
    own = numbers if numbers.ndim == 1 else numbers[begins]
    with np.errstate(all="ignore"):
        width = (points.times[ends] - points.times[begins])[:, None]
        rates = _rows(system.array_function, states, numbers, n)
        jacobian = _jacobians(system, states, numbers)
        bends = np.matmul(jacobian, rates[:, :, None])[:, :, 0]
        slopes = width * rates[begins], width * rates[ends]
        curves = width**2 * bends[begins], width**2 * bends[ends]
        nodes = [jacobian[begins], jacobian[ends]]
        for at in 0.5 + NODES[1:3]:
            between = _between(states[begins], states[ends], slopes, curves, at, sizes)
            nodes.insert(-1, _jacobians(system, between, own))
        scaled = width[:, :, None] * sizes[..., None, :] / sizes[..., None]
        nodes = np.stack(nodes)
        moments = [np.tensordot(WEIGHTS * NODES**k, nodes, 1) * scaled for k in range(3)]
        even, odd = _propagators(*moments)
        # Fast parts of stiff rates decay at once: Euler's backward step.
        stiff = np.abs(moments[0]).sum(axis=2).max(axis=1) > STIFF
        odd[stiff] = (nodes[-1] * scaled)[stiff] / 2
        even[stiff] = np.eye(n) - odd[stiff]
        # Each step rounds its states, and the sum of the terms by which it changes them.
        terms = width * _rows(system.rates.sizes, states, numbers, n)[ends]
        terms[stiff[:, None] | ~np.isfinite(terms)] = 0.0
        kicks = EVEN * np.hypot(states[ends], terms) / sizes
        kicks[states[begins] == states[ends]] = 0.0
        if system.clock is not None:
            kicks[:, system.states.index(system.clock[0])] = 0.0
        kicks = kicks[:, :, None] * signs
        try:
            propagators = np.linalg.solve(even - odd, even + odd)
        except np.linalg.LinAlgError:
            propagators = np.full(even.shape, math.inf)
        # Numbers of one size are rounded alike.
        same = np.atleast_2d(np.abs(numbers))[0, inexact]
        for k, size in enumerate(np.unique(same)):
            moved = numbers.copy()
            moved[..., np.flatnonzero(inexact)[same == size]] *= 1 + SMALL
            drift = (_rows(system.array_function, states, moved, n) - rates) / SMALL
            drift = (width * (drift[begins] + drift[ends]) / 2 / sizes)[:, :, None]
            drift[stiff] = np.matmul(propagators[stiff], drift[stiff])
            kicks += drift * EVEN * _signs(0, n + k + 1)[0, n + k]
        return propagators, kicks


def _rows(
    function: Callable[..., np.ndarray], states: np.ndarray, numbers: np.ndarray, size: int
) -> np.ndarray:
    """Values of a function of states and parameters, shape (k, size)."""
    return np.broadcast_to(function(*states.T, *numbers.T), (size, len(states))).T


def _jacobians(system: System, states: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    """Derivatives of the rates, shape (k, size, size).

    Zero for a clock, which has no roundings, and where a derivative is infinite at the beginning or
    end of a motion, as for sqrt(x) at x = 0.
    """
    n = system.size
    result = _rows(system.array_jacobian, states, numbers, n * n).reshape(-1, n, n)
    result = np.where(np.isfinite(result), result, 0.0)
    if system.clock is not None:
        result[:, :, system.states.index(system.clock[0])] = 0.0
    return result


def _between(
    begin: np.ndarray,
    end: np.ndarray,
    slopes: tuple[np.ndarray, np.ndarray],
    curves: tuple[np.ndarray, np.ndarray],
    at: float,
    sizes: np.ndarray,
) -> np.ndarray:
    """States within steps, by Hermite's polynomial of degree five; linear where that is wild.

    slopes, curves: first and second derivatives at both ends, for a step of one.
    """
    p = at**3 * (10 + at * (6 * at - 15))
    q = at + at**3 * (-6 + at * (8 - 3 * at)), at**3 * (-4 + at * (7 - 3 * at))
    r = at**2 * (1 + at * (-3 + at * (3 - at))) / 2, at**3 * (1 + at * (at - 2)) / 2
    smooth = begin + (end - begin) * p + slopes[0] * q[0] + slopes[1] * q[1]
    smooth += curves[0] * r[0] + curves[1] * r[1]
    bend = np.maximum(np.abs(curves[0]), np.abs(curves[1]))
    # Derivatives of stiff rates lose all their digits.
    tame = np.all(bend <= sizes, axis=1, keepdims=True)
    return np.where(tame, smooth, begin + at * (end - begin))


def _propagators(
    mean: np.ndarray, slope: np.ndarray, bend: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Even and odd part of the numerator of each propagator (even - odd)^-1 (even + odd).

    Magnus' series of order six [Blanes, Casas and Ros 2000] from the moments of the matrix over a
    step, and Pade's approximant (3, 3) of its exponential, which conserves what the motion does.
    """
    one, two, three = 2.25 * mean - 15 * bend, 12 * slope, 180 * bend - 15 * mean
    inner = _bracket(one, two)
    outer = _bracket(one, 2 * three + inner) / -60
    omega = one + three / 12 + _bracket(inner - 20 * one - three, two + outer) / 240
    square = np.matmul(omega, omega)
    return np.eye(omega.shape[-1]) + square / 10, omega / 2 + np.matmul(square, omega) / 120


def _bracket(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.matmul(a, b) - np.matmul(b, a)


def _followed(propagators: np.ndarray, kicks: np.ndarray, first: np.ndarray) -> np.ndarray:
    """v_k = propagator_k v_(k-1) + kick_k from the first on, shape (k, size, sets).

    Rows of steps side by side, each from zero on and as a propagator from its beginning; then the
    beginnings one after the other.
    """
    count, n = kicks.shape[:2]
    if not count:
        return kicks
    width = math.isqrt(count - 1) + 1
    rows = -(-count // width)
    spare = rows * width - count
    both = np.concatenate((kicks, np.zeros((count, n, n))), axis=2)
    if spare:
        both = np.concatenate((both, np.zeros((spare, *both.shape[1:]))))
        propagators = np.concatenate((propagators, np.zeros((spare, n, n))))
    both, propagators = (x.reshape(rows, width, *x.shape[1:]) for x in (both, propagators))
    both[:, 0, :, -n:] = propagators[:, 0]
    with np.errstate(all="ignore"):
        for k in range(1, width):
            both[:, k] += np.matmul(propagators[:, k], both[:, k - 1])
        carries, own = both[..., -n:], both[..., :-n]
        begins = np.empty((rows, *first.shape))
        for k in range(rows):
            begins[k] = first
            first = carries[k, -1] @ first + own[k, -1]
        result = own + np.matmul(carries, begins[:, None])
    return result.reshape(rows * width, n, -1)[:count]
