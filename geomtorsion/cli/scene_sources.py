"""scene_sources: the scene that a name or a file on the command line means.

Separate from `sources`, since scenes take longer to load than spaces.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from geomtorsion import scenes
from geomtorsion.cli.sources import open_space, shipped_or_file
from geomtorsion.cli.values import number, parts
from geomtorsion.errors import GeomtorsionError, StartError, UnknownNameError
from geomtorsion.exact.units import quantity
from geomtorsion.scenes import Scene
from geomtorsion.spaces import Space
from geomtorsion.support.checks import cut, near_names, shown
from geomtorsion.support.files import read_toml


def is_scene(source: str) -> bool:
    """Whether a source is a scene rather than a space: a shipped one, or a file with a body."""
    path = Path(source)
    if path.suffix != ".toml" or not path.exists():
        return source in scenes.names()
    try:
        data = read_toml(path).data
    except GeomtorsionError:
        # A broken file is read as a space, whose error names the problem.
        return False
    return "body" in data or "effects" in data


def space_or_hint(source: str) -> Space:
    """The space of this name or file; if there is none, the error also names a similar scene."""
    try:
        return open_space(source)
    except UnknownNameError as error:
        near = near_names(source, scenes.names())
        hint = f" Did you mean the scene {near}?" if near else ""
        raise UnknownNameError(f"{error}{hint}") from None


def open_scene(
    source: str,
    watch: list[str] | None = None,
    accuracy: float | None = None,
    t: str | None = None,
    settings: list[str] | None = None,
) -> Scene:
    """The shipped scene of this name, or the scene in this file, with the requested changes."""
    scene = shipped_or_file(source, scenes.names(), scenes.load, scenes.read_file)
    changes: dict[str, Any] = {}
    if watch:
        changes["watch"] = parts(",".join(watch))
    if accuracy is not None:
        changes["accuracy"] = accuracy
    if t is not None:
        changes["t"] = quantity(t, "s")
    pairs = [_setting(text) for text in settings or ()]
    for place, (path, _) in enumerate(pairs):
        if path in (other for other, _ in pairs[:place]):
            raise StartError(f"--set: expected {cut(path)} once, got it twice. Give one value.")
    changes |= dict(pairs)
    return scene.with_values(changes) if changes else scene


def _setting(text: str) -> tuple[str, float]:
    """One path=number."""
    path, sign, value = text.partition("=")
    if not sign or not path.strip():
        raise StartError(
            f"--set: expected PATH=NUMBER, got {shown(text)}. Write --set body.moments[2]=3.1."
        )
    return path.strip(), number(value, path.strip())


def start_angles(scene: Scene | None) -> list[str]:
    """The Euler angles at the start in both units: plain numbers in a file are radians."""
    if scene is None or scene.start.euler is None:
        return []
    angles = [float(angle) for angle in scene.start.euler]
    radians = ", ".join(f"{angle:.6g}" for angle in angles)
    degrees = ", ".join(f"{math.degrees(angle):.6g}" for angle in angles)
    name = scene.start.euler_convention
    return [f"starts at Euler angles ({name}) {radians} rad, which are {degrees} degrees"]
