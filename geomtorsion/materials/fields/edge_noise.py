"""Edge noise: what noise at points makes of sums of integrals along edges between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
import scipy  # loads its parts when they are asked for

from geomtorsion.materials.fields.noise import Noise

if TYPE_CHECKING:
    from scipy.sparse import csr_array


class EdgeNoise(Protocol):
    """Noise of integrals along edges. chains: how often each edge is run through, (k, edges)."""

    def covariance(self, chains: csr_array) -> np.ndarray:
        """Of the sum along each chain, shape (k, rows, rows)."""
        ...

    def difference(self, chains: csr_array) -> np.ndarray:
        """Variance of the difference from another rule along each chain, shape (k, rows)."""
        ...


@dataclass(frozen=True, eq=False)
class NodeNoise:
    """Noise of values at points.

    noise: of the values. steps: along each edge, shape (edges, d). rule, less_other: values at
    points to their mean along each edge, and that less the mean by another rule, (edges, points).
    """

    noise: Noise
    steps: np.ndarray
    rule: csr_array
    less_other: csr_array

    def covariance(self, chains: csr_array) -> np.ndarray:
        """Each point counts with the square of all that a chain has of it."""
        return self._of(chains, self.rule)

    def difference(self, chains: csr_array) -> np.ndarray:
        """The diagonal of the same for the other rule."""
        return np.diagonal(self._of(chains, self.less_other), axis1=1, axis2=2)

    def _of(self, chains: csr_array, rule: csr_array) -> np.ndarray:
        weights = [chains @ scipy.sparse.diags_array(step) @ rule for step in self.steps.T]
        return self.noise.of_sums([w.tocsr() for w in weights])


@dataclass(frozen=True, eq=False)
class JumpNoise:
    """Chances that noise has changed by how many lattice vectors a displacement jumps.

    chances: of each edge and vector, shape (edges, k). vectors: shape (k, rows).
    """

    chances: np.ndarray
    vectors: np.ndarray

    def covariance(self, chains: csr_array) -> np.ndarray:
        """Each wrong jump changes the sum by a lattice vector."""
        total = abs(chains) @ self.chances
        return np.einsum("ck,ki,kj->cij", total, self.vectors, self.vectors)

    def difference(self, chains: csr_array) -> np.ndarray:
        """There is no other rule."""
        return np.zeros((chains.shape[0], self.vectors.shape[1]))


def chances_of(rest: np.ndarray, sigma: np.ndarray) -> np.ndarray:
    """Chances that noise has carried a whole number to the next, shape of the rests.

    What is left of a difference is noise about 0, or noise about the next whole number.
    """
    away = 1 - 2 * np.abs(rest)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(sigma > 0, away / (2 * sigma**2), np.where(away > 0, np.inf, 0.0))
    return scipy.special.expit(-share)
