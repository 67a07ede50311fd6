"""burgers: Burgers vectors of loops, for a person or for a pipeline."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any

import sympy as sp
import typer

from geomtorsion.cli.exits import ExitCode
from geomtorsion.cli.loop_sources import LoopFiles, Texts, files_of_loops, named_loop, typed_loop
from geomtorsion.cli.options import Form, Proved, Shown, SpaceOrFile, directory, option
from geomtorsion.cli.sources import open_space
from geomtorsion.cli.terminal import working
from geomtorsion.errors import GeomtorsionError, LoopError, MissingExtraError, MissingValueError
from geomtorsion.geometry import Frame
from geomtorsion.loops import BurgersVector, Loop, burgers_vector, exact_burgers_vector
from geomtorsion.loops.loop_files import LoopFile, number_of
from geomtorsion.pictures.loops import draw_closure
from geomtorsion.pictures.style import save
from geomtorsion.proofs import prove
from geomtorsion.support.checks import cut
from geomtorsion.support.files import make_folder, write_text
from geomtorsion.support.outgoing import measured_text, number_text, size_text

MOST_PICTURES = 12
Values = dict[str, "float | sp.Expr"]


def burgers(
    source: SpaceOrFile,
    circle: Annotated[
        Texts, option(metavar="CENTRE:RADIUS[:PLANE]", text="A circle: 0.3,1,0.2:1e-8:phi1,phi2")
    ] = [],
    ellipse: Annotated[
        Texts, option(metavar="CENTRE:A,B[:PLANE]", text="An ellipse: 0,0,0:2,1")
    ] = [],
    polygon: Annotated[
        Texts, option(metavar="POINT;POINT;...", text="A polygon: '0,0;1,0;0,1'")
    ] = [],
    plaquette: Annotated[
        Texts, option(metavar="CORNER:STEPS[:PLANE]", text="A parallelogram: 0,0,0:1,1:x,y")
    ] = [],
    curve: Annotated[
        Texts, option(metavar="EXPR;EXPR;...", text="A closed curve in s: 'cos(s);sin(s);0'")
    ] = [],
    spline: Annotated[
        Texts, option(metavar="POINT;POINT;...", text="A spline through points.")
    ] = [],
    loop: Annotated[
        Texts,
        option("--loop", metavar="'KIND TEXT'", text="A loop of any kind above: 'circle 20,30:8'."),
    ] = [],
    interval: Annotated[
        str | None, option(metavar="START,END", text="Bounds of s in --curve; default: 0,2*pi.")
    ] = None,
    loops: LoopFiles = [],
    values: Annotated[
        Texts, option("--set", metavar="NAME=VALUE", text="Value of a parameter; may be repeated.")
    ] = [],
    accuracy: Annotated[
        float | None, option(metavar="X", text="Requested relative error; default: 1e-12.")
    ] = None,
    exact: Annotated[
        bool, typer.Option("--exact", help="Compute a closed form instead of numbers.")
    ] = False,
    proved: Proved = False,
    form: Shown = Form.text,
    output: Annotated[
        Path | None,
        directory("Directory for burgers.json and pictures, created if missing."),
    ] = None,
) -> None:
    """Compute the Burgers vectors of loops: the gaps by which they fail to close.

    Components are along the legs of the frame. Numbers may be 0.3 or pi/2; PLANE is two coordinates
    (default: the first two). If one of several loops fails, its entry reports the error, and the
    command ends with 1. `geomtorsion circuit` does the same for measured data.

    \b
    Examples:
      geomtorsion burgers so3 --circle 0.3,1,0.2:1e-12
      geomtorsion burgers screw_dislocation --set b=1 --polygon '1,0,0;0,1,0;-1,-1,0'
      geomtorsion burgers heisenberg --curve 'cos(s);sin(2*s);0' --exact
      geomtorsion burgers screw_dislocation --set b=1 --circle 1,0,0:1.000001 --proved
      geomtorsion burgers so3 --loops loops.json --format json | jq .results
    """
    space = open_space(source)
    frame, name = space.frame, space.name
    shapes = {
        "circle": circle, "ellipse": ellipse, "polygon": polygon,
        "plaquette": plaquette, "curve": curve, "spline": spline,
    }  # fmt: skip
    _refuse_interval(interval, curve, loop)
    files = files_of_loops(frame, loops)
    all_loops = [one for _, read in files for one in read.loops]
    accuracy, parameters = _shared(files, accuracy, _exact_assignments(values))
    if exact and accuracy is not None:
        raise LoopError(
            f"accuracy {accuracy}: expected numbers, got --exact, a closed form without an error. "
            "Omit one of the two."
        )
    if exact and proved:
        raise LoopError(
            "--proved: expected numbers, got --exact, a closed form. Omit one of the two."
        )
    for kind, texts in shapes.items():
        all_loops += (typed_loop(frame, kind, text, interval) for text in texts)
    all_loops += (named_loop(frame, text, interval) for text in loop)
    if not all_loops:
        raise typer.BadParameter(
            "expected a loop, got none. Use --circle, --polygon, ... or --loops FILE."
        )
    with working(f"{name}: {len(all_loops)} loops") as progress:
        results, vectors = _computed(
            frame, all_loops, accuracy, parameters, progress, exact=exact, proved=proved
        )
    complete = len(results) == len(all_loops)
    document = {
        "space": name,
        "parameters": {name: str(value) for name, value in parameters.items()},
        "complete": complete,
        "results": results,
    }
    if form is Form.json:
        typer.echo(json.dumps(document, indent=2))
    else:
        for result in results:
            _explain(result)
    if output is not None:
        _save(document, vectors, output)
    if not complete:
        raise typer.Exit(ExitCode.interrupted)
    if any("failed" in result for result in results):
        raise typer.Exit(ExitCode.failed)


def _computed(
    frame: Frame,
    loops: Sequence[Loop],
    accuracy: float | None,
    parameters: Values,
    progress: Callable[[str], object],
    *,
    exact: bool,
    proved: bool,
) -> tuple[list[dict[str, Any]], list[BurgersVector | None]]:
    """Results as plain data and vectors of all loops, or of the first ones until Ctrl-C.

    The entry of a loop that fails reports the error; the error of a single loop is raised.
    """
    results: list[dict[str, Any]] = []
    vectors: list[BurgersVector | None] = []
    try:
        for k, one in enumerate(loops, 1):
            progress(f"loop {k}")
            try:
                result, vector = _solved(frame, one, accuracy, parameters, exact)
                if vector is not None and proved:
                    result |= {"proof": prove(vector).to_json()}
            except GeomtorsionError as error:
                if len(loops) == 1 or isinstance(error, MissingValueError):
                    raise
                kind = type(error).__name__
                result, vector = {"loop": one.name, "failed": str(error), "kind": kind}, None
            results.append(result)
            vectors.append(vector)
    except KeyboardInterrupt:
        pass
    return results, vectors


def _exact_assignments(texts: Iterable[str]) -> Values:
    """Values of parameters from NAME=VALUE, kept exact where they are written so."""
    values: Values = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not name.strip() or not value.strip():
            raise LoopError(f"--set: expected NAME=VALUE, got {cut(text)}. Write --set R=1.5.")
        values[name.strip()] = number_of(value.strip(), f"--set {name.strip()}")
    return values


def _shared(
    files: Sequence[tuple[Path, LoopFile]], accuracy: float | None, values: Values
) -> tuple[float | None, Values]:
    """Accuracy and parameters of all files; files must agree where no option sets the value."""
    asked: dict[str, Any] = {f"--set {name}": value for name, value in values.items()}
    if accuracy is not None:
        asked["--accuracy"] = accuracy
    settings: dict[str, tuple[Path, Any]] = {}
    for path, read in files:
        file_settings: dict[str, Any] = {f"--set {name}": x for name, x in read.parameters.items()}
        if read.accuracy is not None:
            file_settings["--accuracy"] = read.accuracy
        for switch, value in file_settings.items():
            first, rival = settings.setdefault(switch, (path, value))
            if rival != value and switch not in asked:
                name = switch.removeprefix("--accuracy").removeprefix("--set ") or "accuracy"
                raise LoopError(
                    f"--loops {path}: expected {name} = {rival} as in {first}, got {value}. Choose "
                    f"one by {switch}, or compute the files separately."
                )
    shared = {switch: value for switch, (_, value) in settings.items()} | asked
    accuracy = shared.pop("--accuracy", None)
    return accuracy, {switch.removeprefix("--set "): value for switch, value in shared.items()}


def _refuse_interval(interval: str | None, curves: Texts, others: Texts) -> None:
    """Refuse bounds of a curve if no curve is requested."""
    if interval is not None and not curves and not any(x.split()[:1] == ["curve"] for x in others):
        raise LoopError(
            f"--interval {cut(interval)}: expected a --curve in s, got none. Omit it, or "
            "give --curve 'EXPR;EXPR;...'. Loops in a file have their own intervals."
        )


def _solved(
    frame: Frame, loop: Loop, accuracy: float | None, parameters: Values, exact: bool
) -> tuple[dict[str, Any], BurgersVector | None]:
    """The result of one loop as plain data, and as an object for the picture."""
    if exact:
        closed = exact_burgers_vector(frame, loop, parameters=parameters)
        formula = [str(x) for x in closed.vector]
        return {"loop": loop.name, "exact": formula, "seconds": closed.seconds}, None
    asked: dict[str, Any] = {} if accuracy is None else {"accuracy": accuracy}
    vector = burgers_vector(frame, loop, **asked, parameters=parameters)
    return vector.to_json(), vector


def _explain(result: dict[str, Any]) -> None:
    """One result in words."""
    typer.secho(result["loop"], bold=True)
    if "failed" in result:
        typer.secho(f"  failed: {result['failed']}", fg=typer.colors.RED)
        return
    if "exact" in result:
        typer.echo(f"  b = ({', '.join(result['exact'])})")
        return
    numbers = result["vector"]
    if not any(numbers) and any(result["reduced"]):
        unit = result["unit"]
        shown = ", ".join(f"{x:.15g}" for x in result["reduced"])
        typer.echo(f"  b = ({shown}) * {unit['size']:g}^{unit['power']}, smaller than any double")
    else:
        error = result["error"]
        if all(isinstance(x, float) for x in numbers):
            typer.echo(f"  b = {measured_text(numbers, error)}")
        else:
            values = (x if isinstance(x, float) else complex(*x) for x in numbers)
            shown = ", ".join(number_text(x, error) for x in values)
            typer.echo(f"  b = ({shown}) +- {size_text(error)}")
    if not result["reached"] and any(numbers):
        typer.secho(
            f"  the accuracy {result['accuracy']:g} was not reached", fg=typer.colors.YELLOW
        )
    if "proof" in result:
        for line in result["proof"]["text"].splitlines():
            typer.echo(f"  {line}")
    typer.echo(f"  {result['reason']}")
    typer.echo(f"  checked: {result['check']['text']}")
    typer.echo(f"  {result['evaluations']} evaluations, {result['seconds'] * 1e3:.2f} ms")


def _save(document: dict[str, Any], vectors: Sequence[BurgersVector | None], folder: Path) -> None:
    """burgers.json and a picture of each of the first loops."""
    make_folder(folder)
    target = folder / "burgers.json"
    # A file of thousands of loops must not create thousands of pictures.
    drawn = [vector for vector in vectors if vector is not None][:MOST_PICTURES]
    names = []
    try:
        for k, vector in enumerate(drawn, 1):
            names.append(f"loop-{k}.svg")
            save(draw_closure(vector), folder / names[-1])
    except MissingExtraError as error:
        names.clear()
        typer.echo(f"No pictures: {error}", err=True)
    write_text(target, json.dumps(document, indent=2) + "\n")
    typer.echo(f"wrote {target}{' and ' + ', '.join(names) if names else ''}", err=True)
