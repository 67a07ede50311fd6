"""Loops: closed paths to Burgers vectors."""

from geomtorsion.loops.loop import Loop, Part
from geomtorsion.loops.sides import Side

__all__ = ["Loop", "Part", "Side"]
