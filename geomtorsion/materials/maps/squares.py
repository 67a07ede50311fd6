"""Squares: Burgers vectors of all square circuits of one size in an orientation map."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from geomtorsion.materials.detours import Passages
from geomtorsion.materials.fields.grid_circuits import unexplained
from geomtorsion.materials.maps.lattice_edges import spread_of, spread_of_sums
from geomtorsion.materials.maps.pixel_circuits import Circuit
from geomtorsion.materials.maps.step_grid import StepGrid
from geomtorsion.materials.survey import Errors, Survey, areas, middles
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
    vectors, clean, passages = grid.squares(n)
    vectors[:, ~clean] = np.nan
    cell = grid.steps[0] * grid.steps[1]
    return Survey(
        vectors,
        middles((grid.steps[0] * grid.shift / 2, 0.0), grid.steps, clean.shape, (n, n)),
        areas(cell, (n, n), passages),
        (n, n),
        partial(_errors, grid, noise, phase, passages, clean),
        ("x", "y"),
        components=COMPONENTS,
        unit=unit,
        vector_unit=unit,
        missing="cross a boundary of grains or pixels that are not indexed",
        down=True,
        directed=partial(_in_specimen, grid, n, vectors),
        passages=passages.count,
    )


def _corners(grid: StepGrid, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Row and column of a pixel of each square with an orientation, shape (x, y) each.

    It is the first corner of the square, or the next pixel along its sides.
    """
    grain = grid.grains.grain
    rows, columns = grain.shape
    row, column = np.mgrid[: rows - n, : columns - n]
    chosen = row.copy(), column.copy()
    open_ = grain[chosen] < 0
    for shift in [(0, k) for k in range(1, n + 1)] + [(k, 0) for k in range(1, n + 1)]:
        if not open_.any():
            break
        other = row + shift[0], column + shift[1]
        better = open_ & (grain[other] >= 0)
        for place, new in zip(chosen, other, strict=True):
            place[better] = new[better]
        open_ &= ~better
    return chosen[0].T, chosen[1].T


def _turns(grid: StepGrid, n: int) -> np.ndarray:
    """Rotations from crystal to specimen at a corner of squares, shape (x, y, 3, 3)."""
    return matrix_from_quaternion(grid.grains.quaternions[_corners(grid, n)])


def _in_specimen(grid: StepGrid, n: int, vectors: np.ndarray) -> np.ndarray:
    """b along specimen axes from b along crystal axes, shape (3, x, y) each."""
    return np.einsum("xyij,jxy->ixy", _turns(grid, n), vectors)


def _errors(
    grid: StepGrid,
    noise: Callable[[], Noise],
    phase: np.ndarray,
    passages: Passages,
    clean: np.ndarray,
) -> Errors:
    """Errors of all squares; clean: which squares have a Burgers vector, shape (x, y)."""
    n = passages.windows.size[0]
    turns, bends = _turns(grid, n), np.linalg.norm(grid.square_bends(passages), axis=0)
    covariance, systematic = np.zeros((*clean.shape, 3, 3)), np.full(clean.shape, np.nan)
    phases = phase[_corners(grid, n)]
    # Each ring around pixels without orientation adds at most its noise.
    added = passages.around(grid.ring_weights)
    # In hexagonal grids, circuits that begin in odd rows have other positions than in even rows.
    odd = (np.arange(clean.shape[1]) % 2 == 1) & bool(grid.shift)
    for row, rows in ((0, ~odd), (1, odd)):
        if not rows.any():
            continue
        chain = grid.ascending(Circuit.square((row, 0), n))
        moments, bent = grid.moments(chain), grid.bent_moments(chain)
        for number, each in noise().items():
            mine = clean & (phases == number) & rows
            if mine.any():
                turn = turns[mine]
                spread = spread_of(moments, each) + spread_of_sums(added[:, mine].T, each)
                covariance[mine] = turn.swapaxes(1, 2) @ spread @ turn
                variance = np.trace(spread_of(bent, each))
                around = passages.around(grid.ring_errors(each)[None])[0]
                systematic[mine] = unexplained(bends[mine], variance) + around[mine]
    table = covariance.transpose(2, 3, 0, 1)
    pairs = ((i, j) for i in range(3) for j in range(i, 3))
    return Errors({(i, j): table[i, j] for i, j in pairs}, systematic)
