"""report: everything about a space on one page."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

import typer

from geomtorsion.cli.options import Basis, BasisOption, SpaceOrFile, directory
from geomtorsion.cli.sources import open_space
from geomtorsion.cli.terminal import working
from geomtorsion.cli.theories import (
    ConnectionOption,
    ConstantsOption,
    InvariantOption,
    LagrangianOption,
    MaxwellOption,
    ScalarOption,
    field_equations,
)
from geomtorsion.errors import GravityError
from geomtorsion.pictures.report import write_report


def report(
    source: SpaceOrFile,
    output: Annotated[
        Path | None,
        directory("Directory of the page, created if missing; default: NAME-report."),
    ] = None,
    pictures: Annotated[
        bool, typer.Option("--pictures/--no-pictures", help="Draw motions and a loop.")
    ] = True,
    basis: BasisOption = Basis.natural,
    lagrangian: LagrangianOption = None,
    connection: ConnectionOption = None,
    constants: ConstantsOption = "",
    invariant: InvariantOption = None,
    scalar: ScalarOption = None,
    maxwell: MaxwellOption = None,
) -> None:
    """Write a page with the geometry, motions and a loop of a space.

    The page, index.html, is one file that needs no network; geometry.json contains the geometry
    as data. Pictures need the extra `plots`. With -L the page also shows the field equations of a
    Lagrangian, as `geomtorsion gravity` does.

    \b
    Examples:
      geomtorsion report so3 -o so3-report
      geomtorsion report my-tetrad.toml -o my-report
      geomtorsion report kerr --basis frame
      geomtorsion report frw -L "T + c*T**2"
    """
    with working(source) as progress:
        space = open_space(source)
        # The name in a file may be any text; the name of a directory may not.
        default = re.sub(r"[^\w-]+", "-", space.name) + "-report"
        options = (
            ("--connection", connection), ("--constants", constants), ("--invariant", invariant),
            ("--scalar", scalar), ("--maxwell", maxwell),
        )  # fmt: skip
        for option, value in options:
            if value and lagrangian is None:
                raise GravityError(f"{option}: expected -L with it, got none. Add a Lagrangian.")
        equations = None
        if lagrangian is not None:
            equations = field_equations(
                space, lagrangian, connection, constants, invariant, scalar, maxwell
            )
        written = write_report(
            space, output or default, progress, pictures=pictures, basis=basis.value,
            equations=equations,
        )  # fmt: skip
    typer.echo(f"{space.name}: wrote {written} and {written.with_name('geometry.json')}")
