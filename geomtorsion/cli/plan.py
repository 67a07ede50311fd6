"""plan: what asking for one quantity would compute, and what not."""

from __future__ import annotations

from typing import Annotated

import typer

from geomtorsion.cli.progress import working
from geomtorsion.cli.source import SpaceOrFile, open_space


def plan(
    source: SpaceOrFile,
    quantity: Annotated[
        str,
        typer.Argument(
            metavar="QUANTITY", show_default=False, help="The quantity, for instance ricci."
        ),
    ],
    dot: Annotated[
        bool, typer.Option("--dot", help="Print the graph in Graphviz's format.")
    ] = False,
) -> None:
    """Show what a quantity is computed from, and what is left out.

    \b
    Examples:
      geomtorsion plan kerr ricci
      geomtorsion plan kerr ricci --dot | dot -Tsvg > plan.svg
    """
    with working(source):
        shown = open_space(source).frame.plan(quantity)
        written = shown.to_dot() if dot else str(shown)
    typer.echo(written)
