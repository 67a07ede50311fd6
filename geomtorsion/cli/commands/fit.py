"""fit: parameters of a space and the start of a motion from recorded data."""

from __future__ import annotations

import csv
import io
import json
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from geomtorsion.cli.options import (
    EngineName,
    Force,
    Form,
    FrameVelocity,
    Moments,
    Parameters,
    PictureFormat,
    Pictures,
    Potential,
    Shown,
    SpaceOrFile,
    Start,
    Velocity,
    directory,
    option,
    say_files,
)
from geomtorsion.cli.sources import open_space
from geomtorsion.cli.terminal import working
from geomtorsion.cli.values import (
    engine_of,
    named_numbers,
    number,
    parts,
    start_lines,
    start_options,
)
from geomtorsion.errors import FileFormatError, StartError
from geomtorsion.fits import NOISE, Fit
from geomtorsion.fits import fit as fitted
from geomtorsion.pictures.style import can_draw, save
from geomtorsion.spaces import pair_problems
from geomtorsion.support.checks import cut, shown
from geomtorsion.support.files import read_text, write_texts
from geomtorsion.support.outgoing import csv_cell
from geomtorsion.support.text_rows import lines_of, number_table


class Curve(StrEnum):
    """The motion that is fitted."""

    geodesic = "geodesic"
    autoparallel = "autoparallel"


class LossName(StrEnum):
    """How residuals count."""

    linear = "linear"
    soft_l1 = "soft_l1"
    huber = "huber"
    cauchy = "cauchy"


def fit(
    source: SpaceOrFile,
    data: Annotated[
        Path,
        typer.Argument(metavar="DATA.csv", help="First column: the curve parameter; then data."),
    ],
    free: Annotated[
        str,
        typer.Option(
            metavar="NAME,...", help="What to fit: parameters, coordinates and velocities at t = 0."
        ),
    ],
    sigma: Annotated[
        str | None,
        option(
            metavar="X|NAME=X,...",
            text="Standard deviation of the noise; default: columns sigma_NAME of the file.",
        ),
    ] = None,
    curve: Annotated[
        Curve, typer.Option(help="The motion that the data belong to.")
    ] = Curve.geodesic,
    start: Start = None,
    velocity: Velocity = None,
    frame_velocity: FrameVelocity = None,
    parameters: Parameters = None,
    moments: Moments = None,
    force: Force = None,
    potential: Potential = None,
    bounds: Annotated[
        list[str] | None,
        option(
            metavar="NAME=LOW:HIGH,...",
            text="Bounds of free numbers; an empty side is none. May be repeated.",
        ),
    ] = None,
    loss: Annotated[
        LossName,
        typer.Option(help="How residuals count; all but linear give single outliers less weight."),
    ] = LossName.linear,
    accuracy: Annotated[
        float, typer.Option(metavar="X", help="Largest relative error of each solve.")
    ] = 1e-10,
    engine: EngineName = "auto",
    output: Annotated[
        Path | None, directory("Write fit.json, residuals.csv and a figure to this directory.")
    ] = None,
    pictures: Pictures = PictureFormat.png,
    form: Shown = Form.text,
) -> None:
    """Fit parameters and the start of a motion to recorded data.

    Start and parameters are the first guess. The columns of the file are named as coordinates or
    frame velocities; an empty field is a missing number.

    \b
    Examples:
      geomtorsion fit kerr orbit.csv --free M,a,r --sigma r=1e-3,phi=1e-4 --set M=1,a=0.5 \\
        --start 0,10,1.2,0 --velocity 1.2,0,0.012,0.034
      geomtorsion fit s2 track.csv --free "theta,phi'" --start 1,0 --velocity 0,1 -o fit
    """
    space = open_space(source)
    times, values = read_table(data)
    noise: dict[str, float] | None = None
    if sigma is not None:
        values = {k: x for k, x in values.items() if not k.startswith(NOISE)}
        noise = _noise(sigma, list(values))
    with working(space.name):
        options = start_options(
            start, velocity, frame_velocity, None, parameters, moments, force, potential
        )
        problems, chosen, _ = pair_problems(space, **options)
        problem = problems[curve.value]
        names = [name.strip() for name in free.split(",")]
        result = fitted(
            problem, times, values, noise, names, bounds=_bounds(bounds), loss=loss.value,
            accuracy=accuracy, engine=engine_of(engine),
        )  # fmt: skip
    if form is Form.json:
        typer.echo(json.dumps(result.to_json(), indent=2))
    else:
        typer.echo("\n".join(["first guess", *start_lines(problem, chosen), "", str(result)]))
    if output is not None:
        written = _write(result, output)
        if can_draw():
            written.append(output / f"fit.{pictures.value}")
            save(result.plot(), written[-1])
        say_files(written, form, drawn=can_draw())


def _bounds(texts: list[str] | None) -> dict[str, tuple[float | None, float | None]] | None:
    """Bounds of each name, from NAME=LOW:HIGH."""
    table: dict[str, tuple[float | None, float | None]] = {}
    for part in parts(",".join(texts or ())):
        name, _, pair = part.partition("=")
        low, colon, high = pair.partition(":")
        if not colon:
            raise StartError(
                f"bounds: expected NAME=LOW:HIGH, got {shown(part)}. Write M=0:2, or M=0: for a "
                "lower bound only."
            )
        what = f"bound of {name.strip()}"
        sides = [number(side, what) if side.strip() else None for side in (low, high)]
        table[name.strip()] = (sides[0], sides[1])
    return table or None


def read_table(path: Path) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Times, and all other columns by name, from a table with a header.

    Raises
    ------
    FileFormatError
        The header has fewer than two names or a name twice, or a row is damaged.
    """
    lines = [(k, line) for k, line in enumerate(lines_of(read_text(path)), 1) if line.strip()]
    lines = [(k, line) for k, line in lines if not line.startswith("#")]
    header = [name.strip().strip('"') for name in lines[0][1].split(",")] if lines else []
    if len(header) < 2 or len(set(header)) < len(header) or len(lines) < 2:
        raise FileFormatError(
            f"{path}: expected a header such as t,r,phi and rows of numbers, got "
            f"{shown(cut(','.join(header), 80))}. Name each column once."
        )
    numbers, rows = zip(*lines[1:], strict=True)
    table, _ = number_table(path, numbers, rows, len(header), split=",")
    if not np.isfinite(table[:, 0]).all():
        raise FileFormatError(
            f"{path}: column {header[0]}: expected a number in each row, got an empty field. "
            "Delete the row."
        )
    return table[:, 0], dict(zip(header[1:], table[:, 1:].T, strict=True))


def _noise(text: str, names: list[str]) -> dict[str, float]:
    """The noise of each column, from one number or a number for each name."""
    if "=" in text:
        return named_numbers([text])
    return dict.fromkeys(names, number(text, "sigma"))


def _write(result: Fit, folder: Path) -> list[Path]:
    """Values with their covariance as JSON, and data with residuals as a table."""
    table: dict[str, np.ndarray] = {"t": result.data.at}
    for name, values in result.data.values.items():
        table |= {name: values, f"sigma_{name}": result.data.sigma[name]}
        table[f"residual_{name}"] = result.residuals[name]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(map(csv_cell, table))
    rows = np.stack(list(table.values()), axis=1).tolist()
    writer.writerows([["" if x != x else repr(x) for x in row] for row in rows])
    facts = json.dumps(result.to_json(), indent=2) + "\n"
    return list(write_texts(folder, {"fit.json": facts, "residuals.csv": text.getvalue()}))
