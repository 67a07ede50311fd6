"""Protocols: what loops ask of frames that are known by numbers, whatever class they have."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, TypeVar, runtime_checkable

import numpy as np

from geomtorsion.loops.edges import EdgeIntegrals
from geomtorsion.loops.loop import Loop

Result_co = TypeVar("Result_co", covariant=True)


@runtime_checkable
class HasBurgers(Protocol[Result_co]):
    """A frame known by numbers that closes loops by itself, such as a `SampledFrame`."""

    def burgers(self, circuit: Loop, /) -> Result_co:
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
