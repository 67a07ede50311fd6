"""Roundings: changes of a state on the way, as large as what roundings of steps add up to."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np

from geomtorsion.support.caching import read_only
from geomtorsion.support.precision import GOLDEN

# Number of changes of a motion, after equal numbers of steps, because roundings are many where
# steps are short.
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
    """Changes that one run makes.

    left: steps to the next change. Who calls `made` when it is 0 counts it down after each step, by
        `due` or, where calls are many, by hand.
    """

    def __init__(self, part: float, every: int, passed: int, first: int, clock: int | None) -> None:
        self._part, self._every, self._first, self._clock = part, every, first, clock
        self._place = passed // every
        while self._step(self._place) < passed:
            self._place += 1
        self.left: int = self._step(self._place) - passed + 1
        self._next: list[tuple[int, np.ndarray]] = []
        self._moved = False

    def _step(self, place: int) -> int:
        """Steps before a change: unequally many, as equal ones might fit into turns of a motion."""
        return int(self._every * (place + place * GOLDEN % 1.0))

    def due(self) -> bool:
        """Count a step; whether the state is changed after it."""
        self.left -= 1
        return not self.left

    def made(self, state: np.ndarray, start: np.ndarray) -> np.ndarray:
        """The changed state; a component that is as at the start has not been rounded: it stays."""
        if not self._next:
            self._next = self._block(state)
        self.left, parts = self._next.pop()
        change = parts * state
        if not self._moved:
            # Later each component has been rounded, even one that comes back.
            same = state == start
            self._moved = not same.any()
            change[same] = 0.0
        change += state
        return change

    def _block(self, state: np.ndarray) -> list[tuple[int, np.ndarray]]:
        """Steps to the next change and relative changes now, the last place of a block first."""
        place = (self._place + 1) % PLACES
        first = self._place + 1 - place
        steps = [self._step(k) for k in range(self._place, first + PLACES)]
        self._place = first + PLACES - 1
        parts = self._part * random_parts(self._first + first, len(state))
        if self._clock is not None:
            parts[:, self._clock] = 0.0
        if state.dtype != parts.dtype:
            kind = state.dtype.type
            rows = [[kind(x) for x in row] for row in parts.tolist()]
            parts = np.array(rows, dtype=state.dtype)
        waits = [after - before for before, after in pairwise(steps)]
        return list(zip(waits, parts[place:], strict=True))[::-1]


@lru_cache(maxsize=64)
def random_parts(first: int, size: int) -> np.ndarray:
    """Parts of changes: 1 and the golden section in turn, with pseudo-random signs.

    They add up as roundings do. There is a row of `size` parts for each of PLACES places on the
    way, equal in each call. first: number of the first row.

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
