"""count: the degrees of freedom of a full nonlinear theory."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from geomtorsion.cli.options import Form, Shown, directory, option
from geomtorsion.cli.results import show_result, write_result
from geomtorsion.cli.sources import open_space
from geomtorsion.cli.terminal import working
from geomtorsion.cli.theories import (
    ConstantsOption,
    InvariantOption,
    LagrangianOption,
    invariants_of,
    theory_of,
)
from geomtorsion.cli.values import assigned
from geomtorsion.errors import ArgumentError
from geomtorsion.gravity import perturbed
from geomtorsion.gravity.charges.spheres import number
from geomtorsion.support.typed_text import separated

# Names of connections in other commands -> the geometry that varies them.
CONNECTIONS = {"cartan": "teleparallel", "levi-civita": "riemannian"}


def count(
    lagrangian: LagrangianOption = None,
    geometry: Annotated[
        str | None,
        option(
            "-g",
            "--geometry",
            "-c",
            "--connection",
            metavar="NAME",
            text="teleparallel (or cartan), riemannian (or levi-civita), poincare, 'symmetric "
            "teleparallel' or flat (only matter varies). Default: the one of a named theory, or by "
            "the words of the Lagrangian (R, T, Q; poincare for R with T).",
        ),
    ] = None,
    dimension: Annotated[int, typer.Option(metavar="N", help="Dimension: 2, 3 or 4.")] = 4,
    constants: ConstantsOption = "",
    invariant: InvariantOption = None,
    scalars: Annotated[
        str,
        option(
            metavar="NAMES",
            text='Scalar fields, such as "phi chi", or formulas near which a solution is searched: '
            '"phi = log(1 + t)".',
        ),
    ] = "",
    vectors: Annotated[
        int, typer.Option(metavar="N", help="Number of vector fields A, with F2 and A_a.")
    ] = 0,
    two_forms: Annotated[
        int, typer.Option(metavar="N", help="Number of two-forms B, with H2 and B2.")
    ] = 0,
    near: Annotated[
        str | None,
        option(
            metavar="SPACE",
            text="Space or tetrad file near which a solution is searched; without it flat space.",
        ),
    ] = None,
    values: Annotated[
        list[str] | None,
        option(
            "--set",
            metavar="NAME=VALUE",
            text="Value of a coupling, or of a parameter of --near. May be repeated.",
        ),
    ] = None,
    order: Annotated[
        int | None, typer.Option(metavar="N", help="Highest order of the power series.")
    ] = None,
    seed: Annotated[int, typer.Option(metavar="N", help="Seed of the random start.")] = 0,
    form: Shown = Form.text,
    output: Annotated[
        Path | None,
        directory("Directory for count.json and count.png, created if missing."),
    ] = None,
) -> None:
    """Count the degrees of freedom of a full nonlinear theory.

    The count holds near one solution, which Newton's method finds from flat space or --near; the
    answer is "not settled" where it depends on the order of the power series, or where ranks are
    not clear.

    \b
    Examples:
      geomtorsion count -L "R" -g riemannian --dimension 3
      geomtorsion count -L "T + c*T**2" -g teleparallel --dimension 3
      geomtorsion count -L "-F2/4" -g flat --vectors 1
    """
    if lagrangian is None:
        raise ArgumentError(
            "count: expected a Lagrangian, got none. Give -L 'T + c*T**2' -g teleparallel."
        )
    given = dict(assigned(one, "--set", "c=1") for one in values or ())
    start = None
    fields: str | dict[str, str] = scalars
    if "=" in scalars:
        fields = dict(assigned(x, "--scalars", "phi = log(1 + t)") for x in separated(scalars))
    with working(lagrangian):
        if near is not None:
            start = open_space(near).frame
            own = {x.name for x in start.parameters} & given.keys()
            put = {name: number(given.pop(name), f"--set {name}") for name in sorted(own)}
            start = start.subs(put) if put else start
        answer = perturbed.degrees_of_freedom(
            theory_of(lagrangian),
            CONNECTIONS.get(geometry, geometry) if geometry else None,
            dimension=dimension,
            near=start,
            scalars=fields,
            vectors=vectors,
            two_forms=two_forms,
            parameters=given,
            constants=constants,
            invariants=invariants_of(invariant),
            order=order,
            seed=seed,
        )
    show_result(answer.to_json(), str(answer), form)
    write_result(output, "count", answer.to_json(), answer.plot)
