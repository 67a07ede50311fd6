"""sources: the space or the scene that a name or a file on the command line means."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from geomtorsion import spaces
from geomtorsion.errors import UnknownNameError
from geomtorsion.spaces import Space, read_file

T = TypeVar("T")


def shipped_or_file(
    source: str, names: tuple[str, ...], load: Callable[[str], T], read: Callable[[Path], T]
) -> T:
    """What is shipped under this name, or stands in this file; a name wins over a file."""
    path = Path(source)
    if source in names:
        return load(source)
    # What looks like a file is read as one, so that a misspelt path is no unknown name.
    if path.suffix == ".toml" or path.exists() or path.name != source:
        return read(path)
    # Neither: the error of the loader names what may have been meant.
    try:
        return load(source)
    except UnknownNameError as error:
        raise UnknownNameError(f"{error} There is no file of this name either.") from None


def open_space(source: str) -> Space:
    """The shipped space of this name, or the space in this file."""
    return shipped_or_file(source, spaces.names(), spaces.load, read_file)
