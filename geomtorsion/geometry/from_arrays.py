"""Nested: tensors from nested lists of expressions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import sympy as sp

from geomtorsion.errors import ShapeError
from geomtorsion.geometry.symmetry import Index, Symmetry
from geomtorsion.geometry.tensor import Tensor

if TYPE_CHECKING:
    from geomtorsion.geometry.frame import Frame


def tensor_from_array(
    frame: Frame, slots: str, values: Any, name: str, symmetry: Symmetry = (), symbol: str = "t"
) -> Tensor:
    """Tensor from nested lists, or a sympy or NumPy array, of expressions read together.

    Raises
    ------
    ShapeError
        The lists have not as many levels as slots, or a level has not one entry per dimension.
    ExpressionError
        An entry cannot be read exactly; the message names it.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> x, y = sp.symbols("x y")
    >>> frame = Frame([x, y], [[1, 0], [0, 1]])
    >>> tensor_from_array(frame, "u", [0, x], "velocity").nonzero()
    {(1,): x}
    """
    if hasattr(type(values), "tolist"):
        values = values.tolist()
    flat = dict(_entries(values, (), len(slots), frame.dimension, name))
    named = [(f"{name}{list(index)}", value) for index, value in flat.items()]
    elements = dict(zip(flat, frame.read(named), strict=True))
    return Tensor(frame, slots, elements, symmetry, symbol, name)


def _entries(
    values: Any, index: Index, depth: int, n: int, name: str
) -> Iterator[tuple[Index, Any]]:
    """Index and value of each entry of nested lists that is not plainly zero."""
    if depth == 0:
        if not (isinstance(values, int | float | sp.Expr) and values == 0):
            yield index, values
        return
    size = len(values) if isinstance(values, list | tuple | sp.Tuple) else None
    if size != n:
        raise ShapeError(
            f"{name}{list(index) or ''}: {n} entries were needed, "
            f"{'a single value' if size is None else size} came. "
            f"Give nested lists, one level for each index, each with {n} entries."
        )
    for k in range(n):
        yield from _entries(values[k], (*index, k), depth - 1, n, name)
