"""Burgers: the closure failure of a circuit in measured matter, with its errors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy  # loads its parts when they are asked for

from geomtorsion.caching import cached_property
from geomtorsion.conventions import Signed

# The share of circuits without torsion in which noise alone may look significant.
CHANCE = 1e-3


@dataclass(frozen=True, eq=False, repr=False)
class Burgers(Signed):
    """Burgers vector of a circuit through a field, an orientation map, an image, lines or atoms.

    vector: b^i, shape (n,), in `unit`, from start to finish of a right-handed circuit.
    covariance: of its components by noise, shape (n, n), unit squared; zero where noise is unknown.
    systematic: name -> bound on the largest component, of each error that is not noise.
    whole: b in lattice vectors, whole numbers, shape (k,); empty where b is not counted.
    lattice: the lattice vectors as rows, shape (k, n), in `unit`; empty with `whole`.
    chance: that noise has changed `whole`.

    Examples
    --------
    >>> b = Burgers(np.array([3.0, 4.0]), "nm", np.diag([0.04, 0.05]), {"interpolation": 0.4})
    >>> b, b.magnitude, round(b.noise, 3), round(b.error, 3), b.is_significant
    (Burgers([3, 4] nm, error=0.5: noise 0.3, interpolation 0.4), 5.0, 0.3, 0.5, True)
    """

    vector: np.ndarray
    unit: str = ""
    covariance: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    systematic: Mapping[str, float] = field(default_factory=dict)
    whole: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    lattice: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    chance: float = 0.0

    def __post_init__(self) -> None:
        """Without noise the covariance is zero."""
        if not self.covariance.size:
            object.__setattr__(self, "covariance", np.zeros((len(self.vector),) * 2))

    @property
    def magnitude(self) -> float:
        """Length of the vector, in `unit`."""
        return float(np.linalg.norm(self.vector))

    @property
    def sigmas(self) -> np.ndarray:
        """Standard deviation of each component by noise, shape (n,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def noise(self) -> float:
        """Root mean square of |b| by noise alone; of `whole` from the chance of one more."""
        if self.whole.size:
            longest = np.linalg.norm(self.lattice, axis=1).max()
            return float(np.sqrt(self.chance) * longest)
        return float(np.sqrt((self.sigmas**2).sum()))

    @property
    def systematic_error(self) -> float:
        """All errors that are not noise together, of the largest component, in `unit`."""
        return sum(self.systematic.values())

    @property
    def error(self) -> float:
        """Noise and all systematic errors together, in `unit`."""
        return float(np.hypot(self.noise, self.systematic_error))

    @cached_property
    def significance(self) -> float:
        """|b| in units of its errors: sqrt(b C^-1 b), C the noise and, on its diagonal, the rest.

        Noise alone gives sqrt(n) or so; without any error it is infinite. Of counted vectors the
        length that normal noise passes with their chance of being wrong.
        """
        if self.whole.size:
            return float(noise_level(len(self.vector), self.chance)) if self.whole.any() else 0.0
        return float(significances(self.vector, self.covariance, self.systematic_error))

    @property
    def is_significant(self) -> bool:
        """Whether noise alone gives as much in less than one circuit of a thousand."""
        return bool(self.significance > noise_level(len(self.vector)))

    def __repr__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        parts = {"noise": self.noise} | dict(self.systematic)
        errors = ", ".join(f"{name} {size:.2g}" for name, size in parts.items() if size)
        shown = ", ".join(f"{x:.6g}" for x in self.vector.tolist())
        counted = f" = {self.whole.tolist()} in lattice vectors" if self.whole.size else ""
        said = f", error={self.error:.2g}: {errors}" if errors else ""
        return f"{type(self).__name__}([{shown}]{unit}{counted}{said})"


def noise_level(rows: int, share: Any = CHANCE) -> Any:
    """The length that normal noise of `rows` components passes in this share of all circuits.

    Examples
    --------
    >>> float(noise_level(1).round(3)), float(noise_level(3).round(3))
    (3.291, 4.033)
    """
    return np.sqrt(scipy.special.chdtri(rows, share))


def significances(
    vectors: np.ndarray, covariance: np.ndarray, other: np.ndarray | float = 0.0
) -> np.ndarray:
    """sqrt(b C^-1 b), shape (...,), for b (..., n); infinite where there are no errors.

    covariance: by noise, one for all or one for each; C has the square of the other errors (one for
    all or one for each) added to each component.
    """
    values, axes = np.linalg.eigh(covariance)
    parts = np.einsum("...i,...ij->...j", vectors, axes)
    sizes = np.sqrt(np.maximum(values, 0) + np.asarray(other)[..., None] ** 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.where(parts == 0, 0.0, np.abs(parts) / sizes)
    return np.sqrt((shares**2).sum(axis=-1))


def independent_significances(
    vectors: np.ndarray, sigmas: np.ndarray, other: np.ndarray
) -> np.ndarray:
    """`significances` of components with independent noise, shape (places...).

    vectors, sigmas: shape (rows, places...). other: the other error of each component, shape
    (places...). NaN where b is unknown, infinite where b has no error.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.where(vectors == 0, 0.0, vectors / np.hypot(sigmas, other))
    return np.sqrt((shares**2).sum(axis=0))
