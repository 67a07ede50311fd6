"""run: a scene, solved, as table, arrays, pictures and a film."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from geomtorsion.cli.curve import PictureFormat
from geomtorsion.cli.guard import INTERRUPTED
from geomtorsion.cli.numbers import engine_of
from geomtorsion.cli.progress import bar, working
from geomtorsion.cli.scene_source import (
    Asked,
    LastTime,
    SceneOrFile,
    Settings,
    Watch,
    open_scene,
)
from geomtorsion.errors import CheckpointError, StuckError

if TYPE_CHECKING:
    from geomtorsion.motion import Engine
    from geomtorsion.scenes import Scene, SceneResult

CHECKPOINT, PARTIAL = "checkpoint.npz", "partial.csv"
# Rows and columns of the table that are shown in the terminal, and the width of one number.
ROWS, COLUMNS, WIDTH = 9, 7, 13


def run(
    source: SceneOrFile,
    watch: Watch = None,
    accuracy: Asked = None,
    engine: Annotated[
        str, typer.Option(metavar="NAME", help="auto, taylor, rungekutta or stiff.")
    ] = "auto",
    t: LastTime = None,
    settings: Settings = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="DIR",
            show_default=False,
            help="Write table.csv, result.npz, run.json, scene.toml and pictures there.",
        ),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with the run that was stopped in DIR.")
    ] = False,
    only_kept: Annotated[
        bool,
        typer.Option(
            "--kept", help="Go on with nothing: write what a stopped run has to DIR/partial.csv."
        ),
    ] = False,
    animate: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", show_default=False, help="Write a film, .gif or (with ffmpeg) .mp4."
        ),
    ] = None,
    form: Annotated[
        PictureFormat, typer.Option("--format", help="Format of the pictures.")
    ] = PictureFormat.png,
) -> None:
    """Run a scene: a body, what acts on it, what is watched.

    With -o the run is kept in DIR/checkpoint.npz as it goes: stopped by Ctrl-C or killed, it goes
    on with --resume from there, to the same result bit by bit; --kept writes what there is. Ends
    with 1 where the motion could not be followed to its end; what was computed is shown and
    written all the same.

    \b
    Examples:
      geomtorsion run dzhanibekov -o flip
      geomtorsion run lagrange_loop --watch nutation --accuracy 1e-12 --set gravity.g=1.62
      geomtorsion run my-top.toml -o my-top --animate my-top/film.gif
    """
    from geomtorsion.scenes.saving import write_run

    scene = open_scene(source, watch, accuracy, t, settings)
    solver = engine_of(engine)
    checkpoint = _checkpoint(output, resume or only_kept)
    if only_kept and checkpoint is not None:
        typer.echo(_partial(scene, checkpoint, solver))
        return
    with bar(scene.title or scene.name) as progress:
        try:
            result = scene.run(solver, checkpoint, progress)
        except KeyboardInterrupt:
            typer.echo(f"geomtorsion: stopped{_left(scene, checkpoint, solver)}", err=True)
            raise typer.Exit(INTERRUPTED) from None
        except StuckError as stuck:
            if checkpoint is not None:
                checkpoint.unlink(missing_ok=True)
            if stuck.solution is None or not len(stuck.solution.times):
                raise
            result = stuck.solution
            typer.echo(f"geomtorsion: {str(stuck).partition(' What was computed')[0]}", err=True)
    written: list[Path] = []
    with working(scene.title or scene.name) as say:
        if output is not None:
            written = write_run(result, output, form.value, say)
        if animate is not None:
            say("drawing the film")
            written.append(film(scene, result, animate))
    if checkpoint is not None:
        checkpoint.unlink(missing_ok=True)
        checkpoint.with_name(PARTIAL).unlink(missing_ok=True)
    typer.echo("\n".join(summary(result)))
    for path in written:
        typer.echo(f"wrote {path}")
    _about_pictures(output)
    if not result.complete:
        raise typer.Exit(1)


def _about_pictures(output: Path | None) -> None:
    """Say why there are none."""
    from geomtorsion.pictures.album import can_draw

    if output is not None and not can_draw():
        typer.echo("No pictures: matplotlib is not installed. `pip install geomtorsion[plots]`.")


def _checkpoint(output: Path | None, resume: bool) -> Path | None:
    """The file in which the run is kept; refuse to run over one that was not finished."""
    if output is None:
        if resume:
            raise CheckpointError(
                "--resume and --kept are about the run in a directory: name it with -o."
            )
        return None
    path = output / CHECKPOINT
    if path.exists() and not resume:
        raise CheckpointError(
            f"{output} holds a run that was stopped. Give --resume to go on with it, or remove "
            f"{path} to begin anew."
        )
    output.mkdir(parents=True, exist_ok=True)
    return path


def _left(scene: Scene, checkpoint: Path | None, engine: Engine | None) -> str:
    """After Ctrl-C: what is there, and how to go on."""
    if checkpoint is None or not checkpoint.exists():
        return ""
    try:
        said = _partial(scene, checkpoint, engine)
    except CheckpointError:
        return ""
    return f"; {said}; go on with --resume"


def _partial(scene: Scene, checkpoint: Path, engine: Engine | None) -> str:
    """Write what a stopped run had computed, and say so."""
    from geomtorsion.scenes.checkpoint import partial_result
    from geomtorsion.scenes.table import write_csv

    part = partial_result(scene, checkpoint, engine)
    path = checkpoint.with_name(PARTIAL)
    write_csv(path, part.columns())
    reached = float(part.times[-1]) if len(part.times) else 0.0
    return f"what was computed, to t = {reached:.6g} s, is in {path}"


def film(
    scene: Scene,
    result: SceneResult,
    path: Path,
    progress: Callable[[float], object] = lambda _: None,
) -> Path:
    """Write a film of a scene; the attitude is followed for it if it was not watched."""
    import numpy as np

    from geomtorsion.pictures.scene_film import block_sides, write_film

    names = [name for name in ("matrix", "position") if name in result.values]
    if "matrix" not in names:
        more = ("matrix", *names)
        result = scene.with_values(watch=more, accuracy=max(scene.accuracy, 1e-8)).run()
        names = list(more)
    times = np.linspace(float(result.times[0]), float(result.times[-1]), 401)
    found = result.at(times)
    moments = np.linalg.eigvalsh(scene.body.tensor)
    if scene.body.moments is not None:
        moments = np.array([float(x) for x in scene.body.moments])
    path.parent.mkdir(parents=True, exist_ok=True)
    write_film(
        path,
        times,
        found["matrix"].reshape(-1, 3, 3),
        found["position"] if "position" in names else None,
        block_sides(moments),
        title=scene.title or scene.name,
        progress=progress,
    )
    return path


def summary(result: SceneResult) -> list[str]:
    """What was solved, some rows of the table, and how good they are."""
    import numpy as np

    table = result.columns()
    shown = list(table)[:COLUMNS]
    count = len(result.times)
    rows = np.unique(np.linspace(0, count - 1, min(ROWS, count)).round().astype(int)).tolist()
    heading, *facts = str(result).splitlines()
    width = max(WIDTH, *(len(name) + 2 for name in shown))
    lines = [heading, "", "".join(name.rjust(width) for name in shown)]
    lines += ["".join(f"{table[name][k]:>{width}.6g}" for name in shown) for k in rows]
    rest = len(table) - len(shown)
    if rest > 0:
        lines.append(f"and {rest} more column{'s' * (rest > 1)}")
    return [*lines, "", *facts]
