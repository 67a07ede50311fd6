"""Derived: quantities of a frame, each computed on first use and kept in the frame."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, Protocol, TypeVar, TypeVarTuple

from geomtorsion.support.exclusive import exclusive


class Keeper(Protocol):
    """An object that keeps the quantities that follow from it: a frame."""

    @property
    def _derived(self) -> dict[tuple[object, ...], Any]: ...


F = TypeVar("F", bound=Keeper)
T = TypeVar("T")
Arguments = TypeVarTuple("Arguments")


def derived(make: Callable[[F, *Arguments], T]) -> Callable[[F, *Arguments], T]:
    """Decorator for a quantity of a frame: the frame keeps the result for its later calls.

    The first argument is the frame, the others are hashable. A frame or connection among them is
    known by its identity: the result has elements of its field, not of the field of an equal one.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> @derived
    ... def trace(frame):
    ...     return sum(frame.metric[i, i] for i in range(frame.dimension))
    >>> r, phi = sp.symbols("r phi", positive=True)
    >>> frame = Frame([r, phi], [[1, 0], [0, r]])
    >>> trace(frame), trace(frame) is trace(frame)
    (r**2 + 1, True)
    """

    @exclusive
    @wraps(make)
    def quantity(frame: F, *arguments: *Arguments) -> T:
        results, key = frame._derived, (make, *map(_key, arguments))
        if key not in results:
            results[key] = make(frame, *arguments)
        return results[key]

    return quantity


def _key(argument: object) -> object:
    """An argument as part of a key."""
    return Itself(argument) if getattr(argument, "has_own_field", False) else argument


class Itself:
    """A key that equals only a key of the very same object, which it holds."""

    def __init__(self, value: object) -> None:
        self.value = value

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Itself) and other.value is self.value

    def __hash__(self) -> int:
        return id(self.value)
