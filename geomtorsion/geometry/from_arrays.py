"""From arrays: tensors from nested lists and arrays of expressions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.errors import ShapeError
from geomtorsion.geometry.components import Index, Symmetry
from geomtorsion.geometry.tensor import Tensor
from geomtorsion.support.checks import rows

if TYPE_CHECKING:
    from geomtorsion.geometry.frame import Frame


def tensor_from_array(
    frame: Frame, slots: str, values: object, name: str, symmetry: Symmetry = (), symbol: str = "t"
) -> Tensor:
    """Tensor from nested lists, or a sympy or NumPy array, of expressions read together.

    Raises
    ------
    ShapeError
        The lists do not have one level per slot, or a level not one entry per dimension.
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
    flat = dict(_entries(rows(values), (), len(slots), frame.dimension, name))
    named = [(f"{name}{list(index)}", value) for index, value in flat.items()]
    elements = dict(zip(flat, frame.read(named), strict=True))
    return Tensor(frame, slots, elements, symmetry, symbol, name)


def _entries(
    values: object, index: Index, depth: int, n: int, name: str
) -> Iterator[tuple[Index, object]]:
    """Index and value of each entry of nested lists that is not plainly zero."""
    if depth == 0:
        if not (isinstance(values, int | float | sp.Expr) and values == 0):
            yield index, values
        return
    listed = list(values) if isinstance(values, list | tuple) else None
    size = None if listed is None else len(listed)
    if listed is None or size != n:
        raise ShapeError(
            f"{name}{list(index) or ''}: expected {n} entries, got "
            f"{'a single value' if size is None else size}. Give nested lists, one level for each "
            f"index, each with {n} entries."
        )
    for k in range(n):
        yield from _entries(listed[k], (*index, k), depth - 1, n, name)
