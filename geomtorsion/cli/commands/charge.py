"""charge: mass, spin and charge inside a surface, and horizons."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from geomtorsion import gravity
from geomtorsion.cli.options import Form, Shown, SpaceOrFile, directory, option
from geomtorsion.cli.results import show_result, write_result
from geomtorsion.cli.sources import open_space
from geomtorsion.cli.terminal import working
from geomtorsion.cli.theories import LagrangianOption, theory_of
from geomtorsion.cli.values import assigned
from geomtorsion.errors import ArgumentError
from geomtorsion.pictures.charges import draw_charge
from geomtorsion.support.typed_text import separated


def charge(
    source: SpaceOrFile,
    kind: Annotated[
        str,
        typer.Option(
            "-k",
            "--kind",
            metavar="NAME",
            help="komar, noether, teleparallel, varied, brown-york, adm, electric, or horizons.",
        ),
    ] = "komar",
    killing: Annotated[
        str | None,
        option("--killing", metavar="NAME", text="Coordinate on which the metric does not depend."),
    ] = None,
    lagrangian: LagrangianOption = None,
    values: Annotated[
        list[str] | None,
        option("--set", metavar="NAME=VALUE", text="Value of a parameter. May be repeated."),
    ] = None,
    at: Annotated[
        list[str] | None,
        option("--at", metavar="NAME=VALUE", text="Value of time or radius. May be repeated."),
    ] = None,
    vary: Annotated[
        str | None,
        option("--vary", metavar="NAME", text="For kind varied: the parameter that changes."),
    ] = None,
    reference: Annotated[
        list[str] | None,
        option(
            "--reference",
            metavar="NAME=VALUE",
            text="For kinds adm and teleparallel: a value that makes the space flat, such as M=0. "
            "May be repeated.",
        ),
    ] = None,
    leg: Annotated[
        int, typer.Option(metavar="N", help="For kind teleparallel: number of the leg, from 0.")
    ] = 0,
    potential: Annotated[
        str | None,
        option("--potential", metavar="A,A,...", text="For kind electric: components of A."),
    ] = None,
    form: Shown = Form.text,
    output: Annotated[
        Path | None,
        directory("Directory for charge.json, created if missing; charge.png of a closed form."),
    ] = None,
) -> None:
    """Compute the mass, spin or charge inside a surface, or the horizons of a hole.

    The surface is where the first two coordinates are constant. Without --at and --set the result
    is a formula. -L is a function L(T) for kind teleparallel, and L(R) for noether and horizons.

    \b
    Examples:
      geomtorsion charge kerr
      geomtorsion charge kerr --killing phi --at r=3 --set M=1 --set a=3/5
      geomtorsion charge schwarzschild -k brown-york
      geomtorsion charge kerr -k horizons --set M=1 --set a=3/5
    """
    given = dict(assigned(one, "--set", "M=1") for one in values or ())
    surface = dict(assigned(one, "--at", "r=10") for one in at or ())
    flat = dict(assigned(one, "--reference", "M=0") for one in reference or ())
    theory = theory_of(lagrangian) if lagrangian else None
    drawn = None
    with working(source):
        space = open_space(source)
        if kind == "horizons":
            if surface:
                raise ArgumentError(
                    "--at: expected no value for a horizon, which has its own radius. Omit --at."
                )
            holes = gravity.horizons(space.frame, theory or "R", parameters=given or None)
            document: object = [one.to_json() for one in holes]
            text = "\n".join(map(str, holes))
        else:
            found = gravity.charge(
                space.frame,
                kind,
                killing=killing,
                surface=surface or None,
                parameters=given or None,
                lagrangian=theory,
                leg=leg,
                potential=separated(potential) if potential else None,
                vary=vary,
                reference=flat or None,
            )
            document, text = found.to_json(), str(found)
            if found.is_exact and found.symbols <= {found.radius.name}:
                drawn = partial(draw_charge, found)
    show_result(document, text, form)
    write_result(output, "charge", document, drawn)
