"""Abreast: an answer whose error is told by runs in the lanes beside it, at one go."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

from geomtorsion.motion.checking import (
    LARGEST_STEP,
    RESERVE,
    SATURATED,
    SMALLEST_STEP,
    Attempt,
    Checked,
)
from geomtorsion.motion.engines.abreast import Abreast, run_abreast
from geomtorsion.motion.engines.taylor import Taylor
from geomtorsion.motion.search import Rules, Told, searched
from geomtorsion.motion.system import System

# An error estimate is this many times what the lanes say: four agree more than two.
CAUTION = 1.6
# An answer is taken if what its series leave out is below this part of the accuracy.
TAKEN = 0.8
# What is left to spare where the next motion begins with a looser tolerance.
SPARED = 1.5
# Seconds of running of equal equations after which that is tried.
PROVEN = 0.2
# Motions of fewer steps in a lane end where their last step would go on: they tell nothing.
LEAST_STEPS = 2
# The next tolerance where nothing is known of the error.
BLIND_STEP = 1e-2
# The size by which steps are measured may be so many times too small, and too large.
OUTGROWN, OVERSIZED = 4.0, 16.0
# States of this size that were small may have needed smaller steps where they were small.
GROWN = 1e3
# The first lane leaves out no more than so many times what tells it from the last two.
FASTER = 4.0
# Where lanes are apart by so many times more than the series explain, it is rounding that tells
# them apart; and two roundings may be near each other by chance.
ROUGH, CHANCE = 4.0, 2.0
# Starts of the lanes beside are moved by so many units in the last place, as roundings add up.
ROUNDINGS = 2.0
EPSILON = 2.0**-52

A = TypeVar("A", bound=Attempt)


def _looser(engine: Taylor, tolerance: float, spare: float) -> float:
    """A looser tolerance if there is something to spare: at least one order.

    Orders do not serve evenly: where a motion runs backwards as forwards, even ones are better than
    the odd ones above them.
    """
    if spare <= SPARED:
        return tolerance
    orders = max(math.floor(math.log(spare / SPARED) / 2), 1)
    return engine.rung(tolerance * math.exp(2 * orders))


LANES = Rules("abreast", TAKEN, RESERVE, SMALLEST_STEP, LARGEST_STEP, BLIND_STEP, _looser, PROVEN)


def told(
    engine: Taylor,
    accuracy: float,
    known: dict[Any, float],
    attempt: Callable[[float], Told[A] | None],
) -> Checked[A] | None:
    """The answer of the first tolerance that is good enough, or the best one.

    known: tolerances and sizes of equal equations.
    None where runs abreast cannot tell: then one run after the other may.
    """

    def outgrown() -> bool:
        # States that grow from small ones need steps that are measured by the small ones.
        return known.get("size", 1.0) > GROWN

    return searched(engine, LANES, accuracy, known, attempt, outgrown)


def side_by_side(
    engine: Taylor,
    system: System,
    starts: Any,
    parameters: Any,
    times: Any,
    tolerance: float,
    looser: float,
    known: dict[Any, float],
) -> Abreast | None:
    """Lanes whose steps are measured by the size of the states.

    starts, parameters, looser: as in `run_abreast`.
    known: keeps that size for the next run of equal equations.
    """
    size = max(known.get("size", 1.0), 1.0, *map(abs, starts[:, 0].tolist()))
    for _ in range(3):
        lanes = run_abreast(engine, system, starts, parameters, times, tolerance, looser, size)
        if lanes is None or min(lanes.steps) < LEAST_STEPS:
            return None
        top = max(1.0, *lanes.extents[0])
        if size / OVERSIZED <= top <= OUTGROWN * size:
            return lanes
        known["size"] = size = top
    return None


def gaps(
    extents: Sequence[Sequence[float]],
    blocks: Sequence[Sequence[int]],
    ignored: Callable[[Sequence[int], float, float], bool] = lambda _index, _part, _size: False,
) -> list[float] | None:
    """How far each lane is from the first, relative to the size of each block; None: no number.

    extents: sizes of the states, and how far they are from these in each other lane.
    ignored: (block, largest part by which its lanes differ, size) -> whether that says nothing.
    """
    sizes, *apart = extents
    if not math.isfinite(sum(map(sum, apart))):
        return None
    worst = [0.0] * len(apart)
    for block in blocks:
        found = [max([row[k] for k in block]) for row in apart]
        if not any(found):
            continue
        size = max([sizes[k] for k in block])
        parts = [gap / size if size > 0 else math.inf for gap in found]
        if not ignored(block, max(parts), size):
            worst = list(map(max, worst, parts))
    return worst


def judged(share: float, apart: Sequence[float]) -> tuple[float, float]:
    """Errors by what is left out and by rounding, from how far lanes are apart."""
    far, near = apart[0], CAUTION * max(apart[1:])
    left_out = CAUTION * share * far if far <= SATURATED else math.inf
    if left_out < math.inf:
        # What series of entire functions leave out falls faster than any power of the step.
        left_out = min(left_out, FASTER * near)
    return left_out, near if near <= ROUGH * left_out else CHANCE * near


def moves(looser: float) -> tuple[float, ...]:
    """By which part of themselves the starts of the lanes are moved.

    Of the difference to the second lane only a share is taken for the error: it is moved by as
    much more.
    """
    step = ROUNDINGS * EPSILON
    return 0.0, step * looser, step, -step
