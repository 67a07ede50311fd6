"""Scenes: rigid bodies with exactly the states and effects that the question needs.

Seven files import each other, because a `Scene` is the interface: its methods solve, sweep, draw
and compare, each by a function in another file that takes a scene. At run time the imports point
one way: scene, sweep, solve, result. The imports in the other direction are only for types.
"""

from geomtorsion.scenes import effects
from geomtorsion.scenes.body import Body
from geomtorsion.scenes.magnitudes import Magnitude, Magnitudes
from geomtorsion.scenes.result import SceneResult
from geomtorsion.scenes.saving import to_toml, write_file
from geomtorsion.scenes.scene import Scene, SceneCost
from geomtorsion.scenes.scene_files import read_file
from geomtorsion.scenes.selection import StateSelection
from geomtorsion.scenes.shipped import load, names
from geomtorsion.scenes.state import State
from geomtorsion.scenes.sweep import SceneSweep

__all__ = [
    "Body",
    "Magnitude",
    "Magnitudes",
    "Scene",
    "SceneCost",
    "SceneResult",
    "SceneSweep",
    "State",
    "StateSelection",
    "effects",
    "load",
    "names",
    "read_file",
    "to_toml",
    "write_file",
]


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]
