"""Arrays: elements as one function of arrays, which is right or says where it is not."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from geomtorsion.checks import entries, instance, shown
from geomtorsion.codegen.branches import branch_check
from geomtorsion.codegen.expression_graph import graph
from geomtorsion.codegen.settled import Settled
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
