"""Exclusive: exact work is done by one thread at a time, under one lock.

Frames, tensors and elements never change for a reader, but what they rest on grows: a field adds
generators and factors and lifts numerators to its larger ring; arrays compute components when they
are read. The precision of mpmath and python-flint belongs to the whole process. One lock covers all
of this, not one for each field: two threads that took the locks of two frames in opposite order, as
in maps between charts, would wait for each other for ever.

Entrances take it: the methods of elements, fields, frames, tensors and objects made of them,
printing included, and the functions that generate code. An entrance holds it until its value is
complete, so that threads get the values that their calls give in some order. Numerical work (steps
of a solution, quadratures) runs without it; nobody may wait for another thread while holding it.
"""

from __future__ import annotations

import os
from contextvars import ContextVar
from functools import wraps
from threading import RLock
from types import FunctionType
from typing import Any, Protocol, TypeVar

from geomtorsion.support.caching import cached_property

T = TypeVar("T")


class Block(Protocol):
    """A block of code with limits."""

    def check(self) -> None:
        """Raise if a limit is met."""
        ...


# Entered only by `with LOCK`, between whose two steps no Ctrl-C can come.
LOCK = RLock()
if hasattr(os, "register_at_fork"):
    # A child gets neither half a change by another thread nor a lock that nobody releases.
    os.register_at_fork(
        before=LOCK.acquire, after_in_parent=LOCK.release, after_in_child=LOCK.release
    )
# The limits around a call (see `allowance`), which hold while it waits as well.
BLOCKS: ContextVar[tuple[Block, ...]] = ContextVar("blocks", default=())
# Special methods of an object that no other thread has yet, or that never touch its state.
_FREE = {
    "__init__", "__post_init__", "__new__", "__setattr__", "__delattr__", "__init_subclass__",
    "__class_getitem__", "__deepcopy__", "__copy__", "__bool__",
}  # fmt: skip


def exclusive(entrance: T) -> T:
    """Let one thread at a time run a function, or the public methods and properties of a class.

    Examples
    --------
    >>> @exclusive
    ... class Table:
    ...     rows = ()
    ...
    ...     def append(self, row):
    ...         self.rows = (*self.rows, row)
    >>> table = Table()
    >>> table.append(1)
    >>> table.rows
    (1,)
    """
    if not isinstance(entrance, type):
        return _locked(entrance)
    for name, member in list(vars(entrance).items()):
        is_special = name.startswith("__") and name.endswith("__")
        if name in _FREE or (name.startswith("_") and not is_special):
            continue
        if isinstance(member, FunctionType):
            setattr(entrance, name, _locked(member))
        elif isinstance(member, property):
            setattr(entrance, name, property(_locked(member.fget), doc=member.__doc__))
        elif isinstance(member, classmethod):
            setattr(entrance, name, classmethod(_locked(member.__func__)))
        elif isinstance(member, cached_property):
            member.func = _locked(_unless_cached(member))
    return entrance


def unlocked(entrance: T) -> T:
    """Mark a method in an exclusive class that reads only what never changes."""
    entrance._is_unlocked = True  # pyright: ignore[reportAttributeAccessIssue]
    return entrance


def wait() -> None:
    """Return when no other thread does exact work; limits of this thread end the wait."""
    while not LOCK.acquire(timeout=0.05):
        for block in BLOCKS.get():
            block.check()
    LOCK.release()


def _locked(function: Any) -> Any:
    """A function that holds the lock while it runs."""
    if hasattr(function, "_is_unlocked"):
        return function

    @wraps(function)
    def single(*arguments: Any, **options: Any) -> Any:
        if BLOCKS.get():
            wait()
        with LOCK:
            return function(*arguments, **options)

    return single


def _unless_cached(member: Any) -> Any:
    """The function of a cached property, unless another thread has called it in the meantime."""
    compute = member.func

    @wraps(compute)
    def current(instance: Any) -> Any:
        cache = instance.__dict__
        return cache[member.attrname] if member.attrname in cache else compute(instance)

    return current
