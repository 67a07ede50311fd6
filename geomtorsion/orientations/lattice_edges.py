"""Lattice edges: grains of a map, one variant of symmetry for each, and steps between pixels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geomtorsion.loops.spanning_forest import spanning_forest
from geomtorsion.orientations.symmetry import LaueGroup, angle_of, conjugated
from geomtorsion.rigid.attitude import product


@dataclass(frozen=True, eq=False)
class GrainMap:
    """Grains, and orientations in variants that agree within each.

    grain: number of the grain of each pixel, -1 where nothing was indexed, shape (rows, columns);
        pixels belong together when steps below the threshold join them.
    quaternions: crystal to specimen, each in the variant that is nearest to that of the pixel
        before it on the spanning tree of its grain, shape (rows, columns, 4).
    right, down: whether the step to the next pixel in a row, or in a column, stays in one grain,
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
    joined = np.zeros(len(pairs), dtype=bool)
    for name, group in groups.items():
        mine = np.flatnonzero((phases[pairs] == name).all(axis=1))
        _, angles = group.nearest(q[pairs[mine, 0]], q[pairs[mine, 1]])
        joined[mine] = angles < threshold
    tree = pairs[joined]
    forest = spanning_forest(phase.size, tree, np.zeros((len(tree), 0), dtype=np.int64))
    chosen = q.copy()
    for name, group in groups.items():
        mine = np.flatnonzero(phases == name)
        variants = _along_trees(q, mine, forest.parent, forest.depth, group)
        chosen[mine] = product(q[mine], group.quaternions[variants])
    # Two ways from pixel to pixel may lead to two variants: no circuit uses such a step.
    agree = joined.copy()
    between = product(conjugated(chosen[tree[:, 0]]), chosen[tree[:, 1]])
    agree[joined] = angle_of(between) < threshold
    split = shape[0] * (shape[1] - 1)
    known = phases > 0
    grain = np.full(phase.size, -1)
    # Numbers of grains ascend with their first pixels.
    _, first, which = np.unique(forest.root[known], return_index=True, return_inverse=True)
    grain[known] = np.argsort(np.argsort(first))[which]
    return GrainMap(
        grain.reshape(shape),
        chosen.reshape(*shape, 4),
        agree[:split].reshape(shape[0], shape[1] - 1),
        agree[split:].reshape(shape[0] - 1, shape[1]),
    )


def _along_trees(
    q: np.ndarray, mine: np.ndarray, parent: np.ndarray, depth: np.ndarray, group: LaueGroup
) -> np.ndarray:
    """Number of the variant of each pixel of a phase: products of the steps from its root."""
    place = np.zeros(len(q), dtype=np.int64)
    place[mine] = np.arange(len(mine))
    is_root = parent[mine] < 0
    before = np.where(is_root, mine, parent[mine])
    variants, _ = group.nearest(q[before], q[mine])
    variants[is_root] = 0
    above = place[before]
    # Each round doubles the length of the way that is multiplied up.
    for _ in range(int(depth[mine].max(initial=0)).bit_length()):
        variants, above = group.products[variants, variants[above]], above[above]
    return variants
