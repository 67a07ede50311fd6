"""Arrays: elements as one function of arrays, which says where a value is not finite."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from geomtorsion.checks import entries, instance, shown
from geomtorsion.codegen.expression_graph import graph
from geomtorsion.errors import ArgumentError, MissingValueError, SingularPointError
from geomtorsion.exact.element import Element


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
        whether a value that is not finite raises instead of being returned.

    Returns
    -------
    Function of len(symbols) numbers or arrays of one shape; it returns an array of shape
    (k, *shape).  Its source is kept in the attribute `source`.

    Raises
    ------
    MissingValueError
        an element contains a symbol that is not among the arguments.
    SingularPointError
        (from the function) a value is not finite; the message names element and point.

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
    inner = made.numpy()

    def function(*values: ArrayLike) -> np.ndarray:
        if len(values) != len(symbols):
            raise MissingValueError(
                f"{len(symbols)} arguments are needed ({', '.join(map(str, symbols))}), "
                f"{len(values)} came"
            )
        try:
            result = inner(*values)
        except (TypeError, ValueError):
            came = shown(values)
            raise ArgumentError(
                f"numbers or arrays of one shape were needed, {came} came"
            ) from None
        if check and not np.isfinite(result).all():
            raise SingularPointError(_where_singular(result, values, elements, symbols))
        return result

    # Functions have room for attributes of their own, which types do not say.
    function.source = made.python_source()  # type: ignore[attr-defined]
    return function


def _where_singular(
    result: np.ndarray,
    values: Sequence[ArrayLike],
    elements: Sequence[Element],
    symbols: Sequence[sp.Expr],
) -> str:
    """The message that names the first value that is not finite."""
    first = tuple(int(i) for i in np.argwhere(~np.isfinite(result))[0])
    broad = np.broadcast_arrays(*values)
    point = ", ".join(
        f"{symbol} = {array[first[1:]]:.6g}" for symbol, array in zip(symbols, broad, strict=True)
    )
    return (
        f"{elements[first[0]]} has no finite value at {point}; "
        "move the point away from the edge of the chart"
    )
