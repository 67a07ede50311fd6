"""Squares: windings of phases around all square circuits of one size, by sums along lines."""

from __future__ import annotations

import numpy as np

from geomtorsion.materials.images.circuits import expected_clicks


def squares_of(
    phase: np.ndarray, ratio: np.ndarray, holes: np.ndarray, blur: float, size: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Windings of phases around all squares, whether they avoid holes, and expected clicks.

    The cost does not depend on the size, because sums along lines are shared. phase: phase[i, x,
    y]. ratio: the amplitude in units of its noise.
    """
    sides = [_along(phase, ratio, holes, blur, axis, size) for axis in (1, 2)]
    (whole, clicks, crossed), (up, more, met) = sides
    n = size
    # Along the lower side to the right, up the right side, back along the upper, down the left.
    wound = whole[:, :, :-n] + up[:, n:] - whole[:, :, n:] - up[:, :-n]
    total = clicks[:, :, :-n] + more[:, n:] + clicks[:, :, n:] + more[:, :-n]
    touched = crossed[:, :-n] + met[n:] + crossed[:, n:] + met[:-n]
    return wound, touched == 0, np.minimum(total, 1.0)


def _along(
    phase: np.ndarray, ratio: np.ndarray, holes: np.ndarray, blur: float, axis: int, size: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Whole turns, expected clicks and pixels in holes along all sides in one direction."""
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
    """Sums over `size` consecutive steps."""
    sums = np.cumsum(np.insert(steps, 0, 0, axis), axis=axis)
    count = sums.shape[axis]
    return np.take(sums, range(size, count), axis) - np.take(sums, range(count - size), axis)
