"""Shipped: the scenes that come with the package, each a scene file in this folder."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from geomtorsion.errors import UnknownNameError
from geomtorsion.scenes.scene_files import read_file
from geomtorsion.support.checks import known_name
from geomtorsion.support.files import TomlFile, read_toml

if TYPE_CHECKING:
    from geomtorsion.scenes.scene import Scene

_FOLDER = Path(__file__).parent


def names() -> tuple[str, ...]:
    """Names of the shipped scenes.

    Examples
    --------
    >>> "dzhanibekov" in names()
    True
    """
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.toml")))


def path_of(name: str) -> Path:
    """The scene file of a shipped scene.

    Raises
    ------
    UnknownNameError
        No shipped scene has this name; the message names a near one.
    """
    known_name(name, names(), "", UnknownNameError, expected="the name of a shipped scene")
    return _FOLDER / f"{name}.toml"


def described(name: str) -> TomlFile:
    """The content of a shipped scene's file, its title and story among it.

    Examples
    --------
    >>> described("dzhanibekov").data["title"]
    "Dzhanibekov's flip"
    """
    return read_toml(path_of(name))


def load(name: str) -> Scene:
    """A shipped scene by name.

    Raises
    ------
    UnknownNameError
        No shipped scene has this name; the message names a near one.

    Examples
    --------
    >>> load("dzhanibekov").start.omega
    (0.001, 1, 0)
    """
    return read_file(path_of(name))
