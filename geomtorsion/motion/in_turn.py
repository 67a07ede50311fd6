"""In turn: an answer of RungeKutta whose error is told by two or three cheap runs after it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeVar

from geomtorsion.motion.checking import CAUTION, SATURATED, Attempt, Checked
from geomtorsion.motion.engines.rungekutta import COARSER, FEW_STEPS, RungeKutta, shrunk
from geomtorsion.motion.search import Rules, Told, searched

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

A = TypeVar("A", bound=Attempt)
Moved = Callable[[float, float], A]
Difference = Callable[[A, A], tuple[float, int]]


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
    return searched(
        engine,
        IN_TURN,
        accuracy,
        known,
        lambda tolerance: _told(engine, accuracy, attempt(tolerance), attempt, moved, difference),
    )


def _looser(engine: RungeKutta, tolerance: float, spare: float) -> float:
    """A looser tolerance if there is something to spare."""
    return engine.rung(tolerance * max(spare / SPARED, 1.0))


IN_TURN = Rules("in turn", TAKEN, RESERVE * TAKEN, SMALLEST_STEP, LARGEST_STEP, BLIND_STEP, _looser)


def _told(
    engine: RungeKutta,
    accuracy: float,
    answer: A,
    attempt: Callable[[float], A],
    moved: Moved[A],
    difference: Difference[A],
) -> Told[A] | None:
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
        left_out = max(left_out, CAUTION * share * near)
        return Told(answer, lambda: coarse, gap, left_out, 0.0, (answer, coarse, middle))
    if not fine or left_out > accuracy:
        return Told(answer, lambda: coarse, gap, left_out, 0.0, (answer, coarse))
    others, rounded = _roundings(accuracy, answer, left_out, moved, difference)
    return Told(answer, lambda: coarse, gap, left_out, rounded, (answer, coarse, *others))


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
