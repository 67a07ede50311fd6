"""Budget: the time that each digit costs, from a few runs, and the digits that a time buys."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from geomtorsion import checks
from geomtorsion.errors import AccuracyError
from geomtorsion.outgoing import duration_text

Result = TypeVar("Result")
# Runs shorter than this many seconds of processor time are repeated until they take as long.
LONG_ENOUGH = 0.02
# Digits of the runs from which the time of other digits is predicted, as far as they are needed.
TRIALS = (2.0, 7.0, 12.0)
# Accuracies are chosen from steps of so many to a digit, so that noise of the clock seldom matters.
STEPS = 10


@dataclass(frozen=True)
class Timed(Generic[Result]):
    """A run and its processor time.

    result: of the first run. seconds: of the fastest run, by the thread that called it.
    spread: of repeated runs, (median - fastest) / fastest; 0.0 for a single one.
    """

    result: Result
    seconds: float
    spread: float


def timed(run: Callable[[], Result], *, first: bool = False) -> Timed[Result]:
    """Run, and repeat what is quick.

    first: whether the first run may compile or load something; then it does not count.

    Examples
    --------
    >>> timed(lambda: sum(range(1000))).result
    499500
    """
    result, seconds = _clocked(run)
    every = [] if first else [seconds]
    total = sum(every)
    while not every or total < LONG_ENOUGH:
        every.append(_clocked(run)[1])
        total += every[-1]
    least = min(every)
    return Timed(result, least, max(0.0, statistics.median(every) / least - 1))


def _clocked(run: Callable[[], Result]) -> tuple[Result, float]:
    began = time.thread_time()
    result = run()
    # A coarse clock may show no time at all.
    tick = time.get_clock_info("thread_time").resolution
    return result, max(time.thread_time() - began, tick)


@dataclass(frozen=True)
class TimeModel:
    """Time of d digits: a + b d + c d^2 through three runs, fewer terms through fewer runs.

    digits, seconds: of the runs, digits rising.

    Examples
    --------
    >>> model = TimeModel((2.0, 6.0, 10.0), (1.0, 2.0, 4.0))
    >>> model.at(6.0), model.at(8.0), model.digits_for(2.9), model.digits_for(0.5)
    (2.0, 2.875, 8.0, None)
    """

    digits: tuple[float, ...]
    seconds: tuple[float, ...]

    @classmethod
    def of(cls, digits: Sequence[float], seconds: Sequence[float]) -> TimeModel:
        """Through the first, the middle and the last of some runs."""
        pairs = sorted(dict(zip(digits, seconds, strict=True)).items())
        picked = sorted({0, len(pairs) // 2, len(pairs) - 1})
        return cls(tuple(pairs[k][0] for k in picked), tuple(pairs[k][1] for k in picked))

    def at(self, digits: float) -> float:
        """Predicted seconds; never less than the cheapest of the runs."""
        total = 0.0
        for k, (own, seconds) in enumerate(zip(self.digits, self.seconds, strict=True)):
            others = [x for j, x in enumerate(self.digits) if j != k]
            total += seconds * math.prod((digits - x) / (own - x) for x in others)
        return max(total, min(self.seconds))

    def digits_for(self, seconds: float) -> float | None:
        """The most digits, between those of the runs, that a time buys; None: not even the fewest.

        In steps of a tenth of a digit.
        """
        low, high = self.digits[0], self.digits[-1]
        steps = np.arange(math.ceil(low * STEPS), math.floor(high * STEPS) + 1) / STEPS
        choices = sorted({low, *steps.tolist(), high}, reverse=True)
        return next((d for d in choices if self.at(d) <= seconds), None)


def affordable(run: Callable[[float], object], seconds: object, shorter: str) -> float:
    """The finest accuracy from 1e-2 to 1e-12 for which a run takes no longer than some seconds.

    run: at an accuracy. At most three accuracies are tried: none after the first that takes longer.
    shorter: what else costs less, for the message.

    Raises
    ------
    AccuracyError
        seconds is not a positive number, or the coarsest accuracy takes longer.

    Examples
    --------
    >>> affordable(lambda accuracy: accuracy, 1.0, "a shorter sum")
    1e-12
    """
    most = checks.positive(seconds, "seconds", AccuracyError)
    digits: list[float] = []
    spent: list[float] = []
    for trial in TRIALS:
        try:
            spent.append(timed(lambda d=trial: run(10.0**-d), first=True).seconds)
        except AccuracyError:
            # Digits that cannot be had have no price.
            if not spent:
                raise
            break
        digits.append(trial)
        if spent[-1] > most:
            break
    chosen = TimeModel.of(digits, spent).digits_for(most)
    if chosen is None:
        raise AccuracyError(
            f"seconds: expected at least {duration_text(spent[0])}, the time for an accuracy of "
            f"{10.0 ** -digits[0]:.0e}, got {duration_text(most)}. Give more time, or {shorter}."
        )
    return 10.0**-chosen
