"""Noise: how much measured orientations scatter, given or estimated from the map itself."""

from __future__ import annotations

from math import comb

import numpy as np

from geomtorsion import checks
from geomtorsion.errors import OrientationError
from geomtorsion.loops.fields.noise import SMOOTH, robust_covariance
from geomtorsion.orientations.lattice_edges import GrainMap
from geomtorsion.orientations.symmetry import conjugated
from geomtorsion.rigid.attitude import product


def given_covariance(sigma: object) -> np.ndarray:
    """Covariance of rotations, rad^2, from standard deviations in degrees, one or three."""
    if np.ndim(np.asarray(sigma, dtype=object)) == 0:
        sizes = [checks.number(sigma, "sigma", OrientationError)] * 3
    else:
        sizes = [float(x) for x in checks.numbers(sigma, 3, "sigma", OrientationError)]
    if min(sizes) < 0:
        raise OrientationError(
            f"sigma: standard deviations of 0 or more were needed, but {min(sizes):g} came. Give "
            "degrees, or None to have it estimated."
        )
    return np.diag(np.radians(sizes) ** 2)


def estimated_covariance(grains: GrainMap, chosen: np.ndarray) -> np.ndarray:
    """Covariance of the noise of each orientation as a small rotation in map axes, rad^2, (3, 3).

    Differences of sixth order along rows and columns within grains, and medians, so that walls and
    cores do not count. Pixels are taken to be independent.

    chosen: the pixels that count, truth values, shape (rows, columns).
    """
    right = grains.right & chosen[:, 1:] & chosen[:, :-1]
    down = grains.down & chosen[1:] & chosen[:-1]
    differences = np.concatenate(
        [
            _differences(grains.quaternions, right),
            _differences(grains.quaternions.swapaxes(0, 1), down.T),
        ]
    )
    if not len(differences):
        raise OrientationError(
            f"sigma: {SMOOTH + 1} pixels in a row within a grain are needed to estimate noise, but "
            "there are none. Give sigma in degrees."
        )
    return robust_covariance(list(differences.T))


def _differences(q: np.ndarray, joined: np.ndarray) -> np.ndarray:
    """Differences along rows as rotations in map axes, with the variance of one pixel, (k, 3)."""
    count = joined.shape[1] - SMOOTH + 1
    if count < 1:
        return np.zeros((0, 3))
    runs = np.ones((len(joined), count), dtype=bool)
    for k in range(SMOOTH):
        runs &= joined[:, k : k + count]
    row, column = np.nonzero(runs)
    middle = q[row, column + SMOOTH // 2]
    total = np.zeros_like(middle)
    weights = [(-1) ** k * comb(SMOOTH, k) for k in range(SMOOTH + 1)]
    for k, weight in enumerate(weights):
        one = q[row, column + k]
        # q and -q are the same turn.
        sign = np.where((one * middle).sum(axis=1) < 0, -1.0, 1.0)
        total += (weight * sign)[:, None] * one
    turns = 2 * product(total, conjugated(middle))[:, 1:]
    return turns / np.sqrt(sum(weight**2 for weight in weights))


def spread_of(moments: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Covariance of a sum of w_k x t_k, w_k independent with one covariance, (3, 3).

    moments: t_k, shape (k, 3).
    """
    across = np.zeros((len(moments), 3, 3))
    x, y, z = moments.T
    across[:, 0, 1], across[:, 0, 2], across[:, 1, 2] = -z, y, -x
    across[:, 1, 0], across[:, 2, 0], across[:, 2, 1] = z, -y, x
    return np.einsum("kij,jl,kml->im", across, covariance, across)
