"""modes: gravitational waves, scalar waves and growth on a cosmos of a theory of gravity."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from geomtorsion.cli.options import Form, option
from geomtorsion.cli.results import show_result
from geomtorsion.cli.terminal import working
from geomtorsion.cli.theories import (
    ConstantsOption,
    InvariantOption,
    LagrangianOption,
    invariants_of,
    theory_of,
)
from geomtorsion.errors import ArgumentError
from geomtorsion.gravity import perturbed


class Kind(StrEnum):
    """The waves to report."""

    tensor = "tensor"
    scalar = "scalar"
    growth = "growth"


OF_KIND = {
    Kind.tensor: perturbed.tensor_modes,
    Kind.scalar: perturbed.scalar_modes,
    Kind.growth: perturbed.growth,
}


def modes(
    lagrangian: LagrangianOption = None,
    geometry: Annotated[
        str | None,
        option(
            "-g",
            "--geometry",
            metavar="NAME",
            text="riemannian, teleparallel or 'symmetric teleparallel'. "
            "A named theory has its own.",
        ),
    ] = None,
    kind: Annotated[
        Kind,
        typer.Option(
            help="tensor: gravitational waves. scalar: waves of one scalar field. growth: strength "
            "of gravity for dust."
        ),
    ] = Kind.tensor,
    constants: ConstantsOption = "",
    invariant: InvariantOption = None,
    scalars: Annotated[
        str, option(metavar="NAMES", text='Scalar fields that depend on the time, such as "phi".')
    ] = "",
    form: Annotated[
        Form, typer.Option("--format", help="text to read, json for programs.")
    ] = Form.text,
) -> None:
    """Report the waves of a theory of gravity on a flat cosmos.

    Speeds and kinetic factors are formulas in the rate of expansion H(t) and in the fields, for any
    expansion. A speed c_T^2 = 1 is the speed of light.

    \b
    Examples:
      geomtorsion modes -L "f(R)" -g riemannian
      geomtorsion modes -L "R/2 - X/2 + c*phi*GB" -g riemannian --scalars phi
      geomtorsion modes -L "R/2 - X/2 + c*X*Box(phi)" -g riemannian --scalars phi --kind scalar
      geomtorsion modes -L "f(T)" -g teleparallel --kind growth
    """
    if lagrangian is None:
        raise ArgumentError("modes: expected a Lagrangian, got none. Give -L 'f(R)' -g riemannian.")
    with working(lagrangian):
        result = OF_KIND[kind](
            theory_of(lagrangian),
            geometry,
            scalars=scalars,
            constants=constants,
            invariants=invariants_of(invariant),
        )
        document, text = result.to_json(), str(result)
    show_result(document, text, form)
