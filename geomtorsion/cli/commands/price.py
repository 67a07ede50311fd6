"""price: the cost of digits and certainty for a motion, a loop, a scene or measured data."""

from __future__ import annotations

import json
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from geomtorsion import prices
from geomtorsion.cli.loop_sources import named_loop
from geomtorsion.cli.measured_sources import Reading, identity_frame, opened
from geomtorsion.cli.options import (
    Force,
    Form,
    FrameVelocity,
    LastTime,
    Moments,
    Parameters,
    PictureFormat,
    Pictures,
    Potential,
    Priced,
    Shown,
    Start,
    Velocity,
    directory,
    option,
    say_files,
)
from geomtorsion.cli.scene_sources import is_scene, open_scene, space_or_hint
from geomtorsion.cli.terminal import working
from geomtorsion.cli.values import engine_of, named_numbers, numbers, start_lines, start_options
from geomtorsion.errors import StartError
from geomtorsion.materials.readers import is_source
from geomtorsion.ode import Engine
from geomtorsion.pictures.style import can_draw, save
from geomtorsion.spaces import pair_problems
from geomtorsion.support.files import make_folder, write_text
from geomtorsion.support.outgoing import duration_text
from geomtorsion.support.progress import bar


class Curve(StrEnum):
    """The motion that is measured."""

    geodesic = "geodesic"
    autoparallel = "autoparallel"


def price(
    source: Priced,
    loop: Annotated[
        str | None,
        option(metavar="'KIND TEXT'", text="A loop instead of a motion: 'circle 0.3,1,0.2:0.01'."),
    ] = None,
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
    force: Force = None,
    potential: Potential = None,
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
    proofs: Annotated[
        str, typer.Option(metavar="N,...", help="Digits of proofs; none to omit them.")
    ] = "10,30",
    memory: Annotated[
        bool, typer.Option("--memory", help="Measure the peak of memory; takes much longer.")
    ] = False,
    budget: Annotated[
        float | None, option(metavar="S", text="Report the accuracy that S seconds buy.")
    ] = None,
    output: Annotated[
        Path | None, directory("Write price.json, price.csv and the figure to this directory.")
    ] = None,
    pictures: Pictures = PictureFormat.png,
    form: Shown = Form.text,
) -> None:
    """Measure the cost of digits and certainty for a motion, a loop or a scene.

    True errors are measured against a proof wherever one is possible. Times are measured on this
    machine, in seconds of processor time.

    \b
    Examples:
      geomtorsion price so3 --moments 1,2,3 --t 100
      geomtorsion price so3 --loop 'circle 0.3,1,0.2:0.01' --budget 0.1
      geomtorsion price lagrange_cusp --t 1 --proofs none
      geomtorsion price field.npz --loop 'circle 0,0:0.5' -o prices
    """
    wanted = {
        "accuracies": numbers(accuracies, "accuracies") or [],
        "engines": _engines(engines),
        "proofs": _digits(proofs),
        "memory": memory,
    }
    motion = {"--start": start, "--velocity": velocity, "--frame-velocity": frame_velocity}
    motion |= {"--moments": moments, "--force": force, "--potential": potential, "--curve": curve}
    lines: list[str] = []
    if is_scene(source):
        _refuse(
            motion | {"--loop": loop},
            "a scene, which has its own start. Use --set start.omega[0]=0.1",
        )
        scene = open_scene(source, t=t, settings=parameters)
        with bar(scene.title or scene.name) as progress:
            found = prices.price(scene, **wanted, progress=progress)
    elif is_source(source):
        _refuse(motion | {"--t": t, "--parameters": parameters}, "measured data. Drop it")
        with working(Path(source).name):
            field = opened(source, Reading())
            found = prices.price(
                field, named_loop(identity_frame(field.names), loop or ""), **wanted
            )
    elif loop is not None:
        _refuse(motion | {"--t": t}, "a loop. Drop it")
        space = space_or_hint(source)
        with working(space.name):
            shape = named_loop(space.frame, loop)
            found = prices.price(space, shape, **wanted, parameters=named_numbers(parameters or []))
    else:
        space = space_or_hint(source)
        with working(space.name) as progress:
            options = start_options(
                start, velocity, frame_velocity, t, parameters, moments, force, potential
            )
            problems, chosen, last = pair_problems(space, **options)
            progress("measuring")
            problem = problems[(curve or Curve.geodesic).value]
            found = prices.price(problem, last, **wanted)
        lines = [*start_lines(problem, chosen), ""]
    if form is Form.json:
        bought = {} if budget is None else {"budget": budget, "buys": found.accuracy(budget)}
        typer.echo(json.dumps(found.to_json() | bought, indent=2, ensure_ascii=False))
    else:
        typer.echo("\n".join([*lines, str(found)]))
        if budget is not None:
            typer.echo(f"{duration_text(budget)} buys {found.accuracy(budget):.2g}")
    if output is not None:
        say_files(_write(found, output, pictures.value), form, drawn=can_draw())


def _digits(text: str) -> list[float]:
    """Digits of proofs; whole numbers as such, so that others are refused as they were typed."""
    if text.strip() == "none":
        return []
    return [int(x) if x == int(x) else x for x in numbers(text, "proofs") or []]


def _engines(names: str | None) -> list[Engine] | None:
    """Engines by name; auto adds none, because the table chooses by itself."""
    if names is None:
        return None
    found = [engine_of(name.strip()) for name in names.split(",")]
    return [engine for engine in found if engine is not None] or None


def _refuse(given: dict[str, str | None], got: str) -> None:
    """Refuse options that do not fit the source.

    Raises
    ------
    StartError
        One of them has a value.
    """
    wrong = [name for name, value in given.items() if value is not None]
    if wrong:
        raise StartError(f"{wrong[0]}: expected a motion, got {got}.")


def _write(table: prices.PriceList, folder: Path, form: str) -> list[Path]:
    """Table as data, and the figure where matplotlib is installed."""
    make_folder(folder)
    data, rows, figure = (folder / f"price.{end}" for end in ("json", "csv", form))
    write_text(data, json.dumps(table.to_json(), indent=2, ensure_ascii=False) + "\n")
    table.to_csv(rows)
    if not can_draw():
        return [data, rows]
    save(table.plot(), figure)
    return [data, rows, figure]
