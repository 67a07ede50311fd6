"""count: the degrees of freedom of a full nonlinear theory."""

from __future__ import annotations

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
from geomtorsion.cli.values import assigned
from geomtorsion.errors import ArgumentError
from geomtorsion.gravity import perturbed

# Names of connections in other commands -> the geometry that varies them.
CONNECTIONS = {"cartan": "teleparallel", "levi-civita": "riemannian"}


def count(
    lagrangian: LagrangianOption = None,
    connection: Annotated[
        str | None,
        option(
            "-c",
            "--connection",
            metavar="NAME",
            text="cartan (teleparallel), levi-civita (riemannian), poincare, 'symmetric "
            "teleparallel' or flat (only matter varies). A named theory has its own.",
        ),
    ] = None,
    dimension: Annotated[int, typer.Option(metavar="N", help="Dimension: 2, 3 or 4.")] = 4,
    constants: ConstantsOption = "",
    invariant: InvariantOption = None,
    scalars: Annotated[str, option(metavar="NAMES", text='Scalar fields, such as "phi chi".')] = "",
    vectors: Annotated[
        int, typer.Option(metavar="N", help="Number of vector fields A, with F2 and A_a.")
    ] = 0,
    values: Annotated[
        list[str] | None,
        option("--set", metavar="NAME=VALUE", text="Value of a coupling. May be repeated."),
    ] = None,
    order: Annotated[
        int | None, typer.Option(metavar="N", help="Highest order of the power series.")
    ] = None,
    seed: Annotated[int, typer.Option(metavar="N", help="Seed of the random start.")] = 0,
    form: Annotated[
        Form, typer.Option("--format", help="text to read, json for programs.")
    ] = Form.text,
) -> None:
    """Count the degrees of freedom of a full nonlinear theory.

    The count holds near one solution, which Newton's method finds from flat space; the answer is
    "not settled" where it depends on the order of the power series, or where ranks are not clear.

    \b
    Examples:
      geomtorsion count -L "R" -c levi-civita --dimension 3
      geomtorsion count -L "T + c*T**2" -c cartan --dimension 3
      geomtorsion count -L "-F2/4" -c flat --vectors 1
    """
    if lagrangian is None:
        raise ArgumentError(
            "count: expected a Lagrangian, got none. Give -L 'T + c*T**2' -c cartan."
        )
    given = dict(assigned(one, "--set", "c=1") for one in values or ())
    with working(lagrangian):
        answer = perturbed.degrees_of_freedom(
            theory_of(lagrangian),
            CONNECTIONS.get(connection, connection) if connection else None,
            dimension=dimension,
            scalars=scalars,
            vectors=vectors,
            parameters=given,
            constants=constants,
            invariants=invariants_of(invariant),
            order=order,
            seed=seed,
        )
    show_result(answer.to_json(), str(answer), form)
