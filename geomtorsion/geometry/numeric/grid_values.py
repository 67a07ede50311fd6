"""Grid values: products, derivatives and functions of values at the nodes of a grid."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from geomtorsion.errors import GravityError, SingularPointError
from geomtorsion.geometry.numeric.power_series import NUMPY, PAIRS, SLOPES


@dataclass(frozen=True, eq=False)
class GridValues:
    """Arithmetic of values at the nodes of a grid; NaN is unknown.

    shape: of the grid. derivative: of an array by a coordinate, from values at other nodes.

    Examples
    --------
    >>> line = np.linspace(0, 1, 5)
    >>> values = GridValues((5,), lambda a, mu: np.gradient(a, line))
    >>> values.derivative(2 * line, 0).tolist()
    [2.0, 2.0, 2.0, 2.0, 2.0]
    """

    shape: tuple[int, ...]
    derivative: Callable[[np.ndarray, int], np.ndarray]

    def raised(self, number: Any) -> np.ndarray:
        """A constant at all nodes."""
        return np.full(self.shape, float(number))

    def shifted(self, series: np.ndarray, number: Any) -> np.ndarray:
        """Values plus a constant."""
        return series + number

    def multiply(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """The product at each node."""
        return a * b

    def inverse(self, b: np.ndarray) -> np.ndarray:
        """1 over values that do not vanish."""
        if (b == 0).any():
            node = tuple(np.argwhere(b == 0)[0].tolist())
            raise SingularPointError(
                f"expected a denominator that does not vanish on the grid, got zero at node {node}."
                " Mask this node."
            )
        return 1 / b

    def root(self, b: np.ndarray, degree: int = 2) -> np.ndarray:
        """A root of values that are positive."""
        return self.power(b, 1 / degree)

    def power(self, b: np.ndarray, exponent: Any) -> np.ndarray:
        """A power of values that are positive."""
        if not (np.isnan(b) | (b > 0)).all():
            node = tuple(np.argwhere(~np.isnan(b) & ~(b > 0))[0].tolist())
            raise SingularPointError(
                "expected a root or power of positive numbers on the grid, got one that is not "
                f"positive at node {node}. Mask this node."
            )
        return b**exponent

    def call(self, name: str, b: np.ndarray) -> np.ndarray:
        """A function of the values, by its name.

        Raises
        ------
        GravityError
            There is no such function.
        """
        if name not in SLOPES and not any(name in (one, two) for one, (two, _) in PAIRS.items()):
            raise GravityError(f"expected an elementary function, got {name}. Write it out.")
        with np.errstate(all="ignore"):
            return getattr(np, NUMPY.get(name, name))(b)

    def slope(self, name: str, b: np.ndarray, c: np.ndarray) -> np.ndarray:
        """f'(b) of a function by its name, where c = f(b)."""
        for one, (two, sign) in PAIRS.items():
            if name in (one, two):
                return self.call(two, b) if name == one else sign * self.call(one, b)
        return SLOPES[name](self, b, c)  # type: ignore[arg-type]

    def product_matrix(self, b: np.ndarray) -> np.ndarray:
        """Refuse: small changes of fields are followed by power series only."""
        raise GravityError("expected power series for a linear operator, got values on a grid.")
