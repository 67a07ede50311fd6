"""Scenes: rigid bodies with exactly the states and effects that the question needs."""

from geomtorsion.scenes import effects
from geomtorsion.scenes.body import Body

__all__ = ["Body", "effects"]
