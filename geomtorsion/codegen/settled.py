"""Settled: a graph on arrays, with more digits where rounding would leave too few."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from geomtorsion.codegen.balls import ball_values
from geomtorsion.codegen.expression_graph import Graph
from geomtorsion.codegen.python_code import compiled, python_body, python_source
from geomtorsion.codegen.rounding import Bounds, rounding_bounds
from geomtorsion.precision import CALCULATED

# Points that are worked out at once: what stands between stays in the cache of the processor.
BLOCK = 8192

# What makes a value anew where balls do not: (output, point) -> value, or None.
LastResort = Callable[[int, tuple[float | complex, ...]], float | complex | None]


@dataclass(frozen=True, eq=False)
class Settled:
    """The values of a graph on arrays, each right to 1e-12 of itself.

    Beside each value runs a bound of what rounding does to it. Where that is too large, or the
    value is not finite, it is made anew by ball arithmetic.
    """

    graph: Graph

    @cached_property
    def _bounds(self) -> Bounds:
        return rounding_bounds(
            self.graph.steps, self.graph.outputs, is_complex=self.graph.is_complex
        )

    @cached_property
    def _code(self) -> Callable[..., tuple[np.ndarray, ...]]:
        """Values, and after them the bounds of those that need one at each point."""
        bounds = self._bounds
        body = python_body(bounds.steps, (*bounds.values, *bounds.absolute))
        return compiled(python_source(len(self.graph.arguments), body), "arrays")

    def __call__(self, *arguments: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Values as doubles give them, and which of them are doubtful; shapes (size, *shape)."""
        dtype, size = complex if self.graph.is_complex else float, self.graph.size
        arrays = [np.asarray(argument, dtype=dtype) for argument in arguments]
        shape = np.broadcast_shapes(*(array.shape for array in arrays))
        values, doubtful = np.empty((size, *shape), dtype=dtype), np.zeros((size, *shape), bool)
        moving = [k for k, known in enumerate(self._bounds.relative) if known is None]
        roundings = CALCULATED / 2.0**-53
        with np.errstate(all="ignore"):
            for parts, part in _blocks(arrays, shape):
                found = self._code(*parts)
                for k in range(size):
                    part(values[k, ...])[...] = found[k]
                for k, bound in zip(moving, found[size:], strict=True):
                    spoilt = ~(np.abs(bound) <= roundings * np.abs(found[k]))
                    if spoilt.any():
                        part(doubtful[k, ...])[...] = spoilt
            finite = np.isfinite(values)
            if not finite.all():
                doubtful |= ~finite
        return values, doubtful

    def mend(
        self,
        values: np.ndarray,
        doubtful: np.ndarray,
        arguments: tuple[ArrayLike, ...],
        last_resort: LastResort,
    ) -> tuple[int, ...] | None:
        """Make doubtful values anew, in place; the index of the first for which that fails."""
        dtype = values.dtype
        columns = np.broadcast_arrays(*(np.asarray(x, dtype=dtype) for x in arguments))
        for place in np.argwhere(doubtful.any(axis=0)):
            at = tuple(place.tolist())
            point = tuple(column[at].item() for column in columns)
            which = np.flatnonzero(doubtful[(slice(None), *at)]).tolist()
            outputs = [self.graph.outputs[k] for k in which]
            found = ball_values(self.graph.steps, outputs, point, is_complex=self.graph.is_complex)
            for k, value in zip(which, found, strict=True):
                made = last_resort(k, point) if value is None else value
                if made is None:
                    return (k, *at)
                values[(k, *at)] = made
        return None


def _blocks(
    arrays: list[np.ndarray], shape: tuple[int, ...]
) -> Iterator[tuple[list[np.ndarray], Callable[[np.ndarray], np.ndarray]]]:
    """Parts of arrays that are worked out at once, and what takes that part of an array."""
    count = int(np.prod(shape))
    # Arrays that are still to be stretched are small: they are worked out before that.
    if count <= BLOCK or any(array.shape not in ((), shape) for array in arrays):
        yield arrays, lambda whole: whole
        return
    rows = [array if array.shape == () else array.reshape(-1) for array in arrays]
    for begin in range(0, count, BLOCK):
        some = slice(begin, begin + BLOCK)
        parts = [row if row.shape == () else row[some] for row in rows]
        yield parts, lambda whole, some=some: whole.reshape(-1)[some]
