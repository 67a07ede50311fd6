"""Readings: numbers computed from the modes of a distortion, such as forces on lines."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from geomtorsion.materials.elasticity.cell import Cell
from geomtorsion.materials.elasticity.constants import ElasticConstants
from geomtorsion.materials.lines import LineArrays

# From a cell, numbers of waves and modes of the distortion, shape (modes, 3, 3).
Reading = Callable[[Cell, np.ndarray, np.ndarray], np.ndarray]


def mean_stresses(
    constants: ElasticConstants,
    load: np.ndarray,
    starts: np.ndarray,
    steps: np.ndarray,
    width: float,
) -> Reading:
    """Mean stress along pieces, spread by a Gaussian, with a load: shape (3, 3, pieces)."""

    def read(cell: Cell, waves: np.ndarray, modes: np.ndarray) -> np.ndarray:
        k2 = (cell.vectors(waves) ** 2).sum(axis=1)
        weights = cell.weights(waves) * np.exp(-k2 * width**2 / 2)
        stress = np.tensordot(modes, constants.tensor, ([1, 2], [2, 3]))
        weighted = weights[:, None] * stress.reshape(-1, 9)
        total = np.empty((len(starts), 9))
        for block, means in cell.pieces(starts, steps, waves):
            total[block] = (means.conj() @ weighted).real
        return total.reshape(-1, 3, 3).transpose(1, 2, 0) + load[..., None]

    return read


def forces(mean: Reading, lines: LineArrays, sign: int) -> Reading:
    """Forces (sigma b) x t on the pieces of lines, shape (pieces, 3).

    mean: the mean stress of each piece. sign: b of the crystal over b of the lines.
    """
    b = sign * lines.burgers
    # A piece without length has no sense, and no force.
    lengths = np.where(lines.lengths > 0, lines.lengths, 1.0)
    senses = lines.steps / lengths[:, None]

    def read(cell: Cell, waves: np.ndarray, modes: np.ndarray) -> np.ndarray:
        return np.cross(np.einsum("ijn,nj->ni", mean(cell, waves, modes), b), senses)

    return read
