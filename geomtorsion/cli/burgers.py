"""burgers: Burgers vectors of loops, for a person or for a pipeline."""

from __future__ import annotations

import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from geomtorsion.cli.guard import INTERRUPTED
from geomtorsion.cli.loop_text import assignments, described
from geomtorsion.cli.progress import working
from geomtorsion.cli.source import SpaceOrFile, open_space

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame
    from geomtorsion.loops import Loop

FAILED = 1
MOST_PICTURES = 12
Texts = list[str]


class Form(StrEnum):
    """How results are written."""

    text = "text"
    json = "json"


def _option(metavar: str, text: str) -> Any:
    """An option that may be given several times."""
    return typer.Option(metavar=metavar, show_default=False, help=text)


def burgers(
    source: SpaceOrFile,
    circle: Annotated[
        Texts, _option("CENTRE:RADIUS[:PLANE]", "A circle: 0.3,1,0.2:1e-8:phi1,phi2")
    ] = [],
    ellipse: Annotated[Texts, _option("CENTRE:A,B[:PLANE]", "An ellipse: 0,0,0:2,1")] = [],
    polygon: Annotated[Texts, _option("POINT;POINT;...", "A polygon: '0,0;1,0;0,1'")] = [],
    plaquette: Annotated[
        Texts, _option("CORNER:STEPS[:PLANE]", "A parallelogram: 0,0,0:1,1:x,y")
    ] = [],
    curve: Annotated[
        Texts, _option("EXPR;EXPR;...", "A closed curve in s: 'cos(s);sin(s);0'")
    ] = [],
    spline: Annotated[Texts, _option("POINT;POINT;...", "A spline through points.")] = [],
    interval: Annotated[
        str, typer.Option(metavar="START,END", help="Bounds of s in --curve.")
    ] = "0,2*pi",
    loops: Annotated[
        list[Path], _option("FILE", "Loops from a JSON or CSV file; - for JSON on standard input.")
    ] = [],
    values: Annotated[
        Texts,
        typer.Option("--set", metavar="NAME=VALUE", show_default=False, help="Parameter value."),
    ] = [],
    accuracy: Annotated[
        float | None,
        typer.Option(show_default=False, help="Wanted relative error; default: 1e-12."),
    ] = None,
    exact: Annotated[bool, typer.Option("--exact", help="A closed form, not numbers.")] = False,
    form: Annotated[
        Form, typer.Option("--format", help="text to read, json for programs.")
    ] = Form.text,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="DIR",
            show_default=False,
            help="Directory for burgers.json and pictures, made if it is missing.",
        ),
    ] = None,
) -> None:
    """Compute the Burgers vectors of loops: by how much they fail to close in the frame.

    Numbers may be 0.3 or pi/2; PLANE is two coordinates (the first two if left out). A loop that
    fails among several is reported in its place, and the command ends with 1.

    \b
    Examples:
      geomtorsion burgers so3 --circle 0.3,1,0.2:1e-12
      geomtorsion burgers screw_dislocation --set b=1 --polygon '1,0,0;0,1,0;-1,-1,0'
      geomtorsion burgers heisenberg --curve 'cos(s);sin(2*s);0' --exact
      geomtorsion burgers so3 --loops loops.json --format json | jq .results
    """
    space = open_space(source)
    given = {
        "circle": circle, "ellipse": ellipse, "polygon": polygon,
        "plaquette": plaquette, "curve": curve, "spline": spline,
    }  # fmt: skip
    parameters: dict[str, Any] = {}
    makers: list[Loop] = []
    for path in loops:
        read = _read(space.frame, path)
        makers += read.loops
        parameters |= read.parameters
        accuracy = read.accuracy if accuracy is None else accuracy
    parameters |= assignments(values)
    makers += _described(space.frame, given, interval)
    if not makers:
        raise typer.BadParameter("no loop was given: use --circle, --polygon, ... or --loops FILE")
    wanted = 1e-12 if accuracy is None else accuracy
    results, found, stopped = [], [], False
    with working(f"{space.name}: {len(makers)} loops") as progress:
        try:
            for k, loop in enumerate(makers):
                progress(f"loop {k + 1}")
                one = _solved(space.frame, loop, wanted, parameters, exact, len(makers))
                results.append(one[0])
                found.append(one[1])
        except KeyboardInterrupt:
            stopped = True
    document = {
        "space": space.name,
        "parameters": {name: str(value) for name, value in parameters.items()},
        "complete": not stopped,
        "results": results,
    }
    _write(document, form)
    if output is not None:
        _save(document, found, output)
    if stopped:
        raise typer.Exit(INTERRUPTED)
    if any("failed" in result for result in results):
        raise typer.Exit(FAILED)


def _read(frame: Frame, path: Path) -> Any:
    """Loops of a file, or of standard input."""
    from geomtorsion.loops.loop_files import loops_from_json, read_loops

    if str(path) == "-":
        return loops_from_json(frame, sys.stdin.read(), "standard input")
    return read_loops(frame, path)


def _described(frame: Frame, given: dict[str, list[str]], interval: str) -> list[Loop]:
    """Loops that stand on the command line."""
    from geomtorsion.loops.loop_files import loop_from_data

    return [
        loop_from_data(frame, described(kind, text, interval), f"--{kind} {text}")
        for kind, texts in given.items()
        for text in texts
    ]


def _solved(
    frame: Frame, loop: Loop, accuracy: float, parameters: dict[str, Any], exact: bool, count: int
) -> tuple[dict[str, Any], Any]:
    """The result of one loop as plain data, and as an object for the picture."""
    from geomtorsion.errors import GeomtorsionError, MissingValueError
    from geomtorsion.loops import burgers_vector, exact_burgers_vector

    try:
        if exact:
            closed = exact_burgers_vector(frame, loop)
            formula = [str(x) for x in closed.vector]
            return {"loop": loop.name, "exact": formula, "seconds": closed.seconds}, None
        b = burgers_vector(frame, loop, accuracy, parameters=parameters)
    except MissingValueError as error:
        raise MissingValueError(f"{error} Here: --set NAME=VALUE.") from None
    except GeomtorsionError as error:
        if count == 1:
            raise
        return {"loop": loop.name, "failed": str(error), "kind": type(error).__name__}, None
    return b.to_json(), b


def _write(document: dict[str, Any], form: Form) -> None:
    """Results on standard output."""
    if form is Form.json:
        import json

        typer.echo(json.dumps(document, indent=2))
        return
    for result in document["results"]:
        typer.secho(result["loop"], bold=True)
        if "failed" in result:
            typer.secho(f"  failed: {result['failed']}", fg=typer.colors.RED)
        elif "exact" in result:
            typer.echo(f"  b = ({', '.join(result['exact'])})")
        else:
            _explain(result)


def _explain(result: dict[str, Any]) -> None:
    """One numerical result in words."""
    numbers = result["vector"]
    if not any(numbers) and any(result["reduced"]):
        unit = result["unit"]
        shown = ", ".join(f"{x:.15g}" for x in result["reduced"])
        typer.echo(f"  b = ({shown}) * {unit['size']:g}^{unit['power']}, below all doubles")
    else:
        shown = ", ".join(
            f"{x:.15g}" if isinstance(x, float) else f"{complex(*x):.15g}" for x in numbers
        )
        typer.echo(f"  b = ({shown}) +- {result['error']:.1e}")
    if not result["reached"] and any(numbers):
        typer.secho(
            f"  the accuracy {result['accuracy']:g} was not reached", fg=typer.colors.YELLOW
        )
    typer.echo(f"  {result['why']}")
    typer.echo(f"  checked: {result['check']['text']}")
    typer.echo(f"  {result['evaluations']} evaluations, {result['seconds'] * 1e3:.2f} ms")


def _save(document: dict[str, Any], found: list[Any], output: Path) -> None:
    """burgers.json and a picture of each of the first loops."""
    import json

    output.mkdir(parents=True, exist_ok=True)
    target = output / "burgers.json"
    drawn = [b for b in found if b is not None][:MOST_PICTURES]
    names = []
    if drawn:
        from geomtorsion.errors import MissingExtraError
        from geomtorsion.pictures.ink import save
        from geomtorsion.pictures.loops import draw_closure

        try:
            for k, b in enumerate(drawn):
                names.append(f"loop-{k + 1}.svg")
                save(draw_closure(b), output / names[-1])
        except MissingExtraError as error:
            names.clear()
            typer.echo(f"no pictures: {error}", err=True)
    target.write_text(json.dumps(document, indent=2) + "\n", "utf-8")
    typer.echo(f"wrote {target}{' and ' + ', '.join(names) if names else ''}", err=True)
