"""ringing: the quasinormal frequencies of a static black hole."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from geomtorsion.cli.options import Form, Shown, SpaceOrFile, directory, option
from geomtorsion.cli.results import show_result, write_result
from geomtorsion.cli.sources import open_space
from geomtorsion.cli.terminal import working
from geomtorsion.cli.theories import (
    LagrangianOption,
    MaxwellOption,
    ScalarOption,
    matter_of,
    theory_of,
)
from geomtorsion.cli.values import assigned
from geomtorsion.gravity import perturbed
from geomtorsion.pictures.ringing import draw_ringing


def ringing(
    source: SpaceOrFile,
    lagrangian: LagrangianOption = None,
    harmonic: Annotated[
        int, typer.Option("-l", "--harmonic", metavar="L", help="Degree of the spherical harmonic.")
    ] = 2,
    parity: Annotated[str, typer.Option(metavar="NAME", help="axial, polar or both.")] = "both",
    modes: Annotated[int, typer.Option(metavar="N", help="Number of modes of each parity.")] = 1,
    digits: Annotated[int, typer.Option(metavar="N", help="Digits of each frequency.")] = 8,
    values: Annotated[
        list[str] | None,
        option("--set", metavar="NAME=VALUE", text="Value of a parameter. May be repeated."),
    ] = None,
    scalar: ScalarOption = None,
    potential: MaxwellOption = None,
    geometry: Annotated[
        str | None,
        option(
            "-g",
            "--geometry",
            metavar="NAME",
            text="riemannian or teleparallel. Default: teleparallel for T, riemannian for others.",
        ),
    ] = None,
    form: Shown = Form.text,
    output: Annotated[
        Path | None,
        directory("Directory for ringing.json and ringing.png, created if missing."),
    ] = None,
) -> None:
    """Compute the quasinormal frequencies at which a static black hole rings.

    Without -L the theory is general relativity, L = R. The Lagrangian of a scalar field, -X/2, or
    of a Maxwell field, -F2/4, is a test field on the hole. --maxwell is the potential of a charged
    hole, and --scalar a constant scalar field of the theory.

    \b
    Examples:
      geomtorsion ringing schwarzschild --set M=1
      geomtorsion ringing schwarzschild --set M=1 -l 3 --parity axial --modes 2 -o rings
      geomtorsion ringing schwarzschild --set M=1 -L "-X/2" -l 0
      geomtorsion ringing schwarzschild --set M=1 -L "R + c*R**2" --set c=5/3 -l 1
      geomtorsion ringing schwarzschild --set M=1 -L "phi*R" --scalar "phi = 1" --parity polar
      geomtorsion ringing kerr_newman --set M=1 --set a=0 --set q=4/5 --parity axial \\
          -L "R - F2" --maxwell "q/r, 0, 0, 0"
    """
    given = dict(assigned(one, "--set", "M=1") for one in values or ())
    with working(source):
        rings = perturbed.ringing(
            theory_of(lagrangian) if lagrangian else "R",
            open_space(source),
            l=harmonic,
            parity=parity,
            modes=modes,
            digits=digits,
            parameters=given,
            geometry=geometry,
            matter=matter_of(scalar, potential),
        )
    document = rings.to_json()
    show_result(document, str(rings), form)
    write_result(output, "ringing", document, lambda: draw_ringing(rings))
