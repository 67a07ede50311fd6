"""Error estimate: one rule for everything that moves.

The answer is compared with a run two orders finer, which starts a rounding away; twice the largest
difference is the error. Roundings of two runs in doubles may agree by chance. Where they may be a
noticeable part of the error, the answer is also compared with a run to the same tolerance whose
start is moved by as much as the roundings of all steps add up to; that difference is a lower bound
of the reported error. Where the motion amplifies errors, this run is moved on the way as well.

No step of the finer run is longer than a hundredth of the way: a long step sees nothing of rates
that change further ahead.

The rule cannot see what all of its runs share: rates that change within less than such a step and
are constant to all digits around, and roundings of the rates themselves where these lose digits in
a difference, such as 1 - cos(x) of a small x. A proof sees both: see `geomtorsion.prove`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple, Protocol

import numpy as np

from geomtorsion.ode.numbers import floats
from geomtorsion.ode.system import Engine, columns
from geomtorsion.ode.trajectory import Segment, Stage, Trajectory
from geomtorsion.precision import GOLDEN

# The error is so many times the difference, for the finer run has an error of its own; and that run
# starts so many units in the last place away, for roundings add up on the way.
SAFETY = 2.0
# Each tolerance aims at this part of the accuracy, for errors do not follow it to the letter and
# one more pair of runs costs more than a finer one.
AIM = 0.1
# States that are no larger than so many roundings of the terms of their rates have no size of their
# own.
NOISE = 100.0
# They differ by more than this fraction of their size, because rounding errors are not smaller.
UNALIKE = 1 / NOISE
# A motion that amplifies errors is moved in the middle of each of so many equal parts of the way.
# Each part costs a call of the engine.
PLACES = 16
# Numbers of the patterns of signs by which it is moved.
PATTERNS = (1, 2)


class Comparable(Protocol):
    """What knows how to read states of a motion for comparison."""

    def rows(self, segment: Segment, states: np.ndarray, label: str) -> np.ndarray:
        """States of a segment in the coordinates of a label, shape (m, size)."""
        ...


class Integration(Protocol):
    """Integrates a motion."""

    def __call__(
        self,
        engine: Engine,
        tolerance: float,
        part: float,
        *,
        limited: bool = False,
        pattern: int = 0,
    ) -> Trajectory:
        """The trajectory from a start that is changed by a part.

        limited: whether no step may be longer than a share of the way; pattern: number of a pattern
        of signs by which the state is changed on the way instead of at the start, or 0.
        """
        ...


class Verified(NamedTuple):
    """An answer, the finer run it was compared with, the error, and all runs that were made.

    error: relative to the size of each group of states; infinite where nothing could be compared.
    """

    answer: Trajectory
    reference: Trajectory
    error: float
    runs: tuple[Trajectory, ...]


def verified(
    problem: Comparable,
    engine: Engine,
    accuracy: float,
    run: Integration,
    *,
    failed: bool = False,
) -> Verified:
    """The first answer of an engine's ladder of tolerances whose error is small enough.

    Or the best one, where none is. failed: whether an earlier run missed the accuracy.
    """
    perturbation = SAFETY * 2.0 ** (1 - engine.precision)
    runs: list[Trajectory] = []
    best: Verified | None = None
    growth = 0.0
    tolerance: float | None = engine.first(AIM * accuracy)
    while tolerance is not None and (finer := engine.finer(tolerance)) is not None:
        answer = run(engine, tolerance, 0.0)
        reference = run(engine, finer, perturbation, limited=True)
        least = SAFETY * rounding(engine, answer.steps)
        runs += [answer, reference]
        error = max(SAFETY * difference(problem, answer, reference), least)
        # A motion that misses an accuracy amplifies errors, and it may do so anywhere on the way.
        amplifies = failed or best is not None
        # Roundings grow on the way as far as what the steps omitted did, in an attempt that missed.
        grown = growth * rounding(engine, answer.steps) > AIM * error
        matter = failed or grown or roundings_matter(engine, answer.steps, tolerance)
        if error <= accuracy and matter:
            # Moved on the way, it is moved by the roundings of each part.
            change = change_by_rounding(engine, answer.steps // (PLACES if amplifies else 1))
            if not amplifies:
                # The next power of two keeps the number of different starts small.
                change = 2.0 ** math.ceil(math.log2(change))
            # One pattern of signs may cancel by chance where few roundings decide.
            for pattern in PATTERNS if amplifies else (0,):
                moved = run(engine, tolerance, change, pattern=pattern)
                runs.append(moved)
                second = SAFETY * difference(problem, answer, moved)
                if second > error:
                    reference, error = moved, second
        rounded = best is not None and best.error <= UNALIKE and SAFETY * error > best.error
        if best is None or error < best.error:
            best = Verified(answer, reference, error, ())
        # If a finer tolerance does not halve the error, the rest is rounding, and later agreement
        # would be chance.
        if error <= accuracy or rounded or answer.outcome == "stuck":
            break
        growth = max(growth, error / tolerance)
        tolerance = next_tolerance(engine, tolerance, accuracy / error)
    assert best is not None
    return best._replace(runs=tuple(runs))


def roundings_matter(engine: Engine, steps: int, tolerance: float) -> bool:
    """Whether roundings may be a noticeable part of the error of a run.

    The motion carries the rounding of a step to the end as it carries what the step omits, which is
    about the tolerance. A step may omit less where it counts: therefore AIM twice.
    """
    return rounding(engine, steps) > AIM**2 * tolerance


def change_by_rounding(engine: Engine, steps: int) -> float:
    """Relative change of a state as large as what the roundings of so many steps add up to.

    Each step rounds the state to half a unit in the last place at most. The roundings add up at
    random, as the square root of the number of steps.
    """
    return 2.0**-engine.precision * math.sqrt(max(steps, 1))


def next_tolerance(engine: Engine, tolerance: float, missing: float) -> float | None:
    """The tolerance after one whose error was too large; None where there is none.

    missing: factor by which the error has to shrink. Errors shrink about in proportion to the
    tolerance; the next one aims at AIM times the allowed error, and is finer by at least one step
    of the ladder.
    """
    finer = engine.finer(tolerance)
    if finer is None or not missing > 0:
        return finer
    target = engine.rung(min(tolerance * missing * AIM, finer))
    # A run without a finer run to compare is not an answer.
    return target if engine.finer(target) is not None else finer


def rounding(engine: Engine, steps: int) -> float:
    """The error that no estimate goes below: a last place a step, adding up at random."""
    return 2.0 ** (1 - engine.precision) * math.sqrt(max(steps, 1))


def difference(problem: Comparable, one: Trajectory, two: Trajectory) -> float:
    """Largest difference of two trajectories, each group of states against its own size.

    Over all samples that both reached, in the coordinates in which the first was followed.
    Infinite where there is no such sample, where a difference is NaN, where only one of them was
    stopped, or where only the first reached the end. If both were stopped, their last states and
    times are also compared.
    """
    count = min(one.count, two.count)
    stopped = one.outcome == two.outcome == "stopped"
    if one.outcome != two.outcome and "stopped" in (one.outcome, two.outcome):
        return math.inf
    if one.outcome == "done" and two.count < one.count:
        return math.inf
    if not count and not stopped:
        return math.inf
    worst = 0.0
    if stopped:
        gap = abs(float(one.segments[-1].run.reached - two.segments[-1].run.reached))
        worst = gap / abs(one.reached) if gap else 0.0
    for pair in _pairs(problem, one, two, stopped):
        worst = max(worst, pair.largest(one))
    return worst


def difference_over_samples(problem: Comparable, one: Trajectory, two: Trajectory) -> np.ndarray:
    """The same at each sample of the first, shape (m,); not a number where the second ended."""
    differences = np.full(one.count, np.nan)
    for pair in _pairs(problem, one, two, False):
        differences[pair.places] = pair.at_samples()
    return differences


def _columns(segment: Segment) -> np.ndarray:
    """States of the system at the beginning, the samples and the end; below them parameters."""
    begin, end = (np.asarray(state)[None] for state in (segment.stage.start, segment.run.last))
    return columns([begin, segment.run.states, end], segment.stage.parameters)


class _Pair(NamedTuple):
    """Samples of two trajectories in one set of coordinates.

    parts: number of the first sample, segment and count of each part of the first trajectory.
    first, second: rows of states; sizes: of each state in the first.
    """

    parts: list[tuple[int, Segment, int]]
    first: np.ndarray
    second: np.ndarray
    sizes: list[float]

    @property
    def places(self) -> np.ndarray:
        """Which samples of the first trajectory these are."""
        return np.concatenate([np.arange(place, place + count) for place, _, count in self.parts])

    def largest(self, one: Trajectory) -> float:
        """Largest difference, each group of states against its own size."""
        gaps = np.maximum.reduce(np.abs(self.first - self.second)).astype(float).tolist()
        if not all(map(math.isfinite, gaps)):
            return math.inf
        worst = 0.0
        for group in self.groups:
            gap = max([gaps[k] for k in group], default=0.0)
            if gap > 0:
                extent = max([self.sizes[k] for k in group])
                part = gap / extent if extent > 0 else math.inf
                if part > UNALIKE:
                    part = gap / _size_of_noise(self.parts[0][1].stage, one, group, extent)
                worst = max(worst, part)
        return worst

    def at_samples(self) -> np.ndarray:
        """The difference at each sample."""
        gaps = np.abs(self.first - self.second).astype(float)
        worst = np.zeros(len(gaps))
        for group in self.groups:
            if not group:
                continue
            gap, extent = gaps[:, group].max(axis=1), max([self.sizes[k] for k in group])
            if gap.max() > 0:
                worst = np.maximum(worst, gap / extent if extent > 0 else math.inf)
        return worst

    @property
    def groups(self) -> list[list[int]]:
        """Indices of states that are measured together."""
        size = self.first.shape[1]
        return [[k for k in group if k < size] for group in self.parts[0][1].stage.groups]


def _size_of_noise(stage: Stage, one: Trajectory, group: Sequence[int], extent: float) -> float:
    """The size against which a group of states is measured whose differences are as large as it is.

    That is its extent at the samples, unless this is no more than what roundings of its rates add
    up to, over all of the time or over that in which the motion damps them. Then it is the extent
    between the samples, as at whole turns all of these may be zero; and for states that vanish
    there too, such as the radial velocity of a circle, what the terms of the rates would add up to
    if they did not cancel.
    """
    system = stage.system
    some = [x for x in one.segments if x.stage.system is system]
    terms = max([float(system.rates.sizes(*_columns(x))[group].max()) for x in some])
    last, numbers = floats(some[-1].run.last), floats(some[-1].stage.parameters)
    damping = float((-np.diagonal(system.jacobian(last, numbers))[group]).min())
    full = terms * min(abs(one.reached), 1 / damping if damping > 0 else math.inf)
    noise = NOISE * 2.0**-one.engine.precision * full
    if extent > noise:
        return extent
    between = _size_between(one, stage.label, group)
    return between if between > noise else full


def _size_between(one: Trajectory, label: str, group: Sequence[int]) -> float:
    """Largest state of a group between the samples, in one set of coordinates."""
    samples = np.concatenate([segment.times for segment in one.segments]).astype(float)
    times = np.unique(np.concatenate(([0.0], samples, [one.reached])))
    between = times[:-1] + (1 - GOLDEN) * np.diff(times)
    between = between if one.reached > 0 else between[::-1]
    blocks = [states for segment, states, _ in one.at(between) if segment.label == label]
    return max([float(np.abs(states[:, group]).max()) for states in blocks], default=0.0)


def _pairs(problem: Comparable, one: Trajectory, two: Trajectory, stopped: bool) -> Iterator[_Pair]:
    """Samples that both reached, one pair of arrays for each set of coordinates of the first."""
    mine, others = _samples(one, stopped), _samples(two, stopped)
    for label in dict.fromkeys(one.labels):
        parts, first, second = [], [], []
        for place, segment, states in mine:
            if segment.label != label:
                continue
            rows = problem.rows(segment, states, label)
            there = _matched(problem, place, len(rows), others, label)
            if there is None:
                # The other trajectory ended earlier.
                continue
            parts.append((place, segment, len(there)))
            first.append(rows[: len(there)])
            second.append(there)
        if not parts:
            continue
        here, there = (x[0] if len(x) == 1 else np.concatenate(x) for x in (first, second))
        sizes = np.maximum.reduce(np.abs(here)).astype(float).tolist()
        for _, segment, _ in parts:
            firsts = segment.stage.first.tolist()
            sizes = [max(x, abs(y)) for x, y in zip(sizes, firsts, strict=False)]
        yield _Pair(parts, here, _alike(here, there), sizes)


def _samples(one: Trajectory, stopped: bool) -> list[tuple[int, Segment, np.ndarray]]:
    """Number of the first sample, segment and states of each segment; the end counts if stopped."""
    samples, place = [], 0
    for segment in one.segments:
        samples.append((place, segment, segment.states))
        place += segment.count
    if stopped:
        # After all samples, wherever these end in the other trajectory.
        samples.append((-1, one.segments[-1], one.segments[-1].last[None, :]))
    return samples


def _matched(
    problem: Comparable,
    place: int,
    count: int,
    others: list[tuple[int, Segment, np.ndarray]],
    label: str,
) -> np.ndarray | None:
    """States of the other trajectory at so many samples from a place on, as many as there are."""
    blocks = []
    for begin, segment, states in others:
        if place < 0 or begin < 0:
            part = states if place == begin else states[:0]
        else:
            part = states[max(place - begin, 0) : max(place + count - begin, 0)]
        if len(part):
            blocks.append(problem.rows(segment, part, label))
    if not blocks:
        return None
    return blocks[0] if len(blocks) == 1 else np.concatenate(blocks)


def _alike(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """The second array in the kind of the first, where NumPy cannot mix the two."""
    if first.dtype == second.dtype or first.dtype != np.longdouble or second.dtype == np.float64:
        return second
    rows = [[np.longdouble(str(x)) for x in row] for row in second]
    return np.array(rows, dtype=np.longdouble)
