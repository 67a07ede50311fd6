"""scene source: the scene that SCENE.toml|NAME on the command line means, with what is changed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from geomtorsion.cli.numbers import number
from geomtorsion.errors import StartError, UnknownNameError

if TYPE_CHECKING:
    from geomtorsion.scenes import Scene
    from geomtorsion.spaces.space import Space

SceneOrFile = Annotated[
    str,
    typer.Argument(
        metavar="SCENE.toml|NAME",
        show_default=False,
        help="A scene file, or a shipped scene (see `geomtorsion scenes`).",
    ),
]
Watch = Annotated[
    str | None,
    typer.Option(metavar="NAME,...", show_default=False, help="Watch these quantities instead."),
]
Asked = Annotated[
    float | None,
    typer.Option(
        "--accuracy", metavar="X", show_default=False, help="Largest error, relative, instead."
    ),
]
LastTime = Annotated[
    str | None,
    typer.Option("--t", metavar="T", show_default=False, help='Last time instead: 20 or "3 min".'),
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="PATH=X",
        show_default=False,
        help="Another value: body.moments[2]=3.1, gravity.g=1.62; may be given several times.",
    ),
]


def is_scene(source: str) -> bool:
    """Whether a source is a scene rather than a space: a shipped one, or a file with a body."""
    from geomtorsion.errors import GeomtorsionError
    from geomtorsion.files import read_toml
    from geomtorsion.scenes import names

    path = Path(source)
    if path.suffix != ".toml" or not path.exists():
        return source in names()
    try:
        data = read_toml(path).data
    except GeomtorsionError:
        return False
    return "body" in data or "effects" in data


def space_beside_scenes(source: str) -> Space:
    """The space of this name or file; where there is none, the error names a near scene too."""
    from geomtorsion.cli.source import open_space
    from geomtorsion.exact.names import near_names
    from geomtorsion.scenes import names

    try:
        return open_space(source)
    except UnknownNameError as error:
        near = near_names(source, names())
        hint = f" Did you mean the scene {near}?" if near else ""
        raise UnknownNameError(f"{error}{hint}") from None


def open_scene(
    source: str,
    watch: str | None = None,
    accuracy: float | None = None,
    t: str | None = None,
    settings: list[str] | None = None,
) -> Scene:
    """The shipped scene of this name, or the scene in this file, with what is to be different."""
    from geomtorsion.scenes import load, names, read_file
    from geomtorsion.scenes.units import quantity

    path = Path(source)
    if source in names():
        scene = load(source)
    elif path.suffix == ".toml" or path.exists() or path.name != source:
        scene = read_file(path)
    else:
        try:
            scene = load(source)
        except UnknownNameError as error:
            raise UnknownNameError(f"{error} There is no file of this name either.") from None
    changes: dict[str, Any] = {}
    if watch is not None:
        changes["watch"] = tuple(name.strip() for name in watch.split(",") if name.strip())
    if accuracy is not None:
        changes["accuracy"] = accuracy
    if t is not None:
        changes["t"] = quantity(t, "s")
    changes |= dict(_setting(text) for text in settings or ())
    return scene.with_values(changes) if changes else scene


def _setting(text: str) -> tuple[str, float]:
    """One path=number."""
    path, sign, value = text.partition("=")
    if not sign or not path.strip():
        raise StartError(f"--set: path=number was needed, {text!r} came: body.moments[2]=3.1.")
    return path.strip(), number(value, path.strip())
