"""From arrays: tensors from nested lists and arrays of expressions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from geomtorsion.geometry.components import Symmetry
from geomtorsion.geometry.nested_entries import nested_entries
from geomtorsion.geometry.tensor import Tensor

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
    flat = nested_entries(values, len(slots), frame.dimension, name)
    named = [(f"{name}{list(index)}", value) for index, value in flat.items()]
    elements = dict(zip(flat, frame.read(named), strict=True))
    return Tensor(frame, slots, elements, symmetry, symbol, name)
