"""Rigid: attitude and rotation of a body, without forces and torques."""

from geomtorsion.rigid import attitude, se3
from geomtorsion.rigid.free_top import FreeTop, free_top

__all__ = [
    "FreeTop",
    "attitude",
    "free_top",
    "se3",
]


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]
