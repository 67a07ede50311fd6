"""Roundings: changes of a state on the way, as large as what roundings of steps add up to."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from geomtorsion.support.precision import GOLDEN

# A motion is changed after each of so many equal numbers of steps: roundings are many where steps
# are short.
PLACES = 64


@dataclass(frozen=True)
class Roundings:
    """Relative changes of a state on the way, after equal numbers of steps.

    part: of each component at each place; steps: of the whole way, about; end: the last time;
        pattern: number of a pattern of signs.
    """

    part: float
    steps: int
    end: float
    pattern: int = 1

    def changes(self, begin: float, clock: int | None) -> Changes:
        """The changes from a time on; clock: index of a state that is the time and stays."""
        every = -(-self.steps // PLACES)
        passed = int(self.steps * abs(begin / self.end)) if self.end else 0
        return Changes(self.part, every, passed, self.pattern << 20, clock)


class Changes:
    """Changes that one run makes."""

    def __init__(self, part: float, every: int, passed: int, first: int, clock: int | None) -> None:
        self._part, self._every, self._steps = part, every, passed
        self._first, self._clock = first, clock

    def due(self) -> bool:
        """Count a step; whether the state is changed after it."""
        self._steps += 1
        return self._steps % self._every == 0

    def made(self, state: np.ndarray, start: np.ndarray) -> np.ndarray:
        """The changed state; a component that is as at the start has not been rounded: it stays."""
        number = self._first + self._steps // self._every
        parts = self._part * random_parts(number, len(state))
        parts[state == start] = 0.0
        if self._clock is not None:
            parts[self._clock] = 0.0
        kind = state.dtype.type
        return state + state * np.array([kind(x) for x in parts.tolist()], dtype=state.dtype)


@lru_cache(maxsize=1024)
def random_parts(number: int, size: int) -> np.ndarray:
    """One and the golden section in turn, with signs that look random: roundings add up as these.

    The same in each call. number: of the place on the way.

    Examples
    --------
    >>> np.sign(random_parts(0, 4)).tolist(), np.sign(random_parts(1, 4)).tolist()
    ([-1.0, 1.0, -1.0, 1.0], [1.0, -1.0, 1.0, -1.0])
    """
    parts = []
    for k in range(size):
        # Bits are mixed by the last steps of MurmurHash3.
        bits = (number * 64 + k + 1) * 0x9E3779B9 & 0xFFFFFFFF
        bits = (bits ^ bits >> 16) * 0x85EBCA6B & 0xFFFFFFFF
        bits = (bits ^ bits >> 13) * 0xC2B2AE35 & 0xFFFFFFFF
        size_of_part = GOLDEN if k % 2 else 1.0
        parts.append(size_of_part if (bits ^ bits >> 16) & 1 else -size_of_part)
    return np.array(parts)
