"""Passed over: where steps reached over places at which the rates are not what the steps took.

At y = -40 the rates of a frame with tanh(y) are constant to all digits, and so is every term of a
series there: no rule for steps knows of the wall at y = 0, and runs to any tolerance pass over it
alike. The rates at the samples do know.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

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
CLOSE_BY = np.finfo(float).eps ** 0.25


def just_before(times: np.ndarray) -> np.ndarray:
    """Times so close before others that steps show their slopes there; the first stays."""
    return np.concatenate((times[:1], times[1:] - CLOSE_BY * (times[1:] - times[:-1])))


@dataclass(frozen=True, eq=False)
class Intervals:
    """Intervals between samples, in each a state whose change is not that by its rates.

    states: places among states; gaps: between the change and that by the mean of the rates; shapes
    (count,).
    times, before: ends and begins, and just before these; values, rates: of the states there;
    shapes (2, count).
    """

    states: np.ndarray
    gaps: np.ndarray
    times: np.ndarray
    before: np.ndarray
    values: np.ndarray
    rates: np.ndarray

    def __len__(self) -> int:
        return len(self.states)

    def only(self, which: np.ndarray) -> Intervals:
        """Some of them."""
        return Intervals(*[column[..., which] for column in vars(self).values()])


Columns: TypeAlias = tuple[np.ndarray, ...]


def passed_over(one: Trajectory, accuracy: float, claimed: float = 0.0) -> tuple[Intervals, float]:
    """Where steps may have passed over something, and the error that what is too small may leave.

    That is where a step is as long as an interval between samples, and the change of a state in it
    is not that by the mean of the rates at its ends, and this not because the rates change. What
    lies between two samples altogether is not seen. The error is relative to the size of a group.
    What adds up to no more than the error that is claimed anyhow is nothing new.
    """
    found: list[Columns] = []
    left = 0.0
    for segments in _pieces(one):
        if _has_long_step(segments):
            new, more = _of_piece(segments, accuracy, claimed)
            found += new
            left += more
    if not found:
        return Intervals(*np.empty((2, 0)), *np.empty((4, 2, 0))), left
    return Intervals(*[np.concatenate(x, axis=-1) for x in zip(*found, strict=True)]), left


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
) -> tuple[list[Columns], float]:
    """The same of segments that go on from each other."""
    system = segments[0].stage.system
    times, values, longest = _joined(segments)
    lasts = times[1:] - times[:-1]
    over = longest > (1 - UNLIKE) * np.abs(lasts)
    if len(times) < 3 or not over.any():
        return [], 0.0
    states = values[: system.size]
    rates = system.array_function(*values)
    gaps = _unexplained(states, rates, lasts, over)
    if gaps.any():
        # States with this error have rates with this part of their terms as error. On a stiff
        # motion the terms cancel, and such errors are all that is left of the rates.
        terms = system.rates.sizes(*values)
        doubt = claimed * np.maximum(terms[:, 1:], terms[:, :-1]) * np.abs(lasts)
        gaps[np.abs(gaps) <= doubt] = 0.0
    if not gaps.any():
        return [], 0.0
    sums, parts = np.add.accumulate(gaps, axis=1), np.abs(gaps)
    drifts = (np.maximum(sums.max(1), 0.0) - np.minimum(sums.min(1), 0.0)).tolist()
    extents, before = np.abs(states).max(1).tolist(), just_before(times)
    found: list[Columns] = []
    left, least = 0.0, _least(accuracy, len(lasts))
    for group in map(list, system.groups_but_clock):
        extent = max([extents[k] for k in group])
        if max([drifts[k] for k in group]) <= claimed * extent:
            continue
        worst = parts[group].max(axis=0)
        large = worst > least * extent
        where = np.flatnonzero(large)
        which = np.array(group)[parts[group][:, where].argmax(axis=0)]
        ends = np.array([where + 1, where])
        at = times[ends], before[ends], states[which, ends], rates[which, ends]
        found.append((which, worst[where], *at))
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


def with_samples_before(times: np.ndarray) -> np.ndarray:
    """Times with one just before each but the first."""
    return np.array([just_before(times), times]).T.ravel()[1:]


def left_by_members(
    system: System,
    values: np.ndarray,
    times: np.ndarray,
    longest: np.ndarray,
    accuracy: float,
    *,
    before: bool,
) -> np.ndarray:
    """The errors that what was passed over leaves in many motions, infinite where it is not small.

    values: states above parameters, shape (size + parameters, number, m), at times of each, shape
    (number, m). longest: steps, shape (number,). before: whether times are `with_samples_before`;
    without, what may have been passed over counts as such.
    """
    every, stride = values[: system.size], 2 if before else 1
    states, seen = every[..., ::stride], times[:, ::stride]
    lasts = seen[:, 1:] - seen[:, :-1]
    over = longest[:, None] > (1 - UNLIKE) * np.abs(lasts)
    rates = system.array_function(*values[..., ::stride])
    gaps = np.abs(_unexplained(states, rates, lasts, over))
    far = np.full(gaps.shape, not before)
    if before:
        # The first interval in which something was passed over shows it at its end.
        slopes = (states[..., 1:] - every[..., 1::2]) / (seen[:, 1:] - times[:, 1::2])
        far = np.abs((slopes - rates[..., 1:]) * lasts) > gaps
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


def confirmed(again: Trajectory, intervals: Intervals) -> Intervals:
    """Those of some intervals that a step passed over, by the same motion just before its samples.

    The others are too long to show how a motion goes that its steps follow well.
    """
    before, found = intervals.before, np.zeros(len(intervals), dtype=bool)
    spans, lasts = intervals.times - before, intervals.times[0] - intervals.times[1]
    for segments in _pieces(again):
        times, values, _ = _joined(segments)
        sign = -1.0 if times[-1] < times[0] else 1.0
        place = np.searchsorted(sign * times[:-1], sign * before)
        changes = intervals.values - values[intervals.states, place]
        far = np.abs((changes - intervals.rates * spans) * lasts) > intervals.gaps * np.abs(spans)
        found |= (far & (times[place] == before) & (spans != 0)).any(0)
    return intervals.only(found)


def cuts_of(intervals: Intervals, way: float) -> set[float]:
    """Times at which runs are cut: ends and middles of intervals, or fewer where these are short.

    Behind what was passed over all intervals are wrong, however many: those that go on from each
    other are cut as if the whole way had PARTS of them.
    """
    joined: list[tuple[float, float, int]] = []
    pairs = {*zip(*intervals.times.tolist(), strict=True)}
    for end, begin in sorted(pairs, key=lambda x: abs(x[1])):
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
