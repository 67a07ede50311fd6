"""Windows: sums over the sides of all rectangular circuits of one size on a grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Windows:
    """All rectangular circuits of a size in a plane of a grid, as sums over their four sides.

    plane: two axes of the grid. size: cells along both. periodic: of each axis of the grid.
    sense: 1 if circuits turn from the first axis of the plane to the second, -1 otherwise.
    Arrays have the axes of the grid last.
    """

    plane: tuple[int, int]
    size: tuple[int, int]
    periodic: tuple[bool, ...]
    sense: int = 1

    def places(self, shape: Sequence[int]) -> tuple[int, ...]:
        """Number of circuits along each axis of a grid with this number of nodes."""
        counts = list(shape)
        for k, n in zip(self.plane, self.size, strict=True):
            counts[k] -= 0 if self.periodic[k] else n
        return tuple(counts)

    def along(self, one: np.ndarray, two: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Sums along all sides, from values of edges along the first and along the second axis."""
        d = len(self.periodic)
        first, second = (
            window_sums(values, n, values.ndim - d + k, self.periodic[k])
            for values, k, n in zip((one, two), self.plane, self.size, strict=True)
        )
        return first, second

    def four(self, one: np.ndarray, two: np.ndarray) -> tuple[np.ndarray, ...]:
        """Values on the near and the far side of each circuit, along the first and second axis.

        one, two: values of all sides along the first and along the second axis, (..., sides).
        """
        d, (a, b), periodic = len(self.periodic), self.plane, self.periodic
        near_a, far_a = _pair(one, b - d, self.size[1], periodic[b])
        near_b, far_b = _pair(two, a - d, self.size[0], periodic[a])
        return near_a, far_a, near_b, far_b

    def rounds(self, one: np.ndarray, two: np.ndarray) -> np.ndarray:
        """Sums around circuits."""
        near_a, far_a, near_b, far_b = self.four(one, two)
        total = far_b - near_b
        total = total - far_a
        total += near_a
        return total if self.sense > 0 else -total

    def sums(self, one: np.ndarray, two: np.ndarray) -> np.ndarray:
        """Sums over the four sides, without signs."""
        near_a, far_a, near_b, far_b = self.four(one, two)
        return near_a + far_a + near_b + far_b


def window_sums(values: np.ndarray, count: int, axis: int, periodic: bool = False) -> np.ndarray:
    """Sums of `count` neighbours along an axis, by doubling, with bits independent of the start."""
    moved = np.moveaxis(values, axis, -1)
    if periodic:
        moved = np.concatenate([moved, moved[..., : count - 1]], axis=-1)
    room = moved.shape[-1] - count + 1
    block, width, first = moved, 1, 0
    total: np.ndarray | None = None
    while True:
        if count & width:
            here = block[..., first : first + room]
            total = here if total is None else total + here
            first += width
        if total is not None and 2 * width > count:
            return np.moveaxis(total, -1, axis)
        block = block[..., :-width] + block[..., width:]
        width *= 2


def _pair(values: np.ndarray, axis: int, apart: int, periodic: bool) -> tuple[np.ndarray, ...]:
    """Values on the near sides of circuits, and on the far sides, `apart` nodes further."""
    if values.shape[axis] == 1:
        # One value represents all positions.
        return values, values
    if periodic:
        return values, np.roll(values, -apart, axis)
    count = values.shape[axis] - apart
    index = [slice(None)] * values.ndim
    index[axis] = slice(None, count)
    near = values[tuple(index)]
    index[axis] = slice(apart, None)
    return near, values[tuple(index)]
