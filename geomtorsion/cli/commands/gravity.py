"""gravity: the field equations of a Lagrangian on a space."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from geomtorsion.cli.exits import ExitCode
from geomtorsion.cli.options import Form, Proved, Shown, SpaceOrFile, directory, option, say_written
from geomtorsion.cli.solved_theories import Request, SolvedTheory
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
    model_of,
)
from geomtorsion.errors import ArgumentError
from geomtorsion.gravity.theory.fluids import Fluid
from geomtorsion.pictures.field_equations import field_equations_data, field_equations_lines
from geomtorsion.support.typed_text import separated


def gravity(
    source: SpaceOrFile,
    lagrangian: LagrangianOption = None,
    connection: ConnectionOption = None,
    constants: ConstantsOption = "",
    invariant: InvariantOption = None,
    scalar: ScalarOption = None,
    maxwell: MaxwellOption = None,
    form: Shown = Form.text,
    solved: Annotated[
        str | None,
        option(
            "--solve",
            metavar="NAME=LAST",
            text="Solve the theory of a file up to a last value of a coordinate, such as t=10.",
        ),
    ] = None,
    accuracy: Annotated[
        float, typer.Option(metavar="X", help="Largest error of a solution, relative to its size.")
    ] = 1e-10,
    proved: Proved = False,
    budget: Annotated[
        float | None,
        option(
            "--called-for",
            metavar="X",
            text="With --solve: show which terms and sources an accuracy of X calls for.",
        ),
    ] = None,
    watch: Annotated[
        list[str] | None,
        option(
            "--watch",
            metavar="NAME,...",
            text="Functions to which --called-for applies; by default functions of the coframe.",
        ),
    ] = None,
    output: Annotated[
        Path | None, directory("Write solution.npz and a picture of a solution to this directory.")
    ] = None,
) -> None:
    """Show the field equations of a Lagrangian on a space.

    The default Lagrangian is tegr. E is the equation of the coframe; E_[ij], its antisymmetric
    part, is the equation of the spin connection of a teleparallel theory. A space with its own
    connection also has C, the equation of the connection, and M, the equation of the metric.
    A matter field has an equation of its own.
    Indices count legs of the frame from 1; in JSON they count from 0. The command ends with 1 if a
    Noether identity fails.

    A tetrad file with a table [theory] has its own Lagrangian, matter and start. With --solve, its
    equations are reduced to first-order equations and solved: the command shows these, the
    solution with its error, and the drift of the constraints. With a table of boundary values in
    the file it also shows the free numbers of the start that lead to them. With --called-for, each
    term of the Lagrangian and each fluid is omitted once; the terms that an accuracy calls for are
    shown, and with -o written to effects.json and drawn.

    \b
    Examples:
      geomtorsion gravity frw -L "T + c*T**2"
      geomtorsion gravity kerr -L tegr
      geomtorsion gravity schwarzschild -c levi-civita -L "R + alpha*GB"
      geomtorsion gravity frw_flat -L "T**n" --constants n
      geomtorsion gravity frw -c cartan -c levi-civita -L "f(T, Rbar)"
      geomtorsion gravity frw_flat -c levi-civita -L "R + c*Y" --invariant "Y = R_abcd R^abdc"
      geomtorsion gravity frw_flat -c invariant-torsion -L "R + c*T1"
      geomtorsion gravity frw_flat -L "T - F2/4 - m**2*Y/2" --invariant "Y = A_a A^a" \\
          --maxwell "A(t), 0, 0, 0"
      geomtorsion gravity my-cosmology.toml --solve t=10 -o universe
      geomtorsion gravity my-cosmology.toml --solve t=10 --called-for 1e-3
    """
    if solved is None and (budget is not None or watch):
        raise ArgumentError(
            "--called-for, --watch: expected a solution whose terms can be omitted, got none. Add "
            "--solve t=10."
        )
    if solved is not None:
        request = None if budget is None else Request(budget, _names(watch))
        with working(source) as step:
            result = SolvedTheory.of(source, solved, accuracy, step, proved=proved, request=request)
        if form is Form.json:
            typer.echo(json.dumps(result.document(), indent=2))
        else:
            result.show()
        if output is not None:
            say_written(result.write(output))
        return
    with working(source):
        model = model_of(source) if lagrangian is None else None
        if model is None:
            space = open_space(source)
            chosen = "tegr" if lagrangian is None else lagrangian
            equations = field_equations(
                space, chosen, connection, constants, invariant, scalar, maxwell
            )
        else:
            space, equations = model.space, model.equations
        # Equations of a fluid do not follow from a Lagrangian.
        has_fluid = any(isinstance(one, Fluid) for one in equations.matter)
        identities = [] if has_fluid else equations.identities()
        # Components are computed here, so that limits and the progress line apply.
        if form is Form.json:
            checks = {"identities": {check.name: check.holds for check in identities}}
            data = {"space": space.name, **field_equations_data(equations), **checks}
            text = json.dumps(data, indent=2)
        else:
            lines = field_equations_lines(equations, greek=shows_greek())
            text = "\n".join([*lines, *map(str, identities)])
    if form is Form.text:
        typer.secho(f"{space.name}: L = {equations.lagrangian.expression}", bold=True)
    typer.echo(text)
    if any(check.holds is False for check in identities):
        raise typer.Exit(ExitCode.failed)


def _names(watch: Sequence[str] | None) -> list[str] | None:
    """Names of repeated options, each with several names."""
    return [name for text in watch for name in separated(text)] if watch else None
