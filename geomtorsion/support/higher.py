"""higher: modules of higher layers for what a user typed or displays, named by the top level."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

_NAMED: list[Callable[[str], ModuleType]] = []


def register(module: Callable[[str], ModuleType]) -> None:
    """Set what imports a module of the package by its name; the top level calls this once."""
    _NAMED[:] = [module]


def higher(module: str) -> ModuleType:
    """A module of a higher layer, such as "pictures.notebook_tables" or "spaces".

    Only the name of a shipped space given as a frame, and the drawing of a value, lead upwards.
    The layers themselves import downwards only.

    Examples
    --------
    >>> higher("spaces").shipped_space("so3").frame.dimension
    3
    """
    return _NAMED[0](module)
