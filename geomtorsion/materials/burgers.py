"""Burgers: the closure failure of a circuit in measured matter, with its errors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.conventions import Signed
from geomtorsion.loops import Interpolant
from geomtorsion.materials.detours import Detour
from geomtorsion.support.caching import cached_property
from geomtorsion.support.outgoing import measured_text
from geomtorsion.support.precision import CALCULATED

# The accepted share of false alarms: circuits without torsion whose noise looks significant.
CHANCE = 1e-3
# Plain data, as JSON has it.
Json = dict[str, Any]
# One number for all circuits, or an array with a number for each.
Numbers = float | np.ndarray
# Covariance of each pair of components i <= j; a missing pair has covariance zero.
Covariance = Mapping[tuple[int, int], Numbers]


@dataclass(frozen=True)
class Section:
    """A plane of a source: its two axes, and its coordinates on the other axes, in order."""

    plane: tuple[int, int] = (0, 1)
    at: tuple[float, ...] = ()

    @classmethod
    def of(cls, points: np.ndarray, area: np.ndarray) -> Section:
        """The coordinate plane in which a circuit encloses the largest area, through its middle.

        points: of the circuit, shape (d, k). area: enclosed in each plane, shape (d, d).
        """
        one, two = np.unravel_index(int(np.abs(np.triu(area)).argmax()), area.shape)
        plane = (int(one), int(two)) if one != two else (0, 1)
        others = [k for k in range(len(area)) if k not in plane]
        return cls(plane, tuple(points[others].mean(axis=1).tolist()))


# The only plane of a source with two axes.
PLANE = Section()


@dataclass(frozen=True, eq=False, repr=False)
class Burgers(Signed):
    """Burgers vector of a circuit through a field, an orientation map, an image, lines or atoms.

    vector: b^i, shape (n,), in `unit`, from start to finish of a right-handed circuit.
    covariance: of the components, from noise, shape (n, n), in `unit` squared; zero where the noise
        is unknown.
    systematic: name of each error other than noise -> bound on its largest component.
    whole: b in lattice vectors, whole numbers, shape (k,); empty where b is not counted.
    lattice: the lattice vectors as rows, shape (k, n), in `unit`; empty if `whole` is.
    chance: probability that noise has changed `whole`.
    name: of the circuit. path: the integration path in the plane of `section`, shape (2, k), with
        NaN between parts; empty where it is not known.
    area: enclosed in that plane, signed, in the square of `length_unit`.
    arrow: b along the axes of that plane, shape (2,); None where b has no such direction.
    section: plane of the circuit. components: names of the entries of `vector`.
    detour: how the circuit goes around missing nodes; None where it meets none.
    interpolant: of a grid, for `prove`, which integrates it exactly; None for other sources.

    Examples
    --------
    >>> b = Burgers(np.array([3.0, 4.0]), "nm", np.diag([0.04, 0.05]), {"interpolation": 0.4})
    >>> b
    Burgers((3.00 +- 0.45, 4.00 +- 0.46) nm, error 0.5: noise 0.3, interpolation 0.4)
    >>> b.magnitude, round(b.noise, 3), round(b.error, 3), b.is_significant
    (5.0, 0.3, 0.5, True)
    """

    vector: np.ndarray
    unit: str = ""
    covariance: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    systematic: Mapping[str, float] = field(default_factory=dict)
    whole: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    lattice: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    chance: float = 0.0
    name: str = ""
    path: np.ndarray = field(default_factory=lambda: np.zeros((2, 0)))
    area: float = 0.0
    arrow: np.ndarray | None = None
    section: Section = PLANE
    components: tuple[str, ...] = ()
    length_unit: str = ""
    detour: Detour | None = None
    interpolant: Interpolant | None = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Set a missing covariance to zero, and number components without names."""
        if not self.covariance.size:
            object.__setattr__(self, "covariance", np.zeros((len(self.vector),) * 2))
        if not self.components:
            object.__setattr__(self, "components", numbered(len(self.vector)))

    @property
    def magnitude(self) -> float:
        """Length of the vector, in `unit`."""
        return float(np.linalg.norm(self.vector))

    @property
    def sigmas(self) -> np.ndarray:
        """Standard deviation of each component from noise, shape (n,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def noise(self) -> float:
        """Root mean square of |b| from noise; for a counted b, from the chance of a wrong count."""
        if self.whole.size:
            longest = np.linalg.norm(self.lattice, axis=1).max()
            return float(np.sqrt(self.chance) * longest)
        return float(np.sqrt((self.sigmas**2).sum()))

    @property
    def errors(self) -> np.ndarray:
        """Error of each component, noise and systematic errors in quadrature, shape (n,)."""
        return np.hypot(self.sigmas, self.systematic_error)

    @property
    def text(self) -> str:
        """The vector with its errors, rounded by them, and its unit."""
        return measured_text(self.vector.tolist(), self.errors.tolist(), self.unit)

    @property
    def systematic_error(self) -> float:
        """Sum of all errors other than noise, for the largest component, in `unit`."""
        return sum(self.systematic.values())

    @property
    def error(self) -> float:
        """Noise and systematic errors, added in quadrature, in `unit`."""
        return float(np.hypot(self.noise, self.systematic_error))

    @cached_property
    def significance(self) -> float:
        """|b| in units of its errors: sqrt(b C^-1 b).

        C is the covariance of the noise plus the square of the systematic error on its diagonal.
        Pure noise gives about sqrt(n); a vector without any error gives infinity. The significance
        of a counted vector is the length that normal noise exceeds with probability `chance`.
        """
        if self.whole.size:
            return float(counted_significances(self.whole, self.chance, len(self.vector)))
        rows = range(len(self.vector))
        covariance = {(i, j): self.covariance[i, j] for i in rows for j in rows[i:]}
        return float(significances(self.vector, covariance, self.systematic_error))

    @property
    def is_significant(self) -> bool:
        """Whether pure noise reaches this significance in less than one of a thousand circuits."""
        return bool(self.significance > noise_level(len(self.vector)))

    @property
    def facts(self) -> Json:
        """Further facts by name, as plain JSON data."""
        if not self.whole.size:
            return {}
        vectors = self.lattice.tolist()
        return {"whole": self.whole.tolist(), "chance": self.chance, "vectors": vectors}

    def to_json(self) -> Json:
        """The result as plain JSON data; an infinite significance (no noise) becomes None."""
        finite = np.isfinite(self.significance)
        return {
            "loop": self.name,
            "vector": self.vector.tolist(),
            "components": list(self.components),
            "errors": self.errors.tolist(),
            "magnitude": self.magnitude,
            "noise": self.noise,
            "error": self.error,
            "grid_error": self.systematic_error,
            "significance": self.significance if finite else None,
            "significant": self.is_significant,
            "area": self.area,
            "unit": self.length_unit,
            "vector_unit": self.unit,
            "detour": None if self.detour is None else self.detour.to_json(),
            **self.facts,
        }

    def __repr__(self) -> str:
        parts = {"noise": self.noise} | dict(self.systematic)
        errors = ", ".join(f"{name} {size:.2g}" for name, size in parts.items() if size)
        counted = f" = {self.whole.tolist()} in lattice vectors" if self.whole.size else ""
        error_text = f", error {self.error:.2g}: {errors}" if errors else ""
        return f"{type(self).__name__}({self.text}{counted}{error_text})"


def numbered(rows: int) -> tuple[str, ...]:
    """Default names of the components of b along a frame.

    Examples
    --------
    >>> numbered(2)
    ('b0', 'b1')
    """
    return tuple(f"b{k}" for k in range(rows))


def noise_level(rows: int, share: Numbers = CHANCE) -> np.ndarray:
    """The length that normal noise of `rows` components exceeds in this share of all circuits.

    Examples
    --------
    >>> float(noise_level(1).round(3)), float(noise_level(3).round(3))
    (3.291, 4.033)
    """
    return np.sqrt(scipy.special.chdtri(rows, share))


def significances(
    vectors: np.ndarray, covariance: Covariance, systematic: Numbers = 0.0
) -> np.ndarray:
    """sqrt(b C^-1 b) of one or many Burgers vectors; infinite where there are no errors.

    Equation
    --------
    C = L D L^T, so that b C^-1 b = sum of y_i^2 / D_i with L y = b.

    Parameters
    ----------
    vectors
        b^i, shape (rows, places...).
    covariance
        From noise; one for all places or one for each.
    systematic
        Other error of each component; one for all places or one for each. Its square is added to
        the diagonal of C.

    Examples
    --------
    >>> b = np.array([[3.0, 3.0], [4.0, 0.0]])
    >>> significances(b, {(0, 0): 1.0, (1, 1): 1.0}), significances(b, {(0, 0): 1.0}, 0.0)
    (array([5., 3.]), array([inf,  3.]))
    """
    rows = len(vectors)
    rests: list[np.ndarray] = []
    pivots: list[np.ndarray] = []
    factors: dict[tuple[int, int], np.ndarray] = {}
    total = np.zeros(())
    with np.errstate(divide="ignore", invalid="ignore"):
        for i in range(rows):
            rest = vectors[i]
            pivot = square = np.square(systematic) + covariance.get((i, i), 0.0)
            size = np.abs(rest)
            for k in range(i):
                shared = covariance.get((k, i), 0.0)
                for j in range(k):
                    if (k, j) in factors and (i, j) in factors:
                        shared = shared - factors[k, j] * factors[i, j] * pivots[j]
                if not np.any(shared):
                    continue
                factors[i, k] = factor = np.where(pivots[k] > 0, shared / pivots[k], 0.0)
                rest = rest - factor * rests[k]
                size = size + np.abs(factor * rests[k])
                pivot = pivot - factor**2 * pivots[k]
                # A difference below the rounding error of its terms is set to zero.
                rest = np.where(np.abs(rest) <= CALCULATED * size, 0.0, rest)
                pivot = np.where(pivot <= CALCULATED * square, 0.0, pivot)
            rests.append(rest)
            pivots.append(pivot)
            total = total + np.where(rest == 0, 0.0, rest / np.sqrt(pivot)) ** 2
    return np.sqrt(total)


def counted_significances(whole: np.ndarray, chance: Numbers, rows: int) -> np.ndarray:
    """Significance of counted Burgers vectors: the length that normal noise exceeds by `chance`.

    The significance is zero where all whole numbers are zero.

    whole: shape (k, places...). chance: probability that noise changed the whole numbers, one for
    all places or one for each. rows: number of components of b.
    """
    return np.where(whole.any(axis=0), noise_level(rows, chance), 0.0)
