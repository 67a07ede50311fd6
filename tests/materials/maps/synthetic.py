"""Synthetic orientation maps with known answers."""

import numpy as np
from scipy.spatial.transform import Rotation

from geomtorsion.materials.maps import OrientationMap, Phase


def euler(rotations: Rotation, shape: tuple[int, int]) -> np.ndarray:
    """Bunge's angles in degrees of rotations from crystal to specimen."""
    with np.errstate(all="ignore"):
        return rotations.as_euler("ZXZ", degrees=True).reshape(*shape, 3)


def bunge(angles: np.ndarray) -> np.ndarray:
    """Bunge's matrix g, specimen to crystal, written out by hand; angles in degrees."""
    one, mid, two = np.moveaxis(np.radians(angles), -1, 0)
    zero, unit = np.zeros_like(one), np.ones_like(one)

    def table(*rows):
        return np.stack([np.stack(row, -1) for row in rows], -2)

    def about_z(a):
        return table(
            (np.cos(a), np.sin(a), zero), (-np.sin(a), np.cos(a), zero), (zero, zero, unit)
        )

    about_x = table(
        (unit, zero, zero), (zero, np.cos(mid), np.sin(mid)), (zero, -np.sin(mid), np.cos(mid))
    )
    return about_z(two) @ about_x @ about_z(one)


def wall(degrees: float, shape: tuple[int, int], step: float, **more) -> OrientationMap:
    """A symmetric tilt wall in the middle: the lattice turns about z from left to right."""
    angles = np.zeros((*shape, 3))
    middle = shape[1] // 2
    angles[:, :middle, 0], angles[:, middle:, 0] = -degrees / 2, degrees / 2
    return OrientationMap.from_euler(angles, step, "m-3m", **more)


def noisy_wall(degrees: float, shape: tuple[int, int], noise: float, seed: int) -> np.ndarray:
    """Angles of a wall with random rotations of each pixel, `noise` degrees about each axis."""
    rng = np.random.default_rng(seed)
    sign = np.where(np.arange(shape[1]) < shape[1] // 2, -1.0, 1.0) * degrees / 2
    turns = np.zeros((*shape, 3))
    turns[..., 2] = sign
    tilted = Rotation.from_rotvec(turns.reshape(-1, 3), degrees=True)
    shaken = Rotation.from_rotvec(
        rng.normal(0, noise, (tilted.as_quat().shape[0], 3)), degrees=True
    )
    return euler(shaken * tilted, shape)


def bent(shape: tuple[int, int], bending: float) -> np.ndarray:
    """Angles of a crystal whose lattice turns evenly along x and y, from a general orientation."""
    rows, columns = np.indices(shape)
    vectors = np.stack([0.3 * columns + 0.1 * rows, -0.2 * rows, columns - 0.5 * rows], -1)
    turns = Rotation.from_rotvec(bending * vectors.reshape(-1, 3), degrees=True)
    return euler(turns * Rotation.from_euler("ZXZ", [40, 35, 20], degrees=True), shape)


NICKEL = Phase("nickel", "m-3m", (3.52, 3.52, 3.52))
