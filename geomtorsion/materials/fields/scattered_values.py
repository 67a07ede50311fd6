"""Scattered values: checks of points and values, rules along edges, and noise."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.errors import LONGEST_SHOWN, GridError
from geomtorsion.materials.fields.displacement import lattice_vectors
from geomtorsion.materials.fields.grid import Grid, mask_of
from geomtorsion.materials.fields.noise import (
    JumpNoise,
    chances_of,
    noise_of,
    robust_covariance,
    spread,
)
from geomtorsion.materials.fields.triangulation import Triangulation, checked_polygons
from geomtorsion.support import checks


def checked_points(given: object) -> np.ndarray:
    """Coordinates of points in the plane or in space, checked."""
    points = checks.array(given, "points", GridError, shape=(None, None))
    checks.measured(points, "points", GridError, is_length=True)
    if points.shape[1] not in (2, 3) or len(points) <= points.shape[1]:
        raise GridError(
            "points: expected shape (N, 2) with N > 2 or (N, 3) with N > 3, one point in each row, "
            f"got {points.shape}."
        )
    return points


def mesh_of(
    places: np.ndarray, unknown: np.ndarray, options: dict[str, Any]
) -> tuple[Triangulation, dict[str, str]]:
    """The triangulation and the texts, from the options common to all makers."""
    choices = {"mask", "longest", "boundary", "unit", "vector_unit", "source"}
    for name in options:
        checks.known_name(name, sorted(choices), "option", GridError)
    texts = {k: options[k] for k in ("unit", "vector_unit", "source") if k in options}
    for key, text in texts.items():
        checks.text(text, key, GridError, longest=LONGEST_SHOWN)
    longest = options.get("longest")
    if longest is not None:
        longest = checks.positive(longest, "longest", GridError)
        checks.measured(longest, "longest", GridError, is_length=True)
    boundary = checked_polygons(options.get("boundary"))
    if boundary and places.shape[1] != 2:
        raise GridError(
            "boundary: a boundary needs points in a plane; these have three coordinates. Omit "
            "the boundary."
        )
    mask = mask_of(options.get("mask"), (len(places),)) | unknown
    return Triangulation.of(places, mask, longest, boundary), texts


def check_finite(values: np.ndarray, name: str, mesh: Triangulation) -> None:
    """Refuse infinite values at points of the region."""
    bad = np.argwhere(np.isinf(values[..., mesh.inner]))
    if len(bad):
        raise GridError(
            f"{name}: expected finite values, got infinity at point {mesh.inner[bad[0, -1]]}. Mask "
            "it (NaN is a hole)."
        )


def edge_rules(mesh: Triangulation) -> tuple[Any, Any]:
    """Matrices from values at points to means along edges: by trapezoids, and with correction.

    The integral of f(t) from 0 to 1 is (f(0) + f(1)) / 2 - (f'(1) - f'(0)) / 12 + ...
    """
    a, b = mesh.complex.pairs.T
    edges, shape = np.arange(len(a)), (len(a), len(mesh.points))
    one, two = (scipy.sparse.csr_array((np.ones(len(a)), (edges, k)), shape=shape) for k in (a, b))
    plain = (one + two) / 2
    bend = sum(
        scipy.sparse.diags_array(step) @ ((two - one) @ slope)
        for step, slope in zip(mesh.steps.T, mesh.slopes, strict=True)
    )
    return plain.tocsr(), (plain - bend / 12).tocsr()


def row_of_points(holes: np.ndarray) -> Grid:
    """Points as a grid of one row, so that noise is checked as on grids."""
    return Grid((np.arange(float(len(holes))),), ("point",), (False,), holes)


def estimated_noise(
    mesh: Triangulation, values: np.ndarray, sigma: Any, covariance: Any
) -> tuple[np.ndarray | None, np.ndarray | None, str]:
    """Standard deviations, or covariances, from deviations from planes through neighbours."""
    table, inside = mesh.departures
    flat = np.where(np.isnan(values), 0.0, values).reshape(-1, values.shape[-1])
    rows = list((table @ flat.T).T)
    origin = f"the median of deviations from planes through the neighbours of {len(inside)} points"
    if covariance is None:
        return np.array([spread(row) for row in rows]).reshape(values.shape[:2]), None, origin
    return sigma, robust_covariance(rows), origin


def without_jumps(
    mesh: Triangulation, values: np.ndarray, steps: np.ndarray, branch: Any, sigma: Any
) -> tuple[np.ndarray, JumpNoise | None, str]:
    """Differences of a displacement along edges minus their jumps, their noise, and its origin."""
    rows, (a, b) = len(values), mesh.complex.pairs.T
    noise, origin = None, ""
    if branch is not None:
        vectors = lattice_vectors(branch, rows)
        inverse = np.linalg.pinv(vectors)
        times = np.rint(steps @ inverse)
        rest = steps @ inverse - times
        steps = steps - times @ vectors
        if sigma is not None:
            grid = row_of_points(~np.isin(np.arange(values.shape[1]), mesh.inner))
            how = ""
            if isinstance(sigma, str) and sigma == "estimate":
                # Points next to a cut are far from any plane, but few, so that medians ignore
                # them.
                sigma, _, how = estimated_noise(mesh, values[:, None], sigma, None)
            *_, point_noise, origin = noise_of(sigma, None, values[:, None], grid)
            origin = how or origin
            assert point_noise is not None
            variances = np.array([point_noise.at_nodes(i, 0, grid.shape) for i in range(rows)])
            width = np.sqrt((variances[:, a] + variances[:, b]).T @ inverse**2)
            noise = JumpNoise(chances_of(rest, width), vectors)
    return steps, noise, origin
