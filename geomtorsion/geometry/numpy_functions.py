"""NumPy functions: all components of a tensor, or a list of elements, as one function of arrays."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from geomtorsion import codegen
from geomtorsion.exact import Element
from geomtorsion.geometry.tensor import Tensor


def numpy_function(
    elements: Tensor | Sequence[Element], symbols: Sequence[sp.Expr], *, check: bool = True
) -> Callable[..., np.ndarray]:
    """A function of arrays that gives all components of a tensor, or all elements, at once.

    Parameters
    ----------
    elements
        the outputs: a tensor over n coordinates, or k elements.
    symbols
        the arguments in order: sympy symbols, or unknown functions such as f(r).
    check
        raise where a value is inaccurate or not finite; False: return values unchecked.

    Returns
    -------
    Function of len(symbols) numbers or arrays of one shape. For a tensor it returns an array of
    shape (*shape, n, ..., n), one axis for each index; for elements an array of shape (k, *shape).
    Its source is kept in the attribute `source`. Values have a relative error below 1e-12.

    Raises
    ------
    MissingValueError
        a symbol occurs that is not among the arguments.
    ArgumentError
        (also from the function) a symbol occurs twice; an argument is neither a real number nor an
        array of real numbers, or, with `check`, is not finite.
    SingularPointError
        (from the function) a value is not finite, or is lost in rounding errors; the message names
        it.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion import Frame, numpy_function
    >>> r, phi = sp.symbols("r phi", positive=True)
    >>> metric = numpy_function(Frame([r, phi], [[1, 0], [0, r]]).metric, [r])
    >>> metric([1.0, 2.0]).tolist()
    [[[1.0, 0.0], [0.0, 1.0]], [[1.0, 0.0], [0.0, 4.0]]]
    """
    if not isinstance(elements, Tensor):
        return codegen.numpy_function(elements, symbols, check=check)
    tensor, components = elements, elements.components
    places = list(components.independent)
    inner = codegen.numpy_function(list(components.independent.values()), symbols, check=check)
    signs = {index: components.representative(index) for index in components.support}
    rows = {index: k for k, index in enumerate(places)}
    kind = complex if tensor.frame.complex else float

    def function(*values: ArrayLike) -> np.ndarray:
        table = inner(*values)
        result = np.zeros((*table.shape[1:], *(tensor.frame.dimension,) * len(tensor.slots)), kind)
        for index, (sign, place) in signs.items():
            result[(..., *index)] = sign * table[rows[place]]
        return result

    # Functions accept attributes of their own, which their type does not declare.
    function.source = inner.source  # type: ignore[attr-defined]
    return function
