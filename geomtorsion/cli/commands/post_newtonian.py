"""post-newtonian: gamma, beta and G of a theory, and whether they agree with the solar system."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from geomtorsion.cli.options import Form, Shown, directory, option
from geomtorsion.cli.results import show_result, write_result
from geomtorsion.cli.terminal import working
from geomtorsion.cli.theories import (
    ConstantsOption,
    Couplings,
    InvariantOption,
    LagrangianOption,
    ScalarNames,
    invariants_of,
    theory_of,
)
from geomtorsion.cli.values import assigned
from geomtorsion.errors import ArgumentError
from geomtorsion.gravity import perturbed
from geomtorsion.pictures.solar_system import draw_post_newtonian


def post_newtonian(
    lagrangian: LagrangianOption = None,
    geometry: Annotated[
        str | None,
        option(
            "-g",
            "--geometry",
            metavar="NAME",
            text="riemannian, teleparallel or 'symmetric teleparallel'. Default: the "
            "one of a named theory, or by the words of the Lagrangian (R, T or Q).",
        ),
    ] = None,
    constants: ConstantsOption = "",
    invariant: InvariantOption = None,
    scalars: ScalarNames = "",
    far: Annotated[
        list[str] | None,
        option(
            "--far", metavar="NAME=VALUE", text="Value of a scalar field far away. May be repeated."
        ),
    ] = None,
    values: Couplings = None,
    form: Shown = Form.text,
    output: Annotated[
        Path | None,
        directory("Directory for post_newtonian.json and post_newtonian.png, created if missing."),
    ] = None,
) -> None:
    """Compare a theory of gravity with measurements in the solar system.

    gamma is the curvature of space that a mass makes, beta how gravity adds to itself, G the
    strength of the attraction. General relativity has gamma = beta = 1. Cassini measured gamma,
    and lunar laser ranging beta. A theory passes within two standard errors.

    \b
    Examples:
      geomtorsion post-newtonian -L "phi*R/2 - om*X/(2*phi)" -g riemannian --scalars phi
      geomtorsion post-newtonian -L "T + c*vector2" -g teleparallel --set c=1/10
      geomtorsion post-newtonian -L "R/2 + R**2/12" -g riemannian -o weak
    """
    if lagrangian is None:
        raise ArgumentError(
            "post-newtonian: expected a Lagrangian, got none. Give -L 'T + c*vector2' -g "
            "teleparallel."
        )
    given = dict(assigned(one, "--set", "c=1") for one in values or ())
    with working(lagrangian):
        weak = perturbed.post_newtonian(
            theory_of(lagrangian),
            geometry,
            scalars=scalars,
            far=dict(assigned(one, "--far", "phi=1") for one in far or ()),
            constants=constants,
            invariants=invariants_of(invariant),
        ).subs(given)
    document = weak.to_json()
    show_result(document, str(weak), form)
    write_result(output, "post_newtonian", document, lambda: draw_post_newtonian(weak))
