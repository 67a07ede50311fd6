"""Constraints: the Hamiltonian and the momentum constraint of a slice of a spacetime."""

from __future__ import annotations

from dataclasses import dataclass
from typing import overload

import sympy as sp

from geomtorsion.errors import ArgumentError, GravityError, MetricError, ShapeError
from geomtorsion.exact import Element
from geomtorsion.geometry import Frame, Surface, Tensor, symmetric
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.gravity.initial_data.constraint_tensors import constraint_tensors
from geomtorsion.gravity.initial_data.sampled_constraints import (
    SampledConstraints,
    sampled_constraints,
)
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property


@dataclass(frozen=True, eq=False, repr=False)
class Constraints:
    """Constraints of a slice given by formulas: tensors that vanish on initial data.

    frame: of the metric of the slice. hamiltonian: H, rank 0. momentum: M_i, slots d.
    """

    frame: Frame
    hamiltonian: Tensor
    momentum: Tensor

    @cached_property
    def is_zero(self) -> bool | None:
        """Whether both constraints vanish everywhere; None if this is not decided."""
        both = (self.hamiltonian.is_zero, self.momentum.is_zero)
        return False if False in both else (None if None in both else True)

    def __repr__(self) -> str:
        parts = {"H": self.hamiltonian[()]}
        parts |= {f"M_{q}": self.momentum[i] for i, q in enumerate(self.frame.coordinates)}
        return "constraints: " + ", ".join(f"{name} = {value}" for name, value in parts.items())


@overload
def constraints(
    metric: SampledFrame,
    extrinsic_curvature: object = None,
    *,
    density: object = None,
    momentum: object = None,
    cosmological_constant: object = 0,
) -> SampledConstraints: ...
@overload
def constraints(
    metric: FrameLike | Surface,
    extrinsic_curvature: object = None,
    *,
    density: object = None,
    momentum: object = None,
    cosmological_constant: object = 0,
) -> Constraints: ...
def constraints(
    metric: FrameLike | Surface | SampledFrame,
    extrinsic_curvature: object = None,
    *,
    density: object = None,
    momentum: object = None,
    cosmological_constant: object = 0,
) -> Constraints | SampledConstraints:
    """Hamiltonian and momentum constraint of initial data, from formulas or on a grid.

    Equation
    --------
    H = R + K^2 - K_ij K^ij - 2 Lambda - 16 pi rho
    M_i = D_j K_i^j - D_i K - 8 pi j_i              [Gourgoulhon, gr-qc/0703035, section 4.4]
    K_ij = -(D_i n_j) with the future normal n, and j_i = -T_in: York's sign. G = c = 1.

    Parameters
    ----------
    metric
        Metric gamma_ij of the slice: a frame, the name of a space, or a `gt.surface` of a spacetime
        of signature -+++; or a `SampledFrame`, usually from `SampledFrame.from_metric`. Masked
        nodes are excised.
    extrinsic_curvature
        K_ij in coordinates, shape (d, d), of expressions, or an array (d, d, N_1, ..., N_d). The
        default is zero (time symmetry); 0 means the same. A surface has its own K_ij.
    density, momentum
        rho and j_i, an expression and d expressions; on a grid arrays (N_1, ...) and
        (d, N_1, ...), or a number and d numbers for the same value at all nodes.
    cosmological_constant
        Lambda; a number for data on a grid.

    Returns
    -------
    Constraints
        Of formulas: exact tensors.
    SampledConstraints
        On a grid: residuals with errors, norms and the order of convergence.

    Raises
    ------
    ShapeError, GridError
        Shapes do not fit.
    MetricError
        The metric of the slice is not positive.
    GravityError
        K is not symmetric.
    ArgumentError
        Both K and a surface are given.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> hole = gt.Frame("x y z", [["(1 + m/(2*sqrt(x**2+y**2+z**2)))**2" if i == j else 0
    ...                            for j in range(3)] for i in range(3)], parameters="m")
    >>> gt.gravity.constraints(hole).is_zero
    True
    """
    if isinstance(metric, SampledFrame):
        return sampled_constraints(
            metric, extrinsic_curvature, density, momentum, cosmological_constant
        )
    if isinstance(metric, Surface):
        frame = metric.frame
        if extrinsic_curvature is not None:
            raise ArgumentError(
                "extrinsic_curvature: expected none beside a surface, which has its own, got one. "
                "Omit it, or give the metric of the slice: surface.frame."
            )
        K = metric.extrinsic_curvature
        if metric.normal_sign > 0:
            raise MetricError(
                "metric: expected a spacelike surface in a spacetime of signature -+++, got one "
                "with a spacelike normal. Give a surface such as t = const."
            )
    else:
        frame = as_frame(metric, "metric")
        K = _given(frame, extrinsic_curvature)
    signs = [frame.eta[i, i] for i in range(frame.dimension)]
    if any(sign != 1 for sign in signs):
        raise MetricError(
            f"metric: expected the positive metric of a slice, got the signs {signs}. Take the "
            "slice of a spacetime: gt.surface(frame, 'x y z')."
        )
    n = frame.dimension
    rho, flux = None, None
    if not _is_zero(density):
        (rho,) = frame.read([("density", density)])
    if not _is_zero(momentum):
        rows = checks.entries(momentum, "momentum", ShapeError)
        checks.check_one_each(rows, n, "coordinates", "momentum", ShapeError)
        read = frame.read([(f"momentum[{i}]", x) for i, x in enumerate(rows)])
        flux = Tensor(frame, "d", {(i,): x for i, x in enumerate(read)})
    (constant,) = frame.read([("cosmological_constant", cosmological_constant)])
    H, M = constraint_tensors(frame, K, rho, flux, constant)
    return Constraints(frame, H, M)


def _is_zero(values: object) -> bool:
    """Whether values are omitted, or the number zero instead of components."""
    return values is None or (isinstance(values, int | float | sp.Number) and values == 0)


def _given(frame: Frame, rows: object) -> Tensor:
    """K_ij from a matrix of expressions, or zero."""
    n = frame.dimension
    if _is_zero(rows):
        return Tensor(frame, "dd", {}, symmetric(2), "K")
    if isinstance(rows, Tensor):
        rows = rows.tolist()
    table = [checks.entries(row, "extrinsic_curvature", ShapeError) for row in
             checks.entries(rows, "extrinsic_curvature", ShapeError)]  # fmt: skip
    if len(table) != n or any(len(row) != n for row in table):
        raise ShapeError(
            f"extrinsic_curvature: expected {n} rows of {n} entries, got rows of "
            f"{[len(row) for row in table]}."
        )
    places = [(i, j) for i in range(n) for j in range(n)]
    read = frame.read([(f"extrinsic_curvature[{i}, {j}]", table[i][j]) for i, j in places])
    entries: dict[tuple[int, ...], Element] = dict(zip(places, read, strict=True))
    for i, j in places:
        if not (entries[i, j] - entries[j, i]).is_zero:
            raise GravityError(
                f"extrinsic_curvature: expected a symmetric matrix, got {table[i][j]} at "
                f"[{i}, {j}] and {table[j][i]} at [{j}, {i}]."
            )
    return Tensor(frame, "dd", entries, symmetric(2), "K")
