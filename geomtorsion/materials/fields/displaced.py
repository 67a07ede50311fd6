"""Displaced: circuits and edges through a displacement; b is a sum of whole lattice vectors."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from geomtorsion.loops import Cochain, Complex, EdgeIntegrals, Loop, Part
from geomtorsion.loops.quadrature import ROUNDING
from geomtorsion.materials.detours import Passages
from geomtorsion.materials.fields.cells import Circuits, windows_of
from geomtorsion.materials.fields.displacement import Displacement, differences
from geomtorsion.materials.fields.grid import Grid
from geomtorsion.materials.fields.grid_circuits import (
    Field,
    Measured,
    sampled_edges,
    sampled_polygons,
)
from geomtorsion.materials.fields.sides import on_grid
from geomtorsion.materials.rings import Rings
from geomtorsion.materials.survey import Errors
from geomtorsion.materials.windows import Windows
from geomtorsion.support.precision import CALCULATED

# Largest step along a path, in cells, so that no step skips a cell.
LONGEST = 1 / 2


def displaced_burgers(grid: Grid, displacement: Displacement, loop: Loop) -> Measured:
    """Burgers vector of a loop: the sum of the jumps of the grid edges along it."""
    jumps = displacement.jumps
    times, chances, gap = np.zeros(len(jumps.vectors)), np.zeros(len(jumps.vectors)), 0.0
    for part in loop.parts:
        places, ends = _followed(grid, part)
        nodes = _nodes(grid, places, "loop")
        # The path returns to the first node, shifted by whole periods.
        turns = np.rint(ends / (np.array(grid.steps) * grid.shape)).astype(int)
        nodes = np.concatenate([nodes, nodes[:, :1] + (turns * grid.shape)[:, None]], axis=1)
        here, moves = nodes[:, :-1], np.diff(nodes)
        times += part.times * _along(grid, displacement.times, here, moves).sum(axis=1)
        unsigned = _along(grid, displacement.chances, here, moves, signed=False)
        chances += part.times**2 * unsigned.sum(axis=1)
        gap = gap + part.times * ends
    vector = 0.0 - jumps.sums(times)
    if np.abs(gap).max() > CALCULATED * loop.size:
        grid.check_periods(np.asarray(gap))
        vector = vector + np.eye(len(vector), grid.dimension) @ gap
    rounding = ROUNDING * float(np.abs(vector).max())
    systematic = {"lattice": float(jumps.errors(times)), "rounding": rounding}
    return vector, jumps.covariance(times, chances), systematic


def _followed(grid: Grid, part: Part) -> tuple[np.ndarray, np.ndarray]:
    """Places along a path that skip no cell, (d, k), and the gap between its ends, (d,)."""
    pieces, gap = [], np.zeros(grid.dimension)
    for arc in part.arcs:
        count = 64
        while True:
            points = part.points(arc, np.linspace(0.0, 1.0, count + 1))[0]
            places = grid.places(points, "loop")
            if np.abs(np.diff(places)).max() <= LONGEST:
                break
            count *= 2
        pieces.append(places)
        gap += points[:, -1] - points[:, 0]
    return np.concatenate(pieces, axis=1), gap


def _nodes(grid: Grid, places: np.ndarray, what: str) -> np.ndarray:
    """The first node of the cell of each place; places in holes are refused."""
    blocks = grid.known.blocks(places, 2)
    grid.refuse_holes(blocks.used, places, what)
    return blocks.first


def _along(
    grid: Grid,
    tables: tuple[np.ndarray, ...],
    nodes: np.ndarray,
    moves: np.ndarray,
    *,
    signed: bool = True,
) -> np.ndarray:
    """Sums of table values over the edges from nodes to neighbouring nodes, shape (k, steps).

    tables: one for each axis, (k, edges...). nodes, moves: shape (d, steps), at most one step along
    each axis. Forward steps are first: their edges belong to the old cell, and the edges of
    backward steps to the new cell.
    """
    here = nodes.copy()
    sums = np.zeros((len(tables[0]), here.shape[1]))
    for sign in (1, -1):
        for axis, table in enumerate(tables):
            chosen = np.flatnonzero(moves[axis] == sign)
            if sign < 0:
                here[axis, chosen] -= 1
            edges = here[:, chosen] % np.array(grid.shape)[:, None]
            sums[:, chosen] += (sign if signed else 1) * table[(slice(None), *edges)]
            if sign > 0:
                here[axis, chosen] += 1
    return sums


def displaced_circuits(
    grid: Grid,
    displacement: Displacement,
    plane: tuple[int, int],
    size: tuple[int, int],
    rings: Rings | None,
) -> Circuits:
    """b of all circuits of a size, as in `cells.circuits`."""
    lines, passages = windows_of(grid, plane, size), None
    edges = displacement.times[plane[0]], displacement.times[plane[1]]
    if rings is not None:
        passages = Passages(rings, lines)
        edges = passages.rings.filled(edges)
    times = lines.rounds(*lines.along(*edges))
    vectors = 0.0 - displacement.jumps.sums(times)
    if passages is not None:
        vectors[:, passages.refused] = np.nan
    estimate = partial(_errors, lines, displacement, times, vectors, passages)
    return Circuits(vectors, estimate, passages)


def _errors(
    lines: Windows,
    displacement: Displacement,
    times: np.ndarray,
    vectors: np.ndarray,
    passages: Passages | None,
) -> Errors:
    """Errors of all circuits, from the number of jumps of each circuit."""
    jumps, (a, b) = displacement.jumps, lines.plane
    edges = displacement.chances[a], displacement.chances[b]
    chances = lines.sums(*lines.along(*edges))
    systematic = jumps.errors(times) + ROUNDING * np.abs(vectors).max(axis=0)
    if passages is not None and passages.rings.count:
        rings = passages.rings
        chances = chances + passages.around(rings.totals_of(rings.steps_of(edges, signed=False)))
        own = rings.steps_of((displacement.times[a], displacement.times[b]))
        sizes = np.abs(jumps.sums(rings.totals_of(own))).max(axis=0)
        systematic = systematic + passages.around(sizes[None])[0]
    table, rows = jumps.covariance(times, chances), range(len(vectors))
    covariance = {(i, j): table[..., i, j] for i in rows for j in rows[i:]}
    return Errors(covariance, systematic)


def displaced_torsion(
    grid: Grid, rows: int, order: int, plane: tuple[int, int]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Torsion at the nodes, its error and its sigma, as in `cells.torsion`.

    Torsion is zero, because second derivatives commute, or NaN without enough known nodes in a row.
    """
    torsion = np.zeros((rows, *grid.shape))
    for axis in plane:
        torsion[:, ~on_grid(grid.rule(order, axis, slopes=True).known, grid.shape, axis)] = np.nan
    return torsion, np.zeros_like(torsion), np.where(np.isnan(torsion), np.nan, 0.0)


def displaced_cochain(grid: Grid, displacement: Displacement) -> Cochain:
    """The integral along each edge of a grid without holes: a difference minus the jump."""
    values, errors = [], []
    rows = len(displacement.values)
    for k, times in enumerate(displacement.times):
        steps = differences(displacement.values, 1 + k, grid.periodic[k])
        steps = steps - displacement.jumps.sums(times)
        unit = grid.steps[k] * np.eye(rows, grid.dimension)[:, k]
        values.append(steps.reshape(rows, -1).T + unit)
        noise = np.zeros(steps.shape)
        if displacement.variances is not None:
            noise = np.sqrt(_of_both_ends(displacement.variances, k, grid.periodic[k]))
        errors.append(noise.max(axis=0).ravel())
    integrals = np.concatenate(values)
    rounding = ROUNDING * np.abs(integrals).max(axis=1)
    edges = Complex.grid(grid.shape, periodic=grid.periodic)
    return Cochain(edges, integrals, np.concatenate(errors) + rounding)


def _of_both_ends(values: np.ndarray, axis: int, periodic: bool) -> np.ndarray:
    """Sums of the values at both ends of each edge along an axis, for values (rows, grid...)."""
    both = values + np.roll(values, -1, 1 + axis)
    return both if periodic else np.delete(both, -1, 1 + axis)


def polygon_sums(
    field: Field, displacement: Displacement | None, polygons: Sequence[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """b along closed polygons, and its variances from noise, shape (k, rows) each.

    polygons: points of each, the first one also at the end, shape (points, d).
    """
    if displacement is None:
        return sampled_polygons(field, polygons)
    loops = [Loop.polygon(points[:-1]) for points in polygons]
    each = [displaced_burgers(field.grid, displacement, loop) for loop in loops]
    return np.array([one[0] for one in each]), np.array([np.diag(one[1]) for one in each])


def displaced_edges(
    field: Field, displacement: Displacement, starts: np.ndarray, ends: np.ndarray
) -> EdgeIntegrals:
    """The integrals along straight edges; their sum around a closed circuit contains only jumps.

    From each end to a node of its cell, the coframe is interpolated. From node to node, the
    integral is the difference of the displacement minus the jumps of the grid edges between them.
    """
    grid, jumps = field.grid, displacement.jumps
    count = len(starts)
    both = np.concatenate([starts, ends])
    places = grid.places(both.T, "edge")
    nodes = _nodes(grid, places, "edge")
    origin = np.array([axis[0] for axis in grid.axes])
    corners = (origin[:, None] + np.array(grid.steps)[:, None] * nodes).T
    stubs = sampled_edges(field, corners, both)
    at = tuple(nodes % np.array(grid.shape)[:, None])
    u = displacement.values[(slice(None), *at)].T
    unit = np.eye(field.rows, grid.dimension)
    here = stubs.vectors + u + corners @ unit.T
    integrals = here[count:] - here[:count]
    crossed = _crossed(grid, displacement.times, starts, ends)
    integrals = integrals - jumps.sums(crossed).T
    errors = stubs.errors[count:] + stubs.errors[:count] + jumps.errors(crossed)
    if displacement.variances is not None:
        variances = displacement.variances[(slice(None), *at)].max(axis=0)
        errors = np.hypot(errors, np.sqrt(variances[count:] + variances[:count]))
    rounding = ROUNDING * np.abs(integrals).max(axis=1)
    return EdgeIntegrals(integrals, errors + rounding, stubs.evaluations)


def _crossed(
    grid: Grid, times: tuple[np.ndarray, ...], starts: np.ndarray, ends: np.ndarray
) -> np.ndarray:
    """Jumps of the grid edges along straight edges, shape (k, edges)."""
    cells = np.abs((ends - starts) / np.array(grid.steps)).max(axis=1)
    counts = 1 + np.ceil(cells / LONGEST).astype(int)
    owner = np.repeat(np.arange(len(starts)), counts + 1)
    first = np.cumsum(counts + 1) - (counts + 1)
    share = (np.arange(len(owner)) - first[owner]) / counts[owner]
    line = starts[owner] + share[:, None] * (ends - starts)[owner]
    nodes = _nodes(grid, grid.places(line.T, "edge"), "edge")
    moves = np.diff(nodes) * (owner[1:] == owner[:-1])
    jumps = _along(grid, times, nodes[:, :-1], moves)
    return np.array([np.bincount(owner[:-1], row, len(starts)) for row in jumps]).reshape(
        len(jumps), len(starts)
    )
