"""Edge noise: noise of sums of integrals along edges, from the noise at the points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.materials.fields.noise import Noise

if TYPE_CHECKING:
    from scipy.sparse import csr_array


class EdgeNoise(Protocol):
    """Noise of integrals along edges; chains: multiplicity of each edge, shape (k, edges)."""

    def covariance(self, chains: csr_array) -> np.ndarray:
        """Covariance of the sum along each chain, shape (k, rows, rows)."""
        ...

    def difference(self, chains: csr_array) -> np.ndarray:
        """Variance of the difference from another rule along each chain, shape (k, rows)."""
        ...


@dataclass(frozen=True, eq=False)
class NodeNoise:
    """Noise of values at points.

    noise: of the values. steps: along each edge, shape (edges, d). rule: matrix from values at
    points to their mean along each edge, (edges, points). less_other: `rule` minus the matrix of
    another rule.
    """

    noise: Noise
    steps: np.ndarray
    rule: csr_array
    less_other: csr_array

    def covariance(self, chains: csr_array) -> np.ndarray:
        """Covariance from the square of the total weight of each point in a chain."""
        return self._of(chains, self.rule)

    def difference(self, chains: csr_array) -> np.ndarray:
        """Variance of the difference from the other rule, from the weights `less_other`."""
        return np.diagonal(self._of(chains, self.less_other), axis1=1, axis2=2)

    def _of(self, chains: csr_array, rule: csr_array) -> np.ndarray:
        weights = [chains @ scipy.sparse.diags_array(step) @ rule for step in self.steps.T]
        return self.noise.of_sums([w.tocsr() for w in weights])


@dataclass(frozen=True, eq=False)
class JumpNoise:
    """Chances that noise has changed the jumps of a displacement.

    chances: of each edge and vector, shape (edges, k). vectors: shape (k, rows).
    """

    chances: np.ndarray
    vectors: np.ndarray

    def covariance(self, chains: csr_array) -> np.ndarray:
        """Covariance from wrong jumps, each of which changes the sum by a lattice vector."""
        total = abs(chains) @ self.chances
        return np.einsum("ck,ki,kj->cij", total, self.vectors, self.vectors)

    def difference(self, chains: csr_array) -> np.ndarray:
        """Zero, because there is no other rule."""
        return np.zeros((chains.shape[0], self.vectors.shape[1]))


def chances_of(rest: np.ndarray, sigma: np.ndarray) -> np.ndarray:
    """Chances that noise has changed a whole number by one, shape of the rests.

    The rest of a difference is noise around 0, or noise around the next whole number.
    """
    away = 1 - 2 * np.abs(rest)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(sigma > 0, away / (2 * sigma**2), np.where(away > 0, np.inf, 0.0))
    return scipy.special.expit(-share)
