"""geometry: the components of the quantities of a space, in the format asked for."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from geomtorsion.cli.progress import working
from geomtorsion.cli.source import SpaceOrFile, open_space
from geomtorsion.cli.terminal import shows_greek


class Format(StrEnum):
    """How components are written."""

    text = "text"
    latex = "latex"
    json = "json"
    python = "python"
    mathematica = "mathematica"


class Basis(StrEnum):
    """The basis to which indices refer."""

    natural = "natural"
    coordinate = "coordinate"
    frame = "frame"


def geometry(
    source: SpaceOrFile,
    only: Annotated[
        str,
        typer.Option(
            metavar="QUANTITY,...",
            help="Only these quantities, for instance torsion,ricci. `all` is everything.",
        ),
    ] = "all",
    form: Annotated[
        Format,
        typer.Option(
            "--format",
            help="text to read, latex to print, json for programs, python for NumPy functions, "
            "mathematica for Wolfram's language.",
        ),
    ] = Format.text,
    basis: Annotated[
        Basis,
        typer.Option(help="natural: each quantity in the basis in which it is defined."),
    ] = Basis.natural,
    every: Annotated[
        bool,
        typer.Option("--every", help="In text and latex: also components that follow by symmetry."),
    ] = False,
) -> None:
    """Show metric, connections, torsion and curvature.

    Only components that do not vanish are shown. Letters are coordinates, digits are legs of the
    frame, counted from 0.

    \b
    Examples:
      geomtorsion geometry so3 --only torsion,ricci
      geomtorsion geometry kerr --only kretschmann --format python > kerr.py
      geomtorsion geometry my-tetrad.toml --basis frame --format latex

    \b
    A tetrad file is TOML; expressions stand in quotes:
      coordinates = ["t", "r"]      names, in the order of the columns
      coframe = [["f(r)", 0],       rows are one-forms; or one of
                 [0, "1/f(r)"]]     frame, metric, structure_constants
      signature = [-1, 1]           or a constant matrix; default: plus signs
      domain = ["r > 2*M"]          inequalities
      parameters = {M = "positive"}
      functions = {f = ["r"]}
    and, as needed, name, title, story, source, notes, complex = true, and one of
    spin_connection, contortion, connection.
    """
    from geomtorsion.pictures.chosen import choose

    names = [] if only == "all" else [name.strip() for name in only.split(",") if name.strip()]
    with working(source) as progress:
        space = open_space(source)
        quantities = choose(space, names, basis.value, progress)
    match form:
        case Format.text:
            from geomtorsion.cli.text import text_of

            written = text_of(space, quantities, greek=shows_greek(), every=every)
        case Format.latex:
            from geomtorsion.cli.latex import latex_of

            written = latex_of(space, quantities, every=every)
        case Format.json:
            import json

            from geomtorsion.pictures.document import document

            written = json.dumps(document(space, quantities), indent=2)
        case Format.python:
            from geomtorsion.cli.numpy_code import python_of

            written = python_of(space, quantities)
        case Format.mathematica:
            from geomtorsion.cli.wolfram import mathematica_of

            written = mathematica_of(space, quantities)
    typer.echo(written)
