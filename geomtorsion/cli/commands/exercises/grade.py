"""exercises grade: a folder of answers to a table of marks."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from geomtorsion.checks import cut
from geomtorsion.cli.exits import ExitCode
from geomtorsion.cli.options import argument, option
from geomtorsion.cli.values import parts
from geomtorsion.exercises import grading
from geomtorsion.progress import bar


def grade(
    folder: Annotated[Path, argument("FOLDER", "One TOML file of answers per student.")],
    output: Annotated[
        Path,
        typer.Option(
            "-o", "--output", metavar="FILE", help="Table of marks: CSV, or JSON by its name."
        ),
    ] = Path("marks.csv"),
    only: Annotated[
        str | None,
        option(
            metavar="NUMBER,...", text="Exercises that count; default: all that anybody answered."
        ),
    ] = None,
    seed: Annotated[
        int | None, option(metavar="N", text="Variant that everybody must have worked on.")
    ] = None,
    seconds: Annotated[
        float,
        typer.Option(metavar="S", min=0.1, help="How long the answers to one exercise may take."),
    ] = 10.0,
) -> None:
    """Grade a folder of answers.

    Nothing in a file is ever run as code; a broken or hostile one is reported and costs no one else
    their marks. The table is written after each student: a second run goes on where the first was
    stopped. A row says how many questions were answered, which exercises count, and what to look
    at: no seed, a name that no question has, two files of one student. Ends with 1 if somebody's
    file needs a look.

    \b
    Examples:
      geomtorsion exercises grade answers -o marks.csv
      geomtorsion exercises grade answers -o marks.csv --only 2.2,3.3,5.4
    """
    numbers = None if only is None else list(parts(only))
    if not folder.is_dir():
        raise NotADirectoryError(20, "a folder of TOML files was needed", str(folder))
    with bar("grading") as show:

        def progress(done: int, total: int, name: str) -> None:
            if show is not None:
                show(done / total, f"{done} of {total} {name or 'graded'}")

        marks = grading.grade(
            folder, output, numbers, seed=seed, seconds=seconds, progress=progress
        )
    # A long reason is cut here: it stands in the table in full.
    for row in marks.rows:
        if row["remarks"] or row["status"] != grading.GRADED:
            reason = row["remarks"] or row["diagnoses"]
            typer.echo(f"{row['file']}: {row['status']}: {cut(reason, 100)}", err=True)
    if marks.chosen == grading.OCCURRING:
        typer.echo(
            f"counted: {', '.join(marks.numbers) or 'nothing'}, whatever anybody answered; "
            "--only says which exercises count"
        )
    fine = len(marks.rows) - len(marks.troubled)
    kept = f", {marks.kept} of them before" if marks.kept else ""
    typer.echo(f"graded {fine} of {len(marks.rows)} students{kept}: {output}")
    if marks.troubled:
        raise typer.Exit(ExitCode.failed)
