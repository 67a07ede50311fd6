"""Samples: the checked values of a coframe on a grid, and the functions that make them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from geomtorsion.errors import LONGEST_SHOWN, FileFormatError, GridError
from geomtorsion.loops import Parameters, forms
from geomtorsion.materials.columns import checked_columns
from geomtorsion.materials.fields.contents import TEXTS, Contents
from geomtorsion.materials.fields.displacement import Displacement, checked_height, displacement_of
from geomtorsion.materials.fields.grid import (
    REGULAR,
    Grid,
    check_length,
    check_names,
    check_order,
    check_shape,
    check_values,
    mask_of,
    numbers,
    other_order,
    periodic_axes,
    regular_axis,
    signs_of,
)
from geomtorsion.materials.fields.grid_circuits import Field
from geomtorsion.materials.fields.grid_files import holds_covariance, read_grid, save_grid
from geomtorsion.materials.fields.holes import Hole, holes_of
from geomtorsion.materials.fields.missing import with_holes
from geomtorsion.materials.fields.noise import Noise, estimated, noise_of, sigma_of
from geomtorsion.materials.fields.quantities import QUANTITIES, quantity
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.files import written
from geomtorsion.support.outgoing import count_text

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame


# Fields of a frame, which are replaced by their checked values.
KEPT = "axes coframe names mask periodic vector_unit sigma covariance noise sigma_source".split()


@dataclass(frozen=True, eq=False, repr=False)
class Samples:
    """Values on a grid with holes and noise; the fields are described in `SampledFrame`."""

    axes: Sequence[np.ndarray]
    coframe: np.ndarray
    order: int = 4
    names: Sequence[str] = ()
    # Input of these fields has several types; they are stored as arrays, periodic as truth values.
    mask: Any = field(default=None, kw_only=True)
    sigma: Any = field(default=None, kw_only=True)
    covariance: Any = field(default=None, kw_only=True)
    periodic: Any = field(default=(), kw_only=True)
    unit: str = field(default="", kw_only=True)
    vector_unit: str = field(default="", kw_only=True)
    source: str = field(default="", kw_only=True)
    signature: str = field(default="", kw_only=True)
    displacement: Displacement | None = field(default=None, kw_only=True)
    noise: Noise | None = field(default=None, init=False)
    sigma_source: str = field(default="", init=False)

    def __post_init__(self) -> None:
        """Check axes and values."""
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
        check_length(names, shape, self.order)
        check_values(values, grid)
        if grid.has_holes:
            values = np.where(unknown, np.nan, values)
        for key in ("unit", "vector_unit"):
            checks.text(getattr(self, key), key, GridError, longest=LONGEST_SHOWN)
        signs_of(self.signature, len(values))
        if self.displacement is not None:
            inside = ~unknown
            if not np.array_equal(values[..., inside], self.displacement.coframe[..., inside]):
                raise GridError(
                    "coframe: expected the coframe of the displacement, got another. Make a new "
                    "frame by from_displacement, or by SampledFrame(axes, coframe)."
                )
        noise_values = noise_of(self.sigma, self.covariance, inner, grid)
        unit = self.vector_unit or self.unit
        fields = (axes, values, names, unknown, wraps, unit, *noise_values)
        for key, value in zip(KEPT, fields, strict=True):
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
    ) -> Self:
        """Samples of a distortion beta^i_mu = d_mu u^i (row: displacement, column: derivative).

        The coframe is e = 1 + beta. It maps a step in the real crystal to the ideal lattice if u
        points from the real to the ideal position. For displacements from ideal to real positions,
        give -beta (small distortions), or the inverse of (1 + beta) minus 1.

        options: mask, sigma, periodic, unit, vector_unit, as for `SampledFrame`.
        """
        values = numbers(distortion, "distortion")
        if values.ndim < 3:
            raise GridError(
                f"distortion: expected shape (rows, columns, grid...), got {values.shape}."
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
    ) -> Self:
        """Samples of an exact frame, one axis for each coordinate.

        options: mask, sigma, periodic, unit, vector_unit, as for `SampledFrame`.

        Raises
        ------
        SingularPointError
            The frame has no finite value at a node.
        """
        lines = [numbers(axis, "axis") for axis in axes]
        checks.check_one_each(lines, frame.dimension, "coordinates", "axes", GridError)
        number = math.prod(line.size for line in lines)
        remedy = "Give shorter axes, or sample the region in parts."
        checks.check_room(2 * number * frame.dimension**2, f"axes: {number:,} nodes", remedy)
        coframe = forms(frame, parameters).coframe
        nodes = np.meshgrid(*lines, indexing="ij")
        components = coframe.at(np.array(nodes).reshape(len(nodes), -1))
        values = np.zeros((frame.dimension, frame.dimension, *nodes[0].shape))
        values[coframe.rows, coframe.columns] = components.reshape(-1, *nodes[0].shape)
        names = tuple(symbol.name for symbol in frame.coordinates)
        return cls(lines, values, order, names, **options)

    @classmethod
    def from_displacement(
        cls,
        axes: Sequence[np.ndarray],
        displacement: np.ndarray,
        order: int = 4,
        names: Sequence[str] = (),
        *,
        branch: np.ndarray
        | Sequence[Sequence[float]]
        | Sequence[float]
        | float
        | str
        | None = None,
        height: np.ndarray | None = None,
        **options: Any,
    ) -> Self:
        """Samples of displacements u^i at the nodes, shape (rows, N_1, ..., N_d), which may jump.

        The coframe is e = 1 + d u, as for `from_distortion`. Its integral along an edge is the
        difference of u, without interpolation. If u has no jumps, the differences cancel around
        each circuit, and b is zero for any slope and any noise of u.

        A dislocation makes u jump by a lattice vector across a cut. Declared jumps are subtracted
        on each edge, and b is a sum of whole lattice vectors.

        Parameters
        ----------
        branch
            Lattice vectors by which u may jump, shape (k, rows), one vector, or one length for all
            axes. "find" searches for them: steps of equal size that exceed their neighbours along
            the line, and that form lines. The error of b includes the error of the vectors found,
            and `source` lists them. Slip bands can have the same pattern; the values do not
            distinguish them from jumps. If the jumps around a cell do not add up to zero, the cell
            contains a core, or noise has changed a value; the corners of such cells become holes.
        height
            Third coordinate of the nodes of a surface in space, of the shape of the grid of two
            axes, for a displacement with three rows. The frame then belongs to the deformed
            surface, with the third row d (height + u^3); jumps count without the height.
        options
            mask, periodic, unit, vector_unit, as for `SampledFrame`; sigma: of u at each node,
            one number, an array of the shape of the grid, or "estimate". Noise changes b only if it
            shifts a difference beyond half of a lattice vector.

        Examples
        --------
        >>> from geomtorsion.loops import Loop
        >>> from geomtorsion.materials.fields import SampledFrame
        >>> axis = np.linspace(-3, 3, 40)
        >>> x, y = np.meshgrid(axis, axis, indexing="ij")
        >>> u = np.arctan2(y, x) / (2 * np.pi) * 0.286
        >>> grid = SampledFrame.from_displacement([axis, axis], u[None], branch=0.286)
        >>> grid.burgers(Loop.circle([0, 0], 2)).vector, grid.source
        (array([0.286]), 'a displacement; jumps: (0.286) on 20 edges')
        """
        values = numbers(displacement, "displacement")
        lines = [numbers(axis, "axis") for axis in axes]
        shape = tuple(line.size for line in lines)
        if values.shape[1:] != shape or not len(values):
            raise GridError(
                f"displacement: expected shape (rows, {', '.join(map(str, shape))}), got "
                f"{values.shape}."
            )
        check_order(order)
        heights = checked_height(height, values)
        mask = mask_of(options.pop("mask", None), shape) | np.isnan(values).any(axis=0)
        if heights is not None:
            mask |= np.isnan(heights)
        sigma = options.pop("sigma", None)
        blank = cls(lines, np.zeros((1, len(lines), *shape)), order, names, mask=mask, **options)
        variances = None
        if sigma is not None:
            sigmas = _of_displacement(sigma, values, blank._grid)
            variances = np.broadcast_to(sigmas, values.shape) ** 2
        masked_values = np.where(mask, np.nan, values)
        sampled_u = displacement_of(masked_values, blank._grid, order, branch, variances, heights)
        options |= {"source": sampled_u.source, "displacement": sampled_u, "sigma": sampled_u.sigma}
        return cls(lines, sampled_u.coframe, order, names, **options)

    @classmethod
    def from_strain_rotation(
        cls,
        axes: Sequence[np.ndarray],
        strain: np.ndarray,
        rotation: np.ndarray,
        order: int = 4,
        names: Sequence[str] = (),
        **options: Any,
    ) -> Self:
        """Samples of a strain and a rotation: e = 1 + beta, beta_ij = e_ij + w_ij [Cloete2022].

        Parameters
        ----------
        strain
            e_ij, shape (n, n, grid...), n = 2 or 3; a plane map may have n = 3.
        rotation
            w_ij = (d_j u_i - d_i u_j) / 2, shape (n, n, grid...); or the vector w of u = w x r,
            shape (3, grid...), n = 3; or its angle about the third axis, shape (grid...), n = 2.
        options
            mask, sigma, periodic, unit, vector_unit, as for `SampledFrame`.

        Examples
        --------
        >>> from geomtorsion.materials.fields import SampledFrame
        >>> axes = [np.arange(6.0)] * 2
        >>> x, y = np.meshgrid(*axes, indexing="ij")
        >>> bent = SampledFrame.from_strain_rotation(axes, np.zeros((2, 2, 6, 6)), 0.01 * x)
        >>> bent.nye[:, 0].mean(axis=(1, 2)).round(9).tolist()
        [-0.01, 0.0]
        """
        values = strain_and_rotation(strain, rotation)
        return cls.from_distortion(axes, values, order, names, **options)

    @classmethod
    def read(
        cls,
        path: str | Path,
        order: int = 4,
        *,
        missing: object = None,
        columns: Mapping[str, int | str] | None = None,
    ) -> Self:
        """Read an .npz, .nc, .csv, .h5, .vtk or .vtu file (contents: `grid_files.read_grid`).

        A .csv, .txt or .dat file with columns x, y, u, v, or from DaVis, DICe or VIC, is a
        displacement, as is a .vtk or .vtu file with point data displacement, u or U. Columns exx,
        exy, eyy and wxy (or theta = w_yx, positive counter-clockwise) are a strain and a rotation,
        w_xy = (d_y u_x - d_x u_y) / 2, in radians unless the name has a unit such as (deg).
        Displacements at points (x, y, z) of a surface in space give the frame of this surface.

        Parameters
        ----------
        missing
            Values that mean "no data", such as -9999; words such as NA and NaN always do. Without
            it a value that all failed nodes share, and that is much farther from the others than
            these are from each other, is treated so. `source` reports how many nodes are missing.
        columns
            Tables: quantity -> name or number (from 0) of its column, such as {"x": 0, "y": 1,
            "exx": "strain_xx"}. Quantities are x, y, z; u, v, w; exx, exy, eyy, gxy (2 exy), wxy,
            theta; e_0_0, ...; beta_0_0, .... Other columns count by their names.

        Raises
        ------
        FileFormatError
            The file is missing, truncated or malformed, lacks an array, or does not hold a regular
            grid of finite numbers.
        GridError
            The order is invalid, or a column is not in the table.
        """
        check_order(order)
        chosen = checked_columns(columns, quantity, GridError, QUANTITIES)
        contents = read_grid(checks.file_name(path), chosen)
        grid = tuple(len(axis) for axis in contents.axes)
        values, report = with_holes(contents.values, grid, missing)
        make: Any = cls.from_distortion if contents.is_distortion else cls
        if contents.is_displacement:
            make = cls.from_displacement
        try:
            frame = make(contents.axes, values, order, contents.names, **contents.options)
        except GridError as error:
            raise FileFormatError(f"{path}: {error}") from None
        # A displacement replaces the source of the file by its jumps.
        origin = contents.options.get("source", "") if contents.is_displacement else ""
        texts = [text for text in (frame.source, origin, report) if text]
        return frame if texts == [frame.source] else replace(frame, source="; ".join(texts))

    def save(self, path: str | Path) -> None:
        """Write a file that `read` reads back, in the format of the file ending.

        The file keeps values, holes, sigma, periods, units and source. Tables (CSV, VTK) keep only
        the sigma of a covariance. A displacement is kept only in .npz. All other formats keep its
        coframe, and circuits in the frame read back interpolate this coframe.

        Raises
        ------
        GridError
            There is no format with this file ending.
        MissingExtraError
            The library for the format is not installed.
        """
        file = checks.file_name(path)
        if file.name and not file.suffix:
            file = file.with_suffix(".npz")
        options: dict[str, Any] = {k: getattr(self, k) for k in TEXTS if getattr(self, k)}
        if isinstance(self.covariance, np.ndarray) and holds_covariance(file):
            options["covariance"] = self.covariance
        elif isinstance(self.sigma, np.ndarray):
            options["sigma"] = self.sigma
        if any(self.periodic):
            options["periodic"] = np.array(self.periodic)
        contents = Contents(list(self.axes), self.coframe, tuple(self.names), False, options)
        if self.displacement is not None and file.suffix.lower() == ".npz":
            contents = self._as_displacement(self.displacement, options)
        with written(file) as target:
            save_grid(target, contents)

    def _as_displacement(self, found: Displacement, options: dict[str, Any]) -> Contents:
        """Contents of a file of the displacement, with its noise, and its jumps as declared."""
        entries = {k: options[k] for k in ("unit", "vector_unit", "periodic") if k in options}
        if found.variances is not None:
            entries["sigma"] = np.sqrt(found.variances)[:, None]
        if isinstance(found.branch, str):
            entries["branch"] = np.full((1, self.rows), np.nan)
        elif found.branch is not None:
            entries["branch"] = found.jumps.vectors
        return Contents(list(self.axes), found.values, tuple(self.names), False, entries, True)

    # -- properties -------------------------------------------------------------------------------

    @cached_property
    def _grid(self) -> Grid:
        """Axes and holes."""
        return Grid(tuple(self.axes), tuple(self.names), self.periodic, self.mask)

    @cached_property
    def _field(self) -> Field:
        """The values, prepared for integrals."""
        d, grid = self.dimension, self._grid
        inner = tuple(range(2, 2 + d))
        values = self.coframe[:, :d]
        if grid.has_holes:
            mean = values.mean(axis=inner, keepdims=True, where=~grid.holes)
            bent = np.where(grid.holes, 0.0, values - mean)
        else:
            mean = values.mean(axis=inner, keepdims=True)
            bent = values - mean
        flat = mean.reshape(mean.shape[:2])
        return Field(grid, bent, flat, self.noise, self.order, self.other_order)

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
        """The order to compare with, which gives the errors."""
        return other_order(self.order)

    @cached_property
    def holes(self) -> tuple[Hole, ...]:
        """Connected sets of unknown nodes, in the order of their first nodes."""
        return holes_of(self._grid)

    def __repr__(self) -> str:
        parts = [f"{' x '.join(map(str, self._grid.shape))} nodes", count_text(self.rows, "row")]
        parts.append(f"order {self.order}")
        if any(self.periodic):
            wraps = [n for n, wraps in zip(self.names, self.periodic, strict=True) if wraps]
            parts.append(f"periodic in {', '.join(wraps)}")
        if self.holes:
            count, nodes = len(self.holes), int(np.count_nonzero(self.mask))
            parts.append(f"{count_text(count, 'hole')} of {count_text(nodes, 'node')}")
        if isinstance(self.sigma, np.ndarray):
            low, high = (f"{x:.2g}" for x in (self.sigma.min(), self.sigma.max()))
            parts.append(f"sigma {low}" + (f" to {high}" if high != low else ""))
        if self.signature:
            parts.append(f"signature {self.signature}")
        if self.unit:
            has_own_unit = self.vector_unit != self.unit
            parts.append(f"in {self.unit}" + (f", b in {self.vector_unit}" if has_own_unit else ""))
        return f"SampledFrame({', '.join(parts)})"


def _of_displacement(sigma: object, displacement: np.ndarray, grid: Grid) -> np.ndarray:
    """Standard deviations of a displacement, shape (rows, grid or 1...)."""
    if isinstance(sigma, str):
        checks.choice(sigma, ["estimate"], "sigma", GridError)
        return estimated(displacement[:, None], grid)[:, 0]
    sigmas = sigma_of(sigma, (len(displacement), 1, *grid.shape), grid)[:, 0]
    return np.broadcast_to(sigmas, (len(displacement), *sigmas.shape[1:]))


def strain_and_rotation(strain: object, rotation: object) -> np.ndarray:
    """beta = strain + rotation, d_j u_i = e_ij + w_ij, shape (n, n, grid...)."""
    e = numbers(strain, "strain")
    if e.ndim < 3 or e.shape[0] != e.shape[1] or e.shape[0] not in (2, 3):
        raise GridError(
            f"strain: expected shape (2, 2, grid...) or (3, 3, grid...), got {e.shape}."
        )
    check_turned(e, 1, "strain", "symmetric")
    return e + skew(rotation, len(e), e.shape[2:])


def skew(rotation: object, n: int, shape: tuple[int, ...]) -> np.ndarray:
    """A rotation as w_ij = (d_j u_i - d_i u_j) / 2, from this matrix, its vector or its angle.

    The vector w gives u = w x r, so that w_ij = - eps_ijk w_k; an angle is w_3.
    """
    w = numbers(rotation, "rotation")
    if w.shape == (n, n, *shape):
        check_turned(w, -1, "rotation", "antisymmetric")
        return w
    matrix = np.zeros((n, n, *shape))
    if n == 2 and w.shape == shape:
        matrix[1, 0], matrix[0, 1] = w, -w
        return matrix
    if n == 3 and w.shape == (3, *shape):
        for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            matrix[j, i], matrix[i, j] = w[k], -w[k]
        return matrix
    short_form = f"{shape} (angle)" if n == 2 else f"{(3, *shape)} (vector)"
    raise GridError(
        f"rotation: expected shape {(n, n, *shape)} (matrix) or {short_form}, got {w.shape}."
    )


def check_turned(values: np.ndarray, sign: int, name: str, word: str) -> None:
    """Refuse a matrix that is not symmetric, or not antisymmetric."""
    with np.errstate(invalid="ignore"):
        # Tolerance for the rounding of tables, as for axes.
        away = np.abs(values - sign * np.swapaxes(values, 0, 1))
        bad = np.argwhere(away > REGULAR * np.nanmax(np.abs(values), initial=0.0))
    if len(bad):
        i, j, *node = bad[0].tolist()
        raise GridError(
            f"{name}: expected {word} matrices, got [{i}, {j}] = {values[(i, j, *node)]:.6g} and "
            f"[{j}, {i}] = {values[(j, i, *node)]:.6g} at node {tuple(node)}. For a distortion use "
            "from_distortion."
        )
