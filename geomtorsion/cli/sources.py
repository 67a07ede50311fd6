"""sources: the space or the file that a name on the command line means."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from os.path import exists
from pathlib import Path
from typing import TypeVar

from geomtorsion import spaces
from geomtorsion.errors import FileFormatError, UnknownNameError
from geomtorsion.spaces import Space, read_file
from geomtorsion.support.typed_text import is_typed

T = TypeVar("T")


def shipped_or_file(
    source: str, names: tuple[str, ...], load: Callable[[str], T], read: Callable[[Path], T]
) -> T:
    """The shipped object of this name, or the object in this file; a name wins over a file."""
    path = Path(source)
    if source in names:
        return load(source)
    # A text that looks like a path is read as a file, so that its error names the missing file.
    if path.suffix == ".toml" or path.exists() or path.name != source:
        return read(path)
    # Neither exists: the error of the loader suggests similar names.
    try:
        return load(source)
    except UnknownNameError as error:
        raise UnknownNameError(f"{error} There is no file of this name either.") from None


def open_space(source: str) -> Space:
    """The shipped space of this name, the space in this file, or a line element."""
    if is_typed(source) and not exists(source):
        return spaces.load(source)
    tetrad = source in spaces.names() or Path(source).suffix == ".toml"
    # By name: a command on a space does not need the readers of measured data.
    if not tetrad and import_module("geomtorsion.materials.readers").is_source(source):
        raise FileFormatError(
            f"{source}: expected a space or a tetrad file, got measured data. Use `geomtorsion "
            "circuit FILE --loop 'circle 20,30:8'`, or map, price or stress."
        )
    return shipped_or_file(source, spaces.names(), spaces.load, read_file)
