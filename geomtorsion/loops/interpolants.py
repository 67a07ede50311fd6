"""Interpolants: a coframe that is a polynomial in each cell of a grid, and a loop through it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from geomtorsion.loops.loop import Loop


class CellBlock(Protocol):
    """Nodes through which the polynomials of some points run.

    first: the first node along each axis, shape (d, k); used: how many along each axis, shape (k,).
    thin: whether only the first node is used along an axis, shape (d, k).
    """

    @property
    def first(self) -> np.ndarray:
        """The first node along each axis, shape (d, k)."""
        ...

    @property
    def used(self) -> np.ndarray:
        """How many nodes along each axis, shape (k,)."""
        ...

    @property
    def thin(self) -> np.ndarray:
        """Whether only the first node is used along an axis, shape (d, k)."""
        ...


class CellBlocks(Protocol):
    """Blocks of nodes of a grid, of its type of interpolation."""

    def blocks(self, places: np.ndarray, order: int) -> CellBlock:
        """The block of each point; places in units of the spacing, shape (d, k)."""
        ...


@dataclass(frozen=True, eq=False)
class Interpolant:
    """A coframe on a grid, a polynomial in each cell, and a loop along which it was integrated.

    loop: in coordinates of the grid.
    origin, steps: the first node and the spacing along each axis, as floats, which are exact.
    periodic: whether the first node of an axis follows the last.
    values: e^i_mu at the nodes, shape (rows, d, N_1, ..., N_d).
    known: selects the nodes through which the polynomial of a cell runs.
    order: number of these nodes along each axis, where all of them are known.
    """

    loop: Loop
    origin: tuple[float, ...]
    steps: tuple[float, ...]
    periodic: tuple[bool, ...]
    values: np.ndarray
    known: CellBlocks
    order: int


@runtime_checkable
class HasInterpolant(Protocol):
    """A Burgers vector of data."""

    @property
    def vector(self) -> np.ndarray:
        """b^i, shape (n,)."""
        ...

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the entries of `vector`."""
        ...

    @property
    def systematic(self) -> Mapping[str, float]:
        """Name of each error other than noise -> bound."""
        ...

    @property
    def interpolant(self) -> Interpolant | None:
        """The polynomials that it integrates; None for a source without them."""
        ...
