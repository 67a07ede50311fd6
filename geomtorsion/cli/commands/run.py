"""run: a scene, solved, as table, arrays, pictures and an animation."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from geomtorsion.cli.budgets import write_budget
from geomtorsion.cli.exits import ExitCode, resumable
from geomtorsion.cli.options import (
    EngineName,
    Form,
    PictureFormat,
    Pictures,
    Proved,
    SceneAccuracy,
    SceneOrFile,
    SceneTime,
    Settings,
    Shown,
    Watch,
    directory,
    option,
    say_files,
)
from geomtorsion.cli.scene_sources import open_scene, start_angles
from geomtorsion.cli.terminal import WIDTH, right_aligned, some_rows, working
from geomtorsion.cli.values import engine_of
from geomtorsion.errors import CheckpointError, GeomtorsionError, StuckError
from geomtorsion.ode import Engine
from geomtorsion.pictures.style import can_draw
from geomtorsion.prices import EffectBudget
from geomtorsion.proofs import prove
from geomtorsion.scenes import Scene, SceneResult
from geomtorsion.scenes.checkpoint import partial_result
from geomtorsion.scenes.saving import metadata, write_run, write_scene_film
from geomtorsion.support.csv_table import write_csv
from geomtorsion.support.files import check_resumption, make_folder
from geomtorsion.support.progress import bar

CHECKPOINT, PARTIAL = "checkpoint.npz", "partial.csv"
# The least width of a column: a number of six digits with its sign and exponent, and a gap.
COLUMN = len(f" {-1e-9 / 3:.6g}")


def run(
    source: SceneOrFile,
    watch: Watch = None,
    accuracy: SceneAccuracy = None,
    engine: EngineName = "auto",
    t: SceneTime = None,
    settings: Settings = None,
    output: Annotated[
        Path | None,
        directory("Write table.csv, result.npz, run.json, scene.toml and pictures there."),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Resume the run that was stopped in DIR.")
    ] = False,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Discard a run that was stopped in DIR.")
    ] = False,
    only_kept: Annotated[
        bool,
        typer.Option(
            "--kept", help="Write the computed part of a stopped run to DIR/partial.csv, and exit."
        ),
    ] = False,
    animate: Annotated[
        Path | None,
        option(metavar="FILE", text="Write an animation, .gif or (with ffmpeg) .mp4."),
    ] = None,
    pictures: Pictures = PictureFormat.png,
    form: Shown = Form.text,
    proved: Proved = False,
    only_needed: Annotated[
        bool,
        typer.Option("--only-needed", help="Omit the effects that the accuracy does not call for."),
    ] = False,
) -> None:
    """Run a scene: a body, the effects on it, and the watched quantities.

    With -o the run is saved in DIR/checkpoint.npz while it is computed. If it is stopped by Ctrl-C
    or killed, --resume continues it from there to the same result, bit for bit, and --kept writes
    the computed part. The command ends with 1 if the motion stops before its last time; the
    computed part is still shown and written.

    With --only-needed the influence of each effect is measured and shown first. The error by the
    omitted effects and the error of the integration stay within the accuracy together. With -o both
    are written to DIR/effects.json, and drawn.

    \b
    Examples:
      geomtorsion run dzhanibekov -o flip
      geomtorsion run lagrange_loop --watch nutation --accuracy 1e-12 --set gravity.g=1.62
      geomtorsion run my-top.toml -o my-top --animate my-top/top.gif
      geomtorsion run dzhanibekov --t 10 --proved
      geomtorsion run missile --accuracy 1e-2 --only-needed
    """
    scene = open_scene(source, watch, accuracy, t, settings)
    solver = engine_of(engine)
    budget = _budget(scene, solver) if only_needed else None
    if budget is not None:
        scene = budget.chosen
    title = scene.title or scene.name
    checkpoint = _checkpoint(output, resume=resume or only_kept, overwrite=overwrite)
    if only_kept and checkpoint is not None:
        typer.echo(_partial(scene, checkpoint, solver))
        return
    with resumable(lambda: _left(scene, checkpoint, solver)):
        result = _solved(scene, solver, checkpoint)
        written = _write(title, result, budget, output, animate, pictures)
        if checkpoint is not None:
            checkpoint.unlink(missing_ok=True)
            checkpoint.with_name(PARTIAL).unlink(missing_ok=True)
    _show(title, result, budget, form, proved=proved)
    say_files(written, form, drawn=output is None or can_draw())
    if not result.complete:
        raise typer.Exit(ExitCode.failed)


def _write(
    title: str,
    result: SceneResult,
    budget: EffectBudget | None,
    output: Path | None,
    animate: Path | None,
    pictures: PictureFormat,
) -> list[Path]:
    """Write a result and its animation to files."""
    written: list[Path] = []
    with working(title) as progress:
        if output is not None:
            written = write_run(result, output, pictures.value, progress)
            written += [] if budget is None else write_budget(budget, output, pictures.value)
        if animate is not None:
            progress("drawing the animation")
            written.append(write_scene_film(result, animate))
    return written


def _show(
    title: str, result: SceneResult, budget: EffectBudget | None, form: Form, *, proved: bool
) -> None:
    """Show a result, with its effects and its proof, in words or as JSON."""
    document: dict[str, Any] = {} if budget is None else {"effects": budget.to_json()}
    is_text = form is Form.text
    if is_text:
        typer.echo(f"{budget}\n" * (budget is not None) + "\n".join(_summary(result)))
    if proved:
        with working(f"{title}: proof"):
            proof = prove(result.solution)
        document["proof"] = proof.to_json()
        if is_text:
            typer.echo(str(proof))
    if not is_text:
        typer.echo(json.dumps(metadata(result) | document, indent=2, ensure_ascii=False))


def _budget(scene: Scene, engine: Engine | None) -> EffectBudget:
    """The effects that the accuracy of a scene calls for."""
    with bar(f"{scene.title or scene.name}: effects") as progress:
        return scene.called_for(engine=engine, progress=progress)


def _checkpoint(output: Path | None, *, resume: bool, overwrite: bool) -> Path | None:
    """The checkpoint file of the run; refuse to overwrite an unfinished run."""
    if output is None:
        if resume or overwrite:
            raise CheckpointError(
                "--resume, --kept, --overwrite: expected a directory with a run, got none. Name it "
                "with -o."
            )
        return None
    path = output / CHECKPOINT
    check_resumption(
        output, "run", begun=path.exists(), resume=resume, overwrite=overwrite,
        options="--resume and --kept",
    )  # fmt: skip
    if overwrite:
        path.unlink(missing_ok=True)
    make_folder(output)
    return path


def _solved(scene: Scene, engine: Engine | None, checkpoint: Path | None) -> SceneResult:
    """The result of a scene, as far as it goes."""
    begun = checkpoint is not None and checkpoint.exists()
    with bar(scene.title or scene.name) as progress:
        try:
            return scene.run(engine, checkpoint, progress)
        except GeomtorsionError as error:
            stuck = error.solution if isinstance(error, StuckError) else None
            if stuck is None or not len(stuck.times):
                # Nothing is left that another attempt could use.
                if checkpoint is not None and not begun:
                    checkpoint.unlink(missing_ok=True)
                raise
            typer.echo(f"geomtorsion: {str(error).partition(' The computed part')[0]}", err=True)
            return stuck


def _left(scene: Scene, checkpoint: Path | None, engine: Engine | None) -> str:
    """Message after Ctrl-C: which results exist, and how to resume."""
    if checkpoint is None or not checkpoint.exists():
        return ""
    try:
        return f"; {_partial(scene, checkpoint, engine)}; resume with --resume"
    except CheckpointError:
        # No sample is computed yet, or the motion has a closed form.
        return "; resume with --resume"


def _partial(scene: Scene, checkpoint: Path, engine: Engine | None) -> str:
    """Write the results of a stopped run, and report it."""
    part = partial_result(scene, checkpoint, engine)
    path = checkpoint.with_name(PARTIAL)
    write_csv(path, part.columns())
    reached = float(part.times[-1]) if len(part.times) else 0.0
    return f"the computed part, to t = {reached:.6g} s, is in {path}"


def _summary(result: SceneResult) -> list[str]:
    """The solved scene, some rows of its table, and their errors."""
    table = result.columns()
    shown = list(table)[: WIDTH // COLUMN]
    heading, *facts = str(result).splitlines()
    width = max(COLUMN, *(len(name) + 2 for name in shown))
    lines = [heading, "", right_aligned(shown, width)]
    lines += [
        right_aligned((f"{table[name][k]:.6g}" for name in shown), width)
        for k in some_rows(len(result.times))
    ]
    rest = len(table) - len(shown)
    if rest > 0:
        lines.append(f"and {rest} more column{'s' * (rest > 1)}")
    return [*lines, "", *start_angles(result.scene), *facts]
