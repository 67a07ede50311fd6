"""Sampled constraints: residuals of both constraints on a grid, with norms and convergence."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from geomtorsion.errors import GridError, MetricError
from geomtorsion.geometry import contract, levi_civita
from geomtorsion.gravity.initial_data.constraint_tensors import constraint_tensors
from geomtorsion.loops.quadrature import ROUNDING
from geomtorsion.materials.fields import Density, SampledFrame
from geomtorsion.materials.fields.grid import REGULAR
from geomtorsion.materials.fields.grid_geometry import (
    GridGeometry,
    at_two_steps,
)
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

NAMES = ("hamiltonian", "momentum")


@dataclass(frozen=True, eq=False, repr=False)
class Residual:
    """Size of a constraint at the nodes: |H|, or the length of M_i in the metric of the slice.

    name: hamiltonian or momentum. frame: the metric. size: at the nodes, NaN where unknown.
    error: of the size. coarse: the size from differences of twice the step. scale: sizes of the
    terms that cancel on a solution. inside: nodes with centred stencils, where errors are sharp.
    unit: of the sizes. All have shape (N_1, ..., N_d).
    """

    name: str
    frame: SampledFrame
    size: np.ndarray
    error: np.ndarray
    coarse: np.ndarray
    scale: np.ndarray
    inside: np.ndarray
    unit: str = ""

    @cached_property
    def rms(self) -> float:
        """Root mean square over the known nodes (L2 norm per volume of coordinates)."""
        return _rms(self.size)

    @cached_property
    def largest(self) -> float:
        """Largest size at a node."""
        return float(np.nanmax(self.size))

    @cached_property
    def place(self) -> dict[str, float]:
        """Coordinates of the node of the largest size."""
        node = np.unravel_index(int(np.nanargmax(self.size)), self.size.shape)
        lines = zip(self.frame.names, self.frame.axes, node, strict=True)
        return {name: float(axis[k]) for name, axis, k in lines}

    @cached_property
    def relative(self) -> float:
        """Root mean square over the root mean square of the scale; 0 if both vanish.

        The scale is sqrt(R_ij R^ij) + K_ij K^ij + 2 |Lambda| + 16 pi |rho| for the Hamiltonian
        constraint, and the length of D_i K_jk plus 8 pi |j| for the momentum constraint.
        """
        return self.rms / _rms(self.scale) if self.rms else 0.0

    @cached_property
    def mismatch(self) -> float:
        """Root mean square of the sizes in units of their errors: below 1 on a solution.

        It counts the nodes with centred stencils if there are any, otherwise all nodes.
        """
        ratio = np.divide(self.size, self.error, out=np.zeros_like(self.size), where=self.size > 0)
        return _rms(ratio[self._counted])

    @cached_property
    def visible(self) -> float:
        """Smallest relative size of wrong data that show: there `mismatch` reaches 1.

        It is for a wrong constraint that is the same share of the scale at all counted nodes.
        Where it is 1 or more, the grid is too coarse to test anything. 0 if the scale vanishes.
        """
        tested = self._counted & (self.scale > 0)
        if not tested.any():
            return 0.0
        return 1 / _rms(self.scale[tested] / self.error[tested])

    @cached_property
    def order(self) -> float:
        """Power of the step with which the root mean square falls, from twice the step.

        On a solution it is about the order of the differences, otherwise about 0. It counts the
        nodes of `mismatch`, and is NaN where the size is rounding.
        """
        sizes = self.size[self._counted]
        if not sizes.any() or self._is_rounding:
            return math.nan
        return math.log2(_rms(self.coarse[self._counted]) / _rms(sizes))

    @cached_property
    def _counted(self) -> np.ndarray:
        """Nodes with centred stencils if there are any, otherwise all known nodes."""
        known = ~np.isnan(self.size)
        return known & self.inside if (known & self.inside).any() else known

    @property
    def _is_rounding(self) -> bool:
        """Whether twice the step would not be more accurate: only rounding is left."""
        step = min(map(abs, self.frame.steps))
        size = float(np.nanmax(np.abs(self.frame.coframe)))
        return self.rms <= np.finfo(float).eps * max(1.0, size) / step**2

    def to_json(self) -> dict[str, Any]:
        """Numbers of the residual as plain data."""
        return {
            "rms": self.rms,
            "relative": self.relative,
            "largest": self.largest,
            "place": self.place,
            "mismatch": self.mismatch,
            "visible": self.visible,
            "order": None if math.isnan(self.order) else self.order,
            "unit": self.unit,
            "nodes": int(np.isfinite(self.size).sum()),
        }

    def __repr__(self) -> str:
        if not self.rms:
            return f"{self.name}: zero at all nodes"
        unit = f" {self.unit}" if self.unit else ""
        place = ", ".join(f"{name} = {x:.4g}" for name, x in self.place.items())
        order = round(self.order, 1) + 0.0
        falls = "" if math.isnan(order) else f", falls with order {order:g}"
        return (
            f"{self.name}: root mean square {self.rms:.3g}{unit} (relative {self.relative:.2g}, "
            f"{self.mismatch:.2g} errors{falls}), largest {self.largest:.3g} at {place}"
        )


@dataclass(frozen=True, eq=False, repr=False)
class SampledConstraints:
    """Constraints of initial data on a grid.

    frame: the metric of the slice. hamiltonian: H at the nodes. momentum: M_i at the nodes, shape
    (d, N_1, ..., N_d). residuals: their sizes and norms, by name.
    """

    frame: SampledFrame
    hamiltonian: Density
    momentum: Density
    residuals: Mapping[str, Residual]

    @property
    def is_solution(self) -> bool | None:
        """Whether both constraints vanish within their errors (root mean square).

        None where the errors are as large as the terms that cancel: the grid is too coarse. True
        does not exclude wrong data whose relative size is below `visible` of the residuals.
        """
        parts = self.residuals.values()
        if any(one.mismatch > 1 for one in parts):
            return False
        return None if any(one.visible >= 1 for one in parts) else True

    def to_json(self) -> dict[str, Any]:
        """Norms of both constraints as plain data."""
        return {"is_solution": self.is_solution} | {
            name: one.to_json() for name, one in self.residuals.items()
        }

    def __repr__(self) -> str:
        known = int(np.isfinite(self.residuals["hamiltonian"].size).sum())
        shares = [
            f"{one.visible:.1g} ({name})" for name, one in self.residuals.items() if one.visible
        ]
        verdict = {
            True: "both vanish within the error of the grid",
            False: "they do not vanish within the error of the grid",
            None: "not decided, the grid is too coarse: its error is as large as the terms that "
            "cancel",
        }[self.is_solution]
        if self.is_solution and shares:
            verdict += f"; wrong data show from a relative size of {', '.join(shares)}"
        lines = [f"constraints at {known:,} nodes: {verdict}"]
        return "\n  ".join([*lines, *(repr(one) for one in self.residuals.values())])


def sampled_constraints(
    frame: SampledFrame,
    extrinsic_curvature: object,
    energy: object,
    momentum: object,
    constant: object,
) -> SampledConstraints:
    """See `constraints`."""
    if "-" in frame.signature:
        raise MetricError(
            f"metric: expected the positive metric of a slice, got the signature "
            f"{frame.signature}. Give the metric of the coordinates of space."
        )
    d, shape = frame.dimension, tuple(len(axis) for axis in frame.axes)
    K = _array(extrinsic_curvature, (d, d), shape, "extrinsic_curvature")
    rho = _array(energy, (), shape, "density")
    flux = _array(momentum, (d,), shape, "momentum")
    value = checks.number(constant, "cosmological_constant", GridError)
    away = np.abs(K - np.swapaxes(K, 0, 1))
    if not np.nanmax(away, initial=0.0) <= REGULAR * np.nanmax(np.abs(K), initial=0.0):
        i, j, *node = np.unravel_index(int(np.nanargmax(away)), away.shape)
        raise GridError(
            f"extrinsic_curvature: expected symmetric matrices, got {K[(i, j, *node)]:.6g} and "
            f"{K[(j, i, *node)]:.6g} at node {tuple(map(int, node))}."
        )
    unknown = np.isnan(K).any(axis=(0, 1)) | np.isnan(rho) | np.isnan(flux).any(axis=0)
    if unknown.any():
        frame = replace(frame, mask=frame.mask | unknown)

    def formulas(geometry: GridGeometry) -> dict[str, Any]:
        given = geometry.tensor(K, "dd")
        one = geometry.frame
        read = geometry.element(np.full(shape, float(value)))
        tensors = constraint_tensors(
            one, given, geometry.element(rho), geometry.tensor(flux, "d"), read
        )
        ricci = levi_civita(one).curvature.ricci
        slope = levi_civita(one).covariant_derivative(given)
        return {
            "hamiltonian": tensors[0],
            "momentum": tensors[1],
            "inverse": one.inverse_metric,
            "ricci": contract("ab,ab->", ricci, ricci.raised(0).raised(1)),
            "K": contract("ab,ab->", given, given.raised(0).raised(1)),
            "slope": contract("abc,abc->", slope, slope.raised(0).raised(1).raised(2)),
        }

    found = at_two_steps(frame, formulas)
    fine, coarse = ({name: x for name, (x, _) in one.items()} for one in (found.fine, found.coarse))
    unit = f"1/{frame.unit}^2" if frame.unit else ""
    H, M = (replace(found.density(name), unit=unit) for name in NAMES)
    length = partial(_length, inverse=fine["inverse"])
    sizes = length(M.values)
    # Errors of components may have any signs.
    errors = found.error(coarse["momentum"] - fine["momentum"])
    others = _length(errors, np.abs(fine["inverse"]))
    energy_scale = 2 * abs(float(value)) + 16 * math.pi * np.abs(rho)
    scales = (
        _root(fine["ricci"]) + np.abs(fine["K"]) + energy_scale,
        _root(fine["slope"]) + 8 * math.pi * length(flux),
    )
    # Rounding of the terms that cancel.
    H = replace(H, difference=H.difference + ROUNDING * scales[0])
    parts = (
        (np.abs(H.values), H.error, np.abs(coarse["hamiltonian"])),
        (sizes, others + ROUNDING * scales[1], length(coarse["momentum"])),
    )
    residuals = {
        name: Residual(name, frame, *part, scale, found.inside, unit)
        for name, part, scale in zip(NAMES, parts, scales, strict=True)
    }
    return SampledConstraints(frame, H, M, residuals)


def _array(
    values: object, indices: tuple[int, ...], grid: tuple[int, ...], name: str
) -> np.ndarray:
    """Values at the nodes, from an array or from the same value at all nodes; zeros for None."""
    shape = (*indices, *grid)
    if values is None:
        return np.zeros(shape)
    array = checks.array(values, name, GridError, infinite=None)
    if np.isinf(array).any():
        raise GridError(f"{name}: expected finite values or NaN, got infinity. Mask those nodes.")
    if array.ndim == 0 and not array:
        return np.zeros(shape)
    if array.shape == indices:
        return np.broadcast_to(array.reshape(indices + (1,) * len(grid)), shape).copy()
    if array.shape != shape:
        raise GridError(
            f"{name}: expected shape {shape}, indices first and then the grid, or {indices} for "
            f"the same value at all nodes, got {array.shape}."
        )
    return array


def _length(vectors: np.ndarray, inverse: np.ndarray) -> np.ndarray:
    """Length of covectors at the nodes in a positive metric."""
    return _root(np.einsum("i...,ij...,j...->...", vectors, inverse, vectors))


def _root(squares: np.ndarray) -> np.ndarray:
    """Square root of sums of squares, of which rounding may leave less than zero."""
    return np.sqrt(np.maximum(squares, 0.0))


def _rms(values: np.ndarray) -> float:
    """Root mean square over known values."""
    return float(np.sqrt(np.nanmean(values**2)))
