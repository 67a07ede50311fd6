"""Power series: products, derivatives and functions of truncated series in several variables."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from geomtorsion.codegen import balls
from geomtorsion.errors import GravityError, SingularPointError
from geomtorsion.support.caching import cached_property

Monomial = tuple[int, ...]
# Functions by their differential equations c' = g(b, c) b' with c = f(b).
SLOPES: dict[str, Callable[[PowerSeries, Any, Any], Any]] = {
    "exp": lambda s, b, c: c,
    "log": lambda s, b, c: s.inverse(b),
    "tan": lambda s, b, c: s.shifted(s.multiply(c, c), 1),
    "tanh": lambda s, b, c: s.shifted(-s.multiply(c, c), 1),
    "atan": lambda s, b, c: s.inverse(s.shifted(s.multiply(b, b), 1)),
    "atanh": lambda s, b, c: s.inverse(s.shifted(-s.multiply(b, b), 1)),
    "asin": lambda s, b, c: s.inverse(s.root(s.shifted(-s.multiply(b, b), 1))),
    "acos": lambda s, b, c: -s.inverse(s.root(s.shifted(-s.multiply(b, b), 1))),
    "asinh": lambda s, b, c: s.inverse(s.root(s.shifted(s.multiply(b, b), 1))),
}  # fmt: skip
# Pairs of functions that differentiate into each other: f' = g, g' = sign f.
PAIRS = {"sin": ("cos", -1), "sinh": ("cosh", 1)}
NUMPY = {"asin": "arcsin", "acos": "arccos", "atan": "arctan", "asinh": "arcsinh",
         "atanh": "arctanh"}  # fmt: skip


@dataclass(frozen=True, eq=False)
class PowerSeries:
    """Arithmetic of power series at a point, cut after an order; coefficients on the last axis.

    dimension: number of variables. order: highest total degree. Coefficients are floats, or balls
    (arb) in arrays of objects, with any axes in front.

    Examples
    --------
    >>> series = PowerSeries(2, 2)
    >>> series.monomials
    ((0, 0), (0, 1), (1, 0), (0, 2), (1, 1), (2, 0))
    >>> x = series.variable(0, 1.0)
    >>> series.multiply(x, x).tolist()
    [1.0, 0.0, 2.0, 0.0, 0.0, 1.0]
    """

    dimension: int
    order: int

    @cached_property
    def monomials(self) -> tuple[Monomial, ...]:
        """Exponents of all monomials, by total degree."""
        powers = product(range(self.order + 1), repeat=self.dimension)
        return tuple(sorted((m for m in powers if sum(m) <= self.order), key=lambda m: (sum(m), m)))

    @cached_property
    def place(self) -> dict[Monomial, int]:
        """Monomial -> its place among the coefficients."""
        return {m: k for k, m in enumerate(self.monomials)}

    @cached_property
    def degrees(self) -> np.ndarray:
        """Total degree of each monomial."""
        return np.array([sum(m) for m in self.monomials])

    @property
    def size(self) -> int:
        """Number of coefficients."""
        return len(self.monomials)

    @cached_property
    def _pairs(self) -> tuple[np.ndarray, ...]:
        """Places (first, second, product) of factors, sorted by product, and where each begins."""
        every = [
            (self.place[tuple(map(sum, zip(a, b, strict=True)))], i, j)
            for i, a in enumerate(self.monomials)
            for j, b in enumerate(self.monomials)
            if sum(a) + sum(b) <= self.order
        ]
        whole, first, second = map(np.array, zip(*sorted(every), strict=True))
        return first, second, whole, np.searchsorted(whole, np.arange(self.size))

    @cached_property
    def _derivatives(self) -> list[tuple[np.ndarray, ...]]:
        """For each variable the places of a monomial and of its derivative, and the factor."""
        tables = []
        for mu in range(self.dimension):
            unit = [int(k == mu) for k in range(self.dimension)]
            rows = [
                (self.place[m], self.place[tuple(np.subtract(m, unit).tolist())], m[mu])
                for m in self.monomials
                if m[mu]
            ]
            columns = zip(*rows, strict=True) if rows else ((), (), ())
            tables.append(tuple(np.array(x, dtype=int) for x in columns))
        return tables

    @cached_property
    def _raised(self) -> list[np.ndarray]:
        below = [m for m in self.monomials if sum(m) < self.order]
        units = np.eye(self.dimension, dtype=int)
        return [
            np.array([self.place[tuple((unit + m).tolist())] for m in below], dtype=int)
            for unit in units
        ]

    def raised_by(self, mu: int) -> np.ndarray:
        """Places of all monomials below the last order, times a variable."""
        return self._raised[mu]

    # -- arithmetic ------------------------------------------------------------------------------

    def raised(self, number: Any) -> np.ndarray:
        """A constant as a series, or an array of constants as a series each."""
        shape = (*np.shape(number), self.size)
        result = np.zeros(shape, dtype=float if isinstance(number, float) else object)
        result[..., 0] = number
        return result

    def variable(self, mu: int, value: Any) -> np.ndarray:
        """The coordinate of a number at the point, whose value is given."""
        result = self.raised(value)
        if self.order:
            unit = tuple(int(k == mu) for k in range(self.dimension))
            result[..., self.place[unit]] = value * 0 + 1
        return result

    def shifted(self, series: np.ndarray, number: Any) -> np.ndarray:
        """A series plus a number."""
        result = series.copy()
        result[..., 0] = result[..., 0] + number
        return result

    def multiply(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """The product of two series."""
        first, second, _, starts = self._pairs
        return np.add.reduceat(a[..., first] * b[..., second], starts, axis=-1)

    def derivative(self, a: np.ndarray, mu: int) -> np.ndarray:
        """The partial derivative by a variable; its last order is not known."""
        source, target, factor = self._derivatives[mu]
        result = np.zeros_like(a)
        result[..., target] = a[..., source] * factor
        return result

    def inverse(self, b: np.ndarray) -> np.ndarray:
        """1 over a series that does not vanish at the point."""
        first = b[..., :1]
        if any(_holds_zero(x) for x in np.ravel(first)):
            raise SingularPointError(
                "expected a denominator that does not vanish at the point, got zero. Choose "
                "another point."
            )
        below = 1 / first
        result = np.zeros_like(b)
        result[..., :1] = below
        known = 0
        # Newton's rule c (2 - b c) doubles the number of known orders.
        while known < self.order:
            result = self.multiply(result, self.shifted(-self.multiply(b, result), 2))
            known = 2 * known + 1
        return result

    def product_matrix(self, b: np.ndarray) -> np.ndarray:
        """The matrix by which rows of coefficients are multiplied with a series from the right."""
        first, second, whole, _ = self._pairs
        matrix = np.zeros((self.size, self.size))
        matrix[first, whole] = b[second]
        return matrix

    # -- functions -------------------------------------------------------------------------------

    def root(self, b: np.ndarray, degree: int = 2) -> np.ndarray:
        """A root of a series that is positive at the point."""
        return self.power(b, 1 / degree if b.dtype == float else 1 / balls.exact_ball(degree))

    def power(self, b: np.ndarray, exponent: Any) -> np.ndarray:
        """A power with any exponent of a series that is positive at the point."""
        if not all(x > 0 for x in np.ravel(b[..., 0])):
            raise SingularPointError(
                "expected a root or power of a positive number, got one that is not positive at "
                "the point. Choose another point."
            )
        over = self.inverse(b)
        first = b[..., 0] ** exponent
        return self._integrated(b, first, lambda c: self.multiply(c, over) * exponent)

    def call(self, name: str, b: np.ndarray) -> np.ndarray:
        """A function of a series, by its name.

        Raises
        ------
        GravityError
            The series of this function is not known here.
        """
        for first, (second, sign) in PAIRS.items():
            if name in (first, second):
                both = self._pair(b, first, second, sign)
                return both[name == second]
        if name not in SLOPES:
            known = ", ".join(sorted([*SLOPES, *PAIRS, *(x for x, _ in PAIRS.values())]))
            raise GravityError(
                f"expected functions whose power series is known, got {name}. Known are {known}, "
                "roots and powers."
            )
        first = self._values(name, b)
        return self._integrated(b, first, lambda c: SLOPES[name](self, b, c))

    def slope(self, name: str, b: np.ndarray, c: np.ndarray) -> np.ndarray:
        """f'(b) of a function by its name, where c = f(b)."""
        for first, (second, sign) in PAIRS.items():
            if name == first:
                return self.call(second, b)
            if name == second:
                return sign * self.call(first, b)
        return SLOPES[name](self, b, c)

    def _values(self, name: str, b: np.ndarray) -> np.ndarray:
        """A function of the coefficients at order zero."""
        if b.dtype == float:
            with np.errstate(all="ignore"):
                return getattr(np, NUMPY.get(name, name))(b[..., 0])
        return np.frompyfunc(balls.REAL[name], 1, 1)(b[..., 0])

    def _integrated(
        self, b: np.ndarray, first: Any, rule: Callable[[np.ndarray], np.ndarray]
    ) -> np.ndarray:
        """The solution of x.dc = g x.db with a value at order zero; each pass adds one order."""
        moving = b * self.degrees
        result = np.zeros_like(b)
        result[..., 0] = first
        for _ in range(self.order):
            step = self.multiply(rule(result), moving)
            result[..., 1:] = step[..., 1:] / self.degrees[1:]
        return result

    def _pair(self, b: np.ndarray, first: str, second: str, sign: int) -> tuple:
        moving = b * self.degrees
        one, two = np.zeros_like(b), np.zeros_like(b)
        one[..., 0], two[..., 0] = self._values(first, b), self._values(second, b)
        for _ in range(self.order):
            up, down = self.multiply(two, moving), sign * self.multiply(one, moving)
            one[..., 1:] = up[..., 1:] / self.degrees[1:]
            two[..., 1:] = down[..., 1:] / self.degrees[1:]
        return one, two


def _holds_zero(value: Any) -> bool:
    """Whether a number is zero, or a ball contains it."""
    return bool(value.contains(0)) if hasattr(value, "contains") else value == 0
