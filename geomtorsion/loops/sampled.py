"""Sampled: a coframe known on a regular grid, such as a measured distortion field."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion import checks
from geomtorsion.conventions import burgers
from geomtorsion.errors import FileFormatError, GridError
from geomtorsion.loops.arcs import Arc, Parameters, Part, shown
from geomtorsion.loops.cochain import Cochain
from geomtorsion.loops.complexes import Complex
from geomtorsion.loops.edges import EdgeIntegrals
from geomtorsion.loops.forms import forms
from geomtorsion.loops.grid_files import (
    check_finite,
    check_names,
    check_shape,
    numbers,
    read_grid,
    regular_axis,
)
from geomtorsion.loops.loop import Loop
from geomtorsion.loops.stencils import applied, differentiation, integration, interpolated

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame
    from geomtorsion.loops.loop import Loop

ORDERS = (2, 4, 6, 8)


def check_order(order: object) -> None:
    """Refuse an order for which there are no rules."""
    if order not in ORDERS:
        raise GridError(f"order: one of {ORDERS} was needed, but {checks.shown(order)} came.")


@dataclass(frozen=True, eq=False)
class Plaquettes:
    """Burgers vectors of all cells of a grid in one coordinate plane.

    vectors: b^i, shape (rows, cells..., nodes of the other axes...), axes in the order of the grid;
        each cell is run round from the first axis of the plane to the second, in the sense in which
        the coordinates increase, whichever way the axes are listed.
    errors: bound on the largest component, from a rule of another order, without the first axis.
    area: of one cell, positive; plane: the two axes, turned from the first to the second.
    """

    vectors: np.ndarray
    errors: np.ndarray
    area: float
    plane: tuple[int, int]

    @property
    def density(self) -> np.ndarray:
        """b^i per area: the torsion 2 S_ab^i averaged over each cell."""
        return self.vectors / self.area


@dataclass(frozen=True, eq=False, repr=False)
class SampledFrame:
    """A coframe on a regular grid, interpolated by local polynomials.

    axes: coordinates of the grid, one increasing or decreasing array each, equally spaced.
    coframe: e^i_mu at the nodes, shape (rows, d, N_1, ..., N_d): i, mu, then the grid.
    order: order of interpolation, quadrature and differences in the spacing: 2, 4, 6 or 8. Every
        error is measured against another order (the next lower one; for 2 the next higher one).
    names: of the axes.

    Raises
    ------
    GridError
        Shapes do not fit, an axis is not regular or too short, or a value is not finite.

    Examples
    --------
    >>> import numpy as np
    >>> axes = [np.linspace(-1, 1, 9), np.linspace(-1, 1, 11)]
    >>> x, y = np.meshgrid(*axes, indexing="ij")
    >>> distortion = np.array([[-y, x]]) / 2      # e = dx^i + (x dy - y dx) / 2: torsion 1
    >>> grid = SampledFrame(axes, distortion)
    >>> grid.plaquettes().density.round(12).min(), grid.plaquettes().density.round(12).max()
    (np.float64(1.0), np.float64(1.0))
    """

    axes: Sequence[np.ndarray]
    coframe: np.ndarray
    order: int = 4
    names: Sequence[str] = ()

    def __post_init__(self) -> None:
        """Check axes and values once."""
        check_order(self.order)
        names = tuple(self.names) or tuple("xyzuvw"[: len(self.axes)])
        check_names(self.axes, names)
        values = numbers(self.coframe, "coframe")
        axes = tuple(regular_axis(x, name) for x, name in zip(self.axes, names, strict=True))
        check_shape(values, axes, names, max(self.order, self.other_order) + 1, self.order)
        check_finite(values, axes, names)
        for key, value in (("axes", axes), ("coframe", values), ("names", names)):
            object.__setattr__(self, key, value)

    # -- makers -----------------------------------------------------------------------------------

    @classmethod
    def from_distortion(
        cls,
        axes: Sequence[np.ndarray],
        distortion: np.ndarray,
        order: int = 4,
        names: Sequence[str] = (),
    ) -> SampledFrame:
        """From a distortion beta^i_mu = d_mu u^i (row: displacement, column: derivative).

        The coframe is e = 1 + beta: it maps a step in the crystal as it is to the ideal lattice
        when u points from the real to the ideal place. For displacements from ideal to real places
        give -beta (small distortions), or the inverse of (1 + beta) minus 1.
        """
        values = numbers(distortion, "distortion")
        if values.ndim < 3:
            raise GridError(
                f"distortion: shape (rows, columns, grid...) was needed, but {values.shape} came."
            )
        unit = np.eye(*values.shape[:2]).reshape(*values.shape[:2], *(1,) * (values.ndim - 2))
        return cls(axes, values + unit, order, names)

    @classmethod
    def from_frame(
        cls,
        frame: Frame,
        axes: Sequence[np.ndarray],
        order: int = 4,
        *,
        parameters: Parameters | None = None,
    ) -> SampledFrame:
        """Samples of an exact frame, one axis for each coordinate.

        Raises
        ------
        SingularPointError
            The frame has no finite value at a node.
        """
        lines = [numbers(axis, "axis") for axis in axes]
        if len(lines) != frame.dimension:
            raise GridError(
                f"one axis for each of {frame.dimension} coordinates was needed, but "
                f"{len(lines)} came."
            )
        number = math.prod(line.size for line in lines)
        remedy = "Give shorter axes, or sample the region in parts."
        checks.check_room(2 * number * frame.dimension**2, f"axes: {number:,} nodes", remedy)
        coframe = forms(frame, parameters).coframe
        nodes = np.meshgrid(*lines, indexing="ij")
        found = coframe.at(np.array(nodes).reshape(len(nodes), -1))
        values = np.zeros((frame.dimension, frame.dimension, *nodes[0].shape))
        values[coframe.rows, coframe.columns] = found.reshape(-1, *nodes[0].shape)
        return cls(lines, values, order, tuple(symbol.name for symbol in frame.coordinates))

    @classmethod
    def read(cls, path: str | Path, order: int = 4) -> SampledFrame:
        """From an NPZ or NetCDF file (see `grid_files.read_grid` for its contents).

        Raises
        ------
        FileFormatError
            The file is missing, truncated or malformed, lacks an array, or what it holds is no
            regular grid of finite numbers.
        GridError
            The order is none.
        """
        check_order(order)
        axes, values, names, is_distortion = read_grid(Path(path))
        make = cls.from_distortion if is_distortion else cls
        try:
            return make(axes, values, order, names)
        except GridError as error:
            raise FileFormatError(f"{path}: {error}") from None

    def save(self, path: str | Path) -> None:
        """Write an NPZ file that `read` reads back."""
        lines = {f"axis_{name}": axis for name, axis in zip(self.names, self.axes, strict=True)}
        content: dict[str, Any] = {
            "coframe": self.coframe,
            "names": np.array(self.names),
            **lines,
        }
        np.savez_compressed(path, **content)

    # -- what it is -------------------------------------------------------------------------------

    @property
    def dimension(self) -> int:
        """Number of axes."""
        return len(self.axes)

    @property
    def rows(self) -> int:
        """Number of frame indices."""
        return len(self.coframe)

    @cached_property
    def steps(self) -> tuple[float, ...]:
        """Spacing of each axis; negative where it decreases."""
        return tuple(float(axis[-1] - axis[0]) / (len(axis) - 1) for axis in self.axes)

    @property
    def other_order(self) -> int:
        """The order against which errors are measured."""
        return self.order - 2 if self.order > 2 else 4

    # -- closure ----------------------------------------------------------------------------------

    def plaquettes(self, plane: tuple[int, int] = (0, 1)) -> Plaquettes:
        """Burgers vector of every cell in a coordinate plane, by integrals along its four edges.

        Neighbouring cells share edges, so that the sum over a region is the loop round it.

        Raises
        ------
        GridError
            The plane does not name two different axes.
        """
        a, b = self._plane(plane)
        area = self.steps[a] * self.steps[b]
        # Along a decreasing axis the cells are run round the other way.
        vectors = np.sign(area) * self._cells(a, b, self.order)
        errors = np.abs(vectors - np.sign(area) * self._cells(a, b, self.other_order)).max(axis=0)
        scale = np.abs(self._bent).max() * max(abs(self.steps[a]), abs(self.steps[b]))
        return Plaquettes(vectors, errors + 2.0**-50 * scale, abs(area), (a, b))

    def _cells(self, a: int, b: int, order: int) -> np.ndarray:
        """Closure of all cells, by quadrature of one order along the edges."""
        along_a, along_b = (
            self.steps[k] * applied(integration(order, len(self.axes[k])), self._bent[:, k], 1 + k)
            for k in (a, b)
        )
        return np.diff(along_b, axis=1 + a) - np.diff(along_a, axis=1 + b)

    @cached_property
    def _bent(self) -> np.ndarray:
        """The coframe without its mean: constant parts close exactly, and need not be rounded."""
        inner = tuple(range(2, self.coframe.ndim))
        return self.coframe - self.coframe.mean(axis=inner, keepdims=True)

    def torsion(self, plane: tuple[int, int] = (0, 1)) -> tuple[np.ndarray, np.ndarray]:
        """Torsion 2 S_ab^i = d_a e^i_b - d_b e^i_a at the nodes, and its error.

        Returns arrays of shape (rows, N_1, ..., N_d): the values, and their distance from
        differences of another order.
        """
        a, b = self._plane(plane)
        fine, other = (self._curl(a, b, order) for order in (self.order, self.other_order))
        return fine, np.abs(fine - other)

    def _curl(self, a: int, b: int, order: int) -> np.ndarray:
        """d_a e_b - d_b e_a by differences of one order."""
        one, two = (
            applied(differentiation(order, len(self.axes[k])), self._bent[:, m], 1 + k)
            / self.steps[k]
            for k, m in ((a, b), (b, a))
        )
        return one - two

    @cached_property
    def nye(self) -> np.ndarray:
        """Nye tensor alpha^{ik} = eps^{kab} d_a e^i_b, shape (rows, 3, N_1, N_2, N_3).

        b^i of a small area with normal n_k is alpha^{ik} n_k A. On a plane grid (two axes) only
        k = 2 is known, and the shape is (rows, 1, N_1, N_2).
        """
        if self.dimension == 2:
            return self.torsion((0, 1))[0][:, None]
        if self.dimension != 3:
            raise GridError(
                f"the Nye tensor belongs to two or three dimensions, the grid has {self.dimension}."
                " Use .torsion(plane)."
            )
        return np.stack([self.torsion(pair)[0] for pair in ((1, 2), (2, 0), (0, 1))], axis=1)

    @cached_property
    def cochain(self) -> Cochain:
        """The integral of the coframe along every edge of the grid, on the complex of the grid.

        Its coboundary holds the Burgers vectors of all cells in all planes. Edges run as the axes
        are listed.

        Examples
        --------
        >>> import numpy as np
        >>> axes = [np.linspace(0, 4, 5)] * 2
        >>> x, y = np.meshgrid(*axes, indexing="ij")
        >>> grid = SampledFrame(axes, np.array([[-y, x]]) / 2, order=2)
        >>> grid.cochain.coboundary().values.round(12).ravel().tolist() == [1.0] * 16
        True
        """
        found, errors = [], []
        for k, axis in enumerate(self.axes):
            fine, other = (
                self.steps[k] * applied(integration(order, len(axis)), self.coframe[:, k], 1 + k)
                for order in (self.order, self.other_order)
            )
            found.append(fine.reshape(self.rows, -1).T)
            errors.append(np.abs(fine - other).max(axis=0).ravel())
        values = np.concatenate(found)
        rounding = 2.0**-50 * np.abs(values).max(axis=1)
        made = Complex.grid([len(axis) for axis in self.axes])
        return Cochain(made, values, np.concatenate(errors) + rounding)

    def along_edges(self, starts: np.ndarray, ends: np.ndarray) -> EdgeIntegrals:
        """Integrals along straight edges through the grid, shape (edges, d) each, for networks.

        Raises
        ------
        GridError
            An edge leaves the grid; the message names the point.
        """
        return sampled_edges(self, starts, ends)

    def burgers(self, loop: Loop) -> SampledBurgers:
        """Burgers vector of a loop through the grid, with interpolation and quadrature error.

        Raises
        ------
        GridError
            The loop leaves the grid, or has another dimension; the message names the point.
        """
        return sampled_burgers(self, loop)

    def _plane(self, plane: Sequence[int]) -> tuple[int, int]:
        """Two different axes."""
        pair = tuple(plane) if hasattr(plane, "__len__") else ()
        if len(pair) != 2 or pair[0] == pair[1] or not set(pair) <= set(range(self.dimension)):
            raise GridError(
                f"plane: two different axes from 0 to {self.dimension - 1} were needed, but "
                f"{plane!r} came."
            )
        return pair[0], pair[1]

    def __repr__(self) -> str:
        sizes = " x ".join(str(len(axis)) for axis in self.axes)
        return f"SampledFrame({sizes} nodes, {self.rows} rows, order {self.order})"


# Gauss points on each stretch: enough for the highest order of interpolation.
GAUSS = max(ORDERS) // 2 + 2
# A loop may leave the grid by this share of a step: rounding of its own coordinates.
SLACK = 1e-9


@dataclass(frozen=True, eq=False)
class SampledBurgers:
    """Burgers vector of a loop through a sampled frame.

    vector: b^i, shape (rows,).
    interpolation_error: distance from the result with interpolation of another order.
    quadrature_error: distance from the result with half as many stretches.
    order: order of the interpolation; evaluations: points at which it was taken.
    """

    vector: np.ndarray
    interpolation_error: float
    quadrature_error: float
    order: int
    evaluations: int

    @property
    def error(self) -> float:
        """Both errors together."""
        return self.interpolation_error + self.quadrature_error

    def in_convention(self, name: str) -> np.ndarray:
        """The vector in another convention of sign, such as "FS/RH"; see `conventions.burgers`.

        Raises
        ------
        UnknownNameError
            No convention has this name; the message lists them.
        """
        return burgers(self.vector, name)


def sampled_burgers(grid: SampledFrame, loop: Loop) -> SampledBurgers:
    """The integral of the interpolated coframe along a loop; see SampledFrame.burgers."""
    if loop.dimension != grid.dimension:
        raise GridError(
            f"the loop has {loop.dimension} coordinates, the grid {grid.dimension} axes: give a "
            "loop in the coordinates of the grid."
        )
    found = np.zeros((3, grid.rows))
    evaluations = 0
    for part in loop.parts:
        for arc in part.arcs:
            count = _stretches(grid, part, arc)
            # On the coarse points: how the order matters. On the fine ones: the result.
            places, slopes, weights = _points(grid, part, arc, 2 * count)
            fine = _sum(grid, places, slopes, weights, grid.order)
            other = _sum(grid, places, slopes, weights, grid.other_order)
            coarse = _sum(grid, *_points(grid, part, arc, count), grid.order)
            found += part.times * np.array([fine, other, coarse])
            evaluations += 5 * count * GAUSS
    fine, other, coarse = found
    # Order 2 is compared with a better one: its own error is that distance, give or take a little.
    safety = 4 / 3 if grid.order < grid.other_order else 1.0
    return SampledBurgers(
        fine,
        safety * float(np.abs(fine - other).max()),
        float(np.abs(fine - coarse).max()) + 2.0**-50 * float(np.abs(grid._bent).max()) * loop.size,
        grid.order,
        evaluations,
    )


def _stretches(grid: SampledFrame, part: Part, arc: Arc) -> int:
    """How many stretches an arc needs so that each stays within a part of a cell."""
    count = max(65, 16 * arc.waves + 1)
    points, _ = part.points(arc, np.linspace(0, 1, count))
    steps = np.abs(np.diff(points, axis=1)) / np.abs(np.array(grid.steps))[:, None]
    # Two for each cell that it crosses: one alone may hold the kink between two cells.
    return max(4, math.ceil(2 * float(steps.sum(axis=1).max())), 4 * arc.waves)


def _points(
    grid: SampledFrame, part: Part, arc: Arc, count: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places in units of the grid, slopes and weights of a composite Gauss rule."""
    x, w = np.polynomial.legendre.leggauss(GAUSS)
    s = ((np.arange(count)[:, None] + (x + 1) / 2) / count).ravel()
    weights = np.tile(w / 2, count) / count
    points, slopes = part.points(arc, s)
    return _places(grid, points, "loop"), slopes, weights


def _places(grid: SampledFrame, points: np.ndarray, what: str) -> np.ndarray:
    """Points of shape (d, k) in units of the grid; those that leave it are refused."""
    places = np.array(
        [
            (row - axis[0]) / step
            for row, axis, step in zip(points, grid.axes, grid.steps, strict=True)
        ]
    )
    last = np.array([len(axis) - 1 for axis in grid.axes])[:, None]
    outside = (places < -SLACK) | (places > last + SLACK) | ~np.isfinite(places)
    if outside.any():
        axis, k = (int(i) for i in np.argwhere(outside)[0])
        low, high = sorted((float(grid.axes[axis][0]), float(grid.axes[axis][-1])))
        raise GridError(
            f"the {what} leaves the grid at {shown(points[:, k])}: axis {grid.names[axis]} runs "
            f"from {low:.6g} to {high:.6g}. Choose a smaller {what}; nothing is extrapolated."
        )
    return np.clip(places, 0, last)


def sampled_edges(grid: SampledFrame, starts: np.ndarray, ends: np.ndarray) -> EdgeIntegrals:
    """The integrals of the interpolated coframe along edges; see SampledFrame.along_edges."""
    steps = ends - starts
    crossed = (np.abs(steps) / np.abs(np.array(grid.steps))).sum(axis=1)
    # Two stretches for each cell that is crossed, as along a loop.
    counts = np.maximum(1, np.ceil(2 * crossed).astype(int))
    nodes, weights = np.polynomial.legendre.leggauss(GAUSS)
    nodes, weights = (nodes + 1) / 2, weights / 2

    def summed(order: int, share: int) -> np.ndarray:
        stretches = share * counts
        owner = np.repeat(np.arange(len(starts)), stretches)
        number = np.arange(len(owner)) - np.repeat(np.cumsum(stretches) - stretches, stretches)
        s = ((number[:, None] + nodes) / stretches[owner][:, None]).ravel()
        edge = np.repeat(owner, GAUSS)
        weight = np.tile(weights, len(owner)) / stretches[edge]
        places = _places(grid, (starts[edge] + s[:, None] * steps[edge]).T, "edge")
        flat = grid.coframe.reshape(-1, *grid.coframe.shape[2:])
        values = interpolated(flat, places, order).reshape(grid.rows, grid.dimension, -1)
        each = np.einsum("imk,km,k->ik", values, steps[edge], weight)
        return np.stack([np.bincount(edge, row, len(starts)) for row in each], axis=1)

    fine, other, coarse = summed(grid.order, 2), summed(grid.other_order, 2), summed(grid.order, 1)
    errors = np.abs(fine - other).max(axis=1) + np.abs(fine - coarse).max(axis=1)
    rounding = 2.0**-50 * np.abs(fine).max(axis=1)
    return EdgeIntegrals(fine, errors + rounding, 5 * int(counts.sum()) * GAUSS)


def _sum(
    grid: SampledFrame, places: np.ndarray, slopes: np.ndarray, weights: np.ndarray, order: int
) -> np.ndarray:
    """The integral along one arc; the mean coframe is left out, it closes exactly."""
    n = grid.dimension
    flat = grid._bent.reshape(grid.rows * n, *grid._bent.shape[2:])
    values = interpolated(flat, places, order).reshape(grid.rows, n, -1)
    return np.einsum("imk,mk,k->i", values, slopes, weights)
