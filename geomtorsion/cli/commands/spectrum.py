"""spectrum: the particles of a theory of gravity about flat space."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

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
from geomtorsion.pictures.particles import draw_particles


def spectrum(
    lagrangian: LagrangianOption = None,
    geometry: Annotated[
        str | None,
        option(
            "-g",
            "--geometry",
            metavar="NAME",
            text="riemannian, teleparallel, 'symmetric teleparallel', poincare (metric connection "
            "with torsion) or metric-affine. Default: the one of a named theory, or by the words "
            "of the Lagrangian (R, T, Q; poincare for R with T).",
        ),
    ] = None,
    constants: ConstantsOption = "",
    invariant: InvariantOption = None,
    scalars: ScalarNames = "",
    vectors: Annotated[
        int, typer.Option(metavar="N", help="Number of vector fields A, with F2 and A_a.")
    ] = 0,
    values: Couplings = None,
    form: Shown = Form.text,
    output: Annotated[
        Path | None,
        directory("Directory for spectrum.json and spectrum.png, created if missing."),
    ] = None,
) -> None:
    """List the particles of a theory of gravity about flat space.

    Each has a spin, a parity, a mass and a sign of its energy. Masses and signs are formulas in the
    couplings. The last line is the condition for a theory without ghosts and tachyons.

    \b
    Examples:
      geomtorsion spectrum -L "R/2 + c*R**2" -g riemannian
      geomtorsion spectrum -L "R/2 + c*holst**2 + d*axial2" -g poincare --set d=0
      geomtorsion spectrum -L "R/2 + a*R7 + b*Q3" -g metric-affine -o vector
    """
    if lagrangian is None:
        raise ArgumentError(
            "spectrum: expected a Lagrangian, got none. Give -L 'R/2 + c*R**2' -g riemannian."
        )
    given = dict(assigned(one, "--set", "c=1") for one in values or ())
    with working(lagrangian):
        result = perturbed.spectrum(
            theory_of(lagrangian),
            geometry,
            scalars=scalars,
            vectors=vectors,
            constants=constants,
            invariants=invariants_of(invariant),
        )
        if given:
            result = result.subs(given)
    document = result.to_json()
    show_result(document, str(result), form)
    write_result(output, "spectrum", document, lambda: draw_particles(result))
