"""accuracy: what accuracy costs in time, measured on a motion of a space or on a scene."""

from __future__ import annotations

import json
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from geomtorsion.accuracy import CostTable, accuracy_cost
from geomtorsion.cli.options import (
    NO_PICTURES,
    FrameVelocity,
    LastTime,
    Moments,
    Parameters,
    PictureFormat,
    Pictures,
    Proved,
    SpaceOrScene,
    Start,
    Velocity,
    directory,
    option,
    say_written,
)
from geomtorsion.cli.scene_sources import is_scene, open_scene, space_or_hint
from geomtorsion.cli.terminal import working
from geomtorsion.cli.values import engine_of, numbers, start_lines, start_options
from geomtorsion.errors import StartError
from geomtorsion.files import write_text
from geomtorsion.ode import Engine
from geomtorsion.pictures.style import can_draw, save
from geomtorsion.progress import bar
from geomtorsion.scenes.solve import scene_accuracy
from geomtorsion.spaces import pair_problems


class Curve(StrEnum):
    """The motion that is measured."""

    geodesic = "geodesic"
    autoparallel = "autoparallel"


def accuracy(
    source: SpaceOrScene,
    curve: Annotated[
        Curve | None,
        typer.Option(
            show_default=False, help="The motion of a space that is measured; default: geodesic."
        ),
    ] = None,
    start: Start = None,
    velocity: Velocity = None,
    frame_velocity: FrameVelocity = None,
    t: LastTime = None,
    parameters: Parameters = None,
    moments: Moments = None,
    accuracies: Annotated[
        str, typer.Option(metavar="X,...", help="Requested accuracies, one row each.")
    ] = "1e-3,1e-6,1e-9,1e-12",
    engines: Annotated[
        str | None,
        option(
            metavar="NAME,...",
            text="taylor, rungekutta, stiff; default: taylor (if installed) and rungekutta.",
        ),
    ] = None,
    output: Annotated[
        Path | None, directory("Write accuracy.json and the picture to this directory.")
    ] = None,
    form: Pictures = PictureFormat.png,
    proved: Proved = False,
) -> None:
    """Measure the cost of accuracy, and recommend an engine.

    Errors are measured against a closed form if one is known, otherwise against quadruple
    precision. Times are measured on this machine.

    \b
    Examples:
      geomtorsion accuracy so3 --moments 1,2,3 --t 100
      geomtorsion accuracy s2 --accuracies 1e-6,1e-12 -o cost
      geomtorsion accuracy lagrange_cusp --t 1
      geomtorsion accuracy so3 --proved
    """
    asked = numbers(accuracies, "accuracies") or []
    # The table chooses engines by itself, so that auto adds none.
    names = [] if engines is None else engines.split(",")
    solvers = [solver for name in names if (solver := engine_of(name.strip())) is not None]
    if is_scene(source):
        switches = {"--start": start, "--velocity": velocity, "--frame-velocity": frame_velocity}
        _refuse(switches | {"--moments": moments, "--curve": curve})
        table = _of_scene(source, t, parameters, solvers, asked, proved=proved)
        typer.echo(str(table))
    else:
        space = space_or_hint(source)
        with working(space.name) as progress:
            options = start_options(start, velocity, frame_velocity, t, parameters, moments)
            problems, chosen, last = pair_problems(space, **options)
            progress("measuring")
            problem = problems[(curve or Curve.geodesic).value]
            table = accuracy_cost(problem, last, solvers or None, asked, proved=proved)
        typer.echo("\n".join([*start_lines(problem, chosen), "", str(table)]))
    if output is not None:
        _write(table, output, form.value)


def _of_scene(
    source: str,
    t: str | None,
    settings: list[str] | None,
    engines: list[Engine],
    asked: list[float],
    *,
    proved: bool,
) -> CostTable:
    """The table of a scene."""
    scene = open_scene(source, t=t, settings=settings)
    with bar(scene.title or scene.name) as progress:
        return scene_accuracy(
            scene, engines or None, asked, progress or (lambda _: None), proved=proved
        )


def _refuse(given: dict[str, str | None]) -> None:
    """Refuse options of spaces for a scene."""
    wrong = [name for name, value in given.items() if value is not None]
    if wrong:
        raise StartError(
            f"{wrong[0]}: expected a space, got a scene, which has its own start. Use --set "
            "start.omega[0]=0.1."
        )


def _write(table: CostTable, folder: Path, form: str) -> None:
    """Table as data, and the picture where matplotlib is installed."""
    folder.mkdir(parents=True, exist_ok=True)
    data, picture = folder / "accuracy.json", folder / f"accuracy.{form}"
    write_text(data, json.dumps(table.to_json(), indent=2, ensure_ascii=False) + "\n")
    say_written([data])
    if can_draw():
        save(table.plot(), picture)
        say_written([picture])
    else:
        typer.echo(f"No picture: {NO_PICTURES}")
