"""Squares: Burgers vectors of all square circuits of one size in an orientation map."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from geomtorsion.materials.fields.circuits import unexplained
from geomtorsion.materials.maps.circuits import Circuit
from geomtorsion.materials.maps.lattice_edges import spread_of
from geomtorsion.materials.maps.step_grid import StepGrid
from geomtorsion.materials.survey import Errors, Survey, middles
from geomtorsion.rigid.attitude import matrix_from_quaternion

# Names of components of b in crystal axes.
COMPONENTS = ("b1", "b2", "b3")
Noise = Mapping[int, np.ndarray]


def survey_of_squares(
    grid: StepGrid, phase: np.ndarray, noise: Callable[[], Noise], n: int, unit: str
) -> Survey:
    """Survey of all squares of n x n cells; see OrientationMap.burgers_map.

    phase: number of the phase of each pixel. noise: covariance of orientations of each phase.
    """
    vectors, clean = grid.squares(n)
    clean &= phase[:-n, :-n] > 0
    vectors[~clean] = np.nan
    return Survey(
        vectors.transpose(2, 1, 0),
        middles((grid.steps[0] * grid.shift / 2, 0.0), grid.steps, clean.shape[::-1], (n, n)),
        n**2 * grid.steps[0] * grid.steps[1],
        (n, n),
        partial(_errors, grid, phase, noise, n, clean),
        ("x", "y"),
        components=COMPONENTS,
        unit=unit,
        vector_unit=unit,
        missing="cross a boundary of grains or a pixel that is not indexed",
        down=True,
        directed=partial(_in_specimen, grid, n, vectors),
    )


def _turns(grid: StepGrid, n: int) -> np.ndarray:
    """Rotations from crystal to specimen at the first pixel of squares, (rows, columns, 3, 3)."""
    return matrix_from_quaternion(grid.grains.quaternions[:-n, :-n])


def _in_specimen(grid: StepGrid, n: int, vectors: np.ndarray) -> np.ndarray:
    """b along specimen axes, shape (3, x, y), from b along crystal axes, shape (y, x, 3)."""
    return np.einsum("yxij,yxj->ixy", _turns(grid, n), vectors)


def _errors(
    grid: StepGrid, phase: np.ndarray, noise: Callable[[], Noise], n: int, clean: np.ndarray
) -> Errors:
    """Errors of all squares; clean: which squares have a Burgers vector, shape (rows, columns)."""
    turns, bends = _turns(grid, n), np.linalg.norm(grid.square_bends(n), axis=-1)
    covariance, systematic = np.zeros((*clean.shape, 3, 3)), np.full(clean.shape, np.nan)
    # In hexagonal grids, circuits that begin in odd rows have other positions than in even rows.
    odd = (np.arange(len(clean)) % 2 == 1) & bool(grid.shift)
    for row, rows in ((0, ~odd), (1, odd)):
        if not rows.any():
            continue
        chain = grid.ascending(Circuit.square((row, 0), n))
        moments, bent = grid.moments(chain), grid.bent_moments(chain)
        for number, each in noise().items():
            mine = clean & (phase[:-n, :-n] == number) & rows[:, None]
            if mine.any():
                turn = turns[mine]
                covariance[mine] = turn.swapaxes(1, 2) @ spread_of(moments, each) @ turn
                variance = np.trace(spread_of(bent, each))
                systematic[mine] = unexplained(bends[mine], variance)
    table = covariance.transpose(2, 3, 1, 0)
    pairs = ((i, j) for i in range(3) for j in range(i, 3))
    return Errors({(i, j): table[i, j] for i, j in pairs}, systematic.T)
