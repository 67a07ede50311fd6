"""Evaluation: numbers of a tensor at one point."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import sympy as sp

from geomtorsion.errors import CoordinateError, MissingValueError, SingularPointError

if TYPE_CHECKING:
    import numpy as np

    from geomtorsion.geometry.tensor import Tensor


def evaluated(tensor: Tensor, point: Mapping[Any, Any]) -> np.ndarray:
    """Array of a tensor's components at a point (see Tensor.at)."""
    import numpy as np

    values = _named_values(tensor, point)
    independent = tensor.components.independent
    n, rank = tensor.frame.dimension, len(tensor.slots)
    result = np.zeros((n,) * rank, dtype=complex if tensor.frame.complex else float)
    numbers = {i: _number(tensor, i, v, values) for i, v in independent.items()}
    for index in tensor.components.support:
        sign, representative = tensor.components.representative(index)
        result[index] = sign * numbers[representative]
    return result


def _named_values(tensor: Tensor, point: Mapping[Any, Any]) -> dict[Any, Any]:
    """The point with symbols as keys; a name that means nothing here is refused."""
    symbols = {symbol.name: symbol for symbol in tensor.frame.field.symbols}
    values = {}
    for key, number in point.items():
        if isinstance(key, (str, sp.Symbol)):
            name = key if isinstance(key, str) else key.name
            if name not in symbols or (isinstance(key, sp.Symbol) and key != symbols[name]):
                raise CoordinateError(
                    f"{key} is neither a coordinate nor a parameter of this frame. "
                    f"Known are {', '.join(symbols)}, with the assumptions they were made with."
                )
            values[symbols[name]] = number
        else:
            values[key] = number
    return values


def _number(tensor: Tensor, index: tuple[int, ...], element: Any, values: Mapping) -> complex:
    """Value of one component, with an error that names it where it is not finite."""
    try:
        number = element.evaluate(values)
    except (ZeroDivisionError, SingularPointError):
        number = float("nan")
    except MissingValueError as error:
        raise MissingValueError(f"{tensor.label}{list(index)}: {error}") from None
    if abs(complex(number)) < float("inf") and (tensor.frame.complex or number.imag == 0):
        return number
    place = ", ".join(f"{symbol} = {value}" for symbol, value in values.items())
    raise SingularPointError(
        f"{tensor.label}{list(index)} has no finite real value at {place}. "
        "Choose a point inside the domain of the frame."
    )
