"""Rigid: how a body stands and turns, with nothing of what acts on it."""

from geomtorsion.rigid import attitude, se3
from geomtorsion.rigid.free_top import FreeTop, free_top

__all__ = [
    "FreeTop",
    "attitude",
    "free_top",
    "se3",
]
