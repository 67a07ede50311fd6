"""Indexing: components of a tensor by numbers, slices and names of coordinates; NumPy arrays."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, Any, SupportsIndex, TypeAlias

import numpy as np
import sympy as sp

from geomtorsion.errors import (
    MissingValueError,
    SingularPointError,
    TensorIndexError,
    UndecidedError,
    UnknownNameError,
)
from geomtorsion.geometry import notation
from geomtorsion.geometry.components import determinant, inverse
from geomtorsion.support import checks

if TYPE_CHECKING:
    from types import EllipsisType

    from numpy.typing import DTypeLike

    from geomtorsion.exact import Element
    from geomtorsion.geometry.tensor import Tensor

    # A number (from the end where it is negative), a coordinate or its name, or a slice.
    Place: TypeAlias = SupportsIndex | str | sp.Symbol
    One: TypeAlias = Place | slice | EllipsisType


def chosen(tensor: Tensor, index: One | tuple[One, ...]) -> Any:
    """One component as an expression, or the array of components that slices select."""
    items = index if isinstance(index, tuple) else (index,)
    rank, n = len(tensor.slots), tensor.frame.dimension
    # The only component of a scalar is also its first.
    if not rank and len(items) == 1 and checks.whole(items[0]) == 0:
        items = ()
    gaps = [k for k, item in enumerate(items) if item is Ellipsis]
    if gaps:
        place = gaps[0]
        missing = rank - len(items) + 1
        items = (*items[:place], *[slice(None)] * missing, *items[place + 1 :])
    if len(items) > rank or len(gaps) > 1:
        raise _refused(tensor, index)
    axes: list[int | range] = []
    for slot, item in zip(tensor.slots, items, strict=False):
        values = _numbers(tensor, slot, item)
        if values is None:
            raise _refused(tensor, index)
        axes.append(values)
    axes += [range(n)] * (rank - len(items))
    if not any(isinstance(axis, range) for axis in axes):
        return notation.component(tensor, tuple(k for k in axes if isinstance(k, int)), _plain)
    shape = tuple(len(axis) for axis in axes if isinstance(axis, range))
    places = product(*(axis if isinstance(axis, range) else [axis] for axis in axes))
    flat = [notation.component(tensor, place, _plain) for place in places]
    return sp.ImmutableDenseNDimArray(flat, shape)


_plain = notation.plain


def _numbers(tensor: Tensor, slot: str, item: object) -> int | range | None:
    """The values of one index: a number, or the numbers of a slice; None if it is not valid."""
    n = tensor.frame.dimension
    if isinstance(item, slice):
        ends = (item.start, item.stop, item.step)
        whole = all(end is None or checks.whole(end) is not None for end in ends)
        return range(n)[item] if whole and item.step != 0 else None
    names = [symbol.name for symbol in tensor.frame.coordinates]
    name: object = str(item) if isinstance(item, sp.Symbol) else item
    # Legs have numbers, no names of coordinates.
    if isinstance(name, str):
        return names.index(name) if name in names and slot in "du" else None
    number = checks.whole(item)
    return number % n if number is not None and -n <= number < n else None


def _refused(tensor: Tensor, index: object) -> TensorIndexError:
    items = index if isinstance(index, tuple) else (index,)
    came = ", ".join("..." if item is Ellipsis else checks.shown(item) for item in items)
    rank, n = len(tensor.slots), tensor.frame.dimension
    if not rank:
        return TensorIndexError(
            f"{tensor.label}[{came}]: expected a scalar's only index, [()] or [0]."
        )
    names = ", ".join(symbol.name for symbol in tensor.frame.coordinates)
    named = f", a coordinate ({names})" if set(tensor.slots) & {*"du"} else ""
    legs = " Indices of legs are numbers." if set(tensor.slots) & {*"DU"} else ""
    return TensorIndexError(
        f"{tensor.label}[{came}]: expected up to {rank} indices, each a whole number from {-n} to "
        f"{n - 1}{named} or a slice.{legs}"
    )


def rows(tensor: Tensor) -> Iterator[Any]:
    """The values of the first index one after another, as NumPy iterates over an array."""
    if not tensor.slots:
        raise TensorIndexError(
            f"{tensor.label}: expected a tensor with indices to iterate over, got a scalar. Its "
            "value is scalar[()]."
        )
    return (chosen(tensor, k) for k in range(tensor.frame.dimension))


def truth(tensor: Tensor) -> bool:
    """Whether a scalar does not vanish; refused for tensors with indices."""
    if tensor.slots:
        raise TensorIndexError(
            f"the truth value of {tensor.label}, a tensor with indices, is ambiguous. Use "
            "tensor.is_zero, or compare: tensor == 0."
        )
    return not vanishes(tensor)


def vanishes(tensor: Tensor) -> bool:
    """Whether all components vanish.

    Raises
    ------
    UndecidedError
        That cannot be decided.
    """
    verdict = tensor.is_zero
    if verdict is None:
        raise UndecidedError(
            f"whether {tensor.label} vanishes cannot be decided exactly, because relations between "
            "its functions are unknown. Compare numbers with .at(point)."
        )
    return verdict


def derivative(tensor: Tensor, symbols: tuple[sp.Symbol | str, ...]) -> Tensor:
    """Partial derivatives of every component, one symbol after another."""
    frame = tensor.frame
    names = {symbol.name: symbol for symbol in frame.field.symbols}
    result = tensor
    for symbol in symbols:
        known = names.get(str(symbol))
        if known is None:
            raise UnknownNameError(
                f"derivative of {tensor.label}: expected one of {', '.join(names)}, got "
                f"{checks.shown(symbol)}."
            )
        slope = result.components.mapped(frame.field, lambda _, x, by=known: x.diff(by))
        name = f"d/d{known.name} {result.name}".strip()
        written = rf"\partial_{{{known.name}}} {result.symbol}"
        result = replace(result, source=slope, symbol=written, name=name)
    return result


def _matrix(tensor: Tensor, verb: str) -> dict[tuple[int, int], Element]:
    """The entries of a tensor with two indices that do not vanish."""
    if len(tensor.slots) != 2:
        raise TensorIndexError(
            f"{verb} of {tensor.label}: expected a tensor with two indices, got "
            f"{len(tensor.slots)}."
        )
    return {(i, j): tensor.element(i, j) for i, j in tensor.components.support}


def determinant_of(tensor: Tensor) -> Tensor:
    """See Tensor.det."""
    entries = _matrix(tensor, "determinant")
    frame = tensor.frame
    value = determinant(frame.field, entries, frame.dimension)
    return frame.scalar(value, rf"\det {tensor.symbol}", f"determinant of {tensor.name}".strip())


def inverse_of(tensor: Tensor) -> Tensor:
    """See Tensor.inv."""
    entries = _matrix(tensor, "inverse")
    if vanishes(determinant_of(tensor)):
        raise SingularPointError(
            f"inverse of {tensor.label}: expected a matrix with a determinant that does not vanish."
        )
    frame = tensor.frame
    inverted = inverse(frame.field, entries, frame.dimension)
    slots = tensor.slots[::-1].translate(str.maketrans("duDU", "udUD"))
    symmetry = tensor.symmetry if slots in ("uu", "UU", "dd", "DD") else ()
    return replace(
        tensor, slots=slots, source=inverted, symmetry=symmetry,
        symbol=rf"{tensor.symbol}", name=f"inverse of {tensor.name}".strip(), anchored=(),
    )  # fmt: skip


class _Floats(np.ndarray):
    """Floats of exact components, which are the exact ones where SymPy takes them one by one.

    `sympy.Matrix(tensor)` asks for an array and reads `ravel()` of it, or iterates over a vector;
    `numpy.asarray(tensor)` has plain floats.
    """

    exact: np.ndarray | None = None

    def ravel(self, order: Any = "C") -> np.ndarray:
        """The components in one row: exact ones."""
        return super().ravel(order) if self.exact is None else self.exact.ravel(order)

    def __iter__(self) -> Iterator[Any]:
        return super().__iter__() if self.exact is None else iter(self.exact)


def numpy_array(tensor: Tensor, dtype: DTypeLike | None = None) -> np.ndarray:
    """All components: floats (or complex numbers) if all are numbers, else an array of objects."""
    n, rank = tensor.frame.dimension, len(tensor.slots)
    array = np.full((n,) * rank, sp.S.Zero, dtype=object)
    for index in tensor.components.support:
        array[index] = notation.component(tensor, index, _plain)
    is_object = dtype is not None and np.dtype(dtype) == object
    symbols = sorted({symbol.name for x in array.flat for symbol in x.free_symbols})
    are_numbers = all(x.is_number for x in array.flat)
    if is_object or (dtype is None and not are_numbers):
        return array
    if not are_numbers:
        raise MissingValueError(
            f"{tensor.label}: expected numbers for an array of {np.dtype(dtype)}, got expressions "
            f"in {', '.join(symbols) or 'unknown functions'}. Give values: .at({{...}})."
        )
    is_real = all(x.is_real for x in array.flat)
    numbers = array.astype(float if is_real else complex)
    if dtype is not None:
        return numbers.astype(dtype)
    floats = numbers.view(_Floats)
    floats.exact = array
    return floats
