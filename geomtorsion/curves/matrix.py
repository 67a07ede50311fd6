"""Matrix: sparse matrices of exact elements, at points and at any precision."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import mpmath
import numpy as np

from geomtorsion.codegen import Graph, graph
from geomtorsion.exact import Element
from geomtorsion.ode.numbers import Real, mpf
from geomtorsion.precision import working_precision


@dataclass(frozen=True, eq=False)
class ElementMatrix:
    """A matrix of which only the entries that do not vanish are kept.

    entries: (row, column) -> element; shape: (rows, columns).
    """

    entries: Mapping[tuple[int, ...], Element]
    shape: tuple[int, int]

    @cached_property
    def _graph(self) -> Graph:
        symbols = {symbol.name for element in self.entries.values() for symbol in element.symbols}
        return graph(sorted(symbols), list(self.entries.values()), factor=False)

    def values(self, point: Mapping[str, Real | np.ndarray]) -> np.ndarray:
        """The entries at one point or many, shape (entries, ...)."""
        given = [point[name] for name in self._graph.arguments]
        columns = [x if isinstance(x, np.ndarray) else float(x) for x in given]
        return self._graph.numpy()(*columns)

    def at(self, point: Mapping[str, Real]) -> np.ndarray:
        """The matrix at one point."""
        matrix = np.zeros(self.shape)
        for index, number in zip(self.entries, self.values(point), strict=True):
            matrix[index] = number
        return matrix

    def applied(self, point: Mapping[str, Real | np.ndarray], vectors: np.ndarray) -> np.ndarray:
        """The matrix at many points times a vector at each: shapes (columns, m), (rows, m)."""
        result = np.zeros((self.shape[0], vectors.shape[1]))
        # Where a chart ends entries are infinite; what becomes of them is looked at afterwards.
        with np.errstate(all="ignore"):
            for (i, j), number in zip(self.entries, self.values(point), strict=True):
                result[i] += number * vectors[j]
        return result

    def precisely(self, point: Mapping[str, Real], vector: Sequence[Real], bits: int) -> list[Real]:
        """The matrix at one point times a vector, in numbers of so many bits."""
        if bits <= 53:
            column = np.array([[float(x)] for x in vector])
            return self.applied(point, column)[:, 0].tolist()
        numbers = {name: mpf(x, bits) for name, x in point.items()}
        factors = [mpf(x, bits) for x in vector]
        with working_precision(bits):
            total: list[Real] = [mpmath.mpf(0)] * self.shape[0]
            for (i, j), element in self.entries.items():
                total[i] += element.evaluate(numbers, bits) * factors[j]
        return total
