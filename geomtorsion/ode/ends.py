"""Ends: where and when conditions have stopped the members of a batch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Ends:
    """The stop of each member; arrays that are filled while the members run.

    stops: shape (number,), which of the conditions of the system, from 0 on; -1 without a stop.
    times: shape (number,), of the stop; NaN without a stop.
    states: shape (number, size), at the stop; NaN without a stop.
    """

    stops: np.ndarray
    times: np.ndarray
    states: np.ndarray

    @classmethod
    def none(cls, number: int, size: int) -> Ends:
        """No member has been stopped.

        Examples
        --------
        >>> Ends.none(2, 1).stopped.tolist()
        [False, False]
        """
        stops = np.full(number, -1)
        return cls(stops, np.full(number, np.nan), np.full((number, size), np.nan))

    @property
    def stopped(self) -> np.ndarray:
        """Which members have been stopped, shape (number,)."""
        return self.stops >= 0

    def of(self, index: np.ndarray | slice) -> Ends:
        """Some of the members."""
        return Ends(self.stops[index], self.times[index], self.states[index])

    def put(self, index: np.ndarray | slice, other: Ends) -> None:
        """Fill in the ends of some members."""
        self.stops[index] = other.stops
        self.times[index] = other.times
        self.states[index] = other.states
