"""Search: the tolerance whose answer is good enough, begun where equal equations came to before."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, NamedTuple, TypeVar

from geomtorsion.motion.checking import CAUTION, LITTLE, Attempt, Checked, rounding
from geomtorsion.motion.engines.protocol import Engine

A = TypeVar("A", bound=Attempt)


class Told(NamedTuple, Generic[A]):
    """An answer, a looser run of the same motion, and what they and other runs tell.

    against: gives the looser run, of which nothing is needed but how far it is from the answer.
    gap: how far answer and that run are apart, relative to the size of each block.
    left_out: error by what the steps leave out; rounded: by rounding as it grows on the way.
    spent: all runs that took time of their own; seconds: how long the answer ran.
    """

    answer: A
    against: Callable[[], A]
    gap: float
    left_out: float
    rounded: float
    spent: tuple[A, ...]
    seconds: float = 0.0


@dataclass(frozen=True)
class Rules:
    """How an engine goes from one tolerance to the next.

    name: under which tolerances are remembered.
    taken: an answer is taken if what its steps leave out is below this part of the accuracy.
    reserve: the next tolerance is to leave out this part of the accuracy.
    smallest, largest: it is between these parts of the last one; blind: where nothing is known.
    looser: (tolerance, what is to spare) -> a tolerance to begin with next time.
    proven: seconds of running of equal equations after which that is tried.
    """

    name: str
    taken: float
    reserve: float
    smallest: float
    largest: float
    blind: float
    looser: Callable[[Any, float, float], float]
    proven: float = 0.0


def searched(
    engine: Engine,
    rules: Rules,
    accuracy: float,
    known: dict[Any, float],
    attempt: Callable[[float], Told[A] | None],
    hopeless: Callable[[], bool] = lambda: False,
) -> Checked[A] | None:
    """The answer of the first tolerance that is good enough, or the best one.

    known: tolerances that were good enough before, for equal equations.
    attempt: None where its runs cannot tell; hopeless: whether that is so where the finest fails.

    Returns
    -------
    None where another way of telling has to be tried.
    """
    key = engine.name, accuracy, rules.name
    missing, running = (*key, "missed"), (*key, "ran")
    tolerance, before = known.get(key) or engine.first(accuracy), math.inf
    spent: dict[int, A] = {}
    best, least = None, math.inf
    while True:
        found = attempt(tolerance)
        if found is None:
            return None
        for run in found.spent:
            spent[id(run)] = run
        error = max(found.left_out, found.rounded, rounding(engine, found.answer.steps))
        good = found.left_out <= rules.taken * accuracy and error <= accuracy
        if good:
            known[key] = tolerance
            known[running] = known.get(running, 0.0) + found.seconds
            if known[running] >= rules.proven:
                looser = rules.looser(engine, tolerance, rules.taken * accuracy / error)
                if tolerance < looser < known.get(missing, math.inf):
                    known[key] = looser
        if best is None or error < least:
            best, least = found, error
        # Where rounding is what is left, smaller steps gain nothing. (One look is not enough: runs
        # may be further apart than their steps explain because one step was too long.)
        idle, finest = error > LITTLE * before, tolerance <= engine.finest * 1.01
        if finest and not good and not idle and hopeless():
            return None
        if good or idle or finest:
            share = least / best.gap if best.gap > 0 else CAUTION
            return Checked(best.answer, best.against, share, least, tuple(spent.values()))
        known[missing] = min(tolerance, known.get(missing, math.inf))
        before = error if found.rounded > found.left_out else math.inf
        # Of an error that cannot be told no more is known than that it is too large.
        largest = rules.largest if error < math.inf else rules.blind
        step = min(max(rules.reserve * accuracy / error, largest), rules.smallest)
        tolerance = max(engine.rung(tolerance * step), engine.finest)
