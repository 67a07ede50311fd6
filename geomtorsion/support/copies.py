"""Copies: pickling of a value without its computed properties, and equality by content."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from functools import partial
from typing import Any

import numpy as np


def only_fields(self: Any) -> dict[str, Any]:
    """The fields of a dataclass, with empty private tables: cached values are omitted.

    A class takes it as its `__getstate__`. Locks and compiled code are omitted; copies compute
    them again, to the same bit.

    Examples
    --------
    >>> from geomtorsion.ode import ODE
    >>> sorted(only_fields(ODE.of({"x": "-x"}, [1]).system))
    ['clock', 'end', 'groups', 'guard', 'parameters', 'rates', 'states', 'stops']
    """
    found = {item.name: getattr(self, item.name) for item in fields(self)}
    filled = [name for name, kept in found.items() if name[0] == "_" and isinstance(kept, dict)]
    return found | {name: {} for name in filled}


def content(self: Any) -> tuple[object, ...]:
    """The public fields of a dataclass that count when it is compared, arrays as their numbers.

    Examples
    --------
    >>> from geomtorsion.ode import At
    >>> content(At(1.0, {"a": 0}))
    (1.0, (('a', 0),))
    """
    counted = [x.name for x in fields(self) if x.compare and x.name[0] != "_"]
    return tuple(comparable(getattr(self, name)) for name in counted)


class ByContent:
    """A dataclass that is equal, hashed and copied by its content; declare it with eq=False."""

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return self is other or content(self) == content(other)

    def __hash__(self) -> int:
        return hash(content(self))

    def __getstate__(self) -> dict[str, Any]:
        return only_fields(self)


def comparable(value: Any) -> Any:
    """A value that `==` compares as a whole and that has a hash."""
    if isinstance(value, np.ndarray):
        entries = value.ravel().tolist()
        if value.dtype.kind in "fc" and np.isnan(value).any():
            # A missing number equals a missing number.
            entries = [None if x != x else x for x in entries]
        return value.shape, tuple(entries)
    if isinstance(value, Mapping):
        # The order of the names does not count.
        pairs = [(key, comparable(entry)) for key, entry in value.items()]
        return tuple(sorted(pairs, key=lambda pair: str(pair[0])))
    if isinstance(value, list | tuple):
        return tuple(comparable(entry) for entry in value)
    if isinstance(value, partial):
        return value.func, comparable(value.args), comparable(value.keywords)
    return value
