"""circuit: Burgers vectors of circuits through measured data, with their errors."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from geomtorsion.cli.loop_sources import LoopFiles, files_of_loops, named_loop
from geomtorsion.cli.measured_sources import Reading, identity_frame, opened
from geomtorsion.cli.options import (
    Form,
    MeasuredColumns,
    MeasuredFile,
    MeasuredLaue,
    MeasuredMissing,
    MeasuredOrder,
    MeasuredPixel,
    MeasuredResolution,
    MeasuredSigma,
    MeasuredSlice,
    MeasuredSlip,
    MeasuredSpots,
    MeasuredThreshold,
    Shown,
    directory,
    option,
)
from geomtorsion.cli.results import show_burgers
from geomtorsion.cli.terminal import working
from geomtorsion.errors import LoopError
from geomtorsion.loops import Loop


def circuit(
    source: MeasuredFile,
    loop: Annotated[
        list[str],
        option(
            metavar="'KIND TEXT'",
            text="A loop of any kind: 'circle 20,30:8', 'ellipse CENTRE:A,B', 'plaquette "
            "CORNER:STEPS', 'polygon POINT;POINT;...', 'spline POINT;...', 'curve EXPR;EXPR' in s.",
        ),
    ] = [],
    loops: LoopFiles = [],
    sigma: MeasuredSigma = None,
    threshold: MeasuredThreshold = None,
    order: MeasuredOrder = None,
    missing: MeasuredMissing = None,
    columns: MeasuredColumns = None,
    slice: MeasuredSlice = None,
    laue: MeasuredLaue = None,
    slip: MeasuredSlip = None,
    pixel: MeasuredPixel = None,
    spots: MeasuredSpots = None,
    resolution: MeasuredResolution = None,
    proved: Annotated[
        bool,
        typer.Option("--proved", help="Grids: prove the integral of the interpolant."),
    ] = False,
    form: Shown = Form.text,
    output: Annotated[
        Path | None,
        directory("Directory for burgers.json and circuits.png, created if missing."),
    ] = None,
) -> None:
    """Compute the Burgers vectors of circuits through measured data.

    FILE holds a grid (coframe or distortion), an orientation map or an image of a lattice. A
    circuit follows the nodes or pixels of the data along a loop in their coordinates. If one of
    several circuits fails, its entry reports the error, and the command ends with 1.

    `geomtorsion map` computes a circuit at every position, `geomtorsion network FILE --circle`
    circuits around the lines of a simulation, and `geomtorsion burgers` loops in a space given by
    formulas.

    \b
    Examples:
      geomtorsion circuit map.ctf --loop "circle 20,30:8" -o out
      geomtorsion circuit lattice.tif --pixel 0.032nm --loop "circle 4,4:2.5"
      geomtorsion circuit distortion.npz --loop "circle 0,0:1" --proved
      geomtorsion circuit distortion.npz --sigma 0.001 --loops loops.json --format json
    """
    reading = Reading(
        sigma,
        threshold,
        order,
        tuple(laue or ()),
        slip,
        pixel,
        spots,
        resolution,
        missing or (),
        columns,
        slice,
    )
    with working(Path(source).name):
        field = opened(source, reading)
    frame = identity_frame(field.names)
    circuits: list[Loop] = []
    for path, read in files_of_loops(frame, loops):
        for key, value in (("parameters", read.parameters), ("accuracy", read.accuracy)):
            if value:
                raise LoopError(
                    f"--loops {path}: {key}: expected loops only, because the data determine the "
                    f"error, got {key}. Remove it from the file."
                )
        circuits += read.loops
    circuits += (named_loop(frame, text) for text in loop)
    if not circuits:
        raise typer.BadParameter(
            "expected a circuit, got none. Use --loop 'circle 20,30:8' or --loops FILE."
        )
    show_burgers(field, circuits, output, plain=form is Form.json, proved=proved)
