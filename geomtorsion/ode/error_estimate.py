"""Error estimate: one rule for everything that moves.

The answer is compared with one more run, some orders finer; twice the largest difference is the
error. The start of the finer run is perturbed by one rounding error.

Roundings of two runs may agree by chance: then their difference does not contain them.
Unless steps omit far more than roundings, one more run like the answer is therefore changed on the
way, in 64 places, at random and by a thousand times what the roundings of all steps add up to: its
difference from the answer shows how much the motion amplifies roundings. A few random numbers do
not show their mean: the factor is Student's. If the result is not far below the accuracy, further
runs make it surer. The motion amplifies roundings of all engines alike: it is measured once.

No step of the finer run is longer than a hundredth of the way: a long step sees nothing of rates
that change further ahead.

The rule cannot see what both runs share: rates that change within less than such a step and are
constant to all digits around, and roundings of the rates themselves where these lose digits in a
difference, such as 1 - cos(x) of a small x. A proof sees both: see `geomtorsion.prove`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple, Protocol

import numpy as np

from geomtorsion.ode.changes import changes_before, time_gaps
from geomtorsion.ode.numbers import floats
from geomtorsion.ode.system import Engine, columns
from geomtorsion.ode.trajectory import Segment, Stage, Trajectory
from geomtorsion.support.precision import GOLDEN

# Factor from the difference to the error, because the finer run has an error of its own. Also the
# number of units in the last place by which the start of that run differs, because roundings add up
# on the way.
SAFETY = 2.0
# A single difference of a named quantity is uncertain by this number of roundings.
CHANCE = 20.0
# Changes on the way are larger than roundings by this factor, so that they hide them.
MAGNIFIED = 1000.0
# Quantiles of Student's distribution: a further random number exceeds the root mean square of one,
# two, ... earlier ones by this factor in two of a thousand cases.
STUDENT = (318.0, 22.3, 10.2, 7.2, 5.9, 5.2)
# Number of random changes that give an error estimate which is not far too large.
ENOUGH = 3
# Near unstable equilibria the errors of steps were down to 4e6 times smaller than the tolerance
# (500 motions): they are certainly far larger than roundings only where the tolerance exceeds
# roundings by this factor.
FAR = 1e8
# Each tolerance aims at this part of the accuracy, because errors follow it only roughly and
# another pair of runs costs more than a finer one.
AIM = 0.1
# Below this number of roundings of the largest term of its rate, a state is rounding noise.
NOISE = 100.0
# Noise in two runs differs by more than this fraction of its size.
UNALIKE = 1 / NOISE


class Comparable(Protocol):
    """A reader of states of a motion for comparisons."""

    def rows(self, segment: Segment, states: np.ndarray, label: str) -> np.ndarray:
        """States of a segment in the coordinates of a label, shape (m, size)."""
        ...

    def read_gaps(
        self, one: Trajectory, two: Trajectory, count: int, accuracy: float, /
    ) -> list[tuple[np.ndarray, float]]:
        """Differences at the first samples as a reader sees them, and the size of all.

        accuracy: the part of a size below which differences do not count.
        """
        ...


class Integration(Protocol):
    """Integrates a motion."""

    def __call__(
        self,
        engine: Engine,
        tolerance: float,
        answer: Trajectory | None = None,
        pattern: int = 0,
    ) -> Trajectory:
        """The trajectory; to compare it with an answer, with changes of a pattern if not zero."""
        ...


class Comparison(NamedTuple):
    """A run with which an answer is compared, and the factor of their difference."""

    run: Trajectory
    factor: float


def combined(gaps: Sequence[np.ndarray], comparisons: Sequence[Comparison]) -> np.ndarray:
    """Errors from differences to the finer run and, where there is one, to a changed run."""
    errors = comparisons[0].factor * gaps[0]
    for gap, (_, factor) in zip(gaps[1:], comparisons[1:], strict=True):
        # The finer run has errors of its own, or it has roundings of its own.
        errors = np.maximum(errors, gaps[0] + factor * gap)
    return errors


class Verified(NamedTuple):
    """A solution with its comparison runs, its error, and all runs.

    comparisons: the finer run; and one that was changed on the way, where roundings matter.
    error: relative to the size of each group of states; infinite where nothing could be compared.
    growth: the error in units of what each step adds to it.
    amplified: what the motion makes of a rounding, at most; not a number where it is not known.
    """

    answer: Trajectory
    comparisons: tuple[Comparison, ...]
    error: float
    runs: tuple[Trajectory, ...]
    growth: float
    amplified: float


def verified(
    problem: Comparable,
    engine: Engine,
    accuracy: float,
    run: Integration,
    *,
    growth: float = 0.0,
    amplified: float = math.nan,
    last: bool = True,
) -> Verified:
    """The first answer of an engine's ladder of tolerances whose error is small enough.

    Or the best one, where none is.

    growth, amplified: of an attempt that failed. last: whether no more precise engine follows.
    """
    runs: list[Trajectory] = []
    best: Verified | None = None
    aim = AIM * accuracy
    tolerance: float | None = engine.first(aim / growth if growth > 1 else aim)
    while tolerance is not None and (finer := engine.finer(tolerance)) is not None:
        answer = run(engine, tolerance)
        least = rounding(engine, answer.steps)
        reference = run(engine, finer, answer)
        runs += [answer, reference]
        gap = max(difference(problem, answer, reference, accuracy), least)
        noise, shown = 0.0, None
        if SAFETY * gap <= accuracy and roundings_matter(engine, answer.steps, tolerance):
            # The finer run has roundings of its own.
            rounded_off = rounding(engine, max(answer.steps, reference.steps))
            noise = amplified * rounded_off
            if math.isnan(noise):
                noise, shown, changed = _noise(problem, runs[-2:], gap, accuracy, run)
                amplified = noise / rounded_off if noise <= UNALIKE else math.nan
                runs += changed
        error = max(SAFETY * gap, gap + noise)
        # If a finer tolerance does not halve the error, the rest is rounding, and later agreement
        # would be chance.
        rounded = best is not None and best.error <= UNALIKE and SAFETY * error > best.error
        rounded |= SAFETY * noise > accuracy
        if math.isfinite(error):
            growth = max(growth, SAFETY * gap / max(tolerance, least))
        if best is None or error < best.error:
            comparisons = (Comparison(reference, error / gap),)
            if shown is not None and noise > gap:
                comparisons = Comparison(reference, SAFETY), shown
            best = Verified(answer, comparisons, error, (), growth, amplified)
        # What steps omit may add up in proportion to their number, roundings as its root.
        hopeless = not last and growth * 2.0**-engine.precision > accuracy
        if error <= accuracy or rounded or hopeless or answer.outcome == "stuck":
            break
        tolerance = next_tolerance(engine, tolerance, accuracy / error)
    assert best is not None
    return best._replace(runs=tuple(runs), growth=growth, amplified=amplified)


def roundings_matter(engine: Engine, steps: int, tolerance: float, far: float = FAR) -> bool:
    """Whether roundings may be a noticeable part of the error of a run.

    The motion carries the rounding of a step to the end as it carries what the step omits, which is
    about the tolerance, or less.

    far: how many times less steps may omit.
    """
    return rounding(engine, steps) > tolerance / far


def _noise(
    problem: Comparable, pair: Sequence[Trajectory], gap: float, accuracy: float, run: Integration
) -> tuple[float, Comparison, list[Trajectory]]:
    """What roundings add to the gap of a pair; the run that shows most of it; all that were made.

    pair: the answer and the finer run, which may have more roundings.
    """
    answer, reference = pair
    scale = math.sqrt(max(reference.steps / max(answer.steps, 1), 1.0)) / MAGNIFIED
    noise, total, widest, shown = math.inf, 0.0, 0.0, answer
    changed: list[Trajectory] = []
    for number, factor in enumerate(STUDENT, 1):
        changed.append(run(answer.engine, answer.tolerance, answer, number))
        part = difference(problem, answer, changed[-1], accuracy)
        if part > widest:
            widest, shown = part, changed[-1]
        # What differs that much is not in proportion to the changes.
        total += (part * (scale if part <= UNALIKE else 1.0)) ** 2
        size = math.sqrt(total / number)
        noise = factor * size
        # Where it is much too large, further runs do not help.
        enough = number >= ENOUGH and (gap + noise <= accuracy or SAFETY * size > accuracy)
        if noise <= gap or gap + noise <= AIM * accuracy or enough:
            break
    return noise, Comparison(shown, noise / widest if widest > 0 else 0.0), changed


def change_by_rounding(engine: Engine, steps: float) -> float:
    """Relative change of a state that is as large as the sum of the roundings of a number of steps.

    Each step rounds the state to half a unit in the last place at most. The roundings add up at
    random, as the square root of the number of steps.
    """
    return 2.0**-engine.precision * math.sqrt(max(steps, 1))


def next_tolerance(engine: Engine, tolerance: float, missing: float) -> float | None:
    """The next tolerance after a run with too large an error; None at the finest.

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


def rounding(engine: Engine, steps: float) -> float:
    """Relative size of the roundings of some steps: a last place each, adding up at random."""
    return 2.0 ** (1 - engine.precision) * math.sqrt(max(steps, 1))


def difference(
    problem: Comparable, one: Trajectory, two: Trajectory, accuracy: float = 0.0
) -> float:
    """Largest difference of two trajectories, each group of states against its own size.

    Over all samples that both reached, in the coordinates in which the first was followed, and in
    those in which they are read.
    Infinite where there is no such sample, where a difference is NaN, where only one of them was
    stopped, or where only the first reached the end. If both were stopped, their last states and
    times are also compared.

    accuracy: of values computed from the states, and the distance to an edge of a chart from
        which they are compared.
    """
    count = min(one.count, two.count)
    stopped = one.outcome == two.outcome == "stopped"
    if one.outcome != two.outcome and "stopped" in (one.outcome, two.outcome):
        return math.inf
    if one.outcome == "done" and two.count < one.count:
        return math.inf
    if not count and not stopped:
        return math.inf
    worst = time_gaps(one, two)
    if stopped:
        gap = abs(float(one.segments[-1].run.reached - two.segments[-1].run.reached))
        worst = max(worst, gap / abs(one.reached)) if gap else worst
    for pair in _pairs(problem, one, two, stopped):
        worst = max(worst, pair.largest(one))
    if math.isfinite(worst):
        worst = max(worst, float(_read_differences(problem, one, two, count, accuracy).max()))
    return worst


def _read_differences(
    problem: Comparable, one: Trajectory, two: Trajectory, count: int, accuracy: float
) -> np.ndarray:
    """Largest relative difference of what a reader gets at each of the first samples, (count,)."""
    worst = np.zeros(max(count, 1))
    for gaps, size in problem.read_gaps(one, two, count, accuracy):
        worst = np.maximum(worst, gaps / size if gaps.any() else 0.0)
    return worst


def difference_over_samples(
    problem: Comparable, one: Trajectory, two: Trajectory, accuracy: float = 0.0
) -> np.ndarray:
    """The same at each sample of the first, shape (m,); not a number where the second ended."""
    differences = np.full(one.count, np.nan)
    for pair in _pairs(problem, one, two, False):
        differences[pair.places] = pair.at_samples()
    count = min(one.count, two.count)
    if count:
        read = _read_differences(problem, one, two, count, accuracy)
        differences[:count] = np.maximum(differences[:count], read)
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
                    size = _size_of_noise(self.parts[0][1].stage, one, group, extent)
                    part = gap / size if size > 0 else math.inf
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
    terms = max([_mean_terms(x, group) for x in some])
    last, numbers = floats(some[-1].run.last), floats(some[-1].stage.parameters)
    damping = float((-np.diagonal(system.jacobian(last, numbers))[group]).min())
    full = terms * min(abs(one.reached), 1 / damping if damping > 0 else math.inf)
    noise = NOISE * 2.0**-one.engine.precision * full
    if extent > noise or not math.isfinite(noise):
        return extent
    between = _size_between(one, stage.label, group)
    return between if between > noise else full


def _mean_terms(segment: Segment, group: Sequence[int]) -> float:
    """Mean size of the terms of some rates over a segment; it has no part in a peak at an end.

    Rates may be infinite at a sample, while what they add up to is not.
    """
    times = floats((segment.stage.begin, *segment.run.times, segment.run.reached))
    sizes = segment.stage.system.rates.sizes(*_columns(segment))[group].max(axis=0)
    lasts = np.abs(np.diff(times))
    least = np.minimum(sizes[:-1], sizes[1:])
    # What lasts no time is omitted, where an infinite size would give no number.
    total = float((least[lasts > 0] * lasts[lasts > 0]).sum())
    return total / float(lasts.sum()) if lasts.any() else float(sizes.max())


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
    # Between a change in one motion and the same change in the other, states cannot be compared:
    # the difference of the times counts instead.
    before = [changes_before(x)[: min(one.count, two.count)] for x in (one, two)]
    beside = np.flatnonzero(before[0] != before[1])
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
            inside = beside[(beside >= max(place, 0)) & (beside < place + len(there))]
            if place >= 0 and len(inside):
                there = there.copy()
                there[inside - place] = rows[inside - place]
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
        yield _Pair(parts, here, alike(here, there), sizes)


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
    """States of the other trajectory at a number of samples from an index on, or at the rest."""
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


def alike(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """The second array in the kind of the first, where NumPy cannot mix the two."""
    if first.dtype == second.dtype or first.dtype != np.longdouble or second.dtype == np.float64:
        return second
    rows = [[np.longdouble(str(x)) for x in row] for row in second]
    return np.array(rows, dtype=np.longdouble)
