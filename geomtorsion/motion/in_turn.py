"""In turn: an answer of RungeKutta whose error is told by two or three cheap runs after it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

from geomtorsion.motion.checking import (
    CAUTION,
    LITTLE,
    SATURATED,
    Attempt,
    Checked,
    rounding,
)
from geomtorsion.motion.engines.rungekutta import COARSER, FEW_STEPS, RungeKutta, shrunk

# An answer is taken if what its steps leave out is below this part of the accuracy, ...
TAKEN = 0.35
# ... and the next tolerance is to leave out this part of that.
RESERVE = 0.6
# What is left to spare where the next motion begins with a looser tolerance.
SPARED = 1.4
# The next tolerance is between these parts of the last one, and where nothing is known of the
# error this one.
SMALLEST_STEP, LARGEST_STEP, BLIND_STEP = 0.57, 1e-6, 1e-2
# A run with a looser tolerance than this is no longer like the answer.
LOOSEST = 1.01e-3
# Errors of fewer steps may cancel by chance: they are held against a run between, too.
MANY_STEPS, BETWEEN = 300, 10.0
# From this tolerance on rounding may matter: it is told by runs that round differently, ...
ROUGH_BELOW = 1.2e-13
# ... with tolerances larger by these factors, started above and below.
OTHERWISE = (1.5, 2.25)
# Where runs are apart by so many times more than steps explain, rounding tells them apart.
ROUGH = 4.0
# One such run is enough if so many times what it says is below this part of the accuracy.
CHANCE, DOUBTED = 2.0, 0.25
# Where rounding has grown to this, few of the first roundings decide.
GROWN = 1e-11
EPSILON = 2.0**-52
# Rounding is what is left where it is so many times what the steps leave out.
IDLE = 30.0

A = TypeVar("A", bound=Attempt)
Moved = Callable[[float, float], A]
Difference = Callable[[A, A], tuple[float, int]]


@dataclass(frozen=True, eq=False)
class _Told(Generic[A]):
    """What the runs after an answer tell.

    gap: how far the answer is from the coarse check, relative to the size of each block.
    left_out, rounded: errors by steps and by rounding as it grows on the way.
    """

    check: A
    gap: float
    left_out: float
    rounded: float
    spent: tuple[A, ...]


def told_in_turn(
    engine: RungeKutta,
    accuracy: float,
    known: dict[Any, float],
    attempt: Callable[[float], A],
    moved: Moved[A],
    difference: Difference[A],
) -> Checked[A] | None:
    """The answer of the first tolerance that is good enough, or the best one.

    Parameters
    ----------
    known
        tolerances that were good enough before, for equal equations.
    attempt
        makes a run of a tolerance, each but once.
    moved
        makes a run of a tolerance whose states are moved by a relative part.
    difference
        largest relative difference of two runs, and how many samples were compared.

    Returns
    -------
    None where these runs cannot tell: few steps, a motion that ends on its way.
    """
    key, missing = (engine.name, accuracy), (engine.name, accuracy, "missed")
    tolerance, before = known.get(key) or engine.first(accuracy), math.inf
    spent: list[A] = []
    best: Checked[A] | None = None
    while True:
        answer = attempt(tolerance)
        told = _told(engine, accuracy, answer, attempt, moved, difference)
        if told is None:
            return None
        spent += [answer, *told.spent]
        error = max(told.left_out, told.rounded, rounding(engine, answer.steps))
        good = told.left_out <= TAKEN * accuracy and error <= accuracy
        if best is None or error < best.error:
            share = error / told.gap if told.gap > 0 else CAUTION
            best = Checked(answer, told.check, share, error, ())
        if good:
            missed = known.get(missing, math.inf)
            known[key] = _remembered(engine, tolerance, TAKEN * accuracy / error, missed)
        # Where rounding is what is left, smaller steps gain nothing.
        idle = told.left_out <= told.rounded / IDLE or error > LITTLE * before
        if good or idle or tolerance <= engine.finest * 1.01:
            every = {id(one): one for one in spent}
            return replace(best, spent=tuple(every.values()))
        known[missing] = min(tolerance, known.get(missing, math.inf))
        before = error if told.rounded > told.left_out else math.inf
        tolerance = _next(engine, tolerance, accuracy, error)


def _next(engine: RungeKutta, tolerance: float, accuracy: float, error: float) -> float:
    """The tolerance after an error that is too large; of infinite ones no more is known."""
    largest = LARGEST_STEP if error < math.inf else BLIND_STEP
    step = min(max(RESERVE * TAKEN * accuracy / error, largest), SMALLEST_STEP)
    return max(engine.rung(tolerance * step), engine.finest)


def _remembered(engine: RungeKutta, tolerance: float, spare: float, missed: float) -> float:
    """The tolerance to begin with next time: a looser one if there is so much to spare.

    missed: one that was too loose before.
    """
    looser = engine.rung(tolerance * max(spare / SPARED, 1.0))
    return looser if tolerance < looser < missed else tolerance


def _told(
    engine: RungeKutta,
    accuracy: float,
    answer: A,
    attempt: Callable[[float], A],
    moved: Moved[A],
    difference: Difference[A],
) -> _Told[A] | None:
    """What a coarser run, and runs that round differently where that matters, say of an answer."""
    wide = COARSER * answer.tolerance
    if answer.outcome != "done" or answer.steps < FEW_STEPS or wide > LOOSEST:
        return None
    fine = answer.tolerance <= ROUGH_BELOW
    # Of the difference only a share is taken: the start is moved by as much more, unless other
    # runs are to tell of rounding.
    coarse = attempt(wide) if fine else moved(wide, COARSER * EPSILON)
    share = engine.shrinks(answer, coarse)
    if share is None or coarse.outcome != "done":
        return None
    gap, compared = difference(answer, coarse)
    if not compared or gap == math.inf:
        return None
    left_out = CAUTION * share * gap if gap <= SATURATED else math.inf
    if not fine and answer.steps < MANY_STEPS and left_out <= accuracy:
        middle = moved(BETWEEN * answer.tolerance, BETWEEN * EPSILON)
        share, (near, compared) = shrunk(answer, middle), difference(answer, middle)
        if share is None or not compared:
            return None
        return _Told(coarse, gap, max(left_out, CAUTION * share * near), 0.0, (coarse, middle))
    if not fine or left_out > accuracy:
        return _Told(coarse, gap, left_out, 0.0, (coarse,))
    others, rounded = _roundings(accuracy, answer, left_out, moved, difference)
    return _Told(coarse, gap, left_out, rounded, (coarse, *others))


def _roundings(
    accuracy: float, answer: A, left_out: float, moved: Moved[A], difference: Difference[A]
) -> tuple[list[A], float]:
    """Runs that round differently, one or two, and the error by rounding."""
    others: list[A] = []
    near, rough = 0.0, False
    for factor, part in zip(OTHERWISE, (EPSILON, -EPSILON), strict=True):
        other = moved(factor * answer.tolerance, part)
        others.append(other)
        apart, compared = difference(answer, other)
        near = max(near, CAUTION * apart if compared else math.inf)
        rough = near > ROUGH * left_out
        if not rough or near > accuracy or CHANCE * near <= DOUBTED * accuracy:
            break
    # Two runs may be near each other by chance; so may three where few roundings decide.
    doubted = rough and (len(others) == 1 or near > GROWN)
    return others, CHANCE * near if doubted else near
