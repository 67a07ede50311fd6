"""source: the space that SPACE|FILE on the command line means."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from geomtorsion.spaces.space import Space

SpaceOrFile = Annotated[
    str,
    typer.Argument(
        metavar="SPACE|FILE",
        show_default=False,
        help="A shipped space (see `geomtorsion spaces`) or a tetrad file (TOML).",
    ),
]


def open_space(source: str) -> Space:
    """The shipped space of this name, or the space in this file."""
    from geomtorsion.errors import UnknownNameError
    from geomtorsion.spaces import load, names
    from geomtorsion.spaces.files import read_file

    path = Path(source)
    if source in names():
        return load(source)
    if path.suffix == ".toml" or path.exists() or path.name != source:
        return read_file(path)
    try:
        return load(source)
    except UnknownNameError as error:
        raise UnknownNameError(f"{error} There is no file of this name either.") from None
