"""Displacement: distortions from displacements, which jump by lattice vectors across cuts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.errors import GridError
from geomtorsion.loops.fields.grid import Grid, numbers
from geomtorsion.loops.fields.sides import on_grid
from geomtorsion.loops.fields.stencils import applied

if TYPE_CHECKING:
    from scipy.sparse import csr_array

# An edge compares itself with the median of so many neighbours: two on each side.
NEIGHBOURS = 5


@dataclass(frozen=True, eq=False)
class Distortion:
    """What a displacement has become.

    values: d_mu u^i, shape (rows, d, grid...), NaN where it is not known.
    origins: matrices that take a displacement to its derivative along each axis.
    jumps: the vectors by which it jumps, shape (k, rows); edges: how many jump by each.
    """

    values: np.ndarray
    origins: tuple[csr_array, ...]
    jumps: np.ndarray
    edges: tuple[int, ...]

    @property
    def said(self) -> str:
        """What was found, in words."""
        pairs = zip(self.jumps.tolist(), self.edges, strict=True)
        found = [f"({', '.join(f'{x:.6g}' for x in b)}) on {n} edges" for b, n in pairs]
        return f"a displacement; jumps: {', '.join(found) or 'none'}"


def distortion_of(displacement: np.ndarray, grid: Grid, order: int, branch: object) -> Distortion:
    """The derivatives of a displacement, without its jumps.

    Cells round which the jumps do not close hold a core, or a difference that noise has spoilt:
    their corners become holes.

    branch: the lattice vectors by which it may jump, shape (k, rows), or one length for all
    directions; None: they are looked for.
    """
    steps = [_differences(displacement, 1 + k, grid.periodic[k]) for k in range(grid.dimension)]
    # Smooth fields may change by more than a lattice vector from node to node: jumps are what
    # stands out from the neighbours along the line.
    bent = [step - _medians(step, 1 + k) for k, step in enumerate(steps)]
    if branch is None:
        vectors = _found(steps, bent, grid)
        times = [_nearest(rest, vectors) for rest in bent]
    else:
        vectors = lattice_vectors(branch, len(displacement))
        inverse = np.linalg.pinv(vectors.T)
        times = [np.rint(np.einsum("ki,i...->k...", inverse, rest)) for rest in bent]
        times = [np.nan_to_num(number) for number in times]
    counts = sum(np.count_nonzero(x, axis=tuple(range(1, x.ndim))) for x in times)
    steps = [
        step - np.einsum("ki,k...->i...", vectors, number)
        for step, number in zip(steps, times, strict=True)
    ]
    holes = grid.holes.copy()
    for _, corners in _open_cells(times, grid):
        holes[tuple(corners.T)] = True
    whole = Grid(grid.axes, grid.names, grid.periodic, holes)
    return _derived(steps, whole, order, vectors, np.asarray(counts))


def _open_cells(times: list[np.ndarray], grid: Grid) -> Iterator[tuple[int, np.ndarray]]:
    """In each plane how many cells there are round which jumps do not close, and their corners.

    Cells with unknown corners do not count.
    """
    for a, b in combinations(range(grid.dimension), 2):
        wraps = grid.periodic
        one = _differences(times[b], 1 + a, wraps[a])
        two = _differences(times[a], 1 + b, wraps[b])
        cells = np.argwhere((one != two).any(axis=0))
        corners = np.repeat(cells[None], 4, axis=0)
        corners[1::2, :, a] += 1
        corners[2:, :, b] += 1
        corners %= np.array(grid.shape)
        known = ~grid.holes[tuple(np.moveaxis(corners, -1, 0))].any(axis=0)
        yield int(known.sum()), corners[:, known].reshape(-1, grid.dimension)


def _derived(
    steps: list[np.ndarray], grid: Grid, order: int, vectors: np.ndarray, counts: np.ndarray
) -> Distortion:
    """Derivatives at the nodes from differences along the edges."""
    values = np.empty((len(steps[0]), grid.dimension, *grid.shape))
    origins = []
    for k, step in enumerate(steps):
        rule = grid.rule(order, k, slopes=True)
        lines = rule.holes.shape[1]
        found = applied(rule.matrix_of_steps, np.nan_to_num(step), 1 + k, lines) / grid.steps[k]
        found[:, ~on_grid(rule.known, grid.shape, k)] = np.nan
        values[:, k] = found
        origins.append(rule.matrix / grid.steps[k])
    return Distortion(values, tuple(origins), vectors, tuple(counts.tolist()))


def _differences(values: np.ndarray, axis: int, periodic: bool) -> np.ndarray:
    """From each node to the next one."""
    return np.roll(values, -1, axis) - values if periodic else np.diff(values, axis=axis)


def _window(steps: np.ndarray, axis: int) -> np.ndarray:
    """Each step with its neighbours on the line, (5, rows, ..., line); NaN beyond the end."""
    moved = np.moveaxis(steps, axis, -1)
    wide = NEIGHBOURS // 2
    padded = np.pad(moved, [(0, 0)] * (moved.ndim - 1) + [(wide, wide)], constant_values=np.nan)
    return np.stack([padded[..., k : k + moved.shape[-1]] for k in range(NEIGHBOURS)])


def _medians(steps: np.ndarray, axis: int) -> np.ndarray:
    """The median of each step and its known neighbours along the line."""
    rows = _window(steps, axis)
    # Unknown ones sort to the end.
    rows.sort(axis=0)
    known = np.isfinite(rows).sum(axis=0)
    pair = (np.maximum(known - 1, 0) // 2, np.minimum(known // 2, NEIGHBOURS - 1))
    low, high = (np.take_along_axis(rows, k[None], axis=0)[0] for k in pair)
    return np.moveaxis((low + high) / 2, -1, axis)


def lattice_vectors(branch: object, rows: int) -> np.ndarray:
    """Lattice vectors as rows, from one length, one vector or several."""
    found = numbers(branch, "branch")
    if found.ndim == 0:
        found = float(found) * np.eye(rows)
    elif found.ndim == 1:
        found = found[None]
    fits = found.ndim == 2 and found.shape[1] == rows and 0 < len(found) <= rows
    if not fits or not np.isfinite(found).all() or np.linalg.matrix_rank(found) < len(found):
        raise GridError(
            f"branch: a length, or up to {rows} independent vectors of {rows} components, were "
            f"needed, but {found.tolist()} came. Give the lattice vectors by which u jumps."
        )
    return found


def _found(steps: list[np.ndarray], bent: list[np.ndarray], grid: Grid) -> np.ndarray:
    """The vectors by which steps stand out from their neighbours, the largest first.

    A step may be a jump if it stands out more than each of its neighbours does. A vector counts if
    the jumps by it (within a quarter of it) make lines: fewer cells are left open than there are
    jumps. What is less than half of something that does not count is not asked.
    """
    away = [np.sqrt((x**2).sum(axis=0)) for x in bent]
    open_ = [
        np.isfinite(size) & (size > _of_neighbours(step, 1 + k))
        for k, (step, size) in enumerate(zip(steps, away, strict=True))
    ]
    sharp = [_without_cubic(step, 1 + k) for k, step in enumerate(steps)]
    vectors: list[np.ndarray] = []
    least = 0.0
    while any(x.any() for x in open_):
        k = int(np.argmax([np.where(o, x, 0).max() for o, x in zip(open_, away, strict=True)]))
        place = np.unravel_index(np.where(open_[k], away[k], 0).argmax(), away[k].shape)
        seed = bent[k][(slice(None), *place)]
        if away[k][place] <= least:
            break
        times = [_near(rest, seed) * o for rest, o in zip(bent, open_, strict=True)]
        left_open = sum(count for count, _ in _open_cells([x[None] for x in times], grid))
        if left_open < sum(np.count_nonzero(x) for x in times):
            jumps = [(x * s)[:, x != 0] for x, s in zip(times, sharp, strict=True)]
            vectors.append(np.nanmedian(np.concatenate(jumps, axis=1), axis=1))
        else:
            least = max(least, float(away[k][place]) / 2)
        open_ = [o & (x == 0) for o, x in zip(open_, times, strict=True)]
    return np.array(vectors).reshape(-1, len(bent[0]))


def _of_neighbours(steps: np.ndarray, axis: int) -> np.ndarray:
    """How far the farthest of two neighbours on each side is from the median of all five."""
    middle = np.moveaxis(_medians(steps, axis), axis, -1)
    rows = _window(steps, axis) - middle
    sizes = np.sqrt((np.delete(rows, NEIGHBOURS // 2, axis=0) ** 2).sum(axis=1))
    return np.moveaxis(np.fmax.reduce(sizes, axis=0), -1, axis - 1)


def _without_cubic(steps: np.ndarray, axis: int) -> np.ndarray:
    """Steps less what two neighbours on each side say of them, NaN where there are not both."""
    moved = np.moveaxis(steps, axis, -1)
    found = np.full_like(moved, np.nan)
    left, right = moved[..., 1:-3] + moved[..., 3:-1], moved[..., :-4] + moved[..., 4:]
    found[..., 2:-2] = moved[..., 2:-2] - (4 * left - right) / 6
    return np.moveaxis(found, -1, axis)


def _near(rest: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """1 where steps are within a quarter of a vector, -1 for its opposite, 0 elsewhere."""
    b = vector.reshape(-1, *(1,) * (rest.ndim - 1))
    signs = np.where((rest * b).sum(axis=0) < 0, -1, 1)
    away = ((signs * rest - b) ** 2).sum(axis=0)
    return np.where(np.nan_to_num(away, nan=np.inf) < (vector**2).sum() / 16, signs, 0)


def _nearest(rest: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Which vector (1), or opposite (-1), or none steps are nearest to, shape (k, edges...)."""
    found = np.zeros((len(vectors), *rest.shape[1:]))
    best = np.nan_to_num((rest**2).sum(axis=0), nan=-1.0)
    for k, vector in enumerate(vectors):
        b = vector.reshape(-1, *(1,) * (rest.ndim - 1))
        for sign in (1, -1):
            away = ((rest - sign * b) ** 2).sum(axis=0)
            better = away < best
            found[:, better] = 0
            found[k, better] = sign
            best = np.where(better, away, best)
    return found
