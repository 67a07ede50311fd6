"""Squares: whole numbers of all square circuits of one size in an image, with their noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geomtorsion.images.circuits import expected_clicks


@dataclass(frozen=True, eq=False, repr=False)
class LatticeCircuits:
    """Burgers vectors of all square circuits of one size in a lattice image.

    size: pixels along a side. whole: in lattice vectors, whole numbers, whole[i, x, y] for the
        circuit whose lower left corner is pixel (x, y), run anticlockwise.
    clear: whether the circuit touches no hole, clear[x, y].
    chances: that noise has changed each number, chances[i, x, y]. risk: the largest accepted.
    lattice: the lattice vectors, rows, shape (2, 2), in `unit`. step: size of a pixel.
    """

    size: int
    whole: np.ndarray
    clear: np.ndarray
    chances: np.ndarray
    risk: float
    lattice: np.ndarray
    step: float
    unit: str

    @property
    def chance(self) -> np.ndarray:
        """That noise has changed one of the numbers of a circuit, chance[x, y]."""
        return np.minimum(self.chances.sum(axis=0), 1.0)

    @property
    def known(self) -> np.ndarray:
        """Where the numbers are to be trusted, known[x, y]."""
        return self.clear & (self.chance <= self.risk)

    @property
    def vectors(self) -> np.ndarray:
        """b along x and y, in `unit`, vectors[a, x, y]."""
        return np.einsum("ia,ixy->axy", self.lattice, self.whole)

    @property
    def area(self) -> float:
        """Of each circuit, unit squared."""
        return (self.size * self.step) ** 2

    def __repr__(self) -> str:
        return (
            f"LatticeCircuits({int(self.clear.sum())} of {self.clear.size} circuits of {self.size} "
            f"x {self.size} pixels touch no hole)"
        )


def squares_of(
    phase: np.ndarray, ratio: np.ndarray, holes: np.ndarray, blur: float, size: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Windings of phases round all squares, which touch no hole, and expected clicks of noise.

    phase, ratio: phase[i, x, y], and the amplitude in units of its noise. Sums from the first pixel
    of each line make any size as cheap as a pixel.
    """
    sides = [_along(phase, ratio, holes, blur, axis, size) for axis in (1, 2)]
    (whole, clicks, crossed), (up, more, met) = sides
    n = size
    # Right along the lower side, up the right one, back along the upper one, down the left one.
    wound = whole[:, :, :-n] + up[:, n:] - whole[:, :, n:] - up[:, :-n]
    total = clicks[:, :, :-n] + more[:, n:] + clicks[:, :, n:] + more[:, :-n]
    touched = crossed[:, :-n] + met[n:] + crossed[:, n:] + met[:-n]
    return wound, touched == 0, np.minimum(total, 1.0)


def _along(
    phase: np.ndarray, ratio: np.ndarray, holes: np.ndarray, blur: float, axis: int, size: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Along all sides of one direction: whole turns, expected clicks, pixels in holes."""
    steps = np.diff(phase, axis=axis)
    turns = np.rint(steps / (2 * np.pi)).astype(np.int64)
    clicks = expected_clicks(ratio, steps - 2 * np.pi * turns, blur, axis)
    spoilt = np.cumsum(np.insert(holes.astype(np.int64), 0, 0, axis - 1), axis=axis - 1)
    n, last = size, holes.shape[axis - 1]
    held = np.take(spoilt, range(n + 1, last + 1), axis - 1) - np.take(
        spoilt, range(last - n), axis - 1
    )
    return _runs(-turns, axis, n), _runs(clicks, axis, n), held


def _runs(steps: np.ndarray, axis: int, size: int) -> np.ndarray:
    """Sums over so many steps that follow each other."""
    sums = np.cumsum(np.insert(steps, 0, 0, axis), axis=axis)
    count = sums.shape[axis]
    return np.take(sums, range(size, count), axis) - np.take(sums, range(count - size), axis)
