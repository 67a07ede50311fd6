"""exercises sheet: a chapter as page and notebook, solutions in a folder of their own."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from geomtorsion.cli.options import argument, directory, say_written
from geomtorsion.cli.terminal import working
from geomtorsion.exercises.registry import CHAPTERS
from geomtorsion.exercises.sheets import write_sheet


def sheet(
    chapter: Annotated[str, argument("CHAPTER", "1 to 7, or all.")],
    output: Annotated[Path, directory("Made if it is missing.")],
    seed: Annotated[int, typer.Option(metavar="N", help="Which variant.")] = 0,
) -> None:
    """Write a chapter for students, and its solutions for the teacher.

    For students: a page (HTML with MathML, no network needed), a Jupyter notebook, and a file to
    fill in. For the teacher, in the directory `teacher`: solutions and the mistakes to expect.

    \b
    Examples:
      geomtorsion exercises sheet 2 -o sheets
      geomtorsion exercises sheet all -o sheets --seed 7
    """
    chapters = [number for number, _ in CHAPTERS] if chapter == "all" else [chapter]
    with working("exercises") as progress:
        for number in chapters:
            say_written(write_sheet(number, output, seed, progress))
