"""star: mass, radius and tidal response of stars of a table of matter."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from geomtorsion.cli.options import Form, Shown, directory, option
from geomtorsion.cli.results import show_result, write_result
from geomtorsion.cli.terminal import working
from geomtorsion.cli.values import numbers
from geomtorsion.errors import GravityError
from geomtorsion.gravity import Family, equation_of_state, family
from geomtorsion.pictures.stars import draw_stars


def star(
    matter: Annotated[
        str,
        typer.Argument(
            metavar="MATTER",
            help="CSV file of pressures and energy densities, or published matter: SLy, APR4, "
            "WFF1, ENG, MPA1, MS1, H4.",
        ),
    ],
    units: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Units of all numbers: geometric, cgs, si or mev; by default geometric for a "
            "file, cgs for published matter.",
        ),
    ] = None,
    interpolation: Annotated[
        str, typer.Option(metavar="NAME", help="Between the rows of a file: monotone or cubic.")
    ] = "monotone",
    density: Annotated[
        str | None,
        option("--density", metavar="RHO,...", text="Energy densities at the centre."),
    ] = None,
    pressure: Annotated[
        str | None, option("--pressure", metavar="P,...", text="Pressures at the centre.")
    ] = None,
    mass: Annotated[
        float | None, option("--mass", metavar="M", text="Show the stable star of this mass.")
    ] = None,
    accuracy: Annotated[
        float, typer.Option(metavar="X", help="Relative error of each solution.")
    ] = 1e-9,
    form: Shown = Form.text,
    output: Annotated[
        Path | None,
        directory("Directory for star.json and star.png; stars.csv for several stars."),
    ] = None,
) -> None:
    """Compute mass, radius and tidal response of stars from a table of matter.

    One density or pressure gives one star, several or none a family with its heaviest star. The
    theory is general relativity.

    \b
    Examples:
      geomtorsion star SLy --density 1e15
      geomtorsion star SLy --mass 1.4
      geomtorsion star table.csv --units cgs -o stars
    """
    if density is not None and pressure is not None:
        raise GravityError("expected --density or --pressure, got both. Omit one.")
    word, text = ("density", density) if pressure is None else ("pressure", pressure)
    centres = numbers(text, word) or []
    with working(matter):
        state = equation_of_state(matter, units=units, interpolation=interpolation)
        stars = family(
            state,
            centres if density is not None else None,
            pressures=centres if pressure is not None else None,
            accuracy=accuracy,
        )
        if mass is not None:
            result = stars.at_mass(mass)
        else:
            result = stars.stars[0] if len(stars) == 1 else stars
        document = result.to_json()
        lines = str(result)
    show_result(document, lines, form)
    write_result(output, "star", document, lambda: draw_stars(result))
    if output is not None and isinstance(result, Family):
        result.to_csv(output / "stars.csv")
