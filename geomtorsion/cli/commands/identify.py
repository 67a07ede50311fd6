"""identify: the shipped space that a tetrad describes in other coordinates."""

from __future__ import annotations

from typing import Annotated

import typer

from geomtorsion.cli.exits import ExitCode
from geomtorsion.cli.options import Keep, KeepOption, SpaceOrFile
from geomtorsion.cli.sources import open_space
from geomtorsion.cli.terminal import working
from geomtorsion.spaces import identify as identified


def identify(
    source: SpaceOrFile,
    keep: KeepOption = Keep.metric,
    every: Annotated[
        bool, typer.Option("--every", help="All spaces that are the same, not only the first.")
    ] = False,
) -> None:
    """Find the shipped space that a tetrad describes in other coordinates.

    Prints the space with the values of its parameters, and properties such as flat, vacuum or
    constant curvature. A tetrad without domain is read in one region, which is printed. The command
    ends with 1 unless a space is found or the curvature is constant.

    \b
    Examples:
      geomtorsion identify my-tetrad.toml
      geomtorsion identify so3_quaternion --keep legs --every
    """
    with working(source):
        result = identified(open_space(source), keep.value, every=every)
    typer.echo(str(result))
    for match in result.matches:
        typer.echo(f"  source: {match.source}")
    if not result:
        raise typer.Exit(ExitCode.failed)
