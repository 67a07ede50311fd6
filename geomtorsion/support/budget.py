"""Budget: the time that each digit costs, from a few runs, and the digits that a time buys."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from geomtorsion.errors import AccuracyError
from geomtorsion.support import checks
from geomtorsion.support.outgoing import duration_text

Result = TypeVar("Result")
# Runs shorter than this many seconds of processor time are repeated until they take as long.
LONG_ENOUGH = 0.02
# Digits of the first trials.
TRIALS = (2.0, 7.0, 12.0)
# Accuracies are chosen from steps of so many to a digit, so that noise of the clock seldom matters.
STEPS = 10
# A trial that takes this part of the requested time is not improved.
NEARLY = 0.8


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
    """Run, and repeat quick runs.

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
        """The most digits, in the range of the runs, that a time buys; None if it buys fewer.

        In steps of a tenth of a digit.
        """
        low, high = self.digits[0], self.digits[-1]
        steps = np.arange(math.ceil(low * STEPS), math.floor(high * STEPS) + 1) / STEPS
        choices = sorted({low, *steps.tolist(), high}, reverse=True)
        return next((d for d in choices if self.at(d) <= seconds), None)


def affordable(run: Callable[[float], object], seconds: object, shorter: str) -> float:
    """The finest accuracy from 1e-2 to 1e-12 at which a run took no longer than some seconds.

    Trials at 2, 7 and 12 digits, as far as they fit, enclose the number of digits; secants of the
    logarithm of the time narrow it down, until a trial takes most of the time.

    run: at an accuracy. shorter: what else costs less, for the message.

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
    low, quick = TRIALS[0], timed(lambda: run(10.0 ** -TRIALS[0]), first=True).seconds
    if quick > most:
        raise AccuracyError(
            f"seconds: expected at least {duration_text(quick)}, the time for an accuracy of "
            f"{10.0**-low:.0e}, got {duration_text(most)}. Give more time, or {shorter}."
        )
    high, slow = low, quick
    for trial in TRIALS[1:]:
        high, slow = trial, _seconds(run, trial)
        if slow > most:
            break
        low, quick = high, slow
    while slow > most and quick < NEARLY * most and high - low > 1.5 / STEPS:
        part = 0.5 if math.isinf(slow) else math.log(most / quick) / math.log(slow / quick)
        steps = math.floor((low + part * (high - low)) * STEPS)
        # Inside the bracket, so that it shrinks.
        trial = min(max(steps, math.floor(low * STEPS) + 1), math.ceil(high * STEPS) - 1) / STEPS
        needed = _seconds(run, trial)
        if needed > most:
            high, slow = trial, needed
        else:
            low, quick = trial, needed
    return 10.0**-low


def _seconds(run: Callable[[float], object], digits: float) -> float:
    """Time of a run to some digits; infinite where they cannot be had."""
    try:
        return timed(lambda: run(10.0**-digits), first=True).seconds
    except AccuracyError:
        return math.inf
