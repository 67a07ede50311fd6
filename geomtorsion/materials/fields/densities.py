"""Densities: dislocations, disclinations and incompatibility of a field, and their conservation."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import reduce
from itertools import permutations
from typing import TYPE_CHECKING

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.errors import GridError
from geomtorsion.loops.quadrature import ROUNDING
from geomtorsion.materials.fields.grid import Grid
from geomtorsion.materials.fields.grid_circuits import Field, unexplained
from geomtorsion.materials.fields.samples import Samples
from geomtorsion.materials.fields.sides import on_grid
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

if TYPE_CHECKING:
    from scipy.sparse import csr_array

# (k, a, b) and the sign of eps_kab.
EPSILON = tuple(((k, a, b), 1 if (a - k) % 3 == 1 else -1) for k, a, b in permutations(range(3)))
# One component as a sum: (row, column, axes of the derivatives) -> factor.
Sum = dict[tuple[int, int, tuple[int, ...]], float]
REMEDY = "Use a smaller part of the grid, or every second node."


@dataclass(frozen=True, eq=False, repr=False)
class Density:
    """A tensor field of derivatives of measured values at the nodes, with its errors.

    values: shape (components..., grid...), NaN without enough known nodes around.
    difference: from stencils of another order, same shape: the error of the grid.
    sigma: standard deviation from noise, same shape; zero where the noise is not known.
    unit: of the values.

    Examples
    --------
    >>> Density(np.array([3.0, np.nan]), np.array([0.3, np.nan]), np.array([0.4, np.nan]), "1/nm")
    Density(2 values, 1 unknown, largest 3 1/nm, largest error 0.5)
    """

    values: np.ndarray
    difference: np.ndarray
    sigma: np.ndarray
    unit: str = ""

    @cached_property
    def error(self) -> np.ndarray:
        """Error of the grid and one standard deviation of the noise, added in quadrature."""
        return np.hypot(self.difference, self.sigma)

    def __repr__(self) -> str:
        unknown = int(np.isnan(self.values).sum())
        holes = f", {unknown:,} unknown" if unknown else ""
        largest, error = (
            np.nanmax(np.abs(x)) if unknown < x.size else np.nan for x in (self.values, self.error)
        )
        unit = f" {self.unit}" if self.unit else ""
        return (
            f"Density({self.values.size:,} values{holes}, largest {largest:.4g}{unit}, "
            f"largest error {error:.2g})"
        )


@dataclass(frozen=True, eq=False, repr=False)
class DefectDensities:
    """Densities of dislocations and disclinations of a small distortion, and its incompatibility.

    Equation
    --------
    alpha^{ik} = eps^{kab} d_a e^i_b for a distortion that includes the rotation. For a strain E and
    a bend kappa^m_a (d_a w^m, if a rotation w exists):
    alpha^{ik} = eps^{kab} d_a E^i_b - kappa^k_i + delta_ik kappa^m_m,
    theta^{mk} = eps^{kab} d_a kappa^m_b [de Wit, J. Res. NBS 77A (1973) 49]
    eta_kl = eps_kab eps_lcd d_a d_c E_bd   [Kroener, Kontinuumstheorie, 1958]
    Then eta is the symmetric part of eps_kab d_a alpha^{bl} + theta^{lk}. The index k is the
    direction of the line, as in `SampledFrame.nye`.

    dislocation: alpha^{ik}, shape (rows, 3, grid...), in vector unit per unit squared.
    disclination: theta^{mk}, shape (3, 3, grid...), radians per unit squared; None without a bend.
        Rotations without an independent bend have none: theta is then zero identically.
    incompatibility: eta_kl, shape (3, 3, grid...), per unit squared.
    On a plane grid only k = l = 3 is known, and these axes have length 1.
    """

    dislocation: Density
    disclination: Density | None
    incompatibility: Density

    def __repr__(self) -> str:
        lines = [f"dislocation: {self.dislocation}", f"incompatibility: {self.incompatibility}"]
        if self.disclination is not None:
            lines.insert(1, f"disclination: {self.disclination}")
        return f"DefectDensities({'; '.join(lines)})"


@dataclass(frozen=True, eq=False, repr=False)
class DefectConservation:
    """Residuals of the conservation laws of measured defect densities, with their errors.

    Equation
    --------
    d_k alpha^{ik} = eps_imk theta^{mk}, d_k theta^{mk} = 0  [de Wit 1973]
    Without disclinations, dislocations end nowhere: d_k alpha^{ik} = 0.

    dislocation: d_k alpha^{ik} - eps_imk theta^{mk}, shape (3, grid...).
    disclination: d_k theta^{mk}, shape (3, grid...); None without disclinations.
    """

    dislocation: Density
    disclination: Density | None = None

    @cached_property
    def mismatch(self) -> float:
        """Root mean square of all residuals in units of their errors.

        It is about 1 or less if the laws hold and the errors are right.
        """
        residuals = [self.dislocation] + ([self.disclination] if self.disclination else [])
        ratios = [_ratio(density) for density in residuals]
        return float(np.sqrt(np.nanmean(np.concatenate(ratios) ** 2)))

    @cached_property
    def worst(self) -> tuple[int, ...]:
        """Component and node of the largest residual of `dislocation` in units of its error."""
        shape = self.dislocation.values.shape
        place = np.nanargmax(np.abs(_ratio(self.dislocation)))
        return tuple(int(k) for k in np.unravel_index(int(place), shape))

    def __repr__(self) -> str:
        return f"DefectConservation(mismatch {self.mismatch:.3g} errors, largest at {self.worst})"


def _ratio(density: Density) -> np.ndarray:
    """Values in units of their errors; 0 for a value of zero without any error."""
    values, error = density.values.ravel(), density.error.ravel()
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(values == 0, 0.0, values / error)


def _alpha(rows: int, dimension: int) -> dict[tuple[int, int], Sum]:
    """The curl of a field, eps^{kab} d_a e^i_b, as sums."""
    table: dict[tuple[int, int], Sum] = {}
    for i in range(rows):
        for (k, a, b), sign in EPSILON:
            if max(a, b) < dimension:
                table.setdefault((i, k), {})[i, b, (a,)] = sign
    return table


def _bent(dimension: int) -> dict[tuple[int, int], Sum]:
    """The part of a bend in the dislocation density, delta_ik kappa^m_m - kappa^k_i, as sums."""
    table: dict[tuple[int, int], Sum] = {}
    for i, k in _alpha(3, dimension):
        diagonal = {(m, m, ()): 1.0 for m in range(3) if m != k}
        table[i, k] = diagonal if i == k else {(k, i, ()): -1.0}
    return table


def _eta(dimension: int) -> dict[tuple[int, int], Sum]:
    """Incompatibility of the symmetric part of a field, as sums."""
    table: dict[tuple[int, int], Sum] = {}
    for (k, a, b), one in EPSILON:
        for (m, c, d), two in EPSILON:
            if max(a, b, c, d) < dimension:
                total = table.setdefault((k, m), {})
                for row, column in ((b, d), (d, b)):
                    key = (row, column, tuple(sorted((a, c))))
                    total[key] = total.get(key, 0.0) + one * two / 2
    return table


def _divergence() -> dict[tuple[int, int], Sum]:
    """d_k alpha^{ik} as sums."""
    return {(i, 0): {(i, k, (k,)): 1.0 for k in range(3)} for i in range(3)}


def _source() -> dict[tuple[int, int], Sum]:
    """- eps_imk theta^{mk} as sums."""
    table: dict[tuple[int, int], Sum] = {}
    for (i, m, k), sign in EPSILON:
        table.setdefault((i, 0), {})[m, k, ()] = -sign
    return table


@dataclass(frozen=True, eq=False)
class _Operators:
    """Derivatives of a field at all nodes, as matrices over the flat grid, with another order."""

    sampled: Field
    cache: dict[tuple[tuple[int, ...], bool], csr_array] = field(default_factory=dict)

    @property
    def grid(self) -> Grid:
        return self.sampled.grid

    def matrix(self, axes: tuple[int, ...], other: bool) -> csr_array:
        """The product of derivatives along axes."""
        if (axes, other) not in self.cache:
            if len(axes) == 1:
                self.cache[axes, other] = self._along(axes[0], other)
            else:
                unit = scipy.sparse.eye_array(self.grid.holes.size, format="csr")
                each = [self.matrix((axis,), other) for axis in axes]
                self.cache[axes, other] = reduce(lambda a, b: (b @ a).tocsr(), each, unit)
        return self.cache[axes, other]

    def _along(self, axis: int, other: bool) -> csr_array:
        """The derivative along one axis."""
        grid, size = self.grid, self.grid.holes.size
        rule = grid.rule(self.sampled.order, axis, slopes=True)
        matrix = (rule.other if other else rule).matrix / grid.steps[axis]
        if matrix.shape[0] < size:
            matrix = scipy.sparse.kron(matrix, scipy.sparse.eye_array(size // matrix.shape[0]))
        nodes = np.moveaxis(np.arange(size).reshape(grid.shape), axis, 0).ravel()
        entries = matrix.tocoo()
        places = nodes[entries.coords[0]], nodes[entries.coords[1]]
        return scipy.sparse.csr_array((entries.data, places), shape=(size, size))

    def unknown(self, axes: tuple[int, ...]) -> np.ndarray:
        """Nodes where a derivative is not known, shape (nodes,)."""
        bad = self.grid.holes.ravel()
        if not self.grid.has_holes:
            return bad
        for axis in axes:
            rule = self.grid.rule(self.sampled.order, axis, slopes=True)
            here = ~on_grid(rule.known, self.grid.shape, axis).ravel()
            reached = abs(self.matrix((axis,), False)) @ bad.astype(float) > 0
            bad = bad | here | reached
        return bad

    def of(self, terms: Sum) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Values of a sum, their errors (grid and rounding), and their variances, (nodes,)."""
        one, two = (self._weights(terms, other) for other in (False, True))
        values, rival = (sum(m @ self._column(key) for key, m in w.items()) for w in (one, two))
        less = {key: m - two[key] for key, m in one.items()}
        algebraic = sum(
            f * self.sampled.mean[i, m] for (i, m, axes), f in terms.items() if not axes
        )
        bad = reduce(np.logical_or, (self.unknown(axes) for _, _, axes in terms))
        rounding = sum(abs(m) @ np.abs(self._column(key)) for key, m in one.items())
        difference = unexplained(np.abs(values - rival), self._variance(less))
        return (
            np.where(bad, np.nan, values + algebraic),
            difference + ROUNDING * rounding,
            self._variance(one),
        )

    def _weights(self, terms: Sum, other: bool) -> dict[tuple[int, int], csr_array]:
        """Row and column of the field -> matrix of the sum."""
        weights: dict[tuple[int, int], csr_array] = {}
        for (row, column, axes), factor in terms.items():
            part = factor * self.matrix(axes, other)
            key = row, column
            weights[key] = weights[key] + part if key in weights else part
        return weights

    def _column(self, key: tuple[int, int]) -> np.ndarray:
        """Values of one component of the field without its mean, (nodes,)."""
        return self.sampled.values[key].ravel()

    def _variance(self, weights: Mapping[tuple[int, int], csr_array]) -> np.ndarray:
        """Variance of a sum from the noise of the values, (nodes,)."""
        grid, total = self.grid, np.zeros(self.grid.holes.size)
        if self.sampled.noise is None:
            return total
        for (i, k, j, m), covariance in self.sampled.noise.terms.items():
            if (i, k) in weights and (j, m) in weights:
                here = np.broadcast_to(covariance, grid.shape).ravel()
                total += weights[i, k].multiply(weights[j, m]) @ here
        return np.maximum(total, 0.0)


def _density(
    parts: Iterable[tuple[_Operators, dict[tuple[int, int], Sum]]], unit: str = ""
) -> Density:
    """The sum of linear maps of independent fields."""
    total: dict[tuple[int, int], list[np.ndarray]] = {}
    shape: tuple[int, ...] = ()
    for operators, table in parts:
        shape = operators.grid.shape
        for key, terms in table.items():
            own = list(operators.of(terms))
            before = total.get(key)
            total[key] = (
                own if before is None else [a + b for a, b in zip(before, own, strict=True)]
            )
    places = [sorted({key[axis] for key in total}) for axis in (0, 1)]
    arrays = [
        np.array([[total[i, k][n] for k in places[1]] for i in places[0]]).reshape(
            *map(len, places), *shape
        )
        for n in range(3)
    ]
    values, difference, variance = arrays
    bad = np.isnan(values)
    difference, variance = (np.where(bad, np.nan, x) for x in (difference, variance))
    return Density(values, difference, np.sqrt(variance), unit)


def check_field(grid: Grid, rows: int, least: int, name: str, second: bool = False) -> None:
    """Refuse a field of another dimension or with too few rows, or one that is too large."""
    if grid.dimension not in (2, 3):
        raise GridError(
            f"{name}: expected a grid of two or three axes, got {grid.dimension}. Take a section."
        )
    if rows < least:
        raise GridError(
            f"{name}: expected {least} rows or more, one for each axis of space, got {rows}. Give "
            "all components."
        )
    # Products of two stencils of nine nodes hold up to 81 numbers and places for each node.
    entries = (81 if second else 9) * grid.holes.size
    checks.check_room(4 * entries, f"{name}: stencils of {grid.holes.size:,} nodes", REMEDY)


def check_equal_grids(one: Grid, two: Grid, name: str) -> None:
    """Refuse a second field at other nodes."""
    same = one.shape == two.shape and all(
        np.allclose(a, b, rtol=0, atol=1e-9 * abs(step))
        for a, b, step in zip(one.axes, two.axes, one.steps, strict=True)
    )
    if not same or one.periodic != two.periodic:
        raise GridError(
            f"{name}: expected the same nodes and periods as the first field, {one.shape}, got "
            f"{two.shape}. Resample one of them."
        )


def incompatibility_of(samples: Samples) -> Density:
    """eta_kl = eps_kab eps_lcd d_a d_c E_bd of the symmetric part of a distortion."""
    sampled = _smooth(samples, "incompatibility")
    dimension = sampled.grid.dimension
    check_field(sampled.grid, sampled.rows, dimension, "incompatibility", second=True)
    return _density([(_Operators(sampled), _eta(dimension))], _per_area(samples, ""))


def defect_densities(strain: Samples, bend: Samples | None = None) -> DefectDensities:
    """Densities of dislocations and disclinations, and the incompatibility, with their errors.

    Parameters
    ----------
    strain
        A frame on a grid, with the coframe 1 + strain if there is a bend. Without a bend, the
        coframe includes the rotation, and there are no disclinations.
    bend
        kappa^m_a on the same grid, rows m, radians per unit of length: lattice curvature that is
        measured without a rotation, for example up to symmetry.

    Raises
    ------
    GridError
        The fields have different nodes, too few rows, or more than three axes.

    Examples
    --------
    A bend about z along y that grows along x: disclinations along z.

    >>> from geomtorsion import SampledFrame
    >>> axes = [np.linspace(-1, 1, 9)] * 3
    >>> x, y, z = np.meshgrid(*axes, indexing="ij")
    >>> kappa = np.zeros((3, 3, 9, 9, 9))
    >>> kappa[2, 1] = x
    >>> strain = SampledFrame.from_distortion(axes, np.zeros_like(kappa))
    >>> densities = defect_densities(strain, SampledFrame(axes, kappa))
    >>> densities.disclination.values[:, :, 4, 4, 4].round(9)[2].tolist()
    [0.0, 0.0, 1.0]
    """
    eta = incompatibility_of(strain)
    sampled = _smooth(strain, "strain")
    dimension, own = sampled.grid.dimension, _Operators(sampled)
    unit = _per_area(strain, strain.vector_unit)
    if bend is None:
        alpha = _density([(own, _alpha(sampled.rows, dimension))], unit)
        return DefectDensities(alpha, None, eta)
    curved = _smooth(bend, "bend")
    check_field(sampled.grid, sampled.rows, 3, "strain with a bend")
    check_field(curved.grid, curved.rows, 3, "bend")
    check_equal_grids(sampled.grid, curved.grid, "bend")
    turned = _Operators(curved)
    alpha = _density([(own, _alpha(3, dimension)), (turned, _bent(dimension))], unit)
    theta = _density([(turned, _alpha(3, dimension))], _per_area(strain, "rad"))
    return DefectDensities(alpha, theta, eta)


def defect_conservation(
    dislocation: Samples, disclination: Samples | None = None
) -> DefectConservation:
    """Whether measured densities of defects obey their conservation laws.

    A density that is computed from one coframe satisfies them identically, so that the check is for
    densities from other measurements.

    Parameters
    ----------
    dislocation
        alpha^{ik} on a grid of three axes, rows i and columns k, as a `SampledFrame`.
    disclination
        theta^{mk} at the same nodes, rows m; zero if not given.

    Raises
    ------
    GridError
        The fields do not have three rows on three axes, or have different nodes.

    Examples
    --------
    Screw dislocations along z, whose number grows along z because many end inside:

    >>> from geomtorsion import SampledFrame
    >>> axes = [np.linspace(-1, 1, 9)] * 3
    >>> z = np.meshgrid(*axes, indexing="ij")[2]
    >>> alpha = np.zeros((3, 3, 9, 9, 9))
    >>> alpha[2, 2] = z
    >>> defect_conservation(SampledFrame(axes, alpha, sigma=0.01)).mismatch > 5
    True
    """
    alpha = _smooth(dislocation, "dislocation")
    theta = None if disclination is None else _smooth(disclination, "disclination")
    for name, sampled in (("dislocation", alpha), ("disclination", theta)):
        if sampled is None:
            continue
        if sampled.grid.dimension != 3 or sampled.rows != 3:
            raise GridError(
                f"{name}: expected 3 rows on a grid of three axes, got {sampled.rows} rows and "
                f"{sampled.grid.dimension} axes. A divergence needs derivatives along all axes."
            )
        check_field(sampled.grid, sampled.rows, 3, name)
    parts = [(_Operators(alpha), _divergence())]
    if theta is None:
        return DefectConservation(_flat(_density(parts)))
    check_equal_grids(alpha.grid, theta.grid, "disclination")
    turned = _Operators(theta)
    parts.append((turned, _source()))
    return DefectConservation(_flat(_density(parts)), _flat(_density([(turned, _divergence())])))


def _per_area(samples: Samples, of: str) -> str:
    """Unit of a density."""
    if of == samples.unit:
        return f"1/{samples.unit}" if samples.unit else ""
    return f"{of or 1}/{samples.unit}^2" if samples.unit else of


def _smooth(samples: Samples, name: str) -> Field:
    """The values of a frame; differences of a displacement are refused."""
    checks.instance(samples, Samples, name)
    if samples.displacement is not None:
        raise GridError(
            f"{name}: expected a distortion, got differences of a displacement, whose densities "
            "vanish except at cores. Use burgers_map, or SampledFrame(axes, coframe)."
        )
    return samples._field


def _flat(density: Density) -> Density:
    """A density of one column without its second axis."""
    values, difference, sigma = (
        x[:, 0] for x in (density.values, density.difference, density.sigma)
    )
    return Density(values, difference, sigma, density.unit)
