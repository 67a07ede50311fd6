"""Cells: Burgers vectors of all circuits of one size on a grid, and torsion at all nodes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.loops.quadrature import ROUNDING
from geomtorsion.materials.detours import Passages
from geomtorsion.materials.fields.grid import Grid
from geomtorsion.materials.fields.grid_circuits import Field, unexplained
from geomtorsion.materials.fields.noise import Noise, along
from geomtorsion.materials.fields.sides import Sides, Spread, on_grid
from geomtorsion.materials.fields.stencils import Rule
from geomtorsion.materials.rings import Rings
from geomtorsion.materials.survey import Errors
from geomtorsion.materials.windows import Windows

if TYPE_CHECKING:
    from scipy.sparse import csr_array


@dataclass(frozen=True, eq=False)
class Circuits:
    """All rectangular circuits of a size in a plane of a grid.

    vectors: b^i, shape (rows, places...), NaN where a circuit has none. estimate: computes the
    errors. passages: of circuits that go around missing nodes; None without missing nodes.
    """

    vectors: np.ndarray
    estimate: Callable[[], Errors]
    passages: Passages | None = None


def windows_of(grid: Grid, plane: tuple[int, int], size: tuple[int, int]) -> Windows:
    """Circuits of a size in a plane, which turn in the direction of increasing coordinates."""
    # A decreasing axis reverses the sense of the circuits.
    sense = 1 if grid.steps[plane[0]] * grid.steps[plane[1]] > 0 else -1
    return Windows(plane, size, grid.periodic, sense)


def circuits(
    sampled: Field,
    plane: tuple[int, int],
    size: tuple[int, int],
    rings: Rings | None = None,
    sides: tuple[Sides, Sides] | None = None,
) -> Circuits:
    """b of all circuits of a size; the cost grows with the logarithm of the size.

    rings: around missing nodes, which circuits follow; without them, b is NaN where a side has a
    missing node. sides: along both axes, if another size has them.
    """
    grid, lines = sampled.grid, windows_of(sampled.grid, plane, size)
    one, two = sides or (Sides(sampled, plane[0]), Sides(sampled, plane[1]))
    edges, passages = (one.values, two.values), None
    if rings is not None:
        passages = Passages(rings, lines)
        edges = passages.rings.filled(edges)
    vectors = lines.rounds(*lines.along(*edges))
    if passages is not None:
        vectors[:, passages.refused] = np.nan
    elif grid.has_holes:
        met = (touched(grid, k).astype(np.int32) for k in plane)
        vectors[:, lines.sums(*lines.along(*met)) > 0] = np.nan
    return Circuits(vectors, partial(_errors, sampled, lines, one, two, passages), passages)


def touched(grid: Grid, axis: int) -> np.ndarray:
    """Whether each edge along an axis has an unknown end."""
    either = grid.holes | np.roll(grid.holes, -1, axis)
    return either if grid.periodic[axis] else np.delete(either, -1, axis)


def _errors(
    sampled: Field, lines: Windows, one: Sides, two: Sides, passages: Passages | None
) -> Errors:
    """Errors of all circuits: noise, the difference from a rule of another order, and detours."""
    grid, size = sampled.grid, lines.size
    differences = one.difference, two.difference
    if passages is not None:
        differences = passages.rings.filled(differences)
    difference = np.abs(lines.rounds(*lines.along(*differences)))
    covariance: dict[tuple[int, int], np.ndarray] = {}
    if sampled.noise is not None:
        every, less = (
            _spread(
                sampled.noise, grid, lines, one.spread(size[0], other), two.spread(size[1], other)
            )
            for other in (False, True)
        )
        covariance = {(i, j): c for (i, j), c in every.items() if i <= j}
        for i, row in enumerate(difference):
            row[:] = unexplained(row, less.get((i, i), np.zeros(1)))
    longest = max(abs(grid.steps[k]) * m for k, m in zip(lines.plane, size, strict=True))
    systematic = difference.max(axis=0) + ROUNDING * sampled.size * longest
    if passages is not None and passages.rings.count:
        sizes = np.abs(passages.rings.totals_of(passages.rings.steps_of((one.values, two.values))))
        if sampled.noise is not None:
            edges = one.variances(), two.variances()
            variances = passages.rings.totals_of(passages.rings.steps_of(edges, signed=False))
            sizes = unexplained(sizes, variances)
            # Neighbouring steps of a ring share a node, which at most doubles the variance of a
            # sum. The whole ring is an upper bound for a part of it.
            for i, more in enumerate(passages.around(2 * variances)):
                covariance[i, i] = covariance.get((i, i), 0.0) + more
        systematic = systematic + passages.around(sizes.max(axis=0)[None])[0]
    return Errors(covariance, systematic)


def _spread(
    noise: Noise, grid: Grid, lines: Windows, one: Spread, two: Spread
) -> dict[tuple[int, int], np.ndarray]:
    """Covariances of circuits from noise, computed from the covariances of their sides."""
    plane, size = lines.plane, lines.size
    table = {}
    for pair in {**one.covariance, **two.covariance}:
        none = np.zeros((1,) * grid.dimension)
        table[pair] = lines.sums(one.covariance.get(pair, none), two.covariance.get(pair, none))
    if not noise.joins_columns:
        return table
    # Two adjacent sides share the noise of one node.
    starts, ends = lines.four(one.starts, two.starts), lines.four(one.ends, two.ends)
    for (i, j), c in _both_ways(noise, plane).items():
        at = [
            _corner(c, grid, dict(zip(plane, zip(shift, size, strict=True), strict=True)))
            for shift in product((0, size[0]), (0, size[1]))
        ]
        here = (
            -starts[0] * starts[2] * at[0] + starts[1] * ends[2] * at[1]
            + ends[0] * starts[3] * at[2] - ends[1] * ends[3] * at[3]
        )  # fmt: skip
        table[i, j] = table.get((i, j), 0.0) + here
    return table


def _both_ways(noise: Noise, plane: tuple[int, int]) -> dict[tuple[int, int], np.ndarray]:
    """Covariances between the two columns of a plane at a node, summed over both orders."""
    covariances = noise.between(plane)
    for pair, c in noise.between((plane[1], plane[0])).items():
        covariances[pair] = covariances[pair] + c if pair in covariances else c
    return covariances


def _corner(values: np.ndarray, grid: Grid, shifts: dict[int, tuple[int, int]]) -> np.ndarray:
    """Values at one corner of all circuits. shifts: axis -> (steps to the corner, size)."""
    for axis, (by, size) in shifts.items():
        if values.shape[axis] > 1 and grid.periodic[axis]:
            values = np.roll(values, -by, axis)
        elif values.shape[axis] > 1:
            values = np.take(values, np.arange(by, by + values.shape[axis] - size), axis)
    return values


def curl(sampled: Field, plane: tuple[int, int], out: np.ndarray | None = None) -> np.ndarray:
    """d_a e_b - d_b e_a at the nodes, shape (rows, grid...).

    NaN without enough known nodes in a row. out: array for the result.
    """
    return _curl(sampled, plane, _slopes(sampled, plane), out)


def _slopes(sampled: Field, plane: tuple[int, int]) -> tuple[Rule, Rule]:
    """The rules for derivatives along both axes of a plane."""
    one, two = (sampled.grid.rule(sampled.order, k, slopes=True) for k in plane)
    return one, two


def _curl(
    sampled: Field,
    plane: tuple[int, int],
    rules: tuple[Rule, Rule],
    out: np.ndarray | None = None,
) -> np.ndarray:
    if out is None:
        out = np.empty((sampled.rows, *sampled.grid.shape))
    spare = np.empty((1, *sampled.grid.shape))
    (a, b), (one, two) = plane, rules
    for i, row in enumerate(out):
        one(sampled.values[i : i + 1, b], 1 + a, out=row[None])
        row *= 1 / sampled.grid.steps[a]
        two(sampled.values[i : i + 1, a], 1 + b, out=spare)
        spare *= 1 / sampled.grid.steps[b]
        row -= spare[0]
        for rule, k in zip(rules, plane, strict=True):
            if not rule.known.all():
                row[~on_grid(rule.known, sampled.grid.shape, k)] = np.nan
    return out


def torsion(sampled: Field, plane: tuple[int, int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """`curl`, its difference from the curl of another order, and its sigma."""
    grid, noise, rules = sampled.grid, sampled.noise, _slopes(sampled, plane)
    curls = _curl(sampled, plane, rules)
    one, two = rules
    difference = np.abs(curls - _curl(sampled, plane, (one.other, two.other)))
    sigmas = np.zeros_like(curls)
    if noise is not None:
        steps = [grid.steps[k] for k in plane]
        tables = [r.matrix / step for r, step in zip(rules, steps, strict=True)]
        less = [(r.matrix - r.other.matrix) / step for r, step in zip(rules, steps, strict=True)]
        for i in range(sampled.rows):
            sigmas[i] = np.sqrt(_variance(noise, i, grid, plane, tables))
            difference[i] = unexplained(difference[i], _variance(noise, i, grid, plane, less))
    return curls, difference, np.where(np.isnan(curls), np.nan, sigmas)


def _variance(
    noise: Noise,
    row: int,
    grid: Grid,
    plane: tuple[int, int],
    matrices: Sequence[csr_array],
) -> np.ndarray:
    """Variance of one component of torsion, shape of the grid, or a shape that broadcasts to it."""
    total = np.zeros(grid.shape)
    for matrix, (k, m) in zip(matrices, (plane, plane[::-1]), strict=True):
        variances = noise.at_nodes(row, m, grid.shape)
        total += along(matrix.power(2), variances, k)
    # The two derivatives share the node at which they are taken.
    one, two = (
        on_grid(t.diagonal().reshape(grid.shape[k], -1), grid.shape, k)
        for t, k in zip(matrices, plane, strict=True)
    )
    shared = _both_ways(noise, plane).get((row, row))
    return total if shared is None else np.maximum(total - one * two * shared, 0.0)
