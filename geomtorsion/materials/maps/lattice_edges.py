"""Lattice edges: grains of a map, steps between pixels, and noise of orientations."""

from __future__ import annotations

from dataclasses import dataclass
from math import comb

import numpy as np

from geomtorsion.errors import OrientationError
from geomtorsion.loops import spanning_forest
from geomtorsion.materials.fields.noise import SMOOTH, robust_covariance
from geomtorsion.materials.maps.symmetry import LaueGroup, angle_of, conjugated
from geomtorsion.rigid.attitude import product
from geomtorsion.support import checks


@dataclass(frozen=True, eq=False, repr=False)
class GrainMap:
    """Grains, and orientations in variants that agree within each grain.

    grain: number of the grain of each pixel, -1 where nothing was indexed, shape (rows, columns);
        a grain is a set of pixels connected by steps below the threshold.
    quaternions: crystal to specimen, each in the variant nearest to the previous pixel on the
        spanning tree of the grain, shape (rows, columns, 4).
    right, down: whether the step to the next pixel in a row, or in a column, stays in one grain and
        below the threshold, shapes (rows, columns - 1) and (rows - 1, columns).
    """

    grain: np.ndarray
    quaternions: np.ndarray
    right: np.ndarray
    down: np.ndarray

    @property
    def count(self) -> int:
        """Number of grains."""
        return int(self.grain.max(initial=-1)) + 1

    def __repr__(self) -> str:
        grains = self.grain[self.grain >= 0]
        largest = int(np.bincount(grains).max()) if len(grains) else 0
        return (
            f"GrainMap({self.count:,} grains in {len(grains):,} of {self.grain.size:,} pixels, the "
            f"largest of {largest:,})"
        )


def grains_of(
    quaternions: np.ndarray,
    phase: np.ndarray,
    groups: dict[int, LaueGroup],
    threshold: float,
) -> GrainMap:
    """Join neighbours that differ by less than the threshold (rad), and choose their variants."""
    shape = phase.shape
    q, phases = quaternions.reshape(-1, 4), phase.ravel()
    number = np.arange(phase.size).reshape(shape)
    pairs = np.concatenate(
        [
            np.stack([number[:, :-1].ravel(), number[:, 1:].ravel()], axis=1),
            np.stack([number[:-1].ravel(), number[1:].ravel()], axis=1),
        ]
    )
    same_grain = np.zeros(len(pairs), dtype=bool)
    for name, group in groups.items():
        mine = np.flatnonzero((phases[pairs] == name).all(axis=1))
        _, angles = group.nearest(q[pairs[mine, 0]], q[pairs[mine, 1]])
        same_grain[mine] = angles < threshold
    tree = pairs[same_grain]
    forest = spanning_forest(phase.size, tree, np.zeros((len(tree), 0), dtype=np.int64))
    chosen = q.copy()
    for name, group in groups.items():
        mine = np.flatnonzero(phases == name)
        variants = _along_trees(q, mine, forest.parent, forest.depth, group)
        chosen[mine] = product(q[mine], group.quaternions[variants])
    # Two paths to a pixel may give two variants. Circuits do not use a step between such variants.
    agree = same_grain.copy()
    between = product(conjugated(chosen[tree[:, 0]]), chosen[tree[:, 1]])
    agree[same_grain] = angle_of(between) < threshold
    split = shape[0] * (shape[1] - 1)
    indexed = phases > 0
    grain = np.full(phase.size, -1)
    # Grains are numbered in the order of their first pixels.
    _, first, which = np.unique(forest.root[indexed], return_index=True, return_inverse=True)
    grain[indexed] = np.argsort(np.argsort(first))[which]
    return GrainMap(
        grain.reshape(shape),
        chosen.reshape(*shape, 4),
        agree[:split].reshape(shape[0], shape[1] - 1),
        agree[split:].reshape(shape[0] - 1, shape[1]),
    )


def _along_trees(
    q: np.ndarray, mine: np.ndarray, parent: np.ndarray, depth: np.ndarray, group: LaueGroup
) -> np.ndarray:
    """Variant of each pixel of a phase: the product of the steps from the root of its tree."""
    place = np.zeros(len(q), dtype=np.int64)
    place[mine] = np.arange(len(mine))
    is_root = parent[mine] < 0
    before = np.where(is_root, mine, parent[mine])
    variants, _ = group.nearest(q[before], q[mine])
    variants[is_root] = 0
    above = place[before]
    # Each pass doubles the length of the path whose product is known.
    for _ in range(int(depth[mine].max(initial=0)).bit_length()):
        variants, above = group.products[variants, variants[above]], above[above]
    return variants


def given_covariance(sigma: object) -> np.ndarray:
    """Covariance of rotations, rad^2, from standard deviations in degrees, one or three."""
    if np.ndim(np.asarray(sigma, dtype=object)) == 0:
        three: list[object] = [sigma] * 3
    else:
        three = list(checks.numbers(sigma, 3, "sigma", OrientationError))
    kind = "standard deviations of 0 or more"
    remedy = "Give degrees, or None to have sigma estimated."
    sizes = [
        checks.not_negative(x, "sigma", OrientationError, expected=kind, remedy=remedy)
        for x in three
    ]
    checks.measured(max(sizes), "sigma", OrientationError)
    return np.diag(np.radians(sizes) ** 2)


def estimated_covariance(grains: GrainMap, chosen: np.ndarray) -> np.ndarray:
    """Covariance of the noise of each orientation as a small rotation in map axes, rad^2, (3, 3).

    The estimate uses differences of sixth order along rows and columns within grains, and medians,
    which are insensitive to walls and cores. It assumes that pixels are independent.

    chosen: which pixels to use, truth values, shape (rows, columns).
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
            f"sigma: expected {SMOOTH + 1} adjacent pixels within a grain to estimate noise, got "
            "fewer everywhere. Give sigma in degrees."
        )
    return robust_covariance(list(differences.T))


def _differences(q: np.ndarray, joined: np.ndarray) -> np.ndarray:
    """Differences along rows as rotations in map axes, scaled to the noise of a pixel, (k, 3)."""
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
        quaternion = q[row, column + k]
        # q and -q are the same rotation.
        sign = np.where((quaternion * middle).sum(axis=1) < 0, -1.0, 1.0)
        total += (weight * sign)[:, None] * quaternion
    turns = 2 * product(total, conjugated(middle))[:, 1:]
    return turns / np.sqrt(sum(weight**2 for weight in weights))


def spread_of(moments: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Covariance of a sum of w_k x t_k, w_k independent with equal covariance, (3, 3).

    moments: t_k, shape (k, 3).
    """
    across = np.zeros((len(moments), 3, 3))
    x, y, z = moments.T
    across[:, 0, 1], across[:, 0, 2], across[:, 1, 2] = -z, y, -x
    across[:, 1, 0], across[:, 2, 0], across[:, 2, 1] = z, -y, x
    return np.einsum("kij,jl,kml->im", across, covariance, across)


def spread_of_sums(squares: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """`spread_of` for weights in the plane of a map, from their sums of squares, (k, 3, 3).

    squares: sums of t_x t_x, t_y t_y and t_x t_y, shape (k, 3).
    """
    units = np.zeros((2, 3, 3))
    units[0, 1, 2], units[0, 2, 1] = -1.0, 1.0
    units[1, 0, 2], units[1, 2, 0] = 1.0, -1.0
    (xx, xy), (yx, yy) = ([units[i] @ covariance @ units[j].T for j in (0, 1)] for i in (0, 1))
    return np.einsum("ks,sij->kij", squares, np.stack([xx, yy, xy + yx]))
