"""exercises grade: a folder of answers to a table of marks."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

TROUBLED = 1
LONGEST = 100


def grade(
    folder: Annotated[
        Path,
        typer.Argument(
            metavar="FOLDER", show_default=False, help="One TOML file of answers per student."
        ),
    ],
    output: Annotated[
        Path,
        typer.Option("-o", "--output", metavar="FILE", help="Table of marks (CSV)."),
    ] = Path("marks.csv"),
    only: Annotated[
        str | None,
        typer.Option(
            metavar="NUMBER,...",
            show_default=False,
            help="Exercises that count; default: all that anybody answered.",
        ),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(
            metavar="N", show_default=False, help="Variant that everybody must have worked on."
        ),
    ] = None,
    seconds: Annotated[
        float,
        typer.Option(metavar="S", min=0.1, help="How long the answers to one exercise may take."),
    ] = 10.0,
) -> None:
    """Grade a folder of answers.

    Nothing in a file is ever run as code; a broken or hostile one is reported and costs no one else
    their marks. The table is written after each student: a second run goes on where the first was
    stopped. Ends with 1 if somebody's file needs a look.

    \b
    Examples:
      geomtorsion exercises grade answers -o marks.csv
      geomtorsion exercises grade answers -o marks.csv --only 2.2,3.3,5.4
    """
    from geomtorsion.exercises.grading import grade as graded

    numbers = None if only is None else [part.strip() for part in only.split(",") if part.strip()]
    if not folder.is_dir():
        raise NotADirectoryError(20, "a folder of TOML files was needed", str(folder))
    with _bar() as progress:
        marks = graded(folder, output, numbers, seed=seed, seconds=seconds, progress=progress)
    for row in marks.troubled:
        reason = row["remarks"] or row["diagnoses"]
        typer.echo(f"{row['file']}: {row['status']}: {reason[:LONGEST]}", err=True)
    fine = len(marks.rows) - len(marks.troubled)
    kept = f", {marks.kept} of them before" if marks.kept else ""
    typer.echo(f"graded {fine} of {len(marks.rows)} students{kept}: {output}")
    if marks.troubled:
        raise typer.Exit(TROUBLED)


@contextmanager
def _bar() -> Iterator[Callable[[int, int, str], object]]:
    """A progress bar on standard error, where somebody watches."""
    if not sys.stderr.isatty():
        yield lambda *_: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task("grading")
        yield lambda done, total, name: bar.update(
            task, completed=done, total=total, description=name or "graded"
        )
