"""Roundings: changes of a state on the way, as large as what roundings of steps add up to."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from geomtorsion.precision import GOLDEN

# A motion is changed in the middle of each of so many equal parts of the way.
PLACES = 16


@dataclass(frozen=True)
class Roundings:
    """Relative changes of a state on the way, at the first step after each of some places.

    part: of each component at each place; end: the last time; pattern: number of a pattern of
        signs.
    """

    part: float
    end: float
    pattern: int = 1

    def changes(self, begin: float, clock: int | None) -> Changes:
        """The changes from a time on; clock: index of a state that is the time and stays."""
        sign = math.copysign(1.0, self.end)
        first = PLACES * self.pattern
        places = [(sign * self.end * (k + 0.5) / PLACES, first + k) for k in range(PLACES)]
        left = [place for place in places if place[0] > sign * begin]
        return Changes(self.part, left, sign, clock)


class Changes:
    """Changes that one run has still to make.

    due: the time of the next, counted along the run; sign: 1 or -1, as its times rise or fall.
    """

    def __init__(
        self, part: float, left: list[tuple[float, int]], sign: float, clock: int | None
    ) -> None:
        self.sign: float = sign
        self.due: float = left[0][0] if left else math.inf
        self._part, self._left, self._clock = part, left, clock

    def in_units(self, unit: float) -> Changes:
        """The same for a run that counts time in a unit."""
        left = [(at / unit, number) for at, number in self._left]
        return Changes(self._part, left, self.sign, self._clock)

    def made(self, time: float, state: np.ndarray, start: np.ndarray) -> np.ndarray:
        """The state after a change that is due.

        A component that has not changed since the start has not been rounded: it stays.
        """
        number = 0
        while self._left and self._left[0][0] <= self.sign * time:
            _, number = self._left.pop(0)
        self.due = self._left[0][0] if self._left else math.inf
        parts = self._part * random_parts(number, len(state))
        parts[state == start] = 0.0
        if self._clock is not None:
            parts[self._clock] = 0.0
        kind = state.dtype.type
        return state + state * np.array([kind(x) for x in parts.tolist()], dtype=state.dtype)


@cache
def random_parts(number: int, size: int) -> np.ndarray:
    """One and the golden section in turn, with signs that look random: roundings add up as these.

    The same in each call. number: of the place on the way.

    Examples
    --------
    >>> np.sign(random_parts(0, 4)).tolist(), np.sign(random_parts(1, 4)).tolist()
    ([-1.0, -1.0, 1.0, 1.0], [1.0, 1.0, 1.0, -1.0])
    """
    parts = []
    for k in range(size):
        # Bits are mixed by the last steps of MurmurHash3.
        bits = (1 << 20 | number * 64 + k + 1) * 0x9E3779B9 & 0xFFFFFFFF
        bits = (bits ^ bits >> 16) * 0x85EBCA6B & 0xFFFFFFFF
        bits = (bits ^ bits >> 13) * 0xC2B2AE35 & 0xFFFFFFFF
        size_of_part = GOLDEN if k % 2 else 1.0
        parts.append(size_of_part if (bits ^ bits >> 16) & 1 else -size_of_part)
    return np.array(parts)
