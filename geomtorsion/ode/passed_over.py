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
from geomtorsion.ode.system import columns
from geomtorsion.ode.trajectory import Segment, Trajectory

# Between samples that resolve a motion, the mean rate is that at both but for a twelfth of the
# second difference of rates. A step that saw nothing of a change takes the rate at its beginning,
# half of the change away. This lies between.
UNLIKE = math.sqrt(1 / 2 * 1 / 12)
# Less than this part of a state is rounding of the states themselves, read as doubles.
ROUNDING = 4 * np.finfo(float).eps
# So close to a sample, in parts of an interval, a change is the rate at it: halfway, in digits,
# from an interval to its rounding.
BESIDE = np.finfo(float).eps ** 0.25


class Interval(NamedTuple):
    """Between two samples: its ends, a state, and how far its change is from that by its rates."""

    begin: float
    end: float
    state: int
    gap: float

    @property
    def beside(self) -> tuple[float, float]:
        """Times just inside."""
        lasts = BESIDE * (self.end - self.begin)
        return self.begin + lasts, self.end - lasts


def passed_over(one: Trajectory, accuracy: float) -> tuple[list[Interval], float]:
    """Where steps may have passed over something, and the error that what is too small may leave.

    That is where a step is as long as an interval between samples, and the change of a state in it
    is not that by the mean of the rates at its ends, and this not because the rates change. What
    lies between two samples altogether is not seen. The error is relative to the size of a group.
    """
    found: list[Interval] = []
    left = 0.0
    for segments in _pieces(one):
        if _has_long_step(segments):
            new, more = _of_piece(segments, accuracy)
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


def _of_piece(segments: list[Segment], accuracy: float) -> tuple[list[Interval], float]:
    """The same of segments that go on from each other."""
    system = segments[0].stage.system
    times, values, longest = _joined(segments)
    lasts = times[1:] - times[:-1]
    over = longest > (1 - UNLIKE) * np.abs(lasts)
    if len(times) < 3 or not over.any():
        return [], 0.0
    states, rates = values[: system.size], system.array_function(*values)
    changes = rates[:, 1:] - rates[:, :-1]
    bends = np.abs(changes[:, 1:] - changes[:, :-1])
    bends = np.minimum(np.c_[bends[:, :1], bends], np.c_[bends, bends[:, -1:]])
    gaps = np.abs(states[:, 1:] - states[:, :-1] - (rates[:, :-1] + 0.5 * changes) * lasts)
    gaps[~(over & (gaps > UNLIKE * np.maximum(np.abs(changes), bends) * np.abs(lasts)))] = 0.0
    if not gaps.any():
        return [], 0.0
    found: list[Interval] = []
    left, least = 0.0, max(AIM * accuracy / len(lasts), ROUNDING)
    for group in map(list, system.groups_but_clock):
        extent = float(np.abs(states[group]).max())
        parts = gaps[group]
        worst = parts.max(axis=0)
        large = worst > least * extent
        for k in np.flatnonzero(large).tolist():
            state = group[int(parts[:, k].argmax())]
            found.append(Interval(float(times[k]), float(times[k + 1]), state, float(worst[k])))
        if extent > 0:
            left += float(worst[~large].sum()) / extent
    return found, left


def confirmed(again: Trajectory, intervals: Sequence[Interval]) -> list[Interval]:
    """Those of some intervals that a step passed over, by the same motion with samples beside them.

    The others are too long to show how a motion goes that its steps follow well.
    """
    found: dict[Interval, None] = {}
    for segments in _pieces(again):
        system = segments[0].stage.system
        times, values, _ = _joined(segments)
        place = {t: k for k, t in enumerate(times.tolist())}
        known = [
            (interval, place[at], place[beside])
            for interval in intervals
            for at, beside in zip(interval[:2], interval.beside, strict=True)
            if at in place and beside in place
        ]
        if not known:
            continue
        here, near = np.array([k for _, *k in known]).T
        rows = np.array([interval.state for interval, _, _ in known])
        rates = system.array_function(*values[:, here])[rows, range(len(known))]
        slopes = (values[rows, near] - values[rows, here]) / (times[near] - times[here])
        lasts = np.array([interval.end - interval.begin for interval, _, _ in known])
        far = np.abs((slopes - rates) * lasts) > [interval.gap for interval, _, _ in known]
        found.update(dict.fromkeys(known[k][0] for k in np.flatnonzero(far)))
    return list(found)


def cuts_of(intervals: Iterable[Interval]) -> set[float]:
    """Times at which runs are cut: the ends and middles of intervals."""
    return {t for x in intervals for t in (x.begin, 0.5 * (x.begin + x.end), x.end)}


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
