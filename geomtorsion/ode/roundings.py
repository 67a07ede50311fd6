"""Roundings: changes of a state on the way, as large as what roundings of steps add up to."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from geomtorsion.support.caching import read_only
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
        self._block, self._parts = -1, np.empty((0, 0))
        self._moved = False

    def due(self) -> bool:
        """Count a step; whether the state is changed after it."""
        self._steps += 1
        return self._steps % self._every == 0

    def made(self, state: np.ndarray, start: np.ndarray) -> np.ndarray:
        """The changed state; a component that is as at the start has not been rounded: it stays."""
        block, place = divmod(self._steps // self._every, PLACES)
        if block != self._block:
            numbers = random_parts(self._first + block * PLACES, len(state))
            self._block, self._parts = block, self._part * numbers
            if self._clock is not None:
                self._parts[:, self._clock] = 0.0
        parts = self._parts[place]
        if state.dtype != parts.dtype:
            kind = state.dtype.type
            parts = np.array([kind(x) for x in parts.tolist()], dtype=state.dtype)
        change = parts * state
        if not self._moved:
            # Later each component has been rounded, even one that comes back.
            same = state == start
            self._moved = not same.any()
            change[same] = 0.0
        return state + change


@lru_cache(maxsize=64)
def random_parts(first: int, size: int) -> np.ndarray:
    """One and the golden section in turn, with signs that look random: roundings add up as these.

    Rows of so many for PLACES places on the way, the same in each call. first: number of the first.

    Examples
    --------
    >>> parts = random_parts(0, 4)
    >>> parts.shape, np.sign(parts[:2]).tolist()
    ((64, 4), [[-1.0, 1.0, -1.0, 1.0], [1.0, -1.0, 1.0, -1.0]])
    """
    numbers = np.arange(first, first + PLACES, dtype=np.uint64)[:, None]
    columns = np.arange(1, size + 1, dtype=np.uint64)
    # Bits are mixed by the last steps of MurmurHash3.
    low, wide = np.uint64(0xFFFFFFFF), np.uint64(64)
    bits = (numbers * wide + columns) * np.uint64(0x9E3779B9) & low
    for shift, factor in ((16, 0x85EBCA6B), (13, 0xC2B2AE35)):
        bits = (bits ^ bits >> np.uint64(shift)) * np.uint64(factor) & low
    is_positive = (bits ^ bits >> np.uint64(16)) & np.uint64(1) == 1
    sizes = np.where(columns % 2 == 1, 1.0, GOLDEN)
    return read_only(np.where(is_positive, sizes, -sizes))
