"""Loops: closed paths to Burgers vectors."""

from geomtorsion.loops.burgers import burgers_vector
from geomtorsion.loops.loop import Loop, Part
from geomtorsion.loops.result import BurgersVector, Check
from geomtorsion.loops.sides import Side

__all__ = ["BurgersVector", "Check", "Loop", "Part", "Side", "burgers_vector"]
