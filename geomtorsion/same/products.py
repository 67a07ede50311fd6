"""Products: the factors of a metric that is locally a product, from its holonomy (de Rham)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np
import sympy as sp

from geomtorsion.errors import SingularPointError
from geomtorsion.geometry import levi_civita
from geomtorsion.same.invariant_values import ROUNDING, Array
from geomtorsion.same.invariants import Invariants
from geomtorsion.same.scalars import is_constant


@dataclass(frozen=True)
class Factor:
    """One factor of a product.

    dimension: its dimension.
    curvature: its constant sectional curvature, 0 for flat; None: another geometry.
    """

    dimension: int
    curvature: sp.Expr | None

    def __str__(self) -> str:
        if self.dimension == 1:
            return "a line"
        size = f"{self.dimension} dimensions"
        if self.curvature is None:
            return f"{self.dimension} curved dimensions"
        return (
            f"{size} without curvature"
            if self.curvature == 0
            else (f"{size} of curvature {self.curvature}")
        )


def factors(metric: Invariants) -> tuple[Factor, ...]:
    """The factors, the flat one first; empty where the metric is not seen to be a product.

    Equation
    --------
    Parallel tensors h_ab with X_a^m h_mb + X_b^m h_am = 0 for all X of the holonomy algebra; their
    eigenspaces are the factors.
    """
    n, algebra = metric.frame.dimension, levi_civita(metric.frame).holonomy_algebra
    if n < 2 or algebra.dimension == n * (n - 1) // 2:
        return ()
    point = _matrices(metric, algebra.generators)
    if point is None:
        return ()
    matrices, g = point
    flat = _kernel(np.concatenate([x.T for x in matrices]))
    parts = [flat] if len(flat) else []
    rest = _kernel(flat @ g) if len(flat) else np.eye(n)
    if len(flat) and abs(np.linalg.det(flat @ g @ flat.T)) < ROUNDING:
        # A parallel null vector splits nothing off.
        return ()
    curved = _split(matrices, g, rest)
    if curved is None or len(parts) + len(curved) < 2:
        return ()
    result = [Factor(len(flat), sp.Integer(0))] if parts else []
    if len(curved) == 1:
        return (*result, Factor(len(curved[0]), _curvature(metric, len(curved[0]))))
    return (*result, *(Factor(len(part), None) for part in curved))


def _matrices(metric: Invariants, generators: Sequence) -> tuple[list[Array], Array] | None:
    """The generators X_a^b and the metric at a generic point."""
    frame = metric.frame
    product = frame.metric if frame.complex else frame.eta
    for point in islice(frame.region.points(), 20):
        try:
            matrices = [np.asarray(x.at(point), dtype=complex) for x in generators]
            g = np.asarray(product.at(point), dtype=complex)
        except SingularPointError:
            continue
        if all(np.all(np.abs(np.imag(x)) <= ROUNDING) for x in (*matrices, g)):
            sizes = [np.max(np.abs(x), initial=0) or 1.0 for x in matrices]
            return [np.real(x) / s for x, s in zip(matrices, sizes, strict=True)], np.real(g)
        return None
    return None


def _kernel(matrix: Array) -> Array:
    """A basis (rows) of the vectors v with matrix v = 0."""
    _, sizes, vectors = np.linalg.svd(matrix)
    rank = int(np.sum(sizes > ROUNDING * max(sizes[0], 1e-300))) if len(sizes) else 0
    return vectors[rank:]


def _split(matrices: Sequence[Array], g: Array, basis: Array) -> list[Array] | None:
    """The invariant subspaces of the matrices; None where they do not span the space."""
    n = len(g)
    eye = np.eye(n)
    conditions = [np.kron(x, eye) + np.kron(eye, x) for x in matrices]
    conditions.append(np.kron(eye, eye) - np.kron(eye, eye)[:, _swapped(n)])
    parallel = _kernel(np.concatenate(conditions))
    if not len(parallel) or not len(basis):
        return []
    # Fixed numbers of no particular ratio, so that no eigenvalues coincide by accident.
    mixed = np.sqrt(2 + np.arange(len(parallel))) @ parallel
    inside = basis @ (np.linalg.inv(g) @ mixed.reshape(n, n)) @ np.linalg.pinv(basis)
    values, vectors = np.linalg.eig(inside.T)
    if np.max(np.abs(np.imag(values))) > ROUNDING or np.linalg.cond(vectors) > 1 / ROUNDING:
        return None
    order = np.argsort(np.real(values))
    parts: list[list[int]] = []
    for k in order:
        if parts and abs(values[k] - values[parts[-1][-1]]) < np.sqrt(ROUNDING):
            parts[-1].append(k)
        else:
            parts.append([k])
    return [np.real(vectors)[:, part].T @ basis for part in parts]


def _swapped(n: int) -> Array:
    """Positions of h_ba in the row of all h_ab."""
    return np.arange(n * n).reshape(n, n).T.ravel()


def _curvature(metric: Invariants, n: int) -> sp.Expr | None:
    """The constant curvature of the only curved factor, which has n dimensions."""
    curvature = levi_civita(metric.frame).curvature
    scalar = curvature.scalar.element()
    if not is_constant(metric, scalar):
        return None
    if n > 2:
        # R_ab R^ab = R^2 / n, as R_abcd R^abcd = 2 R^2 / (n (n - 1)), for constant curvature only.
        rest = curvature.kretschmann.element() * (n * (n - 1)) - scalar * scalar * 2
        if rest.is_zero is not True:
            return None
    return sp.factor(scalar.sympy / (n * (n - 1)))
