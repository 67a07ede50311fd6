"""Passed over: where steps reached over places at which the rates are not what the steps took.

At y = -40 the rates of a frame with tanh(y) are constant to all digits, and so is every term of a
series there: no rule for steps knows of the wall at y = 0, and runs to any tolerance pass over it
alike. The rates at the samples do know.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from geomtorsion.ode.error_estimate import AIM
from geomtorsion.ode.numbers import PARTS
from geomtorsion.ode.system import System, columns
from geomtorsion.ode.trajectory import Segment, Trajectory

# Between samples that resolve a motion, the mean rate is that at both but for a twelfth of the
# second difference of rates. A step that saw nothing of a change takes the rate at its beginning,
# half of the change away. This lies between.
UNLIKE = math.sqrt(1 / 2 * 1 / 12)
# Less than this part of a state is rounding of the states themselves, read as doubles: nothing is
# known of it, however many digits a motion has.
ROUNDING = 4 * np.finfo(float).eps
# So close to a sample, in parts of an interval, a change is the rate at it: halfway, in digits,
# from an interval to its rounding.
INSIDE = np.finfo(float).eps ** 0.25


class Interval(NamedTuple):
    """Between two samples: its ends, a state, and how far its change is from that by its rates."""

    begin: float
    end: float
    state: int
    gap: float


def times_looked_at(intervals: Sequence[Interval]) -> np.ndarray:
    """Begins and ends of intervals, and the times just inside of these, shape (4, count)."""
    begins, ends = np.array([interval[:2] for interval in intervals]).T
    lasts = INSIDE * (ends - begins)
    return np.array([begins, ends, begins + lasts, ends - lasts])


def passed_over(
    one: Trajectory, accuracy: float, claimed: float = 0.0
) -> tuple[list[Interval], float]:
    """Where steps may have passed over something, and the error that what is too small may leave.

    That is where a step is as long as an interval between samples, and the change of a state in it
    is not that by the mean of the rates at its ends, and this not because the rates change. What
    lies between two samples altogether is not seen. The error is relative to the size of a group.
    What adds up to no more than the error that is claimed anyhow is nothing new.
    """
    found: list[Interval] = []
    left = 0.0
    for segments in _pieces(one):
        if _has_long_step(segments):
            new, more = _of_piece(segments, accuracy, claimed)
            found += new
            left += more
    return found, left


def has_long_step(one: Trajectory) -> bool:
    """Whether there is anything to look at: steps that see what lies ahead are about alike."""
    return any(map(_has_long_step, _pieces(one)))


def _has_long_step(segments: list[Segment]) -> bool:
    """Whether a step is twice as long as the mean, or there are no others to compare it with."""
    longest = max([x.run.longest_step for x in segments])
    steps = sum([x.run.steps for x in segments])
    lasts = abs(float(segments[-1].run.reached) - float(segments[0].stage.begin))
    return steps <= 2 or longest * steps >= 2 * lasts


def is_long(longest: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """The same of many motions, whose longest step is a part of the way."""
    return (steps <= 2) | (longest * steps >= 2)


def _of_piece(
    segments: list[Segment], accuracy: float, claimed: float
) -> tuple[list[Interval], float]:
    """The same of segments that go on from each other."""
    system = segments[0].stage.system
    times, values, longest = _joined(segments)
    lasts = times[1:] - times[:-1]
    over = longest > (1 - UNLIKE) * np.abs(lasts)
    if len(times) < 3 or not over.any():
        return [], 0.0
    states = values[: system.size]
    gaps = _unexplained(states, system.array_function(*values), lasts, over)
    if not gaps.any():
        return [], 0.0
    sums, parts = np.add.accumulate(gaps, axis=1), np.abs(gaps)
    drifts = (np.maximum(sums.max(1), 0.0) - np.minimum(sums.min(1), 0.0)).tolist()
    extents = np.abs(states).max(1).tolist()
    found: list[Interval] = []
    left, least = 0.0, _least(accuracy, len(lasts))
    for group in map(list, system.groups_but_clock):
        extent = max([extents[k] for k in group])
        if max([drifts[k] for k in group]) <= claimed * extent:
            continue
        worst = parts[group].max(axis=0)
        large = worst > least * extent
        where = np.flatnonzero(large)
        which = np.array(group)[parts[group][:, where].argmax(axis=0)]
        rows = (times[where], times[where + 1], which, worst[where])
        found += map(Interval, *[row.tolist() for row in rows])
        if extent > 0:
            left += float(worst[~large & (worst > ROUNDING * extent)].sum()) / extent
    return found, left


def _unexplained(
    states: np.ndarray, rates: np.ndarray, lasts: np.ndarray, over: np.ndarray
) -> np.ndarray:
    """How far changes of states are from those by their rates, shape (size, ..., intervals).

    Samples are along the last axis, three at least. Zero where rates change as much, and where
    steps do not reach over an interval.
    """
    changes = rates[..., 1:] - rates[..., :-1]
    bends = np.abs(changes[..., 1:] - changes[..., :-1])
    before, after = (bends[..., :1], bends), (bends, bends[..., -1:])
    bends = np.minimum(np.concatenate(before, axis=-1), np.concatenate(after, axis=-1))
    gaps = states[..., 1:] - states[..., :-1] - (rates[..., :-1] + 0.5 * changes) * lasts
    least = UNLIKE * np.maximum(np.abs(changes), bends) * np.abs(lasts)
    gaps[~(over & (np.abs(gaps) > least))] = 0.0
    return gaps


def _least(accuracy: float, intervals: int) -> float:
    """What is no larger, relative to a state, is added to the error and not looked into."""
    return max(AIM * accuracy / intervals, ROUNDING)


def with_samples_inside(times: np.ndarray) -> np.ndarray:
    """Times with one just inside of each end of every interval between them."""
    lasts = INSIDE * (times[1:] - times[:-1])
    found = np.empty(3 * len(times) - 2)
    found[::3], found[1::3], found[2::3] = times, times[:-1] + lasts, times[1:] - lasts
    return found


def left_by_members(
    system: System,
    values: np.ndarray,
    times: np.ndarray,
    longest: np.ndarray,
    accuracy: float,
    *,
    inside: bool,
) -> np.ndarray:
    """The errors that what was passed over leaves in many motions, infinite where it is not small.

    values: states above parameters, shape (size + parameters, number, m), at times of each, shape
    (number, m). longest: steps, shape (number,). inside: whether times are `with_samples_inside`;
    without, what may have been passed over counts as such.
    """
    every, stride = values[: system.size], 3 if inside else 1
    states, seen = every[..., ::stride], times[:, ::stride]
    lasts = seen[:, 1:] - seen[:, :-1]
    over = longest[:, None] > (1 - UNLIKE) * np.abs(lasts)
    rates = system.array_function(*values[..., ::stride])
    gaps = np.abs(_unexplained(states, rates, lasts, over))
    far = np.full(gaps.shape, not inside)
    sides = ((slice(1, None, 3), slice(None, -1)), (slice(2, None, 3), slice(1, None)))
    for near, here in sides if inside else ():
        slopes = (every[..., near] - states[..., here]) / (times[:, near] - seen[:, here])
        far |= np.abs((slopes - rates[..., here]) * lasts) > gaps
    left, least = np.zeros(len(times)), _least(accuracy, lasts.shape[1])
    for group in map(list, system.groups_but_clock):
        extent = np.abs(states[group]).max(axis=(0, 2))[:, None]
        which = gaps[group].argmax(axis=0)[None]
        worst = np.take_along_axis(gaps[group], which, 0)[0]
        large = worst > least * extent
        passed = large & np.take_along_axis(far[group], which, 0)[0]
        small = np.where(large | (worst <= ROUNDING * extent), 0.0, worst)
        small[passed] = np.inf
        left += np.divide(small, extent, out=np.zeros(small.shape), where=extent > 0).sum(axis=1)
    return left


def confirmed(again: Trajectory, intervals: Sequence[Interval]) -> list[Interval]:
    """Those of some intervals that a step passed over, by the same motion with samples inside them.

    The others are too long to show how a motion goes that its steps follow well.
    """
    seen = times_looked_at(intervals)
    lasts = seen[1] - seen[0]
    rows, gaps = (np.array(column) for column in list(zip(*intervals, strict=True))[2:])
    found: set[int] = set()
    for segments in _pieces(again):
        system = segments[0].stage.system
        times, values, _ = _joined(segments)
        sign = -1.0 if times[-1] < times[0] else 1.0
        # Every end of an interval, and the time just inside of it.
        place = np.searchsorted(sign * times[:-1], sign * seen)
        here, near = place.reshape(2, -1)
        known = np.flatnonzero((times[place] == seen).reshape(2, -1).all(0))
        if not len(known):
            continue
        here, near, which = here[known], near[known], known % len(intervals)
        rates = system.array_function(*values[:, here])[rows[which], range(len(known))]
        changes = values[rows[which], near] - values[rows[which], here]
        slopes = changes / (times[near] - times[here])
        far = np.abs((slopes - rates) * lasts[which]) > gaps[which]
        found.update(which[far].tolist())
    return [intervals[k] for k in sorted(found)]


def cuts_of(intervals: Iterable[Interval], way: float) -> set[float]:
    """Times at which runs are cut: ends and middles of intervals, or fewer where these are short.

    Behind what was passed over all intervals are wrong, however many: those that go on from each
    other are cut as if the whole way had PARTS of them.
    """
    joined: list[tuple[float, float, int]] = []
    for begin, end in sorted({one[:2] for one in intervals}, key=lambda x: abs(x[0])):
        first, count = begin, 1
        if joined and joined[-1][1] == begin:
            first, _, known = joined.pop()
            count += known
        joined.append((first, end, count))
    cuts: set[float] = set()
    for begin, end, count in joined:
        pieces = min(2 * count, max(2, math.ceil(2 * PARTS * (end - begin) / way)))
        cuts.update(np.linspace(begin, end, pieces + 1).tolist())
    return cuts


def _pieces(one: Trajectory) -> Iterator[list[Segment]]:
    """Segments that go on from each other by the same equations."""
    piece: list[Segment] = []
    for segment in one.segments:
        if piece and not _goes_on(piece[-1], segment):
            yield piece
            piece = []
        # A run that did not begin has no samples at all.
        if len(segment.run.times):
            piece.append(segment)
    if piece:
        yield piece


def _goes_on(one: Segment, two: Segment) -> bool:
    """Whether one segment begins where another one ended, with the same equations."""
    alike = one.stage.system is two.stage.system
    return alike and all(
        [float(x) for x in first] == [float(x) for x in second]
        for first, second in (
            (one.stage.parameters, two.stage.parameters), (one.run.last, two.stage.start),
        )
    )  # fmt: skip


def _joined(segments: list[Segment]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, states above parameters, and the longest step in each interval between times."""
    times, states, longest = [], [], []
    for segment in segments:
        run = segment.run
        # A run begins with the beginning of its stage, and the next one with its end.
        count = len(run.times) - (segment is not segments[-1])
        times.append(run.times[:count])
        states.append(run.states[:count])
        longest.append(np.full(count, run.longest_step))
    above = columns(states, segments[0].stage.parameters)
    return np.concatenate(times).astype(float), above, np.concatenate(longest)[:-1]
