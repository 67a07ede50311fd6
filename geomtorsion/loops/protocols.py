"""Protocols: what loops ask of frames that are known by numbers, whatever class they have."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

import numpy as np

from geomtorsion.loops.edges import EdgeIntegrals
from geomtorsion.loops.loop import Loop


@runtime_checkable
class HasBurgers(Protocol):
    """Measured data that close loops by themselves, such as a `SampledFrame`."""

    def burgers(self, circuit: Loop, /) -> object:
        """The Burgers vector of a loop, in the class of results of this source."""
        ...


class HasEdges(Protocol):
    """A frame known by numbers that integrates its coframe along straight edges."""

    @property
    def dimension(self) -> int:
        """Number of coordinates and of legs, n."""
        ...

    @property
    def names(self) -> Sequence[str]:
        """Names of the coordinates, for axes of pictures."""
        ...

    def along_edges(self, starts: np.ndarray, ends: np.ndarray) -> EdgeIntegrals:
        """The integral of the coframe along each edge; starts and ends have shape (m, n)."""
        ...
