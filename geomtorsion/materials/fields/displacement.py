"""Displacement: a field of displacements on a grid, with jumps by lattice vectors."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from geomtorsion.errors import GridError
from geomtorsion.materials.fields.grid import Grid, numbers
from geomtorsion.materials.fields.noise import along, chances_of, spread
from geomtorsion.materials.fields.sides import on_grid
from geomtorsion.materials.fields.stencils import applied
from geomtorsion.support.precision import EPS

# Number of steps in the median for an edge: the edge itself and two neighbours on each side.
NEIGHBOURS = 5
# Standard error of the median of normal numbers, in units of the standard error of their mean.
OF_MEDIAN = float(np.sqrt(np.pi / 2))
# Value of `branch` that requests a search for jumps.
FIND = "find"


@dataclass(frozen=True, eq=False)
class Jumps:
    """Lattice vectors by which a displacement jumps.

    vectors: shape (k, rows). scatter: standard errors of vectors found in the values, same shape.
    bias: errors of these vectors from smooth strain, same shape. Both are zero for declared ones.
    """

    vectors: np.ndarray
    scatter: np.ndarray
    bias: np.ndarray

    @classmethod
    def declared(cls, vectors: np.ndarray) -> Jumps:
        """Jumps with exactly known vectors."""
        return cls(vectors, np.zeros_like(vectors), np.zeros_like(vectors))

    def sums(self, times: np.ndarray) -> np.ndarray:
        """Sums of multiples of the vectors, shape (rows, ...), for times of shape (k, ...)."""
        return np.einsum("ki,k...->i...", self.vectors, times)

    def covariance(self, times: np.ndarray, chances: np.ndarray) -> np.ndarray:
        """Covariance of such sums, shape (..., rows, rows).

        chances: that noise changed the number of jumps, summed over all edges of a circuit,
        (k, ...).
        """
        wrong = np.einsum("k...,ki,kj->...ij", chances, self.vectors, self.vectors)
        own = np.einsum("k...,ki->...i", times**2, self.scatter**2)
        return wrong + own[..., None] * np.eye(self.vectors.shape[1])

    def errors(self, times: np.ndarray) -> np.ndarray:
        """Error of the largest component of such sums from smooth strain, shape (...)."""
        return np.einsum("ki,k...->i...", self.bias, np.abs(times)).max(axis=0)


@dataclass(frozen=True, eq=False)
class Displacement:
    """A displacement at the nodes of a grid, and the jumps of the edges in lattice vectors.

    The integral of the coframe along an edge is the difference of the displacement minus the jump.
    The differences cancel around a circuit, and b is a sum of whole lattice vectors.

    values: u^i at the nodes, shape (rows, grid...). branch: the jumps as declared by the user.
    coframe: 1 + d u without the jumps, at the nodes, NaN in holes. sigma: standard deviation of the
    coframe from noise, same shape, or None.
    times: multiple of each vector in the jump of each edge, shape (k, edges...), one array for each
    axis. chances: that noise changed such a multiple, same shapes; zero without noise.
    variances: of u from noise, shape (rows, grid...), or None.
    source: origin of the values and the jumps found, in words.
    """

    values: np.ndarray
    branch: object
    coframe: np.ndarray
    sigma: np.ndarray | None
    jumps: Jumps
    times: tuple[np.ndarray, ...]
    chances: tuple[np.ndarray, ...]
    variances: np.ndarray | None
    source: str


def displacement_of(
    values: np.ndarray,
    grid: Grid,
    order: int,
    branch: object,
    variances: np.ndarray | None = None,
    height: np.ndarray | None = None,
) -> Displacement:
    """A displacement with its jumps, and its derivatives without the jumps.

    If the jumps around a cell do not add up to zero, the cell contains a core, or noise has changed
    a difference. The corners of such cells become holes.

    branch: the lattice vectors by which the displacement may jump, shape (k, rows), or one length
    for all directions; "find" searches for them; None means a displacement without jumps.
    variances: of the values from noise, shape (rows, grid...). height: of a surface in space, shape
    of the grid, which is added to the third row once the jumps of the displacement are known.
    """
    rows, d = values.shape[0], grid.dimension
    steps = [differences(values, 1 + k, grid.periodic[k]) for k in range(d)]
    # A smooth field may change by more than a lattice vector from node to node. Therefore a jump
    # is a step that differs from its neighbours along the line.
    bent = [step - _medians(step, 1 + k) for k, step in enumerate(steps)]
    jumps, inverse, times = _jumps(values, grid, steps, bent, branch)
    source = f"a displacement; jumps: {_listed(jumps.vectors, times) or 'none'}"
    if branch is None and len(jumps.vectors):
        seen = _listed(jumps.vectors[:1], [x[:1] for x in times])
        source = (
            f"a displacement; jumps: none declared. Steps of {seen} are unusually large: if they "
            "are jumps, declare them as branch"
        )
        jumps, inverse = Jumps.declared(np.zeros((0, rows))), np.zeros((0, rows))
        times = [x[:0] for x in times]
    if height is not None:
        values = raised(values, height)
        steps = [differences(values, 1 + k, grid.periodic[k]) for k in range(d)]
    steps = [step - jumps.sums(number) for step, number in zip(steps, times, strict=True)]
    holes = grid.holes.copy()
    for _, corners in _open_cells(times, grid):
        holes[tuple(corners.T)] = True
    whole = Grid(grid.axes, grid.names, grid.periodic, holes)
    coframe, sigma = _derived(steps, whole, order, variances)
    chances = _chances(bent, times, inverse, variances, grid)
    return Displacement(
        values, branch, coframe, sigma, jumps, tuple(times), tuple(chances), variances, source
    )


def _jumps(
    values: np.ndarray,
    grid: Grid,
    steps: list[np.ndarray],
    bent: list[np.ndarray],
    branch: object,
) -> tuple[Jumps, np.ndarray, list[np.ndarray]]:
    """The lattice vectors of jumps, shape (k, rows), their inverse, and how often each occurs.

    steps: differences along each axis; bent: without the median of their neighbours.
    """
    if branch is None or (isinstance(branch, str) and branch == FIND):
        # Differences of equal values are no larger than the rounding of these values.
        # A difference and its median have two roundings each.
        least = 4 * EPS * float(np.abs(np.nan_to_num(values)).max())
        jumps = _found(steps, bent, grid, least)
        inverse = jumps.vectors / (jumps.vectors**2).sum(axis=1, keepdims=True)
        return jumps, inverse, [_nearest(rest, jumps.vectors) for rest in bent]
    jumps = Jumps.declared(lattice_vectors(branch, values.shape[0]))
    inverse = np.linalg.pinv(jumps.vectors.T)
    shares = (np.einsum("ki,i...->k...", inverse, rest) for rest in bent)
    return jumps, inverse, [np.nan_to_num(np.rint(share)) for share in shares]


def _chances(
    bent: list[np.ndarray],
    times: list[np.ndarray],
    inverse: np.ndarray,
    variances: np.ndarray | None,
    grid: Grid,
) -> list[np.ndarray]:
    """Chance that noise has changed a number of jumps, in the shape of the numbers."""
    if variances is None or not len(inverse):
        return [np.zeros_like(x) for x in times]
    chances: list[np.ndarray] = []
    for k, (rest, number) in enumerate(zip(bent, times, strict=True)):
        both = variances + np.roll(variances, -1, 1 + k)
        both = both if grid.periodic[k] else np.delete(both, -1, 1 + k)
        width = np.sqrt(np.einsum("ki,i...->k...", inverse**2, both))
        away = np.einsum("ki,i...->k...", inverse, rest) - number
        chances.append(np.nan_to_num(chances_of(away, width)))
    return chances


def raised(values: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Displacement with the height of a surface over its plane added to the third row."""
    return np.concatenate([values[:2], values[2:] + height])


def checked_height(height: object, values: np.ndarray) -> np.ndarray | None:
    """Height of a surface at the nodes of a displacement in space, shape (3, grid...); or None.

    Raises
    ------
    GridError
        The displacement does not have 3 rows over 2 axes, or the height has another shape.
    """
    if height is None:
        return None
    heights = numbers(height, "height")
    if len(values) != 3 or heights.shape != values.shape[1:]:
        raise GridError(
            f"height: expected shape {values.shape[1:]} and a displacement with 3 components, got "
            f"{heights.shape} and {len(values)} components. Give the third coordinate of each node."
        )
    return heights


def _listed(vectors: np.ndarray, times: list[np.ndarray]) -> str:
    """Vectors and the numbers of edges that jump by them, in words."""
    counts = sum(np.count_nonzero(x, axis=tuple(range(1, x.ndim))) for x in times)
    pairs = zip(vectors.tolist(), np.asarray(counts).tolist(), strict=True)
    return ", ".join(f"({', '.join(f'{x:.6g}' for x in b)}) on {n} edges" for b, n in pairs)


def _open_cells(times: list[np.ndarray], grid: Grid) -> Iterator[tuple[int, np.ndarray]]:
    """For each plane, the number of cells whose jumps do not add up to zero, and their corners.

    Cells with unknown corners are ignored.
    """
    for a, b in combinations(range(grid.dimension), 2):
        wraps = grid.periodic
        one = differences(times[b], 1 + a, wraps[a])
        two = differences(times[a], 1 + b, wraps[b])
        cells = np.argwhere((one != two).any(axis=0))
        corners = np.repeat(cells[None], 4, axis=0)
        corners[1::2, :, a] += 1
        corners[2:, :, b] += 1
        corners %= np.array(grid.shape)
        complete = ~grid.holes[tuple(np.moveaxis(corners, -1, 0))].any(axis=0)
        yield int(complete.sum()), corners[:, complete].reshape(-1, grid.dimension)


def _derived(
    steps: list[np.ndarray], grid: Grid, order: int, variances: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray | None]:
    """The coframe at the nodes from differences along the edges, and its standard deviations."""
    rows, d = len(steps[0]), grid.dimension
    coframe = np.empty((rows, d, *grid.shape))
    sigma = None if variances is None else np.empty_like(coframe)
    for k, step in enumerate(steps):
        rule = grid.rule(order, k, slopes=True)
        lines = rule.holes.shape[1]
        slopes = applied(rule.matrix_of_steps, np.nan_to_num(step), 1 + k, lines) / grid.steps[k]
        slopes[:, ~on_grid(rule.known, grid.shape, k)] = np.nan
        coframe[:, k] = slopes
        if sigma is not None and variances is not None:
            squares = (rule.matrix / grid.steps[k]).power(2)
            sigma[:, k] = [np.sqrt(along(squares, row, k)) for row in variances]
    return coframe + np.eye(rows, d).reshape(rows, d, *(1,) * d), sigma


def differences(values: np.ndarray, axis: int, periodic: bool) -> np.ndarray:
    """Differences from each node to the next one."""
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
    # NaN, for unknown steps, sorts to the end.
    rows.sort(axis=0)
    counts = np.isfinite(rows).sum(axis=0)
    pair = (np.maximum(counts - 1, 0) // 2, np.minimum(counts // 2, NEIGHBOURS - 1))
    low, high = (np.take_along_axis(rows, k[None], axis=0)[0] for k in pair)
    return np.moveaxis((low + high) / 2, -1, axis)


def lattice_vectors(branch: object, rows: int) -> np.ndarray:
    """Lattice vectors as rows, from one length, one vector or several."""
    lattice = numbers(branch, "branch")
    if lattice.ndim == 0:
        lattice = float(lattice) * np.eye(rows)
    elif lattice.ndim == 1:
        lattice = lattice[None]
    fits = lattice.ndim == 2 and lattice.shape[1] == rows and 0 < len(lattice) <= rows
    if not fits or not np.isfinite(lattice).all() or np.linalg.matrix_rank(lattice) < len(lattice):
        raise GridError(
            f"branch: expected a length, or up to {rows} independent vectors of {rows} components, "
            f"got {lattice.tolist()}. Give the lattice vectors by which u jumps."
        )
    return lattice


def _found(steps: list[np.ndarray], bent: list[np.ndarray], grid: Grid, least: float) -> Jumps:
    """The vectors by which steps exceed their neighbours, the largest first.

    A step may be a jump if its excess is larger than the excess of each neighbour. A vector is
    accepted if its jumps (within a quarter of it) form lines: fewer cells remain open than there
    are jumps. Vectors smaller than half of a rejected vector, or than `least`, are not examined.
    """
    away = [np.sqrt((x**2).sum(axis=0)) for x in bent]
    open_ = [
        np.isfinite(size) & (size > _of_neighbours(step, 1 + k))
        for k, (step, size) in enumerate(zip(steps, away, strict=True))
    ]
    smooth = [_of_near_and_far(step, 1 + k) for k, step in enumerate(steps)]
    rows: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
    while any(x.any() for x in open_):
        k = int(np.argmax([np.where(o, x, 0).max() for o, x in zip(open_, away, strict=True)]))
        place = np.unravel_index(np.where(open_[k], away[k], 0).argmax(), away[k].shape)
        seed = bent[k][(slice(None), *place)]
        if away[k][place] <= least:
            break
        times = [_near(rest, seed) * o for rest, o in zip(bent, open_, strict=True)]
        left_open = sum(count for count, _ in _open_cells([x[None] for x in times], grid))
        # The steps minus the cubic through the neighbours, and minus the line through them.
        sharp, blunt = (
            np.concatenate(
                [((s - p[n]) * x)[:, x != 0] for s, p, x in zip(steps, smooth, times, strict=True)],
                axis=1,
            )
            for n in (0, 1)
        )
        finite = np.isfinite(sharp).all(axis=0)
        if left_open < sum(np.count_nonzero(x) for x in times) and finite.any():
            sharp, blunt = sharp[:, finite], blunt[:, finite]
            vector = np.median(sharp, axis=1)
            wide = [spread(row) for row in sharp - vector[:, None]]
            scatter = OF_MEDIAN * np.array(wide) / np.sqrt(sharp.shape[1])
            rows.append((vector, scatter, np.abs(np.median(blunt, axis=1) - vector)))
        else:
            least = max(least, float(away[k][place]) / 2)
        open_ = [o & (x == 0) for o, x in zip(open_, times, strict=True)]
    table = np.array(rows).reshape(-1, 3, len(bent[0]))
    return Jumps(table[:, 0], table[:, 1], table[:, 2])


def _of_neighbours(steps: np.ndarray, axis: int) -> np.ndarray:
    """Largest distance of the two neighbours on each side from the median of all five steps."""
    middle = np.moveaxis(_medians(steps, axis), axis, -1)
    rows = _window(steps, axis) - middle
    sizes = np.sqrt((np.delete(rows, NEIGHBOURS // 2, axis=0) ** 2).sum(axis=1))
    return np.moveaxis(np.fmax.reduce(sizes, axis=0), -1, axis - 1)


def _of_near_and_far(steps: np.ndarray, axis: int) -> tuple[np.ndarray, np.ndarray]:
    """A step predicted from two neighbours on each side, and from one; NaN without them."""
    moved = np.moveaxis(steps, axis, -1)
    predictions = []
    left, right = moved[..., 1:-3] + moved[..., 3:-1], moved[..., :-4] + moved[..., 4:]
    for inner in ((4 * left - right) / 6, left / 2):
        whole = np.full_like(moved, np.nan)
        whole[..., 2:-2] = inner
        predictions.append(np.moveaxis(whole, -1, axis))
    return predictions[0], predictions[1]


def _near(rest: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """1 where steps are within a quarter of a vector, -1 for its opposite, 0 elsewhere."""
    b = vector.reshape(-1, *(1,) * (rest.ndim - 1))
    signs = np.where((rest * b).sum(axis=0) < 0, -1, 1)
    away = ((signs * rest - b) ** 2).sum(axis=0)
    return np.where(np.nan_to_num(away, nan=np.inf) < (vector**2).sum() / 16, signs, 0)


def _nearest(rest: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """1 for the vector nearest to a step, -1 if its opposite is nearest, or 0, (k, edges...)."""
    signs = np.zeros((len(vectors), *rest.shape[1:]))
    best = np.nan_to_num((rest**2).sum(axis=0), nan=-1.0)
    for k, vector in enumerate(vectors):
        b = vector.reshape(-1, *(1,) * (rest.ndim - 1))
        for sign in (1, -1):
            away = ((rest - sign * b) ** 2).sum(axis=0)
            better = away < best
            signs[:, better] = 0
            signs[k, better] = sign
            best = np.where(better, away, best)
    return signs
