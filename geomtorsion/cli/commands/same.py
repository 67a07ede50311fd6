"""same: whether two spaces are one geometry in different coordinates."""

from __future__ import annotations

from typing import Annotated

import typer

from geomtorsion.cli.exits import ExitCode
from geomtorsion.cli.options import Keep, KeepOption, SpaceOrFile, argument
from geomtorsion.cli.sources import open_space
from geomtorsion.cli.terminal import working
from geomtorsion.same import same_geometry


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
    generic points. The command ends with 1 unless the spaces are the same.

    \b
    Examples:
      geomtorsion same schwarzschild schwarzschild_isotropic
      geomtorsion same so3 so3_right --keep legs
      geomtorsion same my-tetrad.toml kerr
    """
    with working(first):
        result = same_geometry(
            open_space(first), open_space(second), keep.value, orientation=orientation
        )
        text, verdict = str(result), result.verdict
    typer.echo(text)
    if verdict != "same":
        raise typer.Exit(ExitCode.failed)
