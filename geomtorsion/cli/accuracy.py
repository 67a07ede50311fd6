"""accuracy: what accuracy costs in time, measured on a motion of a space or on a scene."""

from __future__ import annotations

import json
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from geomtorsion.cli.curve import (
    FrameVelocity,
    LastTime,
    Moments,
    Parameters,
    PictureFormat,
    Start,
    Velocity,
)
from geomtorsion.cli.numbers import engine_of, named_numbers, number, numbers
from geomtorsion.cli.progress import bar, working
from geomtorsion.cli.scene_source import is_scene, open_scene, space_beside_scenes
from geomtorsion.errors import StartError

if TYPE_CHECKING:
    from geomtorsion.accuracy import CostTable
    from geomtorsion.motion import Engine


class Curve(StrEnum):
    """Which motion is measured."""

    geodesic = "geodesic"
    autoparallel = "autoparallel"


def accuracy(
    source: Annotated[
        str,
        typer.Argument(
            metavar="SPACE|SCENE|FILE",
            show_default=False,
            help="A shipped space or scene, a tetrad file or a scene file.",
        ),
    ],
    curve: Annotated[Curve, typer.Option(help="Which motion is measured.")] = Curve.geodesic,
    start: Start = None,
    velocity: Velocity = None,
    frame_velocity: FrameVelocity = None,
    t: LastTime = None,
    parameters: Parameters = None,
    moments: Moments = None,
    accuracies: Annotated[
        str, typer.Option(metavar="X,...", help="What is asked for, one row each.")
    ] = "1e-3,1e-6,1e-9,1e-12",
    engines: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,...",
            show_default=False,
            help="taylor, rungekutta, stiff; default: taylor (if installed) and rungekutta.",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="DIR",
            show_default=False,
            help="Write accuracy.json and the picture to this directory.",
        ),
    ] = None,
    form: Annotated[
        PictureFormat, typer.Option("--format", help="Format of the picture.")
    ] = PictureFormat.png,
) -> None:
    """Measure what accuracy costs, and say what to take.

    Errors are measured against a closed form where there is one, else against quadruple precision;
    times are those of this machine.

    \b
    Examples:
      geomtorsion accuracy so3 --moments 1,2,3 --t 100
      geomtorsion accuracy s2 --accuracies 1e-6,1e-12 -o cost
      geomtorsion accuracy lagrange_cusp --t 1
    """
    asked = numbers(accuracies, "accuracies") or []
    solvers = None if engines is None else [engine_of(name.strip()) for name in engines.split(",")]
    found = [solver for solver in solvers or [] if solver is not None]
    if is_scene(source):
        given = {"--start": start, "--velocity": velocity, "--frame-velocity": frame_velocity}
        _refuse(given | {"--moments": moments})
        table = _of_scene(source, t, parameters, found, asked)
        typer.echo(str(table))
        _report(table, output, form)
        return
    from geomtorsion.accuracy import accuracy_cost
    from geomtorsion.pictures.pair import posed

    space = space_beside_scenes(source)
    with working(space.name) as progress:
        problems, chosen, last = posed(
            space,
            numbers(start, "start"),
            numbers(velocity, "velocity"),
            frame_velocity=numbers(frame_velocity, "frame velocity"),
            t=None if t is None else number(t, "t"),
            parameters=named_numbers(*parameters or ()),
            moments=numbers(moments, "moments"),
        )
        progress("measuring")
        problem = problems[curve.value]
        table = accuracy_cost(problem, last, found or None, asked)
    names = problem.coordinates
    begin = ", ".join(
        f"{n} = {float(x):.6g}" for n, x in zip(names, problem.start or (), strict=True)
    )
    moves = ", ".join(f"{n}' = {x:.6g}" for n, x in zip(names, problem.velocity, strict=True))
    values = ", ".join(f"{n} = {float(x):.6g}" for n, x in problem.parameters.items())
    for key, text in (("start", begin), ("velocity", moves), ("parameters", values)):
        if text:
            typer.echo(f"{key:<11}{text}{'  (chosen)' if key in chosen else ''}")
    typer.echo(f"\n{table}")
    _report(table, output, form)


def _of_scene(
    source: str,
    t: str | None,
    settings: list[str] | None,
    engines: list[Engine],
    asked: list[float],
) -> CostTable:
    """The table of a scene."""
    from geomtorsion.scenes.accuracy_table import scene_accuracy

    scene = open_scene(source, t=t, settings=settings)
    with bar(scene.title or scene.name) as progress:
        return scene_accuracy(scene, engines or None, asked, progress or (lambda _: None))


def _refuse(given: dict[str, str | None]) -> None:
    """Options of spaces mean nothing for a scene."""
    wrong = [name for name, value in given.items() if value is not None]
    if wrong:
        raise StartError(
            f"{wrong[0]} is for spaces; a scene has its own start: --set start.omega[0]=0.1."
        )


def _report(table: CostTable, output: Path | None, form: PictureFormat) -> None:
    """Write what was measured, if there is where to."""
    if output is not None:
        for line in _write(table, output, form.value):
            typer.echo(line)


def _write(table: CostTable, directory: Path, form: str) -> list[str]:
    """Table as data, and the picture where matplotlib is installed."""
    from geomtorsion.pictures.album import can_draw
    from geomtorsion.pictures.ink import save

    directory.mkdir(parents=True, exist_ok=True)
    data = directory / "accuracy.json"
    data.write_text(json.dumps(table.to_json(), indent=2, ensure_ascii=False) + "\n", "utf-8")
    if not can_draw():
        missing = "No picture: matplotlib is not installed. `pip install geomtorsion[plots]`."
        return [f"wrote {data}", missing]
    picture = directory / f"accuracy.{form}"
    save(table.plot(), picture)
    return [f"wrote {data}", f"wrote {picture}"]
