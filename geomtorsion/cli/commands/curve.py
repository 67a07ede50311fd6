"""curve: the straightest and the shortest path from one start."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from geomtorsion.cli.exits import ExitCode
from geomtorsion.cli.options import (
    EngineName,
    Force,
    Form,
    FrameVelocity,
    LastTime,
    Moments,
    Parameters,
    PictureFormat,
    Pictures,
    Potential,
    Proved,
    Shown,
    SpaceOrFile,
    Start,
    Velocity,
    directory,
    say_files,
)
from geomtorsion.cli.sources import open_space
from geomtorsion.cli.terminal import right_aligned, some_rows, working
from geomtorsion.cli.values import engine_of, start_lines, start_options
from geomtorsion.pictures.curve_files import metadata, write_curves
from geomtorsion.pictures.style import can_draw
from geomtorsion.proofs import prove
from geomtorsion.spaces import Pair, solve_pair
from geomtorsion.support.outgoing import number_text, size_text
from geomtorsion.support.progress import bar

# Characters of a number, and the most coordinates that both curves show in one row.
WIDTH, SIDE_BY_SIDE = 11, 4
# Digits of a number: the width minus a gap, a sign, a point and an exponent.
DIGITS = WIDTH - len(" -.e-9")


def curve(
    source: SpaceOrFile,
    start: Start = None,
    velocity: Velocity = None,
    frame_velocity: FrameVelocity = None,
    t: LastTime = None,
    parameters: Parameters = None,
    moments: Moments = None,
    force: Force = None,
    potential: Potential = None,
    accuracy: Annotated[
        float, typer.Option(metavar="X", help="Largest error of the result, relative to its size.")
    ] = 1e-10,
    samples: Annotated[int, typer.Option(metavar="N", help="Rows of the table.")] = 401,
    engine: EngineName = "auto",
    output: Annotated[
        Path | None, directory("Write curve.csv, curve.json and pictures to this directory.")
    ] = None,
    pictures: Pictures = PictureFormat.png,
    form: Shown = Form.text,
    proved: Proved = False,
) -> None:
    """Follow the straightest and the shortest path from one start.

    The straightest path is the autoparallel of the connection (of the space, or the Cartan
    connection of its frame), the shortest is the geodesic of the metric. Missing values are chosen,
    and the output marks them. The command ends with 1 if a motion leaves its chart before the last
    time; the computed part is still shown and written.

    \b
    Examples:
      geomtorsion curve s2 --start 1.9,0 --velocity=-0.2,1.06 --t 6 -o sphere
      geomtorsion curve so3 --moments 1,2,3 --t 20 --accuracy 1e-12
      geomtorsion curve my-tetrad.toml --set M=1 -o curves
      geomtorsion curve kerr --t 100 --proved
      geomtorsion curve s2 --force "B*u2, -B*u1" --set R=1,B=2 --t 6
    """
    space = open_space(source)
    written: list[Path] = []
    with bar(space.name) as show:
        pair = solve_pair(
            space,
            **start_options(
                start, velocity, frame_velocity, t, parameters, moments, force, potential
            ),
            accuracy=accuracy,
            engine=engine_of(engine),
            samples=samples,
            progress=show,
        )
    if output is not None:
        with working(space.name) as progress:
            written = write_curves(pair, output, pictures.value, progress)
    is_text = form is Form.text
    if is_text:
        typer.echo("\n".join(_summary(pair)))
    proofs = {}
    for name, solution in pair.curves.items() if proved else ():
        with working(f"{space.name}: proof of the {name}"):
            proof = prove(solution)
        proofs[name] = proof.to_json()
        if is_text:
            typer.echo(f"{name}, {proof}")
    if not is_text:
        document = metadata(pair) | ({"proofs": proofs} if proved else {})
        typer.echo(json.dumps(document, indent=2, ensure_ascii=False))
    say_files(written, form, drawn=output is None or can_draw())
    for name, reason in pair.stops.items():
        typer.echo(f"geomtorsion: {name}: {reason}", err=True)
    if pair.stops:
        raise typer.Exit(ExitCode.failed)


def _summary(pair: Pair) -> list[str]:
    """Start, table, errors and distance of a pair, line by line."""
    title = f"{pair.space.name}: {pair.space.title}" if pair.space.title else pair.space.name
    starts = start_lines(pair.problem, pair.chosen, float(pair.times[-1]))
    lines = [title, *starts, "", *_table(pair), ""]
    for name, solution in pair.curves.items():
        drift = max(solution.drift.values(), default=None)
        invariants = "" if drift is None else f", invariants drift by {size_text(drift)}"
        lines.append(
            f"{name}: {solution.problem.law.text}; {solution.engine}, error below "
            f"{size_text(solution.error)} (requested {solution.accuracy:.1e}){invariants}"
        )
    largest = float(pair.distance.max())
    if pair.coincide:
        lines.append(f"both curves agree: their distance is at most {size_text(largest)}")
    else:
        lines.append(f"distance {float(pair.distance[-1]):.6g} at the end, {largest:.6g} at most")
    if pair.chart != pair.problem.atlas.home:
        lines.append(f"coordinates refer to chart {pair.chart}: the motion leaves the first chart")
    return lines


def _table(pair: Pair) -> list[str]:
    """Some rows: t, coordinates of both curves side by side or below each other, distance."""
    rows = some_rows(len(pair.distance))
    if len(pair.symbols) <= SIDE_BY_SIDE:
        return _block(pair, rows, list(pair.curves))
    one, two = pair.curves
    return [*_block(pair, rows, [one]), "", *_block(pair, rows, [two])]


def _block(pair: Pair, rows: list[int], curves: list[str]) -> list[str]:
    """Rows of a table, with a heading for each curve."""
    names = [symbol.name.rstrip("_") for symbol in pair.symbols]
    heads = "  ".join(name.center(WIDTH * len(names)) for name in curves)
    # The curve parameter needs another name if a coordinate is called t.
    parameter = "parameter" if "t" in names else "t"
    second = right_aligned(names, WIDTH)
    lines = [
        f"{'':>10}{heads}".rstrip(),
        f"{parameter:>10}{'  '.join([second] * len(curves))}  {'distance':>10}",
    ]
    # A solution's error is relative to the largest value of a coordinate.
    errors = {
        name: pair.curves[name].error
        * np.abs(np.asarray(pair.coordinates[name], float)).max(axis=0)
        for name in curves
    }
    for k in rows:
        cells = [
            right_aligned(
                (
                    number_text(float(x), error, DIGITS)
                    for x, error in zip(pair.coordinates[name][k], errors[name], strict=True)
                ),
                WIDTH,
            )
            for name in curves
        ]
        lines.append(f"{pair.times[k]:>10.5g}{'  '.join(cells)}  {pair.distance[k]:>10.3g}")
    return lines
