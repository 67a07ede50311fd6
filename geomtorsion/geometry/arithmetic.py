"""Arithmetic: sums, multiples and exact equality of tensors."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import TensorIndexError, UndecidedError
from geomtorsion.geometry.arrays import total
from geomtorsion.geometry.symmetry import common

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.geometry.symmetry import Index
    from geomtorsion.geometry.tensor import Tensor


def combined(first: Tensor, second: Tensor, sign: int) -> Tensor:
    """first + sign * second; slots and frame must agree."""
    if not isinstance(second, type(first)):
        raise TensorIndexError(f"{first.label} can be added to a tensor, not to {second!r}.")
    if second.frame is not first.frame or second.slots != first.slots:
        raise TensorIndexError(
            f"{first.label} has slots {first.slots!r}, {second.label} has {second.slots!r}: "
            "only tensors of one frame with equal slots can be added. "
            "Use raised, lowered, in_frame, in_coordinates first."
        )
    field, one, two = first.frame.field, first.components.get, second.components.get

    def rule(index: Index) -> Element | None:
        terms = [(s, x) for s, x in ((1, one(index)), (sign, two(index))) if x is not None]
        return total(field, terms)

    return replace(
        first,
        source=rule,
        symmetry=common(first.symmetry, second.symmetry),
        symbol="t",
        name="",
        anchored=tuple(sorted({*first.anchored, *second.anchored})),
    )


def multiple(tensor: Tensor, factor: Any) -> Tensor:
    """Tensor times a number or an expression."""
    if isinstance(factor, type(tensor)):
        raise TensorIndexError(
            "Say which indices are summed: contract('ab,bc->ac', s, t), or s @ t."
        )
    (scale,) = tensor.frame.read([("factor", factor)])
    get = tensor.components.get

    def rule(index: Index) -> Element | None:
        value = get(index)
        return None if value is None else value * scale

    return replace(tensor, source=rule, symbol="t", name="")


def quotient(tensor: Tensor, divisor: Any) -> Tensor:
    """Tensor divided by a number or an expression."""
    (read,) = tensor.frame.read([("divisor", divisor)])
    if read.is_zero:
        raise ZeroDivisionError(f"{tensor.label} was divided by {divisor}, which is exactly zero.")
    return multiple(tensor, read.inverse())


def equal(first: Tensor, second: Tensor) -> bool:
    """Exact equality of all components over one frame with equal slots."""
    if second.frame is not first.frame or second.slots != first.slots:
        return False
    if first.components.nonzero == second.components.nonzero:
        return True
    verdict = combined(first, second, -1).is_zero
    if verdict is None:
        raise UndecidedError(
            f"Whether {first.label} equals {second.label} cannot be decided exactly: functions "
            "occur whose relations are not known. Compare numbers with .at(point)."
        )
    return verdict
