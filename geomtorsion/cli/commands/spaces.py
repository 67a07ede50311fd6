"""spaces: the shipped spaces, listed."""

from __future__ import annotations

import typer

from geomtorsion.spaces import titles


def spaces() -> None:
    """List the shipped spaces.

    Each name is valid where a command expects SPACE|FILE.

    \b
    Example:
      geomtorsion spaces
    """
    listed = titles()
    width = max(map(len, listed))
    for name, title in listed.items():
        typer.echo(f"{typer.style(name.ljust(width), bold=True)}  {title}")
