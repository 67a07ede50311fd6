"""Abreast: an answer whose error is told by runs in the lanes beside it, at one go."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from geomtorsion.motion.checking import (
    CAUTION,
    FEW_STEPS,
    LARGEST_STEP,
    RESERVE,
    SATURATED,
    SMALLEST_STEP,
    Attempt,
    Checked,
    rounding,
)
from geomtorsion.motion.engines.abreast import Abreast, run_abreast
from geomtorsion.motion.engines.taylor import Taylor
from geomtorsion.motion.system import System

# An answer is taken if what its series leave out is below this part of the accuracy.
TAKEN = 0.8
# The size by which steps are measured may be so many times too small, and too large.
OUTGROWN, OVERSIZED = 4.0, 16.0
# The first lane leaves out no more than so many times what tells it from the last two.
FASTER = 20.0
# Rounding is what is left where it is so many times what the series leave out.
IDLE = 3.0
# Starts of the lanes beside are moved by so many units in the last place, as roundings add up.
ROUNDINGS = 2.0
EPSILON = 2.0**-52

A = TypeVar("A", bound=Attempt)


@dataclass(frozen=True, eq=False)
class Told(Generic[A]):
    """An answer, the run of longer steps beside it, and what they tell.

    left_out: error by what the series leave out; rounded: by rounding as it grows on the way.
    """

    answer: A
    check: A
    share: float
    left_out: float
    rounded: float


def told(
    engine: Taylor,
    accuracy: float,
    known: dict[Any, float],
    attempt: Callable[[float], Told[A] | None],
) -> Checked[A] | None:
    """The answer of the first tolerance that is good enough, or the last one.

    known: tolerances that were good enough before, for equal equations.
    None where runs abreast cannot tell: then one run after the other may.
    """
    key = (engine.name, accuracy)
    tolerance, spent = known.get(key) or engine.first(accuracy), []
    while True:
        found = attempt(tolerance)
        if found is None:
            return None
        spent += [found.answer, found.check]
        least = rounding(engine, found.answer.steps)
        error = max(found.left_out, found.rounded, least)
        good = found.left_out <= TAKEN * accuracy and error <= accuracy
        if good:
            known[key] = tolerance
        # Where rounding is what is left, smaller steps gain nothing.
        rounded = found.left_out <= found.rounded / IDLE
        if good or rounded or tolerance <= engine.finest * 1.01:
            share = CAUTION * found.share
            return Checked(found.answer, found.check, share, error, tuple(spent))
        step = min(max(RESERVE * accuracy / error, LARGEST_STEP), SMALLEST_STEP)
        tolerance = max(engine.rung(tolerance * step), engine.finest)


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
    import numpy as np

    largest = np.maximum.reduce
    size = max(known.get("size", 1.0), float(largest(np.abs(starts[:, 0]), initial=1.0)))
    for _ in range(3):
        lanes = run_abreast(engine, system, starts, parameters, times, tolerance, looser, size)
        if lanes is None or min(lanes.steps) < FEW_STEPS:
            return None
        top = max(1.0, float(largest(lanes.sizes)))
        if size / OVERSIZED <= top <= OUTGROWN * size:
            return lanes
        known["size"] = size = top
    return None


def gaps(states: Any, sizes: Any, blocks: Sequence[Sequence[int]]) -> list[float] | None:
    """How far each lane is from the first, relative to the size of each block; None: no number.

    states: shape (m, size, lanes); sizes: the largest of each state in the first lane.
    """
    import numpy as np

    largest = np.maximum.reduce
    apart = largest(np.abs(states[:, :, 1:] - states[:, :, :1]))
    worst = [0.0] * apart.shape[1]
    for block in blocks:
        first, last = block[0], block[-1] + 1
        size = max(sizes[first:last].tolist())
        for k, gap in enumerate(largest(apart[first:last]).tolist()):
            if gap > 0:
                worst[k] = max(worst[k], gap / size if size > 0 else math.inf)
            elif gap != 0:
                return None
    return worst


def judged(share: float, apart: Sequence[float]) -> tuple[float, float]:
    """Errors by what is left out and by rounding, from how far lanes are apart."""
    far, near = apart[0], CAUTION * max(apart[1:])
    left_out = CAUTION * share * far if far <= SATURATED else math.inf
    # What series of entire functions leave out falls faster than any power of the step.
    return min(left_out, FASTER * near), near


def moves(looser: float) -> tuple[float, ...]:
    """By which part of themselves the starts of the lanes are moved.

    Of the difference to the second lane only a share is taken for the error: it is moved by as
    much more.
    """
    step = ROUNDINGS * EPSILON
    return 0.0, step * looser, step, -step
