"""gravity: the field equations of a Lagrangian on a space."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from geomtorsion.cli.exits import ExitCode
from geomtorsion.cli.options import Form, SpaceOrFile
from geomtorsion.cli.sources import open_space
from geomtorsion.cli.terminal import shows_greek, working
from geomtorsion.cli.theories import (
    ConnectionOption,
    ConstantsOption,
    InvariantOption,
    LagrangianOption,
    MaxwellOption,
    ScalarOption,
    field_equations,
)
from geomtorsion.gravity import FieldEquations
from geomtorsion.pictures.field_equations import field_equations_data
from geomtorsion.pictures.latex import text_label, text_marks
from geomtorsion.pictures.text import expression_text
from geomtorsion.spaces import Space


def gravity(
    source: SpaceOrFile,
    lagrangian: LagrangianOption = None,
    connection: ConnectionOption = None,
    constants: ConstantsOption = "",
    invariant: InvariantOption = None,
    scalar: ScalarOption = None,
    maxwell: MaxwellOption = None,
    form: Annotated[
        Form, typer.Option("--format", help="text to read, json for programs.")
    ] = Form.text,
) -> None:
    """Show the field equations of a Lagrangian on a space.

    The default Lagrangian is tegr. E is the equation of the coframe; E_[ij], its antisymmetric
    part, is the equation of the spin connection of a teleparallel theory. A space with its own
    connection also has C, the equation of the connection, and M, the equation of the metric.
    A matter field has an equation of its own.
    Indices count legs of the frame from 1; in JSON they count from 0. The command ends with 1 if a
    Noether identity fails.

    \b
    Examples:
      geomtorsion gravity frw -L "T + c*T**2"
      geomtorsion gravity kerr -L tegr
      geomtorsion gravity schwarzschild -c levi-civita -L "R + alpha*GB"
      geomtorsion gravity frw_flat -L "T**n" --constants n
      geomtorsion gravity frw -c cartan -c levi-civita -L "f(T, Rbar)"
      geomtorsion gravity frw_flat -c levi-civita -L "R + c*Y" --invariant "Y = R_abcd R^abdc"
      geomtorsion gravity frw_flat -c invariant-torsion -L "R + c*T1"
      geomtorsion gravity frw_flat -L "T - F2/4 - m**2*Y/2" --invariant "Y = A_a A^a" \
          --maxwell "A(t), 0, 0, 0"
    """
    with working(source):
        space = open_space(source)
        chosen = "tegr" if lagrangian is None else lagrangian
        equations = field_equations(
            space, chosen, connection, constants, invariant, scalar, maxwell
        )
        identities = equations.identities()
        # Components are computed here, so that limits and the progress line apply.
        zero = {name: tensor.is_zero for name, tensor in equations.tensors.items()}
        zero |= {name: one.is_zero for name, one in equations.matter_equations.items()}
    if form is Form.json:
        document = {"space": space.name, **field_equations_data(equations)}
        document["identities"] = {check.name: check.holds for check in identities}
        typer.echo(json.dumps(document, indent=2))
    else:
        _show(space, equations, zero)
        for check in identities:
            typer.echo(str(check))
    if any(check.holds is False for check in identities):
        raise typer.Exit(ExitCode.failed)


def _show(space: Space, equations: FieldEquations, zero: dict[str, bool | None]) -> None:
    greek = shows_greek()
    names = ", ".join(one.name for one in equations.connections)
    typer.secho(f"{space.name}: L = {equations.lagrangian.expression}", bold=True)
    typer.echo(names)
    if equations.constants:
        typer.echo(f"constants: {' '.join(equations.constants)}")
    for name, value in equations.scalars.items():
        typer.echo(f"{name} = {expression_text(value, greek=greek)}")
    for name, tensor in equations.tensors.items():
        typer.echo()
        if zero[name]:
            typer.echo(f"{name} = 0")
            continue
        # Equal components, such as E_2^2 = E_3^3, are printed once.
        labels: dict[str, list[str]] = {}
        for index in tensor.components.independent:
            marks = text_marks(tensor, index, greek=greek)
            label = text_label(name[0], marks, tensor.slots)
            if name != name[0]:
                label = label.replace("{", "{[").replace("}", "]}")
            written = equations.readable(name, *index)
            labels.setdefault(expression_text(written, greek=greek), []).append(label)
        for written, equal in labels.items():
            typer.echo(f"{' = '.join(equal)} = {written}")
    for name, tensor in equations.matter_equations.items():
        typer.echo()
        for index in () if zero[name] else tensor.components.independent:
            marks = text_marks(tensor, index, greek=greek)
            label = text_label(name, marks, tensor.slots)
            written = expression_text(equations.written(tensor.element(*index)), greek=greek)
            typer.echo(f"equation of {label}: {written} = 0")
        if zero[name]:
            typer.echo(f"equation of {name}: holds")
    typer.echo()
