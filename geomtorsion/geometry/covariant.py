"""Covariant: derivative of any tensor by any connection."""

from __future__ import annotations

from typing import TYPE_CHECKING

from geomtorsion.errors import ShapeError, TensorIndexError
from geomtorsion.exact import Element
from geomtorsion.geometry.arrays import total
from geomtorsion.geometry.symmetry import Index, shifted
from geomtorsion.geometry.tensor import Tensor

if TYPE_CHECKING:
    from geomtorsion.geometry.connection import Connection


def covariant_derivative(connection: Connection, tensor: Tensor) -> Tensor:
    """D_a t, slots d + slots of t (see Connection.covariant_derivative)."""
    frame = connection.frame
    if tensor.frame is not frame:
        raise ShapeError(
            "The tensor belongs to another frame than the connection. Build it over this one."
        )
    if tensor.anchored:
        raise TensorIndexError(f"{tensor.label} is not a tensor in all its indices.")
    get, n, coordinates = tensor.components.get, frame.dimension, frame.coordinates
    tables = {
        "d": connection.coefficients.components.get,
        "D": connection.spin_connection.components.get,
    }

    def rule(index: Index) -> Element | None:
        a, rest = index[0], index[1:]
        terms = []
        value = get(rest)
        if value is not None:
            terms.append((1, value.diff(coordinates[a])))
        for k, slot in enumerate(tensor.slots):
            table = tables["d" if slot in "du" else "D"]
            up = slot in "uU"
            head, own, tail = rest[:k], rest[k], rest[k + 1 :]
            for b in range(n):
                coefficient = table((a, b, own) if up else (a, own, b))
                if coefficient is None:
                    continue
                value = get((*head, b, *tail))
                if value is not None:
                    terms.append((1 if up else -1, coefficient, value))
        return total(frame.field, terms)

    symmetry = shifted(tensor.symmetry, 1)
    return Tensor(frame, "d" + tensor.slots, rule, symmetry, f"D{tensor.symbol}", "")
