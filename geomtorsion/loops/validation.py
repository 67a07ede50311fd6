"""Validation: what a user gives for loops and complexes, checked once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import sympy as sp

from geomtorsion.errors import LimitError, LoopError, NetworkError
from geomtorsion.loops.arcs import Number, Plane, exact_number
from geomtorsion.support import checks

# What a number of a user is taken for: `exact_number`, or `dyadic_number`.
Reading = Callable[[Any], sp.Expr]
# What the sides of a plane may be, and what to do about parameters without values.
TWO_SIDES = "two coordinates such as (0, 1) or two vectors"
VALUES = "Give parameters={'{missing}': ...}."


def number(value: Number, where: str) -> float:
    """A finite float; symbols are refused with their own message."""
    if checks.real(value) is None and is_symbolic(value):
        raise LoopError(
            f"{where}: {value} contains symbols; only circles, ellipses and curves may."
        )
    return checks.number(value, where, LoopError)


def exact_input(value: Number, where: str) -> Number:
    """A finite number, unchanged."""
    number(value, where)
    return value


def length(value: Number, where: str) -> float:
    """A positive finite float."""
    number(value, where)
    remedy = "A loop without length encloses nothing."
    return checks.positive(value, where, LoopError, expected="a positive length", remedy=remedy)


def vector(values: Any, where: str, dimension: int | None = None) -> tuple[float, ...]:
    """A tuple of finite floats, of a given length."""
    wanted = "two coordinates or more" if dimension is None else f"{dimension} coordinates"
    listed = checks.entries(values, where, LoopError, dimension, expected=wanted)
    if len(listed) < 2:
        checks.refuse(LoopError, where, "two coordinates or more", values)
    return tuple(number(x, f"{where}[{k}]") for k, x in enumerate(listed))


def check_accuracy(accuracy: float, least: float = float(np.finfo(float).resolution)) -> None:
    """Refuse a relative accuracy that no double has, or an invalid one."""
    size = checks.real(accuracy)
    if size is None or not least <= size < 1:
        raise LoopError(
            f"accuracy: expected a relative error from {least} to below 1, got "
            f"{checks.shown(accuracy)}."
        )


def is_symbolic(*values: Any) -> bool:
    """Whether a value contains symbols, at any depth of lists and arrays."""
    for value in values:
        content = checks.rows(value)
        if isinstance(content, sp.Expr):
            if content.free_symbols:
                return True
        elif isinstance(content, list | tuple) and is_symbolic(*content):
            return True
    return False


def rows(plane: Plane, dimension: int, names: Sequence[str] = ()) -> tuple[np.ndarray, np.ndarray]:
    """The two directions of a plane as vectors, from coordinate numbers, names or vectors.

    names: of the coordinates, where a frame has them.
    """
    sides = checks.entries(plane, "plane", LoopError, 2, expected=TWO_SIDES)
    directions = [_direction(side, dimension, names) for side in sides]
    first, second = (np.array(direction) for direction in directions)
    gram = np.dot(first, second) ** 2 / (np.dot(first, first) * np.dot(second, second) or 1.0)
    if gram > 1 - 1e-14 or not first.any() or not second.any():
        raise LoopError(
            f"plane: the two directions {checks.shown(plane)} span no plane. Give independent ones."
        )
    return first, second


def _direction(side: Any, dimension: int, names: Sequence[str]) -> tuple[float, ...]:
    """A unit vector along a coordinate, or the vector that was given."""
    if isinstance(side, str | sp.Symbol):
        if not names:
            raise LoopError(
                f"plane: expected coordinate numbers or vectors, got {checks.shown(side)}. A loop "
                "has no names of coordinates: count them from 0."
            )
        side = names.index(checks.known_name(str(side), names, "plane", LoopError))
    if checks.is_list(side):
        return vector(side, "plane", dimension)
    wanted = f"coordinate numbers from 0 to {dimension - 1}, or vectors"
    number = checks.count(side, "plane", LoopError, 0, dimension - 1, expected=wanted)
    return tuple(float(k == number) for k in range(dimension))


def orthonormal(first: np.ndarray, second: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two orthonormal vectors in the same plane, the first along the first."""
    u = first / np.linalg.norm(first)
    v = second / np.linalg.norm(second)
    v = v - u * np.dot(u, v)
    return u, v / np.linalg.norm(v)


def exact_rows(
    plane: Plane, dimension: int, read: Reading = exact_number
) -> tuple[list[sp.Expr], list[sp.Expr]]:
    """The two directions of a plane as exact vectors; read: what a number is taken for."""
    first, second = (
        [read(x) for x in checks.rows(side)]
        if checks.is_list(side)
        else [sp.Integer(k == checks.whole(side)) for k in range(dimension)]
        for side in plane
    )
    return first, second


def exact_orthonormal(
    plane: Plane, dimension: int, read: Reading = exact_number
) -> tuple[list[sp.Expr], list[sp.Expr]]:
    """Two exact orthonormal vectors in a plane, the first along the first."""
    first, second = exact_rows(plane, dimension, read)
    u, v = (sp.Matrix(x) for x in (first, second))
    u = u / sp.sqrt(u.dot(u))
    v = v - u * u.dot(v)
    return list(u), list(v / sp.sqrt(v.dot(v)))


def exact_multiples(
    plane: Plane, axes: Sequence[Number], dimension: int, read: Reading = exact_number
) -> tuple[list[sp.Expr], list[sp.Expr]]:
    """Semi-axes over the larger one along the directions of a plane, exactly."""
    first, second = exact_rows(plane, dimension, read)
    a, b = (read(axis) for axis in axes)
    size = max(a, b)
    return [x * a / size for x in first], [x * b / size for x in second]


# Sums of whole numbers up to this size are exact in 64 bits, with a bit to spare.
LARGEST_WHOLE = np.iinfo(np.int64).max // 2


def listed(values: object, subject: str) -> list[Any]:
    """The entries of a list, tuple, array or text."""
    return (
        list(values) if isinstance(values, str) else checks.entries(values, subject, NetworkError)
    )


def once_round(values: object, subject: str) -> list[Any]:
    """The entries of a cycle in order, with an optional repetition of the first at the end.

    Examples
    --------
    >>> once_round([1, 2, 3, 1], "cycle"), once_round([1, 2, 3], "cycle")
    ([1, 2, 3], [1, 2, 3])
    """
    chain = listed(values, subject)
    return chain[:-1] if len(chain) > 1 and chain[0] == chain[-1] else chain


def value_rows(values: object, name: str, count: int) -> np.ndarray:
    """Rows of whole numbers or of finite floats."""
    table = checks.unmasked(values) if isinstance(values, np.ndarray) else None
    if table is None or table.dtype.kind not in "iuf":
        try:
            table = np.asarray(values)
        except (TypeError, ValueError):
            table = np.array(None)
        if table.dtype.kind not in "iu":
            table = checks.array(values, "values", NetworkError)
    if table.ndim == 1:
        table = table[:, None]
    if table.ndim != 2 or len(table) != count:
        raise NetworkError(
            f"values: expected one row for each {name}, shape ({count}, n), got {table.shape}."
        )
    if table.dtype.kind in "iu":
        check_sums(largest(table) * max(count, 1))
        return table.astype(np.int64, copy=False)
    bad = np.argwhere(~np.isfinite(table))
    if len(bad):
        k, i = bad[0].tolist()
        raise NetworkError(
            f"{name} {k}: expected finite values, got {table[k, i]} as component {i}. "
            f"Omit the {name}."
        )
    return table.astype(float, copy=False)


def largest(values: np.ndarray) -> float:
    """The largest magnitude, as a double, because |least int64| does not fit into int64."""
    return float(np.abs(values.astype(float)).max(initial=0.0))


def check_sums(size: float) -> None:
    """Refuse sums of whole numbers that may leave 64 bits, and would be wrong without a word."""
    if size >= LARGEST_WHOLE:
        raise LimitError(
            f"sums of these whole numbers may come to {size:.2g}, beyond 64 bits. Give larger "
            "units, or floats."
        )
