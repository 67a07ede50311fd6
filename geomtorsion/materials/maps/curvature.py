"""Curvature: rotation of the lattice from pixel to pixel, and the density of dislocations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from geomtorsion.errors import OrientationError
from geomtorsion.materials.maps.symmetry import conjugated
from geomtorsion.rigid.attitude import product
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property


@dataclass(frozen=True, eq=False, repr=False)
class Curvature:
    """Lattice curvature at each pixel of an orientation map, within its grain.

    Equation
    --------
    kappa_ij = d theta_i / d x_j, theta the rotation of the crystal, j = x, y, by least squares over
    the four neighbours of a square grid or the six of a hexagonal grid that belong to the same
    grain; with all of them these are central differences. alpha_ik = kappa_ki - delta_ik kappa_mm
    (i: component of b, k: of the line, specimen axes), which equals eps_kab d_a e_ib of the coframe
    e = R. One plane of a map determines the components 12, 13, 21, 23 and 33 [Pantleon, Scripta
    Mater. 58 (2008) 994]; strain is neglected.

    tensor: kappa, rad per `unit`, shape (rows, columns, 3, 2), NaN where no neighbour is known.
    variance: of a component, from noise of variance 1, shape (rows, columns, 2).
    unit: of lengths.

    Examples
    --------
    A crystal bent about y along x by 0.02 degrees per um, with Burgers vectors of 0.25 nm:

    >>> import numpy as np
    >>> from geomtorsion.materials.maps import OrientationMap
    >>> angles = np.zeros((7, 9, 3))
    >>> angles[..., 0], angles[..., 1], angles[..., 2] = 90, 0.02 * np.arange(9), -90
    >>> bent = OrientationMap.from_euler(angles, 1.0, "m-3m", sigma=0)
    >>> bent.curvature.tensor[3, 4].round(6).tolist()
    [[0.0, 0.0], [0.000349, 0.0], [0.0, 0.0]]
    >>> density, floor = bent.gnd_density(0.25e-3)
    >>> density[3, 4].round(3), floor[3, 4]
    (np.float64(1.396), np.float64(0.0))
    """

    tensor: np.ndarray
    variance: np.ndarray
    unit: str

    @cached_property
    def nye(self) -> np.ndarray:
        """alpha_ik in specimen axes, shape (rows, columns, 3, 3).

        NaN for components that one plane of a map does not determine, and where no neighbour is
        known.
        """
        kappa = self.tensor
        alpha = np.full((*kappa.shape[:2], 3, 3), np.nan)
        for i, k in ((0, 1), (0, 2), (1, 0), (1, 2)):
            alpha[..., i, k] = kappa[..., k, i]
        alpha[..., 2, 2] = -kappa[..., 0, 0] - kappa[..., 1, 1]
        return alpha

    def gnd_density(self, burgers: float) -> np.ndarray:
        """Density of geometrically necessary dislocations from the five known components.

        rho = sqrt(sum alpha_ik alpha_ik) / b, a lower bound, shape (rows, columns), in lines per
        square of `unit`; NaN where a component is missing.

        Parameters
        ----------
        burgers
            Length of the Burgers vector, in `unit`.
        """
        b = checks.positive(burgers, "burgers", OrientationError)
        checks.measured(b, "burgers", OrientationError, is_length=True)
        # The other components are unknown at all pixels.
        components = self.nye[..., [0, 0, 1, 1, 2], [1, 2, 0, 2, 2]]
        return np.sqrt((components**2).sum(axis=-1)) / b

    def floor(
        self, burgers: float, phase: np.ndarray, noise: Mapping[int, np.ndarray]
    ) -> np.ndarray:
        """Root mean square of the density from noise, shape (rows, columns).

        phase: number of each pixel. noise: covariance of an orientation of each phase, rad^2.
        """
        traces = np.zeros(phase.shape)
        for number, covariance in noise.items():
            traces[phase == number] = np.trace(covariance)
        return np.sqrt(self.variance.sum(axis=-1) * traces) / burgers

    def __repr__(self) -> str:
        count = int(np.isfinite(self.tensor).all(axis=(2, 3)).sum())
        rows, columns = self.tensor.shape[:2]
        return f"Curvature({count:,} of {rows * columns:,} pixels, rad per {self.unit})"


def curvature_of(
    quaternions: np.ndarray,
    grain: np.ndarray,
    steps: tuple[float, float],
    shift: float,
    threshold: float,
    unit: str,
) -> Curvature:
    """The curvature of orientations within grains.

    quaternions: in the variant of each grain, shape (rows, columns, 4). grain: number of the grain
    of each pixel, -1 where nothing is known. shift: of every second row, in steps. threshold: angle
    between neighbours, rad, above which a wall separates them.
    """
    turns = _Turns(quaternions, grain, threshold)
    odd = np.arange(len(grain)) % 2
    # In a hexagonal grid, two pixels of the next row are equally close.
    near = [0 * odd] if not shift else [odd - 1, odd] if shift > 0 else [-odd, 1 - odd]
    sides = [(0, 0 * odd + 1), (0, 0 * odd - 1), *((k, one) for k in (1, -1) for one in near)]
    found = np.array([turns.to(*side) for side in sides])
    known = np.isfinite(found[..., 0])
    # Places of the neighbours in steps, shape (neighbours, rows, 1, 2).
    away = np.array([
        np.stack([columns + shift * (abs(odd - k % 2) - odd), 0.0 * odd + k], axis=-1)
        for k, columns in sides
    ])[:, :, None]  # fmt: skip
    away = np.where(known[..., None], away, 0.0)
    inverse = _inverse(np.einsum("nrcj,nrck->rcjk", away, away))
    weights = np.einsum("nrcj,rcjk->nrck", away, inverse) / np.array(steps)
    tensor = np.einsum("nrci,nrck->rcik", np.where(known[..., None], found, 0.0), weights)
    # Each difference contains the noise of a neighbour, and all contain the noise of the pixel.
    variance = (weights**2).sum(axis=0) + weights.sum(axis=0) ** 2
    return Curvature(tensor, variance, unit)


def _inverse(squares: np.ndarray) -> np.ndarray:
    """Inverses of symmetric matrices in whole and half steps; NaN for unknown directions."""
    xx, xy, yy = squares[..., 0, 0], squares[..., 0, 1], squares[..., 1, 1]
    determinant = xx * yy - xy**2
    with np.errstate(divide="ignore", invalid="ignore"):
        full = np.stack([yy, -xy, -xy, xx], axis=-1) / determinant[..., None]
        # Neighbours along one axis determine only this derivative.
        along_x = np.where(xx * (yy == 0) > 0, 1 / xx, np.nan)
        along_y = np.where(yy * (xx == 0) > 0, 1 / yy, np.nan)
    zero = np.zeros_like(xx)
    single = np.stack([along_x, zero, zero, along_y], axis=-1)
    return np.where((determinant > 0)[..., None], full, single).reshape(squares.shape)


@dataclass(frozen=True, eq=False)
class _Turns:
    """Orientations and grains, for rotations from pixels to their neighbours."""

    quaternions: np.ndarray
    grain: np.ndarray
    threshold: float

    def to(self, rows: int, columns: np.ndarray) -> np.ndarray:
        """Rotation vectors to the pixels at an offset, rad, specimen axes, (rows, columns, 3).

        NaN where the other pixel belongs to another grain or the angle reaches the threshold.

        rows: offset, one for all pixels. columns: offset, one for each row.
        """
        row, column = np.indices(self.grain.shape)
        other = row + rows, column + columns[:, None]
        inside = np.ones(self.grain.shape, dtype=bool)
        for place, size in zip(other, self.grain.shape, strict=True):
            inside &= (place >= 0) & (place < size)
        a, b = (np.where(inside, x, 0) for x in other)
        same = inside & (self.grain >= 0) & (self.grain[a, b] == self.grain)
        turn = product(self.quaternions[a, b], conjugated(self.quaternions))
        size = np.linalg.norm(turn[..., 1:], axis=-1)
        angle = 2 * np.arctan2(size, np.abs(turn[..., 0]))
        same &= angle < self.threshold
        scale = np.copysign(angle / np.maximum(size, 1e-300), turn[..., 0])
        vector = scale[..., None] * turn[..., 1:]
        return np.where(same[..., None], vector, np.nan)
