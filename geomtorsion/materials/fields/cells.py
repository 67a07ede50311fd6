"""Cells: Burgers vectors of all circuits of one size on a grid, and torsion at all nodes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.loops.quadrature import ROUNDING
from geomtorsion.materials.fields.circuits import Field, unexplained
from geomtorsion.materials.fields.grid import Grid
from geomtorsion.materials.fields.noise import (
    Noise,
    along,
    independent_significances,
    significances,
)
from geomtorsion.materials.fields.sides import Spread, on_grid, sides

if TYPE_CHECKING:
    from scipy.sparse import csr_array


@dataclass(frozen=True, eq=False, repr=False)
class Plaquettes:
    """Burgers vectors of rectangular circuits at every place of a grid, in one coordinate plane.

    vectors: b^i, shape (rows, places..., nodes of other axes...), axes in the order of the grid;
        each circuit runs from the first axis of the plane to the second, in the sense in which the
        coordinates increase, whichever way the axes are listed. NaN where a side touches a hole.
    errors: of the largest component, without the first axis: distance from a rule of another order
        (without what noise explains of it), and noise as one standard deviation.
    sigmas: standard deviation by noise, shape of the vectors; zero where no sigma is known.
    interpolation: the errors without the noise.
    known: where no side touches a hole, shape of the errors.
    area: of one circuit, positive; plane: the two axes, turned from the first to the second.
    size: edges along both axes of the plane; units: of length and of b.
    shared: covariance by noise of two components i < j, {(i, j): shape of the errors}; those that
        are not there are zero.
    """

    vectors: np.ndarray
    errors: np.ndarray
    area: float
    plane: tuple[int, int]
    sigmas: np.ndarray
    interpolation: np.ndarray
    known: np.ndarray
    size: tuple[int, int] = (1, 1)
    units: tuple[str, str] = ("", "")
    shared: Mapping[tuple[int, int], np.ndarray] = field(default_factory=dict)

    @property
    def density(self) -> np.ndarray:
        """b^i per area: the torsion 2 S_ab^i averaged over each circuit."""
        return self.vectors / self.area

    @property
    def noise_floor(self) -> np.ndarray:
        """Standard deviation of the density by noise, shape of the vectors."""
        return self.sigmas / self.area

    @property
    def significance(self) -> np.ndarray:
        """|b| against its errors, sqrt(b C^-1 b): pure noise gives sqrt(rows) or so.

        NaN where nothing is known; infinite where b has no error.
        """
        if self.shared:
            return self._joint_significance
        return independent_significances(self.vectors, self.sigmas, self.interpolation)

    @property
    def _joint_significance(self) -> np.ndarray:
        """The same where components have noise in common."""
        rows = len(self.vectors)
        table = np.zeros((*self.known.shape, rows, rows))
        for i in range(rows):
            table[..., i, i] = self.sigmas[i] ** 2
        for (i, j), c in self.shared.items():
            table[..., i, j] = table[..., j, i] = np.broadcast_to(c, self.known.shape)
        found = np.full(self.known.shape, np.nan)
        known = self.known
        vectors = np.moveaxis(self.vectors, 0, -1)[known]
        found[known] = significances(vectors, table[known], self.interpolation[known])
        return found

    def gnd_density(self, burgers: float) -> np.ndarray:
        """Density of geometrically necessary dislocations of a Burgers vector: |b| / (area b)."""
        return np.sqrt((self.vectors**2).sum(axis=0)) / (self.area * burgers)

    def __repr__(self) -> str:
        places = " x ".join(map(str, self.known.shape))
        sides = " x ".join(map(str, self.size))
        missing = int((~self.known).sum())
        holes = f", {missing} touch holes" if missing else ""
        length, b = self.units
        units = f", in {b}, lengths in {length}" if length or b else ""
        return f"Plaquettes({places} circuits of {sides} cells{holes}{units})"


@dataclass(frozen=True, eq=False)
class Rectangles:
    """All rectangular circuits of a size in a plane of a grid, as sums over their four sides."""

    grid: Grid
    plane: tuple[int, int]
    size: tuple[int, int]

    @property
    def area(self) -> float:
        """Of one circuit; negative where one axis of the plane decreases."""
        steps = [self.grid.steps[k] * m for k, m in zip(self.plane, self.size, strict=True)]
        return steps[0] * steps[1]

    def four(self, one: np.ndarray, two: np.ndarray) -> tuple[np.ndarray, ...]:
        """Near and far side along the first axis, and along the second, of each circuit.

        one, two: something of all sides along the first axis, and along the second, (..., sides).
        """
        grid, (a, b) = self.grid, self.plane
        near_a, far_a = _pair(one, b - grid.dimension, self.size[1], grid.periodic[b])
        near_b, far_b = _pair(two, a - grid.dimension, self.size[0], grid.periodic[a])
        return near_a, far_a, near_b, far_b

    def rounds(self, one: np.ndarray, two: np.ndarray) -> np.ndarray:
        """Sums round circuits, in the sense in which the coordinates increase."""
        near_a, far_a, near_b, far_b = self.four(one, two)
        # Along a decreasing axis the circuits run round the other way.
        return float(np.sign(self.area)) * ((far_b - near_b) - (far_a - near_a))

    def sums(self, one: np.ndarray, two: np.ndarray) -> np.ndarray:
        """Sums over the four sides, whichever way they are run through."""
        near_a, far_a, near_b, far_b = self.four(one, two)
        return near_a + far_a + near_b + far_b


def circuits(
    sampled: Field,
    plane: tuple[int, int],
    size: tuple[int, int],
    units: tuple[str, str] = ("", ""),
) -> Plaquettes:
    """All circuits of a size; the cost grows with its logarithm."""
    grid = sampled.grid
    side_a, side_b = (sides(sampled, k, m) for k, m in zip(plane, size, strict=True))
    lines = Rectangles(grid, plane, size)
    four, rounds, sums = lines.four, lines.rounds, lines.sums

    def spread(one: Spread, two: Spread) -> dict[tuple[int, int], np.ndarray]:
        found = {}
        for pair in {**one.covariance, **two.covariance}:
            none = np.zeros((1,) * grid.dimension)
            found[pair] = sums(one.covariance.get(pair, none), two.covariance.get(pair, none))
        if sampled.noise is None or not sampled.noise.joins_columns:
            return found
        # Two sides that meet have the noise of one node in common.
        starts, ends = four(one.starts, two.starts), four(one.ends, two.ends)
        for (i, j), c in _both_ways(sampled.noise, plane).items():
            at = [
                _corner(c, grid, dict(zip(plane, zip(shift, size, strict=True), strict=True)))
                for shift in product((0, size[0]), (0, size[1]))
            ]
            here = (
                -starts[0] * starts[2] * at[0] + starts[1] * ends[2] * at[1]
                + ends[0] * starts[3] * at[2] - ends[1] * ends[3] * at[3]
            )  # fmt: skip
            found[i, j] = found.get((i, j), 0.0) + here
        return found

    vectors = rounds(side_a.values, side_b.values)
    known = np.ones(vectors.shape[1:], dtype=bool)
    if grid.has_holes:
        known = sums((~side_a.known).astype(np.int8), (~side_b.known).astype(np.int8)) == 0
    difference = np.abs(rounds(side_a.difference, side_b.difference))
    sigmas, shared = np.zeros(vectors.shape), {}
    if side_a.noise is not None and side_b.noise is not None:
        here, less = (spread(*both) for both in zip(side_a.noise, side_b.noise, strict=True))
        for i in range(len(vectors)):
            # Rounding may leave less than nothing where noise cancels.
            sigmas[i] += np.sqrt(np.maximum(here.get((i, i), 0.0), 0.0))
            difference[i] = unexplained(difference[i], less.get((i, i), np.zeros(1)))
        shared = {(i, j): c for (i, j), c in here.items() if i < j}
    interpolation = difference.max(axis=0)
    longest = max(abs(grid.steps[k]) * m for k, m in zip(plane, size, strict=True))
    interpolation = interpolation + ROUNDING * sampled.size * longest
    if grid.has_holes:
        vectors[:, ~known], sigmas[:, ~known], interpolation[~known] = np.nan, np.nan, np.nan
    errors = interpolation.copy()
    if side_a.noise is not None:
        errors = np.hypot(interpolation, sigmas.max(axis=0))
    return Plaquettes(
        vectors, errors, abs(lines.area), plane, sigmas, interpolation, known, size, units, shared
    )


def _both_ways(noise: Noise, plane: tuple[int, int]) -> dict[tuple[int, int], np.ndarray]:
    """Covariances of the two columns of a plane at a node, by components, in both orders added."""
    found = noise.between(plane)
    for pair, c in noise.between((plane[1], plane[0])).items():
        found[pair] = found[pair] + c if pair in found else c
    return found


def _corner(values: np.ndarray, grid: Grid, shifts: dict[int, tuple[int, int]]) -> np.ndarray:
    """Values at one corner of all circuits. shifts: axis -> (steps to the corner, size)."""
    for axis, (by, size) in shifts.items():
        if values.shape[axis] > 1 and grid.periodic[axis]:
            values = np.roll(values, -by, axis)
        elif values.shape[axis] > 1:
            values = np.take(values, np.arange(by, by + values.shape[axis] - size), axis)
    return values


def _pair(values: np.ndarray, axis: int, apart: int, periodic: bool) -> tuple[np.ndarray, ...]:
    """Near and far sides of circuits: values, and those so many nodes further along an axis."""
    if values.shape[axis] == 1:
        # One value stands for all.
        return values, values
    if periodic:
        return values, np.roll(values, -apart, axis)
    count = values.shape[axis] - apart
    index = [slice(None)] * values.ndim
    index[axis] = slice(None, count)
    near = values[tuple(index)]
    index[axis] = slice(apart, None)
    return near, values[tuple(index)]


def torsion(sampled: Field, plane: tuple[int, int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """d_a e_b - d_b e_a at the nodes, its distance from another order, and its sigma.

    Shape (rows, grid...) each; NaN where there are not enough known nodes in a row.
    """
    grid, noise = sampled.grid, sampled.noise
    found, weights = [], []
    for k, m in (plane, plane[::-1]):
        rule = grid.rule(sampled.order, k, slopes=True)
        other = rule.other
        values = sampled.values[:, m]
        here, there = (r(values, 1 + k) / grid.steps[k] for r in (rule, other))
        if not rule.known.all():
            here[:, ~on_grid(rule.known, grid.shape, k)] = np.nan
        found.append((here, here - there))
        if noise is not None:
            weights.append([t / grid.steps[k] for t in (rule.matrix, rule.matrix - other.matrix)])
    curl, difference = (one - two for one, two in zip(*found, strict=True))
    difference, sigmas = np.abs(difference), np.zeros_like(curl)
    if noise is not None:
        for i in range(sampled.rows):
            variance, less = (
                _variance(noise, i, grid, plane, pair) for pair in zip(*weights, strict=True)
            )
            sigmas[i] = np.sqrt(variance)
            difference[i] = unexplained(difference[i], less)
    return curl, difference, np.where(np.isnan(curl), np.nan, sigmas)


def _variance(
    noise: Noise,
    row: int,
    grid: Grid,
    plane: tuple[int, int],
    matrices: Sequence[csr_array],
) -> np.ndarray:
    """Variance of one component of torsion, shape of the grid (or what broadcasts to it)."""
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
