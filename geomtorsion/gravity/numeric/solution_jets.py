"""Solution jets: power series that solve field equations, and the freedom of nearby solutions."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from geomtorsion.geometry.numeric.numeric_field import Numeric
from geomtorsion.geometry.numeric.power_series import PowerSeries
from geomtorsion.support.allowance import check_limits
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import EPS

# Field equations at power series of the fields: elements with their linear operators.
Equations = Callable[[PowerSeries, np.ndarray], Sequence[Numeric]]
# Steps of Newton's method after which a start counts as lost; it doubles digits at the end.
STEPS = 40


@dataclass(frozen=True, eq=False)
class Jet:
    """Power series of all fields at a point, and the equations and their linear operator there.

    series: arithmetic of the series. fields: coefficients, shape (fields, coefficients).
    equations: values and linear operators of the equations.
    """

    series: PowerSeries
    fields: np.ndarray
    equations: Equations

    @cached_property
    def _values(self) -> list[Numeric]:
        check_limits()
        return list(self.equations(self.series, self.fields))

    @cached_property
    def _slopes(self) -> list[np.ndarray]:
        """Size of each derivative of a field in each equation at the point.

        Only there: coefficients of high degree miss products that the series cut off.
        """
        return [
            np.abs(one.slope[:, :, 0]).max(axis=0) for one in self._values if one.slope is not None
        ]

    @cached_property
    def order(self) -> int:
        """Highest number of derivatives of a field in an equation."""
        degrees, sizes = self.series.degrees, self._slopes
        # Coefficients that cancel leave rounding.
        least = math.sqrt(EPS) * max((float(x.max()) for x in sizes), default=0.0)
        return max((int(degrees[np.flatnonzero(x > least)[-1]]) for x in sizes if x.max() > least),
                   default=0)  # fmt: skip

    @property
    def is_empty(self) -> bool:
        """Whether no equation depends on any field, except by rounding of terms that cancel."""
        return not any((sizes > EPS**0.75).any() for sizes in self._slopes)

    def _rows(self, order: int) -> np.ndarray:
        """Places of the coefficients of an equation that truncation leaves right."""
        return np.flatnonzero(self.series.degrees <= self.series.order - order)

    def residual(self, order: int) -> np.ndarray:
        """Coefficients of all equations, up to the order that is right."""
        rows = self._rows(order)
        values = [
            np.zeros(self.series.size) if one.is_constant else one.value for one in self._values
        ]
        constants = [one.value if one.is_constant else 0.0 for one in self._values]
        flat = np.array(values)
        flat[:, 0] += constants
        return flat[:, rows].ravel()

    def jacobian(self, order: int) -> np.ndarray:
        """Derivatives of the residual by the coefficients of the fields.

        d^alpha of x^m is m!/(m - alpha)! x^(m - alpha), times the coefficient of the operator.
        """
        series, rows = self.series, self._rows(order)
        count = series.size
        operators = [one.slope for one in self._values]
        matrix = np.zeros((len(operators), len(rows), len(self.fields), count))
        shifts: dict[tuple[int, ...], tuple[np.ndarray, np.ndarray]] = {}
        exponents = np.array(series.monomials)
        for column, monomial in enumerate(series.monomials):
            for place, alpha in enumerate(series.monomials):
                if sum(alpha) > order:
                    break
                rest = tuple(m - a for m, a in zip(monomial, alpha, strict=True))
                if min(rest) < 0:
                    continue
                if rest not in shifts:
                    below = exponents[rows] - np.array(rest)
                    target = np.flatnonzero((below >= 0).all(axis=1))
                    places = [series.place[tuple(x)] for x in below[target].tolist()]
                    shifts[rest] = target, np.array(places, dtype=int)
                target, source = shifts[rest]
                weight = math.prod(map(math.perm, monomial, alpha))
                for number, operator in enumerate(operators):
                    if operator is not None and place < operator.shape[1]:
                        part = operator[:, place][:, source]
                        matrix[number, target, :, column] += weight * part.T
        return matrix.reshape(len(operators) * len(rows), -1)

    @property
    def weights(self) -> np.ndarray:
        """1/2^degree of each coefficient of each field: the scale of changes."""
        return np.tile(0.5**self.series.degrees, len(self.fields))

    def solved(self) -> tuple[Jet, float]:
        """The nearest jet that solves the equations, and its largest residual.

        Newton's method with the step of least weighted norm, halved until the equations improve.
        """
        jet, order = self, self.order
        size = np.linalg.norm(jet.residual(order))
        for _ in range(STEPS):
            rest = jet.residual(order)
            if np.abs(rest).max() <= rest.size * EPS:
                break
            weights = jet.weights
            left, values, right = np.linalg.svd(jet.jacobian(order) * weights, full_matrices=False)
            kept = values > math.sqrt(EPS) * values[0]
            step = weights * (right[kept].T @ ((left.T @ rest)[kept] / values[kept]))
            share, before = 1.0, size
            while True:
                moved = Jet(self.series, jet.fields - share * step.reshape(jet.fields.shape),
                            self.equations)  # fmt: skip
                size = np.linalg.norm(moved.residual(order))
                if size <= (1 - share / 4) * before or share < math.sqrt(EPS):
                    break
                share /= 2
            if not size < before:
                break
            jet = moved
        return jet, float(np.abs(jet.residual(order)).max())

    def freedom(self, order: int) -> tuple[list[int], float, float]:
        """H(q), q = 0, 1, ...: coefficients up to order q that are free for nearby solutions.

        All conditions that follow by differentiation up to the order of the series are used, so
        that H only falls where the order grows.

        Returns
        -------
        H, the smallest singular value that counts, and the largest that does not, relative to the
        largest of all.
        """
        matrix = self.jacobian(order) * self.weights
        sizes = np.abs(matrix).max(axis=1, keepdims=True)
        matrix = matrix[sizes[:, 0] > 0] / sizes[sizes[:, 0] > 0]
        degrees = np.tile(self.series.degrees, len(self.fields))
        smallest, largest = 1.0, 0.0
        ranks = []
        for q in range(-1, self.series.order):
            check_limits()
            part = matrix[:, degrees > q]
            values = np.linalg.svd(part, compute_uv=False)
            values = values / values[0]
            rank = int(np.count_nonzero(values > cut(matrix.shape)))
            ranks.append(rank)
            smallest = min(smallest, values[rank - 1])
            largest = max(largest, values[rank]) if rank < len(values) else largest
        free = [int(np.count_nonzero(degrees <= q)) for q in range(self.series.order)]
        return [x - ranks[0] + y for x, y in zip(free, ranks[1:], strict=True)], smallest, largest


def noise(shape: tuple[int, ...]) -> float:
    """Relative size below which a singular value is rounding."""
    return max(shape) * EPS


def cut(shape: tuple[int, ...]) -> float:
    """Relative size from which a singular value counts: half of the digits above the noise."""
    return math.sqrt(noise(shape) * math.sqrt(noise(shape)))
