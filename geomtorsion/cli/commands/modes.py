"""modes: gravitational waves, scalar waves and growth on a cosmos of a theory of gravity."""

from __future__ import annotations

from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from geomtorsion.cli.options import Form, Shown, directory, option
from geomtorsion.cli.results import show_result, write_result
from geomtorsion.cli.terminal import working
from geomtorsion.cli.theories import (
    ConstantsOption,
    InvariantOption,
    LagrangianOption,
    invariants_of,
    theory_of,
)
from geomtorsion.cli.values import assigned, number
from geomtorsion.errors import ArgumentError
from geomtorsion.gravity import perturbed
from geomtorsion.pictures.modes import draw_evolution
from geomtorsion.support.checks import shown
from geomtorsion.support.typed_text import separated


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
            "Default: the one of a named theory, or by the words of the Lagrangian (R, T or Q).",
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
    values: Annotated[
        list[str] | None,
        option(
            "--set",
            metavar="NAME=VALUE",
            text="With --times: the scale factor a and fields as functions of t, or the value of a "
            "coupling. May be repeated.",
        ),
    ] = None,
    times: Annotated[
        str, option(metavar="FIRST,LAST", text="Report numbers between two times on a cosmos.")
    ] = "",
    form: Shown = Form.text,
    output: Annotated[
        Path | None,
        directory("Directory for modes.json and, with --times, modes.png, created if missing."),
    ] = None,
) -> None:
    """Report the waves of a theory of gravity on a flat cosmos.

    Speeds and kinetic factors are formulas in the rate of expansion H(t) and in the fields, for any
    expansion. A speed c_T^2 = 1 is the speed of light. With --times, they are numbers on the cosmos
    that --set gives, and -o writes their figure.

    \b
    Examples:
      geomtorsion modes -L "f(R)" -g riemannian
      geomtorsion modes -L "R/2 - X/2 + c*phi*GB" -g riemannian --scalars phi
      geomtorsion modes -L "R/2 - X/2 + c*X*Box(phi)" -g riemannian --scalars phi --kind scalar
      geomtorsion modes -L "f(T)" -g teleparallel --kind growth
      geomtorsion modes -L "R/2 - X/2 + c*phi*GB" -g riemannian --scalars phi --times 1,10 \\
          --set a=t**(1/2) --set phi=t --set c=1/10 -o speeds
    """
    if lagrangian is None:
        raise ArgumentError("modes: expected a Lagrangian, got none. Give -L 'f(R)' -g riemannian.")
    given = dict(assigned(one, "--set", "a=t**(2/3)") for one in values or ())
    if given and not times:
        raise ArgumentError("--set: expected times for the cosmos, got none. Add --times 1,10.")
    with working(lagrangian):
        result = OF_KIND[kind](
            theory_of(lagrangian),
            geometry,
            scalars=scalars,
            constants=constants,
            invariants=invariants_of(invariant),
        )
        document, text = result.to_json(), str(result)
        figure = None
        if times:
            over = result.over_time(_between(times), **given)
            document, text = document | {"over_time": over.to_json()}, f"{text}\n{over}"
            figure = partial(draw_evolution, over)
    show_result(document, text, form)
    write_result(output, "modes", document, figure)


def _between(text: str) -> np.ndarray:
    """Times of a figure from the first and the last one."""
    ends = [number(one, "--times") for one in separated(text)]
    if len(ends) != 2 or ends[0] >= ends[1]:
        raise ArgumentError(
            f"--times: expected two increasing times, got {shown(text)}. Write --times 1,10."
        )
    return np.linspace(ends[0], ends[1], 200)
