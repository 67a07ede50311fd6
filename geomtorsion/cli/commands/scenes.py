"""scenes: the shipped scenes, or the file of one of them."""

from __future__ import annotations

from typing import Annotated

import typer

from geomtorsion.cli.options import argument
from geomtorsion.scenes.shipped import described, names, path_of


def scenes(
    name: Annotated[str | None, argument("[NAME]", "Print the file of this scene.")] = None,
) -> None:
    """List the shipped scenes; with a name, print that scene as a file.

    \b
    Examples:
      geomtorsion scenes
      geomtorsion scenes lagrange_cusp > my-top.toml
    """
    if name is not None:
        typer.echo(path_of(name).read_text("utf-8"), nl=False)
        return
    listed = {each: str(described(each).data["title"]) for each in names()}
    width = max(map(len, listed))
    for each, title in listed.items():
        typer.echo(f"{each:<{width}}  {title}")
