"""Scattered map: Burgers vectors of many circuits between scattered points, with their errors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geomtorsion.materials.fields.noise import significances


@dataclass(frozen=True, eq=False, repr=False)
class ScatteredMap:
    """Burgers vectors of circuits between scattered points.

    vectors: b^i, shape (rows, circuits); places: mean of the points of each, shape (d, circuits).
    covariance: of the components by noise, shape (circuits, rows, rows).
    interpolation: distance from another rule, without what noise explains of it, (circuits,).
    areas: of each circuit, shape (circuits,). units: of length and of b.
    """

    vectors: np.ndarray
    places: np.ndarray
    covariance: np.ndarray
    interpolation: np.ndarray
    areas: np.ndarray
    units: tuple[str, str] = ("", "")

    @property
    def sigmas(self) -> np.ndarray:
        """Standard deviation by noise, shape of the vectors."""
        return np.sqrt(np.diagonal(self.covariance, axis1=1, axis2=2)).T

    @property
    def errors(self) -> np.ndarray:
        """Of the largest component: interpolation and noise, shape (circuits,)."""
        return np.hypot(self.interpolation, self.sigmas.max(axis=0))

    @property
    def density(self) -> np.ndarray:
        """b^i per area."""
        return self.vectors / self.areas

    @property
    def noise_floor(self) -> np.ndarray:
        """Standard deviation of the density by noise."""
        return self.sigmas / self.areas

    @property
    def significance(self) -> np.ndarray:
        """|b| against its errors, sqrt(b C^-1 b): pure noise gives sqrt(rows) or so."""
        return significances(self.vectors.T, self.covariance, self.interpolation)

    def __repr__(self) -> str:
        length, b = self.units
        units = f", in {b}, lengths in {length}" if length or b else ""
        return f"ScatteredMap({len(self.areas)} circuits{units})"
