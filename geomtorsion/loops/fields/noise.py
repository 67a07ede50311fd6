"""Noise: standard deviations of values on a grid, given or estimated from the values."""

from __future__ import annotations

from math import comb, sqrt
from statistics import NormalDist

import numpy as np

from geomtorsion.errors import GridError
from geomtorsion.loops.fields.grid import ORDERS, Grid, numbers

# Differences of the sixth order leave nothing of a field that is smooth over seven nodes.
SMOOTH = ORDERS[-2]
# The median of |x| of a normal distribution of standard deviation 1.
MEDIAN = NormalDist().inv_cdf(3 / 4)


def sigma_of(given: object, shape: tuple[int, ...], grid: Grid) -> np.ndarray:
    """Standard deviations with all axes of the coframe, of length 1 where nothing varies.

    given: a number, or an array of the shape of the grid, of (rows, columns), or of the coframe.
    """
    found = numbers(given, "sigma")
    inner = (1,) * grid.dimension
    shapes = {(): (1, 1, *inner), grid.shape: (1, 1, *grid.shape), shape: shape}
    shapes.setdefault(shape[:2], (*shape[:2], *inner))
    shapes.setdefault((*shape[:2], *inner), (*shape[:2], *inner))
    shapes.setdefault((1, 1, *inner), (1, 1, *inner))
    shapes.setdefault((1, 1, *grid.shape), (1, 1, *grid.shape))
    if found.shape not in shapes:
        raise GridError(
            f"sigma: a number, or shape {grid.shape} (nodes), {shape[:2]} (components) or {shape} "
            f"(both) was needed, but {found.shape} came."
        )
    found = found.reshape(shapes[found.shape])
    bad = ~(found >= 0) | np.isinf(found)
    if found.shape[2:] == grid.shape:
        # Nothing is asked about holes.
        bad &= ~grid.holes
        found = np.where(grid.holes, 0.0, found)
    if bad.any():
        place = tuple(np.argwhere(bad)[0].tolist())
        where = f" at node {place[2:]}" if found.shape[2:] == grid.shape else ""
        raise GridError(
            f"sigma: standard deviations of 0 or more were needed, but {found[place]:.6g} came"
            f"{where}. Mask what is not known."
        )
    return found


def estimated(values: np.ndarray, grid: Grid) -> np.ndarray:
    """Standard deviation of each component, from differences of sixth order.

    sigma = median |difference| / (0.6745 sqrt(sum of squared binomials)), the least along the axes:
    what is smooth over seven nodes cancels, and the median knows nothing of cores and cuts.

    values: shape (rows, columns, grid...). Returns shape (rows, columns, 1, ...).
    """
    best = np.full(values.shape[:2], np.inf)
    for axis, points in enumerate(grid.shape):
        order = min(SMOOTH, points - 1)
        scale = MEDIAN * sqrt(sum(comb(order, k) ** 2 for k in range(order + 1)))
        bent = np.moveaxis(values, 2 + axis, -1)
        holes = np.moveaxis(grid.holes, axis, -1)
        known = np.ones((*holes.shape[:-1], points - order), dtype=bool)
        for k in range(order + 1):
            known &= ~holes[..., k : k + points - order]
        if not known.any():
            continue
        for i, mu in np.ndindex(*best.shape):
            found = np.abs(np.diff(bent[i, mu], order, axis=-1)[known])
            best[i, mu] = min(best[i, mu], float(np.median(found)) / scale)
    if not np.isfinite(best).all():
        raise GridError(
            "sigma: rows of seven known nodes (or of a whole axis) are needed to estimate noise, "
            "but there are none. Give sigma as a number or an array."
        )
    return best.reshape(*best.shape, *(1,) * grid.dimension)
