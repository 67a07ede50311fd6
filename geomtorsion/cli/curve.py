"""curve: the straightest and the shortest path from one start."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from geomtorsion.cli.numbers import engine_of, named_numbers, number, numbers
from geomtorsion.cli.progress import working
from geomtorsion.cli.source import SpaceOrFile, open_space

if TYPE_CHECKING:
    from geomtorsion.pictures.pair import Pair

STOPPED = 1
# Rows of the table that are shown in the terminal.
ROWS = 9
# Columns of one number, and how many coordinates are shown for both curves in one row.
WIDTH, SIDE_BY_SIDE = 11, 4


class PictureFormat(StrEnum):
    """How pictures are written."""

    png = "png"
    svg = "svg"
    pdf = "pdf"


Start = Annotated[
    str | None,
    typer.Option(
        metavar="Q,...", show_default=False, help="Coordinates at t = 0; pi/2 is a number too."
    ),
]
Velocity = Annotated[
    str | None,
    typer.Option(metavar="V,...", show_default=False, help="Coordinate velocities at t = 0."),
]
FrameVelocity = Annotated[
    str | None,
    typer.Option(
        metavar="U,...", show_default=False, help="Instead: velocities along the legs of the frame."
    ),
]
LastTime = Annotated[
    str | None,
    typer.Option("--t", metavar="T", show_default=False, help="Last value of the curve parameter."),
]
Parameters = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        "--parameters",
        metavar="NAME=X,...",
        show_default=False,
        help="Values of the parameters of the frame; may be given several times.",
    ),
]
Moments = Annotated[
    str | None,
    typer.Option(
        metavar="I,...",
        show_default=False,
        help="Kinetic metric of the geodesic: a moment of inertia for each leg.",
    ),
]


def curve(
    source: SpaceOrFile,
    start: Start = None,
    velocity: Velocity = None,
    frame_velocity: FrameVelocity = None,
    t: LastTime = None,
    parameters: Parameters = None,
    moments: Moments = None,
    accuracy: Annotated[
        float, typer.Option(metavar="X", help="Largest error of the result, relative to its size.")
    ] = 1e-10,
    samples: Annotated[int, typer.Option(metavar="N", help="Rows of the table.")] = 401,
    engine: Annotated[
        str, typer.Option(metavar="NAME", help="auto, taylor, rungekutta or stiff.")
    ] = "auto",
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="DIR",
            show_default=False,
            help="Write curve.csv, curve.json and pictures to this directory.",
        ),
    ] = None,
    form: Annotated[
        PictureFormat, typer.Option("--format", help="Format of the pictures.")
    ] = PictureFormat.png,
) -> None:
    """Follow the straightest and the shortest path from one start.

    The autoparallel of the space's connection (its own, or the Cartan connection of the frame) and
    the geodesic of its metric. What is not given is chosen, and said. Ends with 1 where a motion
    ran out of its chart before the last time; what was computed is shown and written all the same.

    \b
    Examples:
      geomtorsion curve s2 --start 1.9,0 --velocity=-0.2,1.06 --t 6 -o sphere
      geomtorsion curve so3 --moments 1,2,3 --t 20 --accuracy 1e-12
      geomtorsion curve my-tetrad.toml --set M=1 -o curves
    """
    from geomtorsion.pictures.album import can_draw, write_curves
    from geomtorsion.pictures.pair import follow

    space = open_space(source)
    written: list[Path] = []
    with working(space.name) as progress:
        progress("solving")
        pair = follow(
            space,
            numbers(start, "start"),
            numbers(velocity, "velocity"),
            frame_velocity=numbers(frame_velocity, "frame velocity"),
            t=None if t is None else number(t, "t"),
            parameters=named_numbers(*parameters or ()),
            moments=numbers(moments, "moments"),
            accuracy=accuracy,
            engine=engine_of(engine),
            samples=samples,
        )
        if output is not None:
            written = write_curves(pair, output, form.value, progress)
    typer.echo("\n".join(summary(pair)))
    for path in written:
        typer.echo(f"wrote {path}")
    if output is not None and not can_draw():
        typer.echo("No pictures: matplotlib is not installed. `pip install geomtorsion[plots]`.")
    for name, reason in pair.stops.items():
        typer.echo(f"geomtorsion: {name}: {reason}", err=True)
    if pair.stops:
        raise typer.Exit(STOPPED)


def summary(pair: Pair) -> list[str]:
    """Start, table, errors and distance of a pair, line by line."""
    from geomtorsion.pictures.quality import coincide

    problem = pair.problem
    lines = [*start_lines(pair), "", *_table(pair), ""]
    for name, solution in pair.curves.items():
        drift = max(solution.drift.values(), default=None)
        kept = "" if drift is None else f", invariants drift by {drift:.1e}"
        lines.append(
            f"{name}: {solution.problem.law.text}; {solution.engine}, error below "
            f"{solution.error:.1e} (asked {solution.accuracy:.1e}){kept}"
        )
    largest = float(pair.distance.max())
    if coincide(pair):
        lines.append(f"the two are one: never further apart than {largest:.1e}")
    else:
        lines.append(f"apart by {float(pair.distance[-1]):.6g} at the end, {largest:.6g} at most")
    if pair.chart != problem.atlas.home:
        lines.append(
            f"coordinates are those of chart {pair.chart}: the motion leaves the first one"
        )
    return lines


def start_lines(pair: Pair) -> list[str]:
    """Start, velocity, parameters and duration, with a word where they were chosen."""
    problem, names = pair.problem, pair.problem.coordinates
    facts = {
        "start": _pairs(names, [float(x) for x in problem.start or ()]),
        "velocity": _pairs([f"{name}'" for name in names], problem.velocity.tolist()),
        "parameters": _pairs(list(pair.parameters), list(pair.parameters.values())),
        "t": f"0 to {float(pair.times[-1]):g}",
    }
    lines = [f"{pair.space.name}: {pair.space.title}" if pair.space.title else pair.space.name]
    for key, text in facts.items():
        if text:
            lines.append(f"{key:<11}{text}{'  (chosen)' if key in pair.chosen else ''}")
    return lines


def _pairs(names: list[str] | tuple[str, ...], values: list[float]) -> str:
    return ", ".join(f"{name} = {value:.6g}" for name, value in zip(names, values, strict=True))


def _table(pair: Pair) -> list[str]:
    """Some rows: t, coordinates of both curves side by side or below each other, distance."""
    import numpy as np

    count = len(pair.distance)
    rows = np.unique(np.linspace(0, count - 1, min(ROWS, count)).round().astype(int)).tolist()
    if len(pair.symbols) <= SIDE_BY_SIDE:
        return _block(pair, rows, list(pair.curves))
    one, two = pair.curves
    return [*_block(pair, rows, [one]), "", *_block(pair, rows, [two])]


def _block(pair: Pair, rows: list[int], curves: list[str]) -> list[str]:
    """Rows of a table, with a heading for each curve."""
    names = [symbol.name.rstrip("_") for symbol in pair.symbols]
    heads = "  ".join(name.center(WIDTH * len(names)) for name in curves)
    clock = "parameter" if "t" in names else "t"
    second = "".join(name.rjust(WIDTH) for name in names)
    lines = [
        f"{'':>10}{heads}".rstrip(),
        f"{clock:>10}{'  '.join([second] * len(curves))}  {'distance':>10}",
    ]
    for k in rows:
        cells = ["".join(f"{x:>{WIDTH}.5g}" for x in pair.coordinates[name][k]) for name in curves]
        lines.append(f"{pair.times[k]:>10.5g}{'  '.join(cells)}  {pair.distance[k]:>10.3g}")
    return lines
