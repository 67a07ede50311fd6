"""Sampled: a coframe known on a regular grid, such as a measured distortion field."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from geomtorsion.errors import GridError
from geomtorsion.loops import Cochain, EdgeIntegrals, Loop
from geomtorsion.materials.burgers import PLANE, Burgers, Section
from geomtorsion.materials.detours import detour_of
from geomtorsion.materials.fields import cells, holes
from geomtorsion.materials.fields.densities import Density, incompatibility_of
from geomtorsion.materials.fields.displaced import (
    displaced_burgers,
    displaced_cochain,
    displaced_edges,
    displaced_torsion,
    polygon_sums,
)
from geomtorsion.materials.fields.exact_interpolants import interpolant_of
from geomtorsion.materials.fields.grid import two_axes
from geomtorsion.materials.fields.grid_circuits import (
    Measured,
    edge_cochain,
    sampled_burgers,
    sampled_edges,
    unexplained,
)
from geomtorsion.materials.fields.grid_geometry import at_two_steps
from geomtorsion.materials.fields.holes import Hole
from geomtorsion.materials.fields.metrics import orthonormal_coframe
from geomtorsion.materials.fields.samples import Samples
from geomtorsion.materials.fields.stretches import detoured
from geomtorsion.materials.fields.surveys import survey_of
from geomtorsion.materials.source import Backdrop
from geomtorsion.materials.survey import Survey
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property


@dataclass(frozen=True, eq=False, repr=False)
class SampledFrame(Samples):
    """A coframe on a regular grid, with holes and noise, interpolated by local polynomials.

    axes: coordinates of the grid, one increasing or decreasing array each, equally spaced.
    coframe: e^i_mu at the nodes, shape (rows, d, N_1, ..., N_d): i, mu, then the grid. A plane map
        (d = 2) may hold all three columns; circuits do not use the third column, normal to the map.
    order: order of interpolation, quadrature and differences in the spacing: 2, 4, 6 or 8. Errors
        come from the comparison with another order (the next lower one; for 2, the next higher
        one).
    names: of the axes.
    mask: True where nothing is known, shape (N_1, ..., N_d); nodes with NaN are also holes.
        Circuits may surround holes. A circuit that meets a hole follows the ring of nodes around
        it, see `Burgers.detour`, or is refused where the rings would cover more than half of its
        area or the hole reaches the edge of the grid (in surveys, a larger square or NaN). Near a
        hole, stencils are one-sided, as at the edge of the grid, or of lower order.
    sigma: standard deviation of the noise of each value, independent for all values: a number, or
        an array of the shape of the grid, of (rows, d) or of the coframe; or "estimate", from the
        median of differences of sixth order in the data (`noise.estimated`). Errors then include
        the noise, propagated along the circuit.
    periodic: one truth value for each axis, or names of axes. The period is N steps, so that the
        first node is not repeated at the end.
    source, sigma_source: origin of the values and of sigma, in words.
    displacement: the displacement given to `from_displacement`. Circuits are then sums of its
        jumps, without interpolation.
    signature: signs of the rows of the coframe, such as "-+++"; all + by default.
    unit, vector_unit: of the axes, and of integrals of the coframe (by default the same); any text,
        shown with results.

    Raises
    ------
    GridError
        Shapes do not fit, an axis is irregular or too short, a value is infinite, all values are
        unknown, or sigma is negative.

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
    SampledFrame(9 x 11 nodes, 1 row, order 4, 1 hole of 5 nodes, sigma 0.001, in um)
    >>> b = grid.burgers(grid.loop_around(grid.holes[0]))
    >>> b.vector.round(9), round(b.noise, 6), b.unit
    (array([0.8]), 0.000868, 'um')
    """

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
            One of `holes`, or its number; optional if there is only one hole.
        margin
            Nodes from the hole to the rectangle, including the rectangle.
        plane
            The two axes; the rectangle turns from the first to the second.
        at
            Node number of the rectangle on each axis, for grids of three axes or more; the entries
            of the plane are ignored. The default is the middle of the hole.

        Raises
        ------
        GridError
            There is no such hole, or the rectangle leaves the grid or touches a hole; the message
            names the nodes.
        """
        pair = two_axes(plane, self.dimension)
        target = holes.chosen_hole(self.holes, hole)
        checks.count(margin, "margin", GridError, 1)
        if at is None:
            at = [(a + b) // 2 for a, b in zip(target.low, target.high, strict=True)]
        else:
            rows = checks.numbers(at, self.dimension, "at", GridError)
            at = [checks.count(x, f"at[{k}]", GridError) for k, x in enumerate(rows)]
        return holes.loop_around(self._grid, target, margin, pair, at)

    @property
    def description(self) -> tuple[str, ...]:
        """Lines of text about the size, the noise and the source of the frame."""
        noise = self.sigma_source or "not known; the errors include only the grid error"
        source = (f"source: {self.source}",) if self.source else ()
        return (repr(self), f"noise: {noise}", *source)

    # -- geometry ---------------------------------------------------------------------------------

    @classmethod
    def from_metric(
        cls,
        axes: Sequence[np.ndarray],
        metric: np.ndarray,
        order: int = 4,
        names: Sequence[str] = (),
        *,
        signature: str = "",
        **options: Any,
    ) -> SampledFrame:
        """Samples of a metric g_mu_nu, shape (d, d, N_1, ..., N_d), of any signature.

        The coframe is orthonormal, g = e^T eta e, and as smooth as the metric. Its rotation or
        boost is a choice: only quantities of the metric, such as curvature, do not depend on it.

        Parameters
        ----------
        signature
            Signs of the rows, such as "-+++"; by default negative ones first.
        options
            mask, periodic, unit, vector_unit, source, as for `SampledFrame`.

        Raises
        ------
        GridError
            The metric is not symmetric, or is degenerate at a node that is not masked.
        SignatureError
            The metric has another signature.

        Examples
        --------
        >>> theta, phi = np.linspace(0.5, 2.5, 21), np.linspace(0, 1, 9)
        >>> sine = np.sin(theta)[:, None] * np.ones(9)
        >>> one, zero = np.ones((21, 9)), np.zeros((21, 9))
        >>> metric = np.array([[one, zero], [zero, sine**2]])
        >>> sphere = SampledFrame.from_metric([theta, phi], metric, names=("theta", "phi"))
        >>> found = sphere.quantity("scalar_curvature")
        >>> bool((abs(found.values - 2) <= found.error).all())
        True
        """
        coframe, signs = orthonormal_coframe(metric, signature, options.get("mask"))
        return cls(axes, coframe, order, names, signature=signs, **options)

    def quantity(self, name: str) -> Density:
        """A named tensor of this frame at the nodes, with its error, as `Frame.quantity`.

        Examples are riemann, ricci, scalar_curvature, christoffel, torsion and contortion.
        Derivatives come from polynomials through `order` + 1 nodes, one-sided at edges and holes.
        The error comes from twice the step: inside by Richardson's rule with the safety factor 3
        [Roache 1994], near edges and holes the whole difference. Noise makes it larger. Values have
        shape (d, ..., N_1, ..., N_d), with indices as in the exact tensor, and NaN at holes.

        Raises
        ------
        UnknownNameError
            There is no quantity of this name.
        GridError
            The numbers of rows and axes differ, or the grid is too small for twice the step.
        SingularPointError
            The coframe is singular at a node.

        Examples
        --------
        >>> axes = [np.linspace(1, 2, 12), np.linspace(0, 1, 12)]
        >>> r, phi = np.meshgrid(*axes, indexing="ij")
        >>> polar = SampledFrame(axes, np.array([[1 + 0 * r, 0 * r], [0 * r, r]]), unit="km")
        >>> polar.quantity("riemann").values.shape, polar.quantity("torsion").unit
        ((2, 2, 2, 2, 12, 12), '1/km')
        """
        return at_two_steps(self, lambda one: {name: one.frame.quantity(name)}).density(name)

    # -- closure ----------------------------------------------------------------------------------

    def plaquettes(self, plane: tuple[int, int] = (0, 1)) -> Survey:
        """Burgers vector of each cell in a coordinate plane, by integrals along its four edges.

        Neighbouring cells share edges, so that the sum over a region equals the loop around it.

        Raises
        ------
        GridError
            The plane does not name two different axes.
        """
        return self.burgers_map(1, plane, widen=False)

    def burgers_map(
        self,
        size: int | Sequence[int],
        plane: tuple[int, int] = (0, 1),
        *,
        widen: bool = True,
    ) -> Survey:
        """Burgers vectors of rectangular circuits of one size at all positions, with their noise.

        Circuits that meet missing nodes go around them, as in `burgers`. The cost hardly grows
        with the size.

        A square whose detour would be longer than itself has no b of its own, for example a cell
        beside a missing core. It is replaced by the smallest larger square around it that has one:
        `survey.sides` is the side of each square, and `area` and `density` refer to it.

        Parameters
        ----------
        size
            Cells along the sides: one number for squares, or one for each axis of the plane.
        widen
            Whether larger squares replace squares without b; otherwise b is NaN there.

        Raises
        ------
        GridError
            The size is not a whole number, or larger than the grid.

        Examples
        --------
        >>> axes = [np.arange(6.0)] * 2
        >>> x, y = np.meshgrid(*axes, indexing="ij")
        >>> grid = SampledFrame(axes, np.array([[-y, x]]) / 2)
        >>> found = grid.burgers_map(3)
        >>> found.vectors.shape, found.vectors.round(12).max(), found.density.round(12).max()
        ((1, 3, 3), np.float64(9.0), np.float64(1.0))

        Cells beside a missing node take the square of 2 x 2 cells around it:

        >>> core = np.hypot(x - 2, y - 2) < 1
        >>> survey = SampledFrame(axes, np.array([[-y, x]]) / 2, mask=core).burgers_map(1)
        >>> survey.sides[:4, 2].tolist(), survey.density.round(12).max()
        ([1, 2, 2, 1], np.float64(1.0))
        """
        pair = two_axes(plane, self.dimension)
        entries = checks.rows(size)
        sides = list(entries) if isinstance(entries, list | tuple) else [entries] * 2
        if len(sides) != 2:
            raise GridError(f"size: expected one number or two, got {checks.shown(size)}.")
        for k, side in zip(pair, sides, strict=True):
            checks.count(side, "size", GridError, 1, len(self.axes[k]) - 1)
        whole = int(sides[0]), int(sides[1])
        return survey_of(self, pair, whole, widen=widen)

    def backdrop(self, section: Section = PLANE) -> Backdrop:
        """|b| per area of each cell, in the layer next to the section; holes are blank."""
        survey = self.plaquettes(section.plane)
        others = [k for k in range(self.dimension) if k not in section.plane]
        middle = [float(np.mean(self.axes[k])) for k in others]
        at = [
            int(np.abs(np.asarray(self.axes[k]) - x).argmin())
            for k, x in zip(others, section.at or middle, strict=True)
        ]
        layer = int(np.ravel_multi_index(at, [len(self.axes[k]) for k in others])) if at else 0
        unit = f" ({survey.density_unit})" if survey.density_unit else ""
        where = f", {survey.layers[layer]}" if at else ""
        title = f"|b| per area of each cell{unit}{where}"
        return Backdrop(survey.lines, survey.laid(survey.per_area)[..., layer], "sizes", title)

    def torsion(self, plane: tuple[int, int] = (0, 1)) -> tuple[np.ndarray, np.ndarray]:
        """Torsion 2 S_ab^i = d_a e^i_b - d_b e^i_a at the nodes, and its error.

        Returns arrays of shape (rows, N_1, ..., N_d): the values, and their errors, which combine
        the difference from another order with the noise if sigma is known. Nodes without three
        known nodes in a row have NaN.
        """
        curl, difference, sigmas = self._torsion(two_axes(plane, self.dimension))
        return curl, np.hypot(difference, sigmas) if self.sigma is not None else difference

    @cached_property
    def nye(self) -> np.ndarray:
        """Nye tensor alpha^{ik} = eps^{kab} d_a e^i_b, shape (rows, 3, N_1, N_2, N_3).

        b^i of a small area with normal n_k is alpha^{ik} n_k A. On a plane grid (two axes) only
        k = 2 is known, and the shape is (rows, 1, N_1, N_2).
        """
        if self.displacement is not None:
            return np.stack([self._torsion(pair)[0] for pair in self._nye_planes], axis=1)
        planes = self._nye_planes
        tensor = np.empty((self.rows, len(planes), *self._grid.shape))
        for k, pair in enumerate(planes):
            cells.curl(self._field, pair, tensor[:, k])
        return tensor

    @cached_property
    def nye_noise(self) -> np.ndarray:
        """Standard deviation of the Nye tensor from noise (its noise floor); zero without sigma."""
        sigmas = [self._torsion(pair)[2] for pair in self._nye_planes]
        return np.stack(sigmas, axis=1)

    def _torsion(self, plane: tuple[int, int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Torsion at the nodes, its difference from another order, and its sigma."""
        if self.displacement is not None:
            return displaced_torsion(self._grid, self.rows, self.order, plane)
        return cells.torsion(self._field, plane)

    @property
    def _nye_planes(self) -> tuple[tuple[int, int], ...]:
        """The planes of the components of the Nye tensor."""
        if self.dimension == 2:
            return ((0, 1),)
        if self.dimension != 3:
            raise GridError(
                f"nye: expected a grid of two or three dimensions, got {self.dimension}. Use "
                ".torsion(plane)."
            )
        return ((1, 2), (2, 0), (0, 1))

    def gnd_density(self, burgers: float) -> tuple[np.ndarray, np.ndarray]:
        """Density of geometrically necessary dislocations, and its noise floor.

        rho = sqrt(sum alpha^{ik} alpha^{ik}) / b, a lower bound if only some components are known.
        The noise floor is the root mean square of rho from noise, sqrt(sum sigma^2) / b. Both have
        shape (N_1, ..., N_d), in lines per square of the unit of length.

        Parameters
        ----------
        burgers
            Length of the Burgers vector, in `vector_unit`.
        """
        b = checks.positive(burgers, "burgers", GridError)
        checks.measured(b, "burgers", GridError, is_length=True)
        both = (self.nye, self.nye_noise)
        values, floor = (np.sqrt((x**2).sum(axis=(0, 1))) / b for x in both)
        return values, floor

    @cached_property
    def incompatibility(self) -> Density:
        """Incompatibility eta_kl = eps_kab eps_lcd d_a d_c E_bd of the strain, with its errors.

        E is the symmetric part of the coframe, whose distortion is small. A strain that comes from
        a displacement has eta = 0 [Kroener 1958]. The values have shape (3, 3, N_1, N_2, N_3); on a
        plane grid only k = l = 3 is known, with shape (1, 1, N_1, N_2).

        Raises
        ------
        GridError
            The grid has more than three axes, or the field fewer rows than axes.

        Examples
        --------
        >>> axes = [np.linspace(-1, 1, 9)] * 2
        >>> x, y = np.meshgrid(*axes, indexing="ij")
        >>> strain = np.array([[3 * y**2, 0 * x], [0 * x, x**2]])
        >>> eta = SampledFrame.from_distortion(axes, strain, sigma=1e-3).incompatibility
        >>> eta.values[0, 0].mean().round(9), eta.error[0, 0, 4, 4].round(3)
        (np.float64(8.0), np.float64(0.033))
        """
        return incompatibility_of(self)

    @cached_property
    def cochain(self) -> Cochain:
        """The integral of the coframe along each edge of the grid, on the complex of the grid.

        Its coboundary holds the Burgers vectors of all cells in all planes. Edges run in the
        listed order of the axes. The error of an edge includes one standard deviation of the noise.
        The sum of these errors exceeds the scatter of a circuit; `burgers` and `burgers_map` return
        the scatter.

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
                "cochain: expected a value on every edge, got a grid with holes. Use "
                ".plaquettes() or .burgers(loop)."
            )
        if self.displacement is not None:
            return displaced_cochain(self._grid, self.displacement)
        return edge_cochain(self._field)

    def along_edges(self, starts: np.ndarray, ends: np.ndarray) -> EdgeIntegrals:
        """Integrals along straight edges through the grid, shape (edges, d) each, for networks.

        Errors include one standard deviation of the noise, as in `cochain`.

        Raises
        ------
        GridError
            An edge leaves the grid or touches a hole; the message names the point.
        """
        if self.displacement is not None:
            return displaced_edges(self._field, self.displacement, starts, ends)
        return sampled_edges(self._field, starts, ends)

    def burgers(self, loop: Loop) -> Burgers:
        """Burgers vector of a loop through the grid, with its errors: grid and noise.

        A loop in a plane of nodes that meets missing nodes follows the rings of nodes around them.
        `Burgers.detour` holds these nodes, the change of the area, and the added error.

        Raises
        ------
        GridError
            The loop leaves the grid, touches a hole that it cannot go around, or has another
            dimension; the message names the point and the nodes.
        """
        checks.instance(loop, Loop, "loop")
        if loop.dimension != self.dimension:
            raise GridError(
                f"loop: expected {self.dimension} coordinates, one for each axis of the grid, got "
                f"{loop.dimension}. Give a loop in the coordinates of the grid."
            )
        asked, detour = loop, None
        ways = detoured(self._grid, loop)
        if ways is not None:
            loop = ways.loop
        vector, covariance, systematic = self._measured(loop)
        if ways is not None:
            rings = list(ways.around.values())
            b, variances = polygon_sums(self._field, self.displacement, rings)
            sizes = unexplained(np.abs(b), variances).max(axis=1)
            error = float(sizes @ [ways.passages[hole] for hole in ways.around])
            a, c = ways.plane
            detour = detour_of(
                ways.rings,
                np.array(list(ways.passages)),
                np.array(list(ways.passages.values())),
                float(loop.area[a, c] - asked.area[a, c]),
                [self._grid.steps[k] for k in ways.plane],
                error,
            )
            systematic = systematic | detour.errors
        points, area = loop.points(), loop.area
        section = Section.of(points, area)
        plane = list(section.plane)
        return Burgers(
            vector,
            self.vector_unit,
            covariance,
            systematic,
            name=loop.name or "loop",
            path=np.concatenate([points, points[:, :1]], axis=1)[plane],
            area=float(area[section.plane]),
            arrow=vector[plane] if self.rows > max(plane) else None,
            section=section,
            length_unit=self.unit,
            detour=detour,
            interpolant=interpolant_of(self, loop),
        )

    def _measured(self, loop: Loop) -> Measured:
        """b of a loop that touches no hole, with its covariance and its systematic errors."""
        if self.displacement is not None:
            return displaced_burgers(self._grid, self.displacement, loop)
        return sampled_burgers(self._field, loop)
