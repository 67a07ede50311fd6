"""Arithmetic: sums, multiples and equality of tensors; a tensor of rank 0 counts as a scalar."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp

from geomtorsion.errors import (
    ArgumentError,
    MissingValueError,
    TensorIndexError,
    UndecidedError,
)
from geomtorsion.exact import Element
from geomtorsion.geometry.components import Index, common
from geomtorsion.geometry.homes import at_home, over_frame
from geomtorsion.geometry.indexing import vanishes
from geomtorsion.support import checks

if TYPE_CHECKING:
    from geomtorsion.geometry.tensor import Scalar, Tensor


def combined(first: Tensor, second: Tensor | Scalar, sign: int) -> Tensor:
    """first + sign * second; slots and frame must agree, numbers add only to scalars."""
    if not isinstance(second, type(first)):
        if first.slots or not _is_scalar(second):
            raise TensorIndexError(
                f"{first.label}: expected a tensor to add, got {checks.shown(second)}."
            )
        second = first.frame.scalar(second, "t", "")
    home = over_frame(first.frame, second, second.label, TensorIndexError)
    if second.slots != first.slots:
        raise TensorIndexError(
            f"{first.label} and {second.label}: expected equal slots, got {first.slots!r} and "
            f"{second.slots!r}. Use raised, lowered, in_frame or in_coordinates first."
        )
    field, one, two = first.frame.field, first.components.get, home.components.get

    def rule(index: Index) -> Element:
        return field.sum([(1, one(index)), (sign, two(index))])

    return replace(
        first,
        source=rule,
        symmetry=common(first.symmetry, second.symmetry),
        symbol="t",
        name="",
        anchored=tuple(sorted({*first.anchored, *second.anchored})),
    )


def multiple(tensor: Tensor, factor: Tensor | Scalar) -> Tensor:
    """Tensor times a number, an expression or a tensor of rank 0."""
    if isinstance(factor, type(tensor)):
        if not tensor.slots and factor.slots:
            return multiple(factor, tensor)
        if factor.slots:
            raise TensorIndexError(
                "expected letters for the summed indices, got a product of two tensors with "
                "indices. Write contract('ab,bc->ac', s, t), or s @ t."
            )
        factor = _own_element(tensor, factor)
    elif not (isinstance(factor, Element) or _is_scalar(factor)):
        raise TensorIndexError(
            f"{tensor.label}: expected a number or an expression as a factor, got "
            f"{checks.shown(factor)}. For products of matrices write sympy.Matrix(tensor)."
        )
    (scale,) = tensor.frame.read([("factor", factor)])
    get = tensor.components.get

    def rule(index: Index) -> Element:
        return get(index) * scale

    return replace(tensor, source=rule, symbol="t", name="")


def quotient(tensor: Tensor, divisor: Tensor | Scalar) -> Tensor:
    """Tensor divided by a number, an expression or a tensor of rank 0."""
    if isinstance(divisor, type(tensor)):
        if divisor.slots:
            raise TensorIndexError(
                f"{tensor.label} / {divisor.label}: expected a scalar divisor, got a tensor with "
                "indices. Divide by one component."
            )
        divisor = _own_element(tensor, divisor)
    (read,) = tensor.frame.read([("divisor", divisor)])
    if read.is_zero:
        raise ZeroDivisionError(
            f"{tensor.label} / {divisor}: expected a divisor that is not zero, got exactly zero."
        )
    return multiple(tensor, read.inverse())


def power(tensor: Tensor, exponent: Scalar) -> Tensor:
    """Power of a tensor of rank 0."""
    if tensor.slots:
        raise TensorIndexError(
            f"{tensor.label}: expected a scalar for a power, got a tensor with indices. Choose the "
            "summed indices: s @ t."
        )
    raised = checks.expression(exponent, "exponent")
    if raised.is_negative and tensor.is_zero:
        raise ZeroDivisionError(
            f"{tensor.label}: expected a scalar that is not zero for a negative power, got exactly "
            "zero."
        )
    whole = raised.is_Integer
    value = tensor.element() ** int(raised) if whole else tensor[()] ** raised
    return tensor.frame.scalar(value, "t", "")


def number(tensor: Tensor) -> float:
    """A constant tensor of rank 0 as a float."""
    if tensor.slots:
        raise ArgumentError(
            f"{tensor.label}: expected a scalar, got a tensor with indices. Take one component."
        )
    value = tensor[()]
    if value.free_symbols or not value.is_number:
        names = ", ".join(sorted(map(str, value.free_symbols)))
        raise MissingValueError(
            f"{tensor.label}: expected a number, got an expression in {names}. Give values: "
            f".at({{...}})."
        )
    return float(value)


def equal(first: Tensor, second: Tensor) -> bool:
    """Exact equality of all components over one frame with equal slots."""
    home = at_home(first.frame, second) if second.slots == first.slots else None
    if home is None:
        return False
    if first.components.nonzero == home.components.nonzero:
        return True
    verdict = combined(first, home, -1).is_zero
    if verdict is None:
        raise UndecidedError(
            f"whether {first.label} equals {second.label} cannot be decided exactly, because "
            "relations between their functions are unknown. Compare numbers with .at(point)."
        )
    return verdict


def equals(tensor: Tensor, other: object) -> bool:
    """Whether a scalar is this expression, a tensor these components, or 0 where it vanishes."""
    if _is_scalar(other):
        exact = checks.fraction(other)
        if not tensor.slots:
            return equal(tensor, tensor.frame.scalar(other if exact is None else exact, "t", ""))
        return vanishes(tensor) if exact == 0 else False
    listed = checks.rows(other)
    if not tensor.slots or not isinstance(listed, list | tuple):
        return NotImplemented
    try:
        array = np.array(listed, dtype=object)
    except ValueError:
        # Rows of several lengths.
        return False
    if array.shape != tensor.shape:
        return False
    return equal(tensor, replace(tensor, source=dict(np.ndenumerate(array)), symmetry=()))


def _is_scalar(value: object) -> bool:
    """Whether a value is really one number or expression."""
    plain_value = checks.plain(value)
    if isinstance(plain_value, bool) or getattr(plain_value, "is_Matrix", False):
        return False
    return isinstance(plain_value, int | float | Fraction | sp.Expr)


def _own_element(tensor: Tensor, scalar: Tensor) -> Element:
    """The value of a tensor of rank 0 that belongs to the same frame."""
    return over_frame(tensor.frame, scalar, scalar.label, TensorIndexError).element()
