"""shadow: the shadow of a black hole in the light that reaches a camera."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from geomtorsion.cli.options import Form, Parameters, Shown, SpaceOrFile, directory, option
from geomtorsion.cli.results import say_on_error, show_result
from geomtorsion.cli.sources import open_space
from geomtorsion.cli.terminal import working
from geomtorsion.cli.values import named_numbers, numbers
from geomtorsion.curves import shadow as shadow_of
from geomtorsion.errors import StartError
from geomtorsion.pictures.shadow import draw_shadow
from geomtorsion.pictures.style import can_draw, save
from geomtorsion.support.files import make_folder, write_text


def shadow(
    source: SpaceOrFile,
    camera: Annotated[
        str | None,
        option("--camera", metavar="Q,...", text="Coordinates of the camera, such as 0,30,pi/2,0."),
    ] = None,
    parameters: Parameters = None,
    dark: Annotated[
        list[str] | None,
        option(
            "--dark",
            metavar="EXPR",
            text='A ray is captured where this falls through zero, such as "r - 2.001*M"; may be '
            "repeated. Default: near the edges of the domain.",
        ),
    ] = None,
    sky: Annotated[
        list[str] | None,
        option(
            "--sky",
            metavar="EXPR",
            text='A ray escapes where this falls through zero, such as "60 - r"; may be repeated.',
        ),
    ] = None,
    light: Annotated[str, typer.Option(metavar="NAME", help="geodesic or autoparallel.")] = (
        "geodesic"
    ),
    directions: Annotated[
        int, typer.Option(metavar="N", help="Directions in which the edge is found.")
    ] = 36,
    accuracy: Annotated[
        float, typer.Option(metavar="X", help="Largest error of the edge, in radians.")
    ] = 1e-7,
    pixels: Annotated[
        int, typer.Option(metavar="N", help="Pixels along each side of the image; 0: no image.")
    ] = 128,
    field: Annotated[
        float | None, option("--field", metavar="X", text="Width of the image, in radians.")
    ] = None,
    form: Shown = Form.text,
    output: Annotated[
        Path | None,
        directory("Directory for edge.csv, shadow.json, edge.png and image.png."),
    ] = None,
) -> None:
    """Compute the shadow of a black hole in the light that reaches a camera.

    The camera is at rest in the legs of the tetrad. Its rays are followed back until they are
    captured or escape. The first motion of the space supplies a missing camera and missing
    parameters. The image is computed only with -o.

    \b
    Examples:
      geomtorsion shadow kerr --set a=0.9 -o shadow
      geomtorsion shadow schwarzschild --camera 0,30,pi/2,0 --directions 4
      geomtorsion shadow wormhole.toml --camera 0,10,pi/2,0 --dark "l + 20" --sky "20 - l"
    """
    space = open_space(source)
    motion = space.motion
    if motion is None and camera is None:
        raise StartError(
            "camera: expected coordinates, got none, and the space has no first motion. Give "
            "--camera 0,30,pi/2,0, for example."
        )
    place = numbers(camera, "camera") or list(motion.start if motion is not None else ())
    chosen = {} if motion is None else dict(motion.parameters)
    with working(space.name):
        view = shadow_of(
            space, place, parameters=chosen | named_numbers(parameters or ()), dark=dark or None,
            sky=sky or None, light=light,
        )  # fmt: skip
        edge = view.edge(directions, accuracy)
        image = view.image(pixels, field) if output is not None and pixels else None
    where = dict(zip(view.rays.coordinates, map(float, place), strict=True))
    values = {name: float(x) for name, x in view.rays.parameters.items()}
    document = {"camera": where, "parameters": values, "dark": list(view.dark), **edge.to_json()}
    lines = [repr(view), repr(edge)] + ([] if image is None else [repr(image)])
    show_result(document, "\n".join(lines), form)
    if output is None:
        return
    make_folder(output)
    paths = [output / "edge.csv", output / "shadow.json"]
    edge.to_csv(paths[0])
    write_text(paths[1], json.dumps(document, indent=2) + "\n")
    for name, found in (("edge", edge), ("image", image)):
        if found is not None and can_draw():
            paths.append(output / f"{name}.png")
            save(draw_shadow(found), paths[-1])
    say_on_error(paths)
