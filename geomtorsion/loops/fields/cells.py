"""Cells: Burgers vectors of all circuits of one size on a grid, and torsion at all nodes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geomtorsion.loops.fields.circuits import Field, unexplained
from geomtorsion.loops.fields.sides import on_grid, sides
from geomtorsion.loops.fields.stencils import applied
from geomtorsion.loops.quadrature import ROUNDING


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
        """|b| against its errors, sqrt(sum (b^i / sigma^i)^2): pure noise gives sqrt(rows) or so.

        NaN where nothing is known; infinite where b has no error.
        """
        sigmas = np.hypot(self.sigmas, self.interpolation)
        with np.errstate(divide="ignore", invalid="ignore"):
            shares = np.where(self.vectors == 0, 0.0, self.vectors / sigmas)
        return np.sqrt((shares**2).sum(axis=0))

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


def circuits(
    field: Field,
    plane: tuple[int, int],
    size: tuple[int, int],
    units: tuple[str, str] = ("", ""),
) -> Plaquettes:
    """All circuits of a size; the cost grows with its logarithm."""
    grid, (a, b) = field.grid, plane
    side_a, side_b = (sides(field, k, m) for k, m in zip(plane, size, strict=True))
    area = grid.steps[a] * grid.steps[b] * size[0] * size[1]
    # Along a decreasing axis the circuits run round the other way.
    sign = float(np.sign(area))

    def rounds(one: np.ndarray, two: np.ndarray) -> np.ndarray:
        near_a, far_a = _pair(one, b - grid.dimension, size[1], grid.periodic[b])
        near_b, far_b = _pair(two, a - grid.dimension, size[0], grid.periodic[a])
        return sign * ((far_b - near_b) - (far_a - near_a))

    def sums(one: np.ndarray, two: np.ndarray) -> np.ndarray:
        near_a, far_a = _pair(one, b - grid.dimension, size[1], grid.periodic[b])
        near_b, far_b = _pair(two, a - grid.dimension, size[0], grid.periodic[a])
        return near_a + far_a + near_b + far_b

    vectors = rounds(side_a.values, side_b.values)
    known = sums((~side_a.known).astype(np.int8), (~side_b.known).astype(np.int8)) == 0
    difference = np.abs(rounds(side_a.difference, side_b.difference))
    sigmas = np.zeros_like(vectors)
    if field.variances is not None:
        sigmas += np.sqrt(sums(side_a.variance, side_b.variance))
        spread = sums(side_a.difference_variance, side_b.difference_variance)
        difference = unexplained(difference, spread)
    interpolation = difference.max(axis=0)
    longest = max(abs(grid.steps[k]) * m for k, m in zip(plane, size, strict=True))
    interpolation = interpolation + ROUNDING * field.size * longest
    if grid.has_holes:
        vectors[:, ~known], sigmas[:, ~known], interpolation[~known] = np.nan, np.nan, np.nan
    errors = np.hypot(interpolation, sigmas.max(axis=0))
    return Plaquettes(vectors, errors, abs(area), plane, sigmas, interpolation, known, size, units)


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


def torsion(field: Field, plane: tuple[int, int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """d_a e_b - d_b e_a at the nodes, its distance from another order, and its sigma.

    Shape (rows, grid...) each; NaN where there are not enough known nodes in a row.
    """
    grid = field.grid
    found = []
    for k, m in (plane, plane[::-1]):
        rule = grid.rule(field.order, k, slopes=True)
        other = rule.other()
        step = grid.steps[k]
        values = field.values[:, m]
        here, there = (r(values, 1 + k) / step for r in (rule, other))
        here[:, ~on_grid(rule.known, grid.shape, k)] = np.nan
        spread = [np.zeros(1), np.zeros(1)]
        if field.variances is not None:
            variances = np.broadcast_to(field.variances[:, m], values.shape)
            lines = rule.holes.shape[1]
            spread = [
                applied(table.power(2), variances, 1 + k, lines) / step**2
                for table in (rule.matrix, rule.matrix - other.matrix)
            ]
        found.append((here, here - there, *spread))
    one, two = found
    curl, difference = one[0] - two[0], np.abs(one[1] - two[1])
    sigmas = np.sqrt(one[2] + two[2])
    difference = unexplained(difference, one[3] + two[3])
    sigmas = np.where(np.isnan(curl), np.nan, np.broadcast_to(sigmas, curl.shape))
    return curl, difference, sigmas
