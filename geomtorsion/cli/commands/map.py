"""map: |b| per area of a measured field at every position, with the effect of noise on it."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from geomtorsion.cli.exits import ExitCode, resumable
from geomtorsion.cli.loop_sources import typed_loop
from geomtorsion.cli.measured_sources import Reading, dashed, identity_frame, opened, sigma_of
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
    PictureFormat,
    Pictures,
    Shown,
    Workers,
    directory,
    option,
)
from geomtorsion.cli.results import (
    burgers_of,
    explain,
    refused_of,
    say_on_error,
    survey_lines,
    write_survey,
)
from geomtorsion.cli.terminal import working, wrapped
from geomtorsion.errors import CheckpointError, GridError, ImageError, OrientationError
from geomtorsion.materials.fields.blocked_fields import BlockedSurvey, map_in_blocks
from geomtorsion.materials.fields.blocked_map import run_in
from geomtorsion.materials.fields.contents import module
from geomtorsion.materials.readers import is_array, open_in_blocks
from geomtorsion.pictures.measured import draw_circuits, draw_survey
from geomtorsion.pictures.style import can_draw, save
from geomtorsion.support.checks import count, shown
from geomtorsion.support.files import plain_float, write_text
from geomtorsion.support.progress import bar


def map(
    source: MeasuredFile,
    size: Annotated[
        int, typer.Option(metavar="CELLS", help="Cells along the side of each square circuit.")
    ] = 8,
    plane: Annotated[
        str | None,
        option(
            metavar="X,Y", text="Two axes of a grid with more than two; default: the first two."
        ),
    ] = None,
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
    circle: Annotated[
        list[str] | None,
        option(metavar="X,Y:RADIUS", text="Compute also the b of a circle: 20,30:8"),
    ] = None,
    blocks: Annotated[
        int | None,
        option(
            metavar="N", text="Grids: compute blocks of N x N positions, saved in DIR/map.zarr."
        ),
    ] = None,
    steps: Annotated[
        str | None, option(metavar="DX,DY", text="Fields in .npy and .zarr: steps along the axes.")
    ] = None,
    unit: Annotated[
        str, typer.Option(metavar="UNIT", help="Fields in .npy and .zarr: unit of the axes.")
    ] = "",
    workers: Workers = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Resume the map in blocks that was stopped in DIR.")
    ] = False,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Discard a map that was stopped in DIR.")
    ] = False,
    output: Annotated[
        Path | None, directory("Write map.csv, map.npz, map.json and a picture there.")
    ] = None,
    pictures: Pictures = PictureFormat.png,
    form: Shown = Form.text,
) -> None:
    """Map the Burgers vector per area of a measured field, and compare it with noise.

    FILE holds a grid (coframe or distortion: .npz, .nc, .csv, .h5, .vtk, .vtu), an orientation map
    (.ctf, .ang, .h5) or an image of a lattice (.png, .tif, .npy). A square circuit of the given
    size is computed at every position.

    A field in an array (.npy of shape (rows, columns, grid...), .zarr) may be larger than memory:
    its map is computed in blocks, and written to map.zarr in DIR with map.json and a picture. If
    the command is stopped or killed, the finished blocks stay there, and --resume computes the
    others to the same result, bit for bit.

    \b
    Examples:
      geomtorsion map wafer.ctf --size 8 -o wafer-map
      geomtorsion map steel.ang --size 4 --threshold 3 -o steel-map
      geomtorsion map distortion.npz --size 2 --sigma 0.001
      geomtorsion map lattice.tif --pixel 0.032nm --size 40 -o image-map
      geomtorsion map field.zarr --steps 0.5,0.5 --unit um --workers 2 -o field-map
    """
    reading = Reading(
        sigma=sigma,
        threshold=threshold,
        order=order,
        laue=tuple(laue or ()),
        slip=slip,
        pixel=pixel,
        spots=spots,
        resolution=resolution,
        missing=missing or (),
        columns=columns,
        slice=slice,
    )
    path = Path(source)
    layout = Blocks(blocks, steps, unit, workers, resume, overwrite)
    if blocks is not None or resume or is_array(path):
        _in_blocks(path, reading, layout, size, plane, output, pictures, form, circle=circle)
        return
    layout.refuse()
    with bar(f"{path.name}: reading", 2) as show:
        field = opened(source, reading)
        if show is not None:
            show(1, f"{path.name}: circuits of {size} x {size} cells")
        try:
            survey = field.burgers_map(size, _plane(plane, tuple(field.names)))
        except (GridError, OrientationError, ImageError) as error:
            raise dashed(error) from None
        description = field.description
    frame = identity_frame(field.names)
    loops = [typed_loop(frame, "circle", text) for text in circle or []]
    results, vectors, _ = burgers_of(field, loops, raises=False)
    document = {"about": list(description), **survey.summary(), "circles": results}
    if form is Form.json:
        typer.echo(json.dumps(document, indent=2))
    else:
        typer.echo("\n".join(wrapped(line) for line in (*description, *survey_lines(survey))))
        for result in results:
            explain(result)
    if output is not None:
        written = write_survey(survey, document, output, pictures.value)
        if loops and can_draw():
            written.append(output / f"circuits.{pictures.value}")
            drawn = draw_circuits(field, vectors, refused_of(loops, results))
            save(drawn, written[-1])
        say_on_error(written)
    if len(vectors) < len(loops):
        raise typer.Exit(ExitCode.failed)


@dataclass(frozen=True)
class Blocks:
    """Options of maps in blocks, as they are typed."""

    block: int | None
    steps: str | None
    unit: str
    workers: int | None
    resume: bool
    overwrite: bool

    def refuse(self) -> None:
        """Refuse options that a map without blocks does not have."""
        options = {"--steps": self.steps, "--unit": self.unit or None, "--workers": self.workers}
        options["--overwrite"] = self.overwrite or None
        for name, value in options.items():
            if value is not None:
                raise GridError(
                    f"{name}: expected a map in blocks, got one without. Omit it, or give --blocks."
                )


def _in_blocks(
    path: Path,
    reading: Reading,
    wanted: Blocks,
    size: int,
    plane: str | None,
    output: Path | None,
    pictures: PictureFormat,
    form: Form,
    *,
    circle: list[str] | None,
) -> None:
    """A map that is saved block by block."""
    others = {k: v for k, v in reading.given.items() if k not in ("--sigma", "--order")}
    for name in [*others, *(["--circle"] if circle else [])]:
        raise GridError(f"{name} does not work for a map in blocks. Omit {name}.")
    if output is None:
        raise CheckpointError(
            f"{path.name}: expected a directory for the blocks, got none. Name it with -o."
        )
    place = output / "map.zarr"

    def left() -> str:
        begun = run_in(place) is not None
        return f"; finished blocks are in {place}; resume with --resume" if begun else ""

    try:
        with resumable(left):
            steps = None if wanted.steps is None else _numbers(wanted.steps)
            sigma = None if reading.sigma is None else sigma_of(reading.sigma)
            with working(path.name):
                field = open_in_blocks(
                    path, steps=steps, unit=wanted.unit, sigma=sigma, order=reading.order
                )
            # One worker is this thread itself.
            number = count(1 if wanted.workers is None else wanted.workers, "workers", GridError, 1)
            kind = "threads" if number > 1 else "synchronous"
            with module("dask", path).config.set(scheduler=kind, num_workers=number):
                survey = map_in_blocks(
                    field, place, wanted.block, size, _plane(plane, field.names),
                    resume=wanted.resume, overwrite=wanted.overwrite,
                )  # fmt: skip
            with working("writing") as progress:
                progress("summary and picture")
                numbers, lines, written = _report(survey, pictures.value)
    except (GridError, OrientationError, ImageError) as error:
        raise dashed(error) from None
    if form is Form.json:
        typer.echo(json.dumps(numbers, indent=2))
    else:
        typer.echo("\n".join(wrapped(line) for line in lines))
    say_on_error(written)


def _report(found: BlockedSurvey, form: str) -> tuple[dict[str, Any], list[str], list[Path]]:
    """Write map.json and a picture beside the map; return numbers, their words, and the files."""
    survey, numbers = found.survey()
    description = found.field.description
    document = {"about": list(description), **numbers, "circles": []}
    place = Path(found.result.path)
    written = [place, place.with_suffix(".json")]
    write_text(written[1], json.dumps(document, indent=2) + "\n")
    if can_draw():
        written.append(place.with_suffix(f".{form}"))
        save(draw_survey(survey), written[-1])
    return document, [*description, *survey_lines(survey, numbers)], written


def _numbers(text: str) -> list[float]:
    """Numbers with commas between them."""
    try:
        return [plain_float(x) for x in text.split(",")]
    except ValueError:
        raise GridError(f"steps: expected numbers such as 0.5,0.5, got {shown(text)}.") from None


def _plane(text: str | None, names: tuple[str, ...]) -> tuple[int, int]:
    """Numbers of the two axes that were named."""
    if text is None:
        return 0, 1
    axes = [part.strip() for part in text.split(",")]
    if len(axes) != 2 or axes[0] == axes[1] or not set(axes) <= set(names):
        raise GridError(
            f"plane: expected two of the axes {', '.join(names)}, got {shown(text)}. "
            f"Write --plane {names[0]},{names[1]}."
        )
    return names.index(axes[0]), names.index(axes[1])
