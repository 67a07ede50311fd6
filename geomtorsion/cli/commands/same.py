"""same: whether two spaces are one geometry in different coordinates."""

from __future__ import annotations

from typing import Annotated

import typer

from geomtorsion.cli.exits import ExitCode
from geomtorsion.cli.options import Keep, KeepOption, SpaceOrFile, argument
from geomtorsion.cli.sources import open_space
from geomtorsion.cli.terminal import working
from geomtorsion.same import same_geometry
from geomtorsion.spaces import Space, names


def same(
    first: SpaceOrFile,
    second: Annotated[str, argument("SPACE|FILE", "The space to compare it with.")],
    keep: KeepOption = Keep.metric,
    orientation: Annotated[
        bool, typer.Option("--orientation", help="Keep left and right apart.")
    ] = False,
) -> None:
    """Decide whether two spaces are one geometry in different coordinates.

    The verdict is same, different or undecided, with its reason and certainty. It holds near
    generic points. Beside a file, a shipped space is a family: values of its parameters are
    searched. The command ends with 1 unless the spaces are the same.

    \b
    Examples:
      geomtorsion same schwarzschild schwarzschild_isotropic
      geomtorsion same so3 so3_right --keep legs
      geomtorsion same my-tetrad.toml kerr
    """
    with working(first):
        result = same_geometry(_side(first), _side(second), keep.value, orientation=orientation)
        text, verdict = str(result), result.verdict
    typer.echo(text)
    if verdict != "same":
        raise typer.Exit(ExitCode.failed)


def _side(source: str) -> Space | str:
    """The name of a shipped space, whose parameters are free, or the space in a file."""
    return source if source in names() else open_space(source)
