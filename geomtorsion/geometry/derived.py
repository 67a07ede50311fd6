"""Derived: quantities of a frame, each computed on first use and kept in the frame."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, Protocol, TypeVar, TypeVarTuple

from geomtorsion.exclusive import exclusive


class Keeper(Protocol):
    """An object that keeps the quantities that follow from it: a frame."""

    @property
    def _derived(self) -> dict[tuple[object, ...], Any]: ...


F = TypeVar("F", bound=Keeper)
T = TypeVar("T")
Arguments = TypeVarTuple("Arguments")


def derived(make: Callable[[F, *Arguments], T]) -> Callable[[F, *Arguments], T]:
    """Decorator for a quantity of a frame: the frame keeps the result for its later calls.

    The first argument is the frame, the others are hashable.

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
        results, key = frame._derived, (make, *arguments)
        if key not in results:
            results[key] = make(frame, *arguments)
        return results[key]

    return quantity
