"""spaces: the shipped frames, each in a file of its own, loaded by name or read from a file."""

from importlib import import_module
from typing import TYPE_CHECKING

from geomtorsion.spaces.files import read_file
from geomtorsion.spaces.registry import load, names, titles
from geomtorsion.spaces.space import KnownAnswer, Space

if TYPE_CHECKING:
    from geomtorsion.spaces.pair import Pair, solve_pair

__all__ = ["KnownAnswer", "Pair", "Space", "load", "names", "read_file", "solve_pair", "titles"]


def __getattr__(name: str) -> object:
    """A public name, imported on first use: who loads a space needs no motions."""
    if name not in ("Pair", "solve_pair"):
        raise AttributeError(f"module 'geomtorsion.spaces' has no attribute {name!r}")
    return getattr(import_module("geomtorsion.spaces.pair"), name)
