"""Squares: windings of phases round all square circuits of one size, by sums along lines."""

from __future__ import annotations

import numpy as np

from geomtorsion.materials.images.circuits import expected_clicks


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
