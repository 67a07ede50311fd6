"""Sampled: a coframe known on a regular grid, such as a measured distortion field."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion import checks
from geomtorsion.errors import LONGEST_SHOWN, FileFormatError, GridError
from geomtorsion.loops.arcs import Parameters
from geomtorsion.loops.cochain import Cochain
from geomtorsion.loops.edges import EdgeIntegrals
from geomtorsion.loops.fields import cells, holes
from geomtorsion.loops.fields.cells import Plaquettes
from geomtorsion.loops.fields.circuits import (
    Field,
    SampledBurgers,
    sampled_burgers,
)
from geomtorsion.loops.fields.edges import edge_cochain, sampled_edges
from geomtorsion.loops.fields.grid import (
    Grid,
    check_names,
    check_order,
    check_shape,
    check_values,
    mask_of,
    numbers,
    periodic_axes,
    regular_axis,
)
from geomtorsion.loops.fields.holes import Hole
from geomtorsion.loops.fields.noise import estimated, sigma_of
from geomtorsion.loops.forms import forms
from geomtorsion.loops.grid_files import read_grid, save_grid
from geomtorsion.loops.loop import Loop

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame

# What a frame keeps is what came, checked.
KEPT = "axes coframe names mask sigma periodic vector_unit sigma_source".split()


@dataclass(frozen=True, eq=False, repr=False)
class SampledFrame:
    """A coframe on a regular grid, with holes and noise, interpolated by local polynomials.

    axes: coordinates of the grid, one increasing or decreasing array each, equally spaced.
    coframe: e^i_mu at the nodes, shape (rows, d, N_1, ..., N_d): i, mu, then the grid. A plane map
        (d = 2) may hold all three columns; the third one, across the map, enters no circuit.
    order: order of interpolation, quadrature and differences in the spacing: 2, 4, 6 or 8. Every
        error is measured against another order (the next lower one; for 2 the next higher one).
    names: of the axes.
    mask: True where nothing is known, shape (N_1, ..., N_d); nodes with NaN are holes as well.
        Circuits may surround holes; what touches one is refused (arrays have NaN there). Near a
        hole stencils are one-sided, as at the edge of the grid, or of lower order.
    sigma: standard deviation of the noise of each value, independent from value to value: a number,
        an array of the shape of the grid, of (rows, d) or of the coframe; or "estimate", from the
        data: the median of differences of sixth order (`noise.estimated`). Every error then
        contains the noise, propagated along the very circuit.
    periodic: one truth value for each axis, or names of axes; the period is N steps, so that the
        first node is not repeated at the end.
    sigma_source: where sigma comes from, in words.
    unit, vector_unit: of the axes, and of what integrals of the coframe are (if not given, the
        same); any text, shown with results.

    Raises
    ------
    GridError
        Shapes do not fit, an axis is not regular or too short, a value is infinite, nothing is
        known, or sigma is negative.

    Examples
    --------
    >>> import numpy as np
    >>> axes = [np.linspace(-1, 1, 9), np.linspace(-1, 1, 11)]
    >>> x, y = np.meshgrid(*axes, indexing="ij")
    >>> distortion = np.array([[-y, x]]) / 2      # e = dx^i + (x dy - y dx) / 2: torsion 1
    >>> grid = SampledFrame(axes, distortion)
    >>> grid.plaquettes().density.round(12).min(), grid.plaquettes().density.round(12).max()
    (np.float64(1.0), np.float64(1.0))

    A hole in the middle, and noise:

    >>> hole = np.hypot(x, y) < 0.3
    >>> grid = SampledFrame(axes, distortion, mask=hole, sigma=1e-3, unit="um")
    >>> grid
    SampledFrame(9 x 11 nodes, 1 rows, order 4, 1 hole of 5 nodes, sigma 0.001, in um)
    >>> b = grid.burgers(grid.loop_around(grid.holes[0]))
    >>> b.vector.round(9), round(b.noise, 6), b.unit
    (array([0.8]), 0.000868, 'um')
    """

    axes: Sequence[np.ndarray]
    coframe: np.ndarray
    order: int = 4
    names: Sequence[str] = ()
    # These come in several kinds; kept are arrays, and one truth value for each axis.
    mask: Any = field(default=None, kw_only=True)
    sigma: Any = field(default=None, kw_only=True)
    periodic: Any = field(default=(), kw_only=True)
    unit: str = field(default="", kw_only=True)
    vector_unit: str = field(default="", kw_only=True)
    sigma_source: str = field(default="", init=False)

    def __post_init__(self) -> None:
        """Check axes and values once."""
        check_order(self.order)
        names = tuple(self.names) or tuple("xyzuvw"[: len(self.axes)])
        check_names(self.axes, names)
        values = numbers(self.coframe, "coframe")
        axes = tuple(regular_axis(x, name) for x, name in zip(self.axes, names, strict=True))
        shape = tuple(len(axis) for axis in axes)
        check_shape(values, shape)
        wraps = periodic_axes(self.periodic, names)
        inner = values[:, : len(axes)]
        unknown = mask_of(self.mask, shape) | np.isnan(inner).any(axis=(0, 1))
        grid = Grid(axes, names, wraps, unknown)
        grid.check_length(self.order, self.other_order)
        check_values(values, grid)
        if grid.has_holes:
            values = np.where(unknown, np.nan, values)
        for key in ("unit", "vector_unit"):
            checks.text(getattr(self, key), key, GridError, longest=LONGEST_SHOWN)
        sigma, said = self.sigma, ""
        if isinstance(sigma, str):
            checks.choice(sigma, ["estimate"], "sigma", GridError)
            sigma = estimated(inner, grid)
            said = "the median of sixth differences along the axes"
        elif sigma is not None:
            sigma = sigma_of(sigma, (len(values), len(axes), *shape), grid)
            said = "given"
        found = (axes, values, names, unknown, sigma, wraps, self.vector_unit or self.unit, said)
        for key, value in zip(KEPT, found, strict=True):
            object.__setattr__(self, key, value)

    # -- makers -----------------------------------------------------------------------------------

    @classmethod
    def from_distortion(
        cls,
        axes: Sequence[np.ndarray],
        distortion: np.ndarray,
        order: int = 4,
        names: Sequence[str] = (),
        **options: Any,
    ) -> SampledFrame:
        """From a distortion beta^i_mu = d_mu u^i (row: displacement, column: derivative).

        The coframe is e = 1 + beta: it maps a step in the crystal as it is to the ideal lattice
        when u points from the real to the ideal place. For displacements from ideal to real places
        give -beta (small distortions), or the inverse of (1 + beta) minus 1.

        options: mask, sigma, periodic, unit, vector_unit, as for `SampledFrame`.
        """
        values = numbers(distortion, "distortion")
        if values.ndim < 3:
            raise GridError(
                f"distortion: shape (rows, columns, grid...) was needed, but {values.shape} came."
            )
        unit = np.eye(*values.shape[:2]).reshape(*values.shape[:2], *(1,) * (values.ndim - 2))
        return cls(axes, values + unit, order, names, **options)

    @classmethod
    def from_frame(
        cls,
        frame: Frame,
        axes: Sequence[np.ndarray],
        order: int = 4,
        *,
        parameters: Parameters | None = None,
        **options: Any,
    ) -> SampledFrame:
        """Samples of an exact frame, one axis for each coordinate.

        options: mask, sigma, periodic, unit, vector_unit, as for `SampledFrame`.

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
        names = tuple(symbol.name for symbol in frame.coordinates)
        return cls(lines, values, order, names, **options)

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
        axes, values, names, is_distortion, options = read_grid(Path(path))
        make = cls.from_distortion if is_distortion else cls
        try:
            return make(axes, values, order, names, **options)
        except GridError as error:
            raise FileFormatError(f"{path}: {error}") from None

    def save(self, path: str | Path) -> None:
        """Write an NPZ file that `read` reads back."""
        save_grid(Path(path), self)

    # -- what it is -------------------------------------------------------------------------------

    @cached_property
    def _grid(self) -> Grid:
        """Axes and holes."""
        return Grid(tuple(self.axes), tuple(self.names), self.periodic, self.mask)

    @cached_property
    def _field(self) -> Field:
        """The values as integrals use them."""
        d, grid = self.dimension, self._grid
        inner = tuple(range(2, 2 + d))
        values = self.coframe[:, :d]
        if grid.has_holes:
            mean = values.mean(axis=inner, keepdims=True, where=~grid.holes)
            bent = np.where(grid.holes, 0.0, values - mean)
        else:
            mean = values.mean(axis=inner, keepdims=True)
            bent = values - mean
        variances = None
        if isinstance(self.sigma, np.ndarray):
            ones = (1,) * d
            shape = (*values.shape[:2], *(grid.shape if self.sigma.shape[2:] != ones else ones))
            variances = np.broadcast_to(self.sigma**2, shape)
        flat = mean.reshape(mean.shape[:2])
        return Field(grid, bent, flat, variances, self.order, self.other_order)

    @property
    def dimension(self) -> int:
        """Number of axes."""
        return len(self.axes)

    @property
    def rows(self) -> int:
        """Number of frame indices."""
        return len(self.coframe)

    @property
    def steps(self) -> tuple[float, ...]:
        """Spacing of each axis; negative where it decreases."""
        return self._grid.steps

    @property
    def other_order(self) -> int:
        """The order against which errors are measured."""
        return self.order - 2 if self.order > 2 else 4

    # -- holes ------------------------------------------------------------------------------------

    @cached_property
    def holes(self) -> tuple[Hole, ...]:
        """Connected nodes of which nothing is known, in the order of their first nodes."""
        return holes.holes_of(self._grid)

    def loop_around(
        self,
        hole: Hole | int | None = None,
        margin: int = 1,
        plane: tuple[int, int] = (0, 1),
        at: Sequence[int] | None = None,
    ) -> Loop:
        """A rectangle along lines of nodes that surrounds a hole.

        Parameters
        ----------
        hole
            One of `holes`, or its number; not needed where there is one.
        margin
            Nodes between the hole and the rectangle, the rectangle counted.
        plane
            The two axes, turned from the first to the second.
        at
            Number of the node on each axis where the rectangle lies, for grids of three axes or
            more; the entries of the plane do not count. Without it the middle of the hole.

        Raises
        ------
        GridError
            There is no such hole, or the rectangle leaves the grid or touches a hole; the message
            names the nodes.
        """
        pair = self._plane(plane)
        found = holes.chosen_hole(self.holes, hole)
        checks.count(margin, "margin", GridError, 1)
        if at is None:
            at = [(a + b) // 2 for a, b in zip(found.low, found.high, strict=True)]
        else:
            rows = checks.numbers(at, self.dimension, "at", GridError)
            at = [checks.count(x, f"at[{k}]", GridError) for k, x in enumerate(rows)]
        return holes.loop_around(self._grid, found, margin, pair, at)

    # -- closure ----------------------------------------------------------------------------------

    def plaquettes(self, plane: tuple[int, int] = (0, 1)) -> Plaquettes:
        """Burgers vector of every cell in a coordinate plane, by integrals along its four edges.

        Neighbouring cells share edges, so that the sum over a region is the loop round it.

        Raises
        ------
        GridError
            The plane does not name two different axes.
        """
        return self.burgers_map(1, plane)

    def burgers_map(self, size: int | Sequence[int], plane: tuple[int, int] = (0, 1)) -> Plaquettes:
        """Burgers vectors of rectangular circuits of one size at every place, with their noise.

        A circuit may surround a hole, but not touch one. The cost hardly grows with the size.

        Parameters
        ----------
        size
            Cells along the sides: one number for squares, or one for each axis of the plane.

        Raises
        ------
        GridError
            The size is no whole number, or larger than the grid.

        Examples
        --------
        >>> axes = [np.arange(6.0)] * 2
        >>> x, y = np.meshgrid(*axes, indexing="ij")
        >>> grid = SampledFrame(axes, np.array([[-y, x]]) / 2)
        >>> found = grid.burgers_map(3)
        >>> found.vectors.shape, found.vectors.round(12).max(), found.density.round(12).max()
        ((1, 3, 3), np.float64(9.0), np.float64(1.0))
        """
        pair = self._plane(plane)
        given = checks.rows(size)
        sides = list(given) if isinstance(given, list | tuple) else [given] * 2
        if len(sides) != 2:
            raise GridError(f"size: one number or two were needed, but {checks.shown(size)} came.")
        for k, side in zip(pair, sides, strict=True):
            checks.count(side, "size", GridError, 1, len(self.axes[k]) - 1)
        units = (self.unit, self.vector_unit)
        return cells.circuits(self._field, pair, (int(sides[0]), int(sides[1])), units)

    def torsion(self, plane: tuple[int, int] = (0, 1)) -> tuple[np.ndarray, np.ndarray]:
        """Torsion 2 S_ab^i = d_a e^i_b - d_b e^i_a at the nodes, and its error.

        Returns arrays of shape (rows, N_1, ..., N_d): the values, and their distance from
        differences of another order, with the noise where sigma is known. NaN at nodes that have
        not three known nodes in a row.
        """
        curl, difference, sigmas = cells.torsion(self._field, self._plane(plane))
        return curl, np.hypot(difference, sigmas) if self.sigma is not None else difference

    @cached_property
    def nye(self) -> np.ndarray:
        """Nye tensor alpha^{ik} = eps^{kab} d_a e^i_b, shape (rows, 3, N_1, N_2, N_3).

        b^i of a small area with normal n_k is alpha^{ik} n_k A. On a plane grid (two axes) only
        k = 2 is known, and the shape is (rows, 1, N_1, N_2).
        """
        return np.stack([self.torsion(pair)[0] for pair in self._nye_planes], axis=1)

    @cached_property
    def nye_noise(self) -> np.ndarray:
        """Standard deviation of the Nye tensor by noise, its floor; zero without sigma."""
        found = [cells.torsion(self._field, pair)[2] for pair in self._nye_planes]
        return np.stack(found, axis=1)

    @property
    def _nye_planes(self) -> tuple[tuple[int, int], ...]:
        """The planes of the components of the Nye tensor."""
        if self.dimension == 2:
            return ((0, 1),)
        if self.dimension != 3:
            raise GridError(
                f"the Nye tensor belongs to two or three dimensions, the grid has {self.dimension}."
                " Use .torsion(plane)."
            )
        return ((1, 2), (2, 0), (0, 1))

    def gnd_density(self, burgers: float) -> tuple[np.ndarray, np.ndarray]:
        """Density of geometrically necessary dislocations, and its noise floor.

        rho = sqrt(sum alpha^{ik} alpha^{ik}) / b, a lower bound where only some components are
        known; the floor is sqrt(sum sigma^2) / b, what noise alone makes of it in the root mean
        square. Shape (N_1, ..., N_d) each, in lines per square of the unit of length.

        Parameters
        ----------
        burgers
            Length of the Burgers vector, in `vector_unit`.
        """
        b = checks.positive(burgers, "burgers", GridError)
        both = (self.nye, self.nye_noise)
        values, floor = (np.sqrt((x**2).sum(axis=(0, 1))) / b for x in both)
        return values, floor

    @cached_property
    def cochain(self) -> Cochain:
        """The integral of the coframe along every edge of the grid, on the complex of the grid.

        Its coboundary holds the Burgers vectors of all cells in all planes. Edges run as the axes
        are listed.

        Raises
        ------
        GridError
            The grid has holes: some edges have no value.

        Examples
        --------
        >>> axes = [np.linspace(0, 4, 5)] * 2
        >>> x, y = np.meshgrid(*axes, indexing="ij")
        >>> grid = SampledFrame(axes, np.array([[-y, x]]) / 2, order=2)
        >>> grid.cochain.coboundary().values.round(12).ravel().tolist() == [1.0] * 16
        True
        """
        if self._grid.has_holes:
            raise GridError(
                "cochain: a value on every edge is needed, but the grid has holes. Use "
                ".plaquettes() or .burgers(loop)."
            )
        return edge_cochain(self._field)

    def along_edges(self, starts: np.ndarray, ends: np.ndarray) -> EdgeIntegrals:
        """Integrals along straight edges through the grid, shape (edges, d) each, for networks.

        Raises
        ------
        GridError
            An edge leaves the grid or touches a hole; the message names the point.
        """
        return sampled_edges(self._field, starts, ends)

    def burgers(self, loop: Loop) -> SampledBurgers:
        """Burgers vector of a loop through the grid, with its errors: grid and noise.

        Raises
        ------
        GridError
            The loop leaves the grid, touches a hole, or has another dimension; the message names
            the point and the nodes.
        """
        checks.instance(loop, Loop, "loop")
        return sampled_burgers(self._field, loop, self.vector_unit)

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
        parts = [f"{' x '.join(map(str, self._grid.shape))} nodes", f"{self.rows} rows"]
        parts.append(f"order {self.order}")
        if any(self.periodic):
            wraps = [n for n, wraps in zip(self.names, self.periodic, strict=True) if wraps]
            parts.append(f"periodic in {', '.join(wraps)}")
        if self.holes:
            count, nodes = len(self.holes), int(np.count_nonzero(self.mask))
            parts.append(f"{count} hole{'s' * (count > 1)} of {nodes} node{'s' * (nodes > 1)}")
        if isinstance(self.sigma, np.ndarray):
            low, high = (f"{x:.2g}" for x in (self.sigma.min(), self.sigma.max()))
            parts.append(f"sigma {low}" + (f" to {high}" if high != low else ""))
        if self.unit:
            other = self.vector_unit != self.unit
            parts.append(f"in {self.unit}" + (f", b in {self.vector_unit}" if other else ""))
        return f"SampledFrame({', '.join(parts)})"
