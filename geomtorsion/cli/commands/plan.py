"""plan: which quantities a computation on a space or a scene needs, and which it skips."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from geomtorsion.cli.options import SpaceOrScene, Watch, argument, option
from geomtorsion.cli.scene_sources import is_scene, open_scene, space_or_hint, start_angles
from geomtorsion.cli.terminal import working
from geomtorsion.errors import UnknownNameError
from geomtorsion.scenes import StateSelection
from geomtorsion.support.files import write_text

# How the nodes of a scene's graph are drawn by Graphviz.
LOOKS = {"effect": "shape=box", "watch": "style=bold", "state": "shape=ellipse"}


def plan(
    source: SpaceOrScene,
    quantity: Annotated[
        str | None, argument("[QUANTITY]", "A quantity of a space, for instance ricci.")
    ] = None,
    watch: Watch = None,
    dot: Annotated[
        bool, typer.Option("--dot", help="Print the graph in Graphviz's format.")
    ] = False,
    lacking: Annotated[
        bool,
        typer.Option(
            "--lacking", help="Show how much each effect that is not in the scene would change it."
        ),
    ] = False,
    output: Annotated[
        Path | None,
        option("-o", "--output", metavar="FILE.svg", text="Draw the plan of a scene as a picture."),
    ] = None,
) -> None:
    """Show the steps that a quantity or a scene needs, and those it omits.

    \b
    Examples:
      geomtorsion plan kerr ricci
      geomtorsion plan kerr ricci --dot | dot -Tsvg > plan.svg
      geomtorsion plan lagrange_cusp --watch nutation -o plan.svg
      geomtorsion plan missile --lacking
    """
    if quantity is None and is_scene(source):
        scene = open_scene(source, watch)
        if lacking:
            with working(scene.title or scene.name):
                text = str(scene.magnitudes())
            typer.echo(text)
            return
        shown = scene.selection
        lines = [str(shown), *start_angles(scene)]
        typer.echo(_dot(shown) if dot else "\n".join(lines))
        if output is not None:
            write_text(output, shown.draw())
            typer.echo(f"wrote {output}")
        return
    if quantity is None:
        # A wrong name raises its own error, before the quantity is requested.
        space_or_hint(source)
        raise UnknownNameError(
            f"plan {source}: expected a quantity of the space, got none. Name one, as in "
            f"`geomtorsion plan {source} ricci`."
        )
    scenes_only = {"--watch": watch, "--output": output, "--lacking": lacking or None}
    for name, value in scenes_only.items():
        if value is not None:
            raise UnknownNameError(
                f"{name}: expected a scene, got the space {source}. Omit the option."
            )
    with working(source):
        quantity_plan = space_or_hint(source).frame.plan(quantity)
        written = quantity_plan.to_dot() if dot else str(quantity_plan)
    typer.echo(written)


def _dot(plan: StateSelection) -> str:
    """The graph of a scene in Graphviz's format; effects are boxes, watched quantities are bold."""
    lines = ["digraph plan {", "  rankdir=LR;"]
    for name, data in plan.graph.nodes(data=True):
        lines.append(f'  "{name}" [{LOOKS.get(data.get("kind", "state"), "")}];')
    lines += [f'  "{one}" -> "{other}";' for one, other in plan.graph.edges]
    return "\n".join([*lines, "}"])
