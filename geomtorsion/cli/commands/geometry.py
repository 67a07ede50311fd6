"""geometry: the components of the quantities of a space, in the requested format."""

from __future__ import annotations

import json
from enum import StrEnum
from typing import Annotated

import typer

from geomtorsion.cli.formats import latex_of, mathematica_of, python_of, text_of
from geomtorsion.cli.options import Basis, BasisOption, SpaceOrFile
from geomtorsion.cli.sources import open_space
from geomtorsion.cli.terminal import shows_greek, working
from geomtorsion.cli.values import some_names
from geomtorsion.pictures.quantities import chosen_quantities, geometry_data


class Format(StrEnum):
    """How components are written."""

    text = "text"
    latex = "latex"
    json = "json"
    python = "python"
    mathematica = "mathematica"


def geometry(
    source: SpaceOrFile,
    only: Annotated[
        str,
        typer.Option(
            metavar="QUANTITY,...",
            help="Only these quantities, for instance torsion,ricci; `all` shows all.",
        ),
    ] = "all",
    form: Annotated[
        Format,
        typer.Option(
            "--format",
            help="text to read, latex to print, json for programs (--json for short), python for "
            "NumPy functions, mathematica for Wolfram's language.",
        ),
    ] = Format.text,
    basis: BasisOption = Basis.natural,
    every: Annotated[
        bool,
        typer.Option(
            "--every", help="text and latex: show also components that follow by symmetry."
        ),
    ] = False,
) -> None:
    """Show metric, connections, torsion and curvature.

    Only components that do not vanish are shown. Letters are coordinates, digits are legs of the
    frame, counted from 1; in JSON and Python indices count from 0.

    \b
    Examples:
      geomtorsion geometry so3 --only torsion,ricci
      geomtorsion geometry kerr --only kretschmann --format python > kerr.py
      geomtorsion geometry my-tetrad.toml --basis frame --format latex

    \b
    A tetrad file is TOML; expressions are in quotes:
      coordinates = ["t", "r"]      names, in the order of the columns
      coframe = [["f(r)", 0],       rows are one-forms; or one of
                 [0, "1/f(r)"]]     frame, metric, structure_constants
      signature = [-1, 1]           or a constant matrix; default: plus signs
      domain = ["r > 2*M"]          inequalities
      parameters = {M = "positive"}
      functions = {f = ["r"]}
      names = {F = "f(r)**2"}       expressions printed by their name
    and, if needed, name, title, story, source, notes, complex = true, and one of
    spin_connection, contortion, connection.
    """
    with working(source) as progress:
        space = open_space(source)
        names = [] if only == "all" else some_names(only, "--only")
        quantities = chosen_quantities(space, names, basis.value, progress)
    match form:
        case Format.text:
            written = text_of(space, quantities, greek=shows_greek(), every=every)
        case Format.latex:
            written = latex_of(space, quantities, every=every)
        case Format.json:
            written = json.dumps(geometry_data(space, quantities), indent=2)
        case Format.python:
            written = python_of(space, quantities)
        case Format.mathematica:
            written = mathematica_of(space, quantities)
    typer.echo(written)
