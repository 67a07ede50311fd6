"""Arrays: elements as one function of arrays, with more digits where rounding would spoil them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from geomtorsion.checks import entries, instance, shown
from geomtorsion.codegen.branches import branch_check
from geomtorsion.codegen.evaluation import ball_values
from geomtorsion.codegen.expression_graph import Graph, graph
from geomtorsion.codegen.printers import compiled, python_body, python_source
from geomtorsion.codegen.rounding import Bounds, rounding_bounds
from geomtorsion.errors import ArgumentError, MissingValueError, SingularPointError
from geomtorsion.exact.element import Element
from geomtorsion.precision import CALCULATED


def numpy_function(
    elements: Sequence[Element], symbols: Sequence[sp.Expr], *, check: bool = True
) -> Callable[..., np.ndarray]:
    """A function of arrays that gives the values of all elements at once.

    Parameters
    ----------
    elements
        what to compute, k of them.
    symbols
        the arguments in order: sympy symbols, or unknown functions such as f(r).
    check
        whether values are right, or raise; False: as they come, spoilt or not finite, and no
        numbers where a root has not the sign with which it was read.

    Returns
    -------
    Function of len(symbols) numbers or arrays of one shape; it returns an array of shape
    (k, *shape).  Its source is kept in the attribute `source`.  Values are right to 1e-12 of
    themselves: where rounding may leave fewer digits, as beside a removable singularity or a zero,
    they are worked out with as many more as it takes.

    Raises
    ------
    MissingValueError
        an element contains a symbol that is not among the arguments.
    BranchError
        (from the function) a root has not the sign with which it was read, see `Frame.branches`.
    SingularPointError
        (from the function) a value is not finite, or drowns in rounding however many digits are
        taken; the message names element and point.

    Examples
    --------
    >>> import sympy
    >>> from geomtorsion import numpy_function
    >>> from geomtorsion.exact import Field
    >>> r = sympy.Symbol("r")
    >>> f = numpy_function([Field([r]).read(r**2 + 1)], [r])
    >>> f([1.0, 2.0])
    array([[2., 5.]])
    """
    symbols = entries(symbols, "symbols")
    elements = entries(elements, "elements")
    for k, element in enumerate(elements):
        instance(element, Element, f"elements[{k}]")
    made = graph([str(symbol) for symbol in symbols], elements, factor=False)
    inner, settled = made.numpy(), Settled(made)
    names = [str(symbol) for symbol in symbols]
    branches = branch_check((element.field for element in elements), names)

    def last_resort(k: int, point: tuple[float | complex, ...]) -> float | complex | None:
        try:
            value = elements[k].evaluate(dict(zip(symbols, point, strict=True)))
        except (SingularPointError, ZeroDivisionError, ValueError):
            return None
        return value if np.isfinite(value) else None

    def function(*values: ArrayLike) -> np.ndarray:
        if len(values) != len(symbols):
            raise MissingValueError(
                f"{len(symbols)} arguments are needed ({', '.join(map(str, symbols))}), "
                f"{len(values)} came"
            )
        try:
            if not check:
                result = inner(*values)
                if branches is not None:
                    result[:, branches.broken(*values).any(axis=0)] = np.nan
                return result
            if branches is not None:
                branches.refuse(*values)
            result, doubtful = settled(*values)
        except (TypeError, ValueError):
            came = shown(values)
            raise ArgumentError(
                f"numbers or arrays of one shape were needed, {came} came"
            ) from None
        if doubtful.any():
            lost = settled.mend(result, doubtful, values, last_resort)
            if lost is not None:
                raise SingularPointError(_where_singular(lost, values, elements, symbols))
        return result

    # Functions have room for attributes of their own, which types do not say.
    function.source = made.python_source()  # type: ignore[attr-defined]
    return function


def _where_singular(
    first: tuple[int, ...],
    values: Sequence[ArrayLike],
    elements: Sequence[Element],
    symbols: Sequence[sp.Expr],
) -> str:
    """The message that names the first value that there is not."""
    broad = np.broadcast_arrays(*values)
    point = ", ".join(
        f"{symbol} = {array[first[1:]]:.6g}" for symbol, array in zip(symbols, broad, strict=True)
    )
    return (
        f"{elements[first[0]]} has no finite value at {point}; "
        "move the point away from the edge of the chart"
    )


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
