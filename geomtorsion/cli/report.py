"""report: everything about a space on one page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from geomtorsion.cli.progress import working
from geomtorsion.cli.source import SpaceOrFile, open_space


def report(
    source: SpaceOrFile,
    output: Annotated[
        Path,
        typer.Option(
            "-o",
            "--output",
            metavar="DIR",
            show_default=False,
            help="Directory to write to; made if it is missing.",
        ),
    ],
) -> None:
    """Write the whole geometry of a space as a page (index.html) and as data (geometry.json).

    The page is one file that needs no network.

    Example:  geomtorsion report so3 -o so3-report

    Example:  geomtorsion report my-tetrad.toml -o my-report
    """  # fmt: skip
    from geomtorsion.pictures.report import write_report

    space = open_space(source)
    with working(space.name) as progress:
        written = write_report(space, output, progress)
    typer.echo(f"{space.name}: wrote {written} and {written.with_name('geometry.json')}")
