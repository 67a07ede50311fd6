"""app: the commands in one place."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version
from typing import Annotated

import typer

from geomtorsion.cli.accuracy import accuracy
from geomtorsion.cli.burgers import burgers
from geomtorsion.cli.check import check
from geomtorsion.cli.curve import curve
from geomtorsion.cli.exercises import exercises
from geomtorsion.cli.geometry import geometry
from geomtorsion.cli.guard import guarded
from geomtorsion.cli.lab import lab
from geomtorsion.cli.paper import paper
from geomtorsion.cli.plan import plan
from geomtorsion.cli.report import report
from geomtorsion.cli.run import run
from geomtorsion.cli.scenes import scenes
from geomtorsion.cli.spaces import spaces

app = typer.Typer(
    name="geomtorsion",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def installed_version() -> str:
    """Version of the installed package."""
    try:
        return version("geomtorsion")
    except PackageNotFoundError:
        return "unknown (not installed)"


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"geomtorsion {installed_version()}")
        raise typer.Exit


@app.callback()
def geomtorsion(
    _version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_show_version, is_eager=True, help="Show the version and stop."
        ),
    ] = False,
) -> None:
    """Give it any tetrad; get its geometry, exactly.

    \b
    Examples:
      geomtorsion spaces
      geomtorsion geometry so3 --only torsion,ricci
      geomtorsion report so3 -o so3-report
    """


for _command in (spaces, geometry, check, plan, report, curve, accuracy, burgers, run, scenes):
    app.command()(guarded(_command))
app.command(short_help="Recompute the equations of the paper.")(guarded(paper))
app.command(short_help="A page to play with, for the classroom.")(guarded(lab))
app.add_typer(exercises)
