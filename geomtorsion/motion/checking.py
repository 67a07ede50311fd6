"""Checking: an answer, and how wrong it is, from two runs of different tolerance."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Generic, NamedTuple, Protocol, TypeVar

from geomtorsion.motion.engines.protocol import Engine

# An error estimate is this many times what the difference of two runs says.
CAUTION = 2.2
# An answer is taken if its error is below this part of the accuracy: estimates, too, have errors.
TAKEN = 0.15
# An answer of fewer steps is held against a finer run: its steps end where the motion does.
FEW_STEPS = 4
# Two runs that differ by more than this part say nothing about each other.
SATURATED = 0.02
# An error that is above this part of the one before has not gained by a smaller tolerance; once is
# no sign yet, for single orders serve badly.
LITTLE, PATIENCE = 0.5, 2
# An error does not fall further than in proportion to the tolerance, but for this part: two runs
# of a few long steps may be near each other by chance.
TRUSTED = 0.05
# (Only a step of the tolerance by more than this is a step.)
REAL_STEP = 0.15
# An error above this part of the accuracy is confirmed by a second check by a finer run.
DOUBTED = 0.01
# Of long numbers, of which longer ones are to be had, two checks are trusted less.
LONGER = 2.5
# Two fine runs share so many roundings, which grow like any error on the way.
SHARED = 6.0
# Where an attempt fails, the next tolerance is this much below what the estimate asks for, ...
RESERVE = 0.35
# ... and between these parts of the last one.
SMALLEST_STEP, LARGEST_STEP = 0.2, 1e-6


class Attempt(Protocol):
    """One integration of a motion."""

    @property
    def tolerance(self) -> float:
        """Local tolerance asked of the engine."""
        ...

    @property
    def steps(self) -> int:
        """Steps that were taken."""
        ...

    @property
    def outcome(self) -> str:
        """How it ended."""
        ...


A = TypeVar("A", bound=Attempt)


class Checked(NamedTuple, Generic[A]):
    """An answer, the run it was held against, and the error.

    against: gives the run that the answer was held against.
    share: the error is this many times the difference of the two.
    error: estimate, relative; infinite where nothing could be compared.
    spent: all runs that took time of their own.
    """

    answer: A
    against: Callable[[], A]
    share: float
    error: float
    spent: tuple[A, ...]

    @property
    def check(self) -> A:
        """The run that the answer was held against."""
        return self.against()


def checked(
    engine: Engine,
    accuracy: float,
    first: float,
    attempt: Callable[[float], A],
    difference: Callable[[A, A], tuple[float, int]],
    ended: Callable[[A], bool],
    *,
    coarse: bool = True,
    disturbed: Callable[[float, float], A] | None = None,
) -> Checked[A]:
    """The answer of the first tolerance that is good enough, or the last one.

    An answer is held against a coarser run where the engine knows by how much the error shrinks
    from one tolerance to the other, else against a finer one. The coarse run costs a half of the
    answer or less, and shows how errors grow along this very motion; the share is a matter of
    the two orders or step lengths alone.

    Parameters
    ----------
    engine
        gives the tolerances to try.
    accuracy
        largest error.
    first
        tolerance to begin with.
    attempt
        makes a run of a tolerance.
    difference
        largest relative difference of two runs, and how many samples were compared.
    ended
        whether an answer is final however wrong it is: the motion ended on its way.
    coarse
        whether a coarser run may tell the error; not where more is rounded than states, as the
        time is in equations that contain it.
    disturbed
        makes a run of a tolerance whose start is moved by a small relative part, so that a check
        shows how rounding grows. None: checks start as answers do.
    """
    made: dict[float, A] = {}
    aside: dict[tuple[float, float], A] = {}

    def run(tolerance: float) -> A:
        if tolerance not in made:
            made[tolerance] = attempt(tolerance)
        return made[tolerance]

    def run_aside(tolerance: float, answer: A, sign: float = 1.0) -> A:
        if disturbed is None:
            return run(tolerance)
        key = tolerance, sign * _part(engine, answer, tolerance)
        if key not in aside:
            aside[key] = disturbed(*key)
        return aside[key]

    tolerance: float | None = first
    best, before, last, idle = None, math.inf, math.inf, 0
    while tolerance is not None:
        answer = run(tolerance)
        check, share, error = _judged(
            engine, answer, made if disturbed is None else {}, run_aside, difference, coarse
        )
        enough = TAKEN * accuracy
        finer = check.tolerance < answer.tolerance
        if (
            disturbed is not None
            and error <= accuracy
            and (error > DOUBTED * accuracy or not finer)
        ):
            if finer:
                enough = accuracy
            # Two runs may agree by chance where rounding is all that tells them apart; and of what
            # is rounded on the way, a coarser run shows only a share: one of other, shorter steps
            # shows all.
            shorter = max(engine.rung(answer.tolerance * SMALLEST_STEP), engine.finest)
            second = check.tolerance if finer else shorter
            gap, compared = difference(answer, run_aside(second, answer, -1.0))
            weight = CAUTION if engine.precision == 53 else LONGER * CAUTION
            error = max(error, weight * gap if compared else math.inf)
        if finer and before < math.inf:
            error = max(error, TRUSTED * before * answer.tolerance / last)
        if best is None or error < best[-1]:
            best = answer, check, share, error
        if error <= enough or ended(answer):
            break
        if finer:
            # Nothing is gained any more by smaller steps: what is left is rounding.
            gains = not LITTLE * before < error < SATURATED or answer.tolerance >= REAL_STEP * last
            idle = 0 if gains else idle + 1
            if idle == PATIENCE:
                break
            before, last = error, answer.tolerance
        reusable = disturbed is None
        tolerance = _next(engine, answer, check, error / accuracy, reusable=reusable)
    assert best is not None
    every = {id(one): one for one in (*made.values(), *aside.values())}
    answer, check, share, error = best
    return Checked(answer, lambda: check, share, error, tuple(every.values()))


def rounding(engine: Engine, steps: int) -> float:
    """The error that no estimate goes below: one rounding a step, adding up at random."""
    return 2.0**-engine.precision * math.sqrt(max(steps, 1))


def _part(engine: Engine, answer: Attempt, tolerance: float) -> float:
    """By how much to move the start of a check: by one unit in the last place.

    Of the difference to a coarser run only a share is taken for the error, about the ratio of the
    tolerances; moved by as much more, it has its full weight.
    """
    return 2.0 ** (1 - engine.precision) * max(1.0, tolerance / answer.tolerance)


def _judged(
    engine: Engine,
    answer: A,
    made: dict[float, A],
    run: Callable[[float, A], A],
    difference: Callable[[A, A], tuple[float, int]],
    may_coarsen: bool,
) -> tuple[A, float, float]:
    """The run against which an answer is held, the share of the difference, and the error."""
    least = rounding(engine, answer.steps)
    coarse = engine.coarser(answer.tolerance) if may_coarsen else None
    if coarse is not None and answer.steps >= FEW_STEPS:
        usable = [t for t in made if engine.shrinks(answer, made[t]) is not None]
        check = run(max(usable, default=coarse), answer)
        share = engine.shrinks(answer, check)
        if share is not None and check.outcome == answer.outcome:
            gap, compared = difference(answer, check)
            if compared and gap <= SATURATED:
                return check, CAUTION * share, max(CAUTION * share * gap, least)
    finer = engine.finer(answer.tolerance)
    if finer is None:
        return answer, CAUTION, math.inf
    growth = _growth(answer, made, difference)
    least = max(least, SHARED * 2.0**-engine.precision * growth)
    check = run(finer, answer)
    gap, compared = difference(answer, check)
    return check, CAUTION, max(CAUTION * gap, least) if compared else math.inf


def _growth(
    answer: A, made: dict[float, A], difference: Callable[[A, A], tuple[float, int]]
) -> float:
    """How much errors grow on the way, as far as an earlier attempt shows it.

    Two fine runs do not show the rounding that they share.
    """
    earlier = max(made, default=0.0)
    if earlier <= answer.tolerance:
        return 1.0
    gap, compared = difference(answer, made[earlier])
    return gap / earlier if compared and gap <= SATURATED else 1.0


def _next(
    engine: Engine, answer: Attempt, check: Attempt, excess: float, *, reusable: bool
) -> float | None:
    """The tolerance to try after an error that is too large by a factor.

    reusable: whether a finer check may itself serve as the next answer.
    """
    if check.tolerance < answer.tolerance and reusable:
        return check.tolerance
    if answer.tolerance <= engine.finest * 1.01:
        return None
    step = min(max(RESERVE / excess, LARGEST_STEP), SMALLEST_STEP)
    wanted: float | None = max(engine.rung(answer.tolerance * step), engine.finest)
    nearest = engine.rung(answer.tolerance * SMALLEST_STEP)
    if engine.finer(wanted) is None:
        # What cannot be checked is no answer.
        wanted = nearest if nearest < answer.tolerance and engine.finer(nearest) else None
    # A check by a finer run costs three times one by a coarser run: first what is near.
    by_coarser = check.tolerance > answer.tolerance and engine.coarser(nearest) is not None
    if wanted and by_coarser and engine.coarser(wanted) is None:
        return nearest
    return wanted
