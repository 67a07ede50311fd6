"""options: arguments and options that several commands share, each described once."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


def option(*names: str, metavar: str, text: str) -> object:
    """An option whose default is not shown: None, or nothing."""
    return typer.Option(*names, metavar=metavar, show_default=False, help=text)


def argument(metavar: str, text: str, known: Callable[[], Iterable[str]] | None = None) -> object:
    """An argument whose default is not shown; the shell completes the known names."""

    def completed(incomplete: str) -> list[str]:
        return [name for name in known() if name.startswith(incomplete)] if known else []

    return typer.Argument(
        metavar=metavar,
        show_default=False,
        help=text,
        autocompletion=completed if known else None,
    )


def _spaces() -> Iterable[str]:
    # Loaded when the shell asks: `--help` is faster without.
    from geomtorsion.spaces import names

    return names()


def _scenes() -> Iterable[str]:
    # As above.
    from geomtorsion.scenes import names

    return names()


def _exercises() -> Iterable[str]:
    # As above.
    from geomtorsion.teaching.exercises import names

    return names()


def directory(text: str) -> object:
    """The option -o DIR."""
    return option("-o", "--output", metavar="DIR", text=text)


class PictureFormat(StrEnum):
    """How pictures are written."""

    png = "png"
    svg = "svg"
    pdf = "pdf"


class Form(StrEnum):
    """How results are written."""

    text = "text"
    json = "json"


class Basis(StrEnum):
    """The basis to which indices refer."""

    natural = "natural"
    coordinate = "coordinate"
    frame = "frame"


class Keep(StrEnum):
    """The geometry that is compared."""

    metric = "metric"
    teleparallel = "teleparallel"
    legs = "legs"


KeepOption = Annotated[
    Keep,
    typer.Option(
        "--keep",
        help="metric: legs are free. teleparallel: they may differ by a constant rotation or "
        "reflection. legs: each leg onto the leg of the same number.",
    ),
]
BasisOption = Annotated[
    Basis,
    typer.Option("--basis", help="natural: each quantity in the basis in which it is defined."),
]


Language = Annotated[
    str,
    option(
        metavar="NAME|DIR", text="Language of the texts: en, de, or a folder of translated files."
    ),
]

ChapterFolder = Annotated[
    Path | None,
    option(
        "--chapter",
        metavar="FOLDER",
        text="A teacher's own exercises: a folder with chapter.toml; its chapter.py is run.",
    ),
]


# -- sources of a command -------------------------------------------------------------------------

SpaceOrFile = Annotated[
    str,
    argument(
        "SPACE|FILE",
        "A shipped space (see `geomtorsion spaces`), a tetrad file (TOML), or a line element or "
        "one-forms in quotes: 'dr^2 + r^2 dtheta^2', 'dr, r dtheta'.",
        _spaces,
    ),
]
SceneOrFile = Annotated[
    str,
    argument(
        "SCENE.toml|NAME",
        "A scene file, or a shipped scene (see `geomtorsion scenes`).",
        _scenes,
    ),
]
SpaceOrScene = Annotated[
    str,
    argument(
        "SPACE|SCENE|FILE",
        "A shipped space or scene, a tetrad file or a scene file.",
        lambda: (*_spaces(), *_scenes()),
    ),
]

Priced = Annotated[
    str,
    argument(
        "SPACE|SCENE|FILE",
        "A shipped space or scene, a file of either, or measured data (.npz, .csv, .ctf, ...).",
        lambda: (*_spaces(), *_scenes()),
    ),
]
MeasuredFile = Annotated[
    str,
    argument(
        "FILE",
        "A grid (.npz, .nc, .csv, .h5, .vtk), orientations (.ctf, .ang, .h5) or an image (.png, "
        ".tif, .npy).",
    ),
]

# -- settings of a measured field -----------------------------------------------------------------

MeasuredSigma = Annotated[
    str | None,
    option(
        "--sigma",
        metavar="X",
        text="Measured data: noise of each value (grids) or orientation (degrees), or `estimate`.",
    ),
]
MeasuredThreshold = Annotated[
    float | None,
    option(
        "--threshold",
        metavar="DEG",
        text="Orientation maps: pixels that differ by less are in one grain; default: 5.",
    ),
]
MeasuredLaue = Annotated[
    list[str] | None,
    option("--laue", metavar="PHASE=GROUP", text="Orientation maps: symmetry of a phase: 1=m-3m"),
]
MeasuredOrder = Annotated[
    int | None,
    option("--order", metavar="N", text="Grids: order of interpolation, 2, 4, 6 or 8; default: 4."),
]
MeasuredMissing = Annotated[
    list[float] | None,
    option("--missing", metavar="X", text="Grids: a value that means no data: --missing=-9999"),
]
MeasuredColumns = Annotated[
    str | None,
    option(
        "--columns",
        metavar="Q=COLUMN,...",
        text="Tables: name or number, from 0, of the column of a quantity: x=0,y=1,exx=strain_xx",
    ),
]
MeasuredSlice = Annotated[
    str | None,
    option("--slice", metavar="N", text="HDF5: number, from 0, or name of one of several maps."),
]

MeasuredSlip = Annotated[
    str | None,
    option(
        "--slip",
        metavar="NAME",
        text="Orientation maps: densities of slip systems: fcc, bcc, diamond or hcp.",
    ),
]
MeasuredPixel = Annotated[
    str | None,
    option(
        "--pixel",
        metavar="SIZE",
        text="Images: size of a pixel with its unit, if the file has none or a wrong one: 0.03nm",
    ),
]
MeasuredSpots = Annotated[
    str | None,
    option(
        "--spots",
        metavar="G;G",
        text="Images: two Bragg spots in cycles per unit, '4,0;0,4'; default: detected.",
    ),
]
MeasuredResolution = Annotated[
    float | None,
    option("--resolution", metavar="X", text="Images: length over which phases are averaged."),
]

# -- maps in blocks -------------------------------------------------------------------------------

Workers = Annotated[
    int | None,
    option("--workers", metavar="N", text="Threads that compute blocks; default: 1."),
]


# -- start of a curve -----------------------------------------------------------------------------

Start = Annotated[str | None, option(metavar="Q,...", text="Coordinates at t = 0: 0.3,pi/2")]
Velocity = Annotated[str | None, option(metavar="V,...", text="Coordinate velocities at t = 0.")]
FrameVelocity = Annotated[
    str | None, option(metavar="U,...", text="Instead of --velocity: velocities along the legs.")
]
LastTime = Annotated[
    str | None, option("--t", metavar="T", text="Last value of the curve parameter.")
]
Parameters = Annotated[
    list[str] | None,
    option(
        "--set",
        "--parameters",
        metavar="NAME=X,...",
        text="Values of the parameters of the frame and of forces; may be repeated.",
    ),
]
Moments = Annotated[
    str | None,
    option(
        metavar="I,...",
        text="Kinetic metric of the geodesic: a moment of inertia for each leg.",
    ),
]
Force = Annotated[
    str | None,
    option(
        metavar="F,...",
        text="Force along each leg, of coordinates, velocities u1, u2, ..., t and parameters: "
        '"-k*u1, -k*u2".',
    ),
]
Potential = Annotated[
    str | None,
    option(metavar="V", text='Potential of a force, of coordinates, t and parameters: "-1/r".'),
]

# -- changes to a scene ---------------------------------------------------------------------------

Watch = Annotated[
    list[str] | None,
    option(
        metavar="NAME,...",
        text="Watch these quantities instead of those in the scene; may be repeated.",
    ),
]
SceneAccuracy = Annotated[
    float | None,
    option(
        "--accuracy", metavar="X", text="Largest relative error, instead of the one in the scene."
    ),
]
SceneTime = Annotated[
    str | None,
    option("--t", metavar="T", text='Last time, instead of the one in the scene: 20 or "3 min".'),
]
Settings = Annotated[
    list[str] | None,
    option(
        "--set",
        metavar="PATH=X",
        text="Change a value: body.moments[2]=3.1, gravity.g=1.62; may be repeated.",
    ),
]

# -- solver and output of a scene -----------------------------------------------------------------

EngineName = Annotated[str, typer.Option(metavar="NAME", help="auto, taylor, rungekutta or stiff.")]
Pictures = Annotated[
    PictureFormat, typer.Option("--picture-format", help="Format of the pictures.")
]
Shown = Annotated[
    Form, typer.Option("--format", help="text to read, json for programs; --json for short.")
]

Proved = Annotated[
    bool,
    typer.Option("--proved", help="Prove the result and print its certain digits; takes longer."),
]

# -- exercises ------------------------------------------------------------------------------------

Number = Annotated[str, argument("NUMBER", "An exercise, such as 3.2.", _exercises)]
Seed = Annotated[
    int, typer.Option(metavar="N", help="Number of the variant; 0 has the values of the paper.")
]

# -- files ----------------------------------------------------------------------------------------

NO_PICTURES = "matplotlib is not installed. Run `pip install 'geomtorsion[plots]'`."


def say_files(paths: Iterable[Path], form: Form, *, drawn: bool) -> None:
    """One line for each file that was written; beside JSON on the stream of errors."""
    aside = form is Form.json
    for path in paths:
        typer.echo(f"wrote {path}", err=aside)
    if not drawn:
        typer.echo(f"No pictures: {NO_PICTURES}", err=aside)


def say_written(paths: Iterable[Path]) -> None:
    """One line for each file that was written."""
    for path in paths:
        typer.echo(f"wrote {path}")
