"""plan: what a quantity of a space, or a scene, would compute, and what not."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from geomtorsion.cli.progress import working
from geomtorsion.cli.scene_source import Watch, is_scene, open_scene, space_beside_scenes
from geomtorsion.errors import UnknownNameError

if TYPE_CHECKING:
    from geomtorsion.scenes import StateSelection


def plan(
    source: Annotated[
        str,
        typer.Argument(
            metavar="SPACE|SCENE|FILE",
            show_default=False,
            help="A shipped space or scene, a tetrad file or a scene file.",
        ),
    ],
    quantity: Annotated[
        str | None,
        typer.Argument(
            metavar="[QUANTITY]",
            show_default=False,
            help="Of a space: the quantity, for instance ricci.",
        ),
    ] = None,
    watch: Watch = None,
    dot: Annotated[
        bool, typer.Option("--dot", help="Print the graph in Graphviz's format.")
    ] = False,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="FILE.svg",
            show_default=False,
            help="Of a scene: draw the plan as a picture.",
        ),
    ] = None,
) -> None:
    """Show what is computed for a quantity of a space or for a scene, and what is left out.

    \b
    Examples:
      geomtorsion plan kerr ricci
      geomtorsion plan kerr ricci --dot | dot -Tsvg > plan.svg
      geomtorsion plan lagrange_cusp --watch nutation -o plan.svg
    """
    if quantity is None and is_scene(source):
        shown = open_scene(source, watch).selection
        typer.echo(_dot(shown) if dot else str(shown))
        if output is not None:
            output.write_text(shown.draw(), "utf-8")
            typer.echo(f"wrote {output}")
        return
    if quantity is None:
        space_beside_scenes(source)
        raise UnknownNameError(
            f"plan {source}: name a quantity of the space, as in `geomtorsion plan {source} ricci`."
        )
    with working(source):
        wanted = space_beside_scenes(source).frame.plan(quantity)
        written = wanted.to_dot() if dot else str(wanted)
    typer.echo(written)


def _dot(plan: StateSelection) -> str:
    """The graph of a scene in Graphviz's format; effects are boxes, what is watched is bold."""
    looks = {"effect": "shape=box", "watch": "style=bold", "state": "shape=ellipse"}
    lines = ["digraph plan {", "  rankdir=LR;"]
    for name, about in plan.graph.nodes(data=True):
        lines.append(f'  "{name}" [{looks.get(about.get("kind", "state"), "")}];')
    lines += [f'  "{one}" -> "{other}";' for one, other in plan.graph.edges]
    return "\n".join([*lines, "}"])
