"""Copies: pickling of a value: its fields, and nothing computed from them."""

from __future__ import annotations

from dataclasses import fields
from typing import Any


def only_fields(self: Any) -> dict[str, Any]:
    """The fields of a dataclass, with empty private tables: cached values are omitted.

    A class takes it as its `__getstate__`. Locks and compiled code are omitted; copies compute
    them again, to the same bit.

    Examples
    --------
    >>> from geomtorsion.ode import ODE
    >>> sorted(only_fields(ODE.of({"x": "-x"}, [1]).system))
    ['clock', 'end', 'groups', 'guard', 'parameters', 'rates', 'states']
    """
    found = {item.name: getattr(self, item.name) for item in fields(self)}
    filled = [name for name, kept in found.items() if name[0] == "_" and isinstance(kept, dict)]
    return found | {name: {} for name in filled}
