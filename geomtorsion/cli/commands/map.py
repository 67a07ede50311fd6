"""map: |b| per area of a measured field at every place, with what noise makes of it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from geomtorsion.checks import cut, shown
from geomtorsion.cli.commands.burgers import loop_data
from geomtorsion.cli.exits import ExitCode
from geomtorsion.cli.measured import (
    Reading,
    closures_of,
    dashed,
    explain,
    identity_frame,
    opened,
    say_on_error,
    survey_lines,
    write_survey,
)
from geomtorsion.cli.options import (
    MeasuredFile,
    MeasuredLaue,
    MeasuredOrder,
    MeasuredPixel,
    MeasuredResolution,
    MeasuredSigma,
    MeasuredSpots,
    MeasuredThreshold,
    PictureFormat,
    Pictures,
    directory,
    option,
)
from geomtorsion.cli.terminal import working, wrapped
from geomtorsion.errors import GridError, ImageError, OrientationError
from geomtorsion.loops.loop_files import loop_from_data
from geomtorsion.measured.writing import summary
from geomtorsion.pictures.measured import draw_circuits
from geomtorsion.pictures.style import can_draw, save


def map(
    source: MeasuredFile,
    size: Annotated[
        int, typer.Option(metavar="CELLS", help="Cells along the side of each square circuit.")
    ] = 8,
    plane: Annotated[
        str | None, option(metavar="X,Y", text="Two axes of a grid with more; default: the first.")
    ] = None,
    sigma: MeasuredSigma = None,
    threshold: MeasuredThreshold = None,
    order: MeasuredOrder = None,
    laue: MeasuredLaue = None,
    pixel: MeasuredPixel = None,
    spots: MeasuredSpots = None,
    resolution: MeasuredResolution = None,
    circle: Annotated[
        list[str] | None, option(metavar="X,Y:RADIUS", text="A circle in the map as well: 20,30:8")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Results as data on standard output.")
    ] = False,
    output: Annotated[
        Path | None, directory("Write map.csv, map.npz, map.json and a picture there.")
    ] = None,
    form: Pictures = PictureFormat.png,
) -> None:
    """Map |b| per area of a measured field, and whether it is more than noise.

    FILE holds a grid (coframe or distortion: .npz, .nc, .csv, .h5, .vtk, .vtu), an orientation map
    (.ctf, .ang, .h5) or a picture of a lattice (.png, .tif, .npy). Square circuits of one size are
    taken at every place.

    \b
    Examples:
      geomtorsion map wafer.ctf --size 8 -o wafer-map
      geomtorsion map steel.ang --size 4 --threshold 3 -o steel-map
      geomtorsion map distortion.npz --size 2 --sigma 0.001
      geomtorsion map lattice.tif --pixel 0.032nm --size 40 -o image-map
    """
    reading = Reading(sigma, threshold, order, tuple(laue or ()), pixel, spots, resolution)
    with working(Path(source).name) as progress:
        field = opened(source, reading)
        progress(f"circuits of {size} x {size} cells")
        try:
            survey = field.survey(size, _plane(plane, field.names))
        except (GridError, OrientationError, ImageError) as error:
            raise dashed(error) from None
        about = field.about
    frame = identity_frame(field.names)
    loops = [
        loop_from_data(frame, loop_data("circle", text, ""), f"--circle {cut(text)}")
        for text in circle or []
    ]
    results, found, _ = closures_of(field, loops, alone=False)
    document = {"about": list(about), **summary(survey), "circles": results}
    if as_json:
        typer.echo(json.dumps(document, indent=2))
    else:
        typer.echo("\n".join(wrapped(line) for line in (*about, *survey_lines(survey))))
        for result in results:
            explain(result)
    if output is not None:
        written = write_survey(survey, document, output, form.value)
        if found and can_draw():
            written.append(output / f"circuits.{form.value}")
            save(draw_circuits(field, found), written[-1])
        say_on_error(written)
    if len(found) < len(loops):
        raise typer.Exit(ExitCode.failed)


def _plane(text: str | None, names: tuple[str, ...]) -> tuple[int, int]:
    """Numbers of the two axes that were named."""
    if text is None:
        return 0, 1
    found = [part.strip() for part in text.split(",")]
    if len(found) != 2 or found[0] == found[1] or not set(found) <= set(names):
        raise GridError(
            f"plane: two of the axes {', '.join(names)} were needed, but {shown(text)} came. "
            f"Write --plane {names[0]},{names[1]}."
        )
    return names.index(found[0]), names.index(found[1])
