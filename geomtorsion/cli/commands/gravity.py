"""gravity: the field equations of a Lagrangian on a space."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
import typer

from geomtorsion.cli.budgets import write_budget
from geomtorsion.cli.exits import ExitCode
from geomtorsion.cli.options import Form, Proved, SpaceOrFile, directory, option, say_written
from geomtorsion.cli.sources import open_space
from geomtorsion.cli.terminal import right_aligned, shows_greek, some_rows, working
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
from geomtorsion.cli.values import number, separated
from geomtorsion.errors import ArgumentError, FileFormatError
from geomtorsion.gravity import FieldEquations
from geomtorsion.gravity.theory.fluids import Fluid
from geomtorsion.ode import Solution
from geomtorsion.pictures.field_equations import field_equations_data
from geomtorsion.pictures.latex import text_label, text_marks
from geomtorsion.pictures.style import can_draw, save
from geomtorsion.pictures.text import expression_text
from geomtorsion.prices import called_for
from geomtorsion.proofs import prove
from geomtorsion.spaces import Space
from geomtorsion.support.checks import shown
from geomtorsion.support.files import make_folder
from geomtorsion.support.outgoing import number_text

# Characters of a number in a table, and its digits.
WIDTH = len("  -1.234567e-8")
DIGITS = len("1234567")


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
        request = None if budget is None else _Request(budget, _names(watch))
        _solve(source, solved, accuracy, proved, output, form, request)
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


class _Request(NamedTuple):
    """The accuracy for which terms are to be chosen, and the functions that count."""

    accuracy: float
    watch: list[str] | None


def _names(watch: Sequence[str] | None) -> list[str] | None:
    """Names of repeated options, each with several names."""
    return [name for text in watch for name in separated(text)] if watch else None


def _solve(
    source: str,
    request: str,
    accuracy: float,
    proved: bool,
    output: Path | None,
    form: Form,
    choice: _Request | None = None,
) -> None:
    """Solve the theory of a file, and show or write the solution."""
    variable, sign, last = request.partition("=")
    if not sign:
        raise ArgumentError(
            f"--solve: expected a coordinate and its last value, got {shown(request)}. Write "
            "--solve t=10."
        )
    end = number(last, "--solve")
    with working(source) as step:
        model = model_of(source)
        if model is None:
            raise FileFormatError(
                f"--solve: expected a tetrad file with a table [theory], got {shown(source)}. "
                "Write one with a lagrangian and a start."
            )
        reduction = model.reduce(variable.strip())
        step("solution")
        shooting = None
        if model.boundary or model.free:
            if choice is not None:
                raise ArgumentError(
                    "--called-for: expected a theory with a start, got one with boundary values, "
                    "which each omitted term would reach from another start. Write the start "
                    "without a table boundary."
                )
            shooting = model.shoot(reduction.variable, end, accuracy)
            solution = shooting.solution
        else:
            solution = model.solve(reduction.variable, end, accuracy)
        proof = prove(solution) if proved else None
        budget = None
        if choice is not None:
            step("terms")
            budget = called_for(solution, choice.accuracy, watch=choice.watch)
    names = [reduction.variable, *reduction.states, *reduction.outputs, *model.outputs]
    table = {name: _column(solution, name) for name in names}
    if form is Form.json:
        document = {
            "space": model.space.name,
            "lagrangian": str(model.equations.lagrangian.expression),
            "rates": {name: str(rate) for name, rate in reduction.rates.items()},
            "constraints": [str(one) for one in reduction.constraints],
            "solution": {name: column.tolist() for name, column in table.items()},
            "outcome": solution.outcome,
            "error": solution.error,
            "drift": dict(solution.drift),
            "proved": None if proof is None else proof.holds,
            "called_for": None if budget is None else budget.to_json(),
        }
        if shooting is not None:
            document["free"] = {
                name: {"value": value, "error": shooting.errors[name]}
                for name, value in shooting.values.items()
            }
            document["boundary"] = {
                name: {"miss": miss, "remainder": shooting.remainders.get(name)}
                for name, miss in shooting.misses.items()
            }
        typer.echo(json.dumps(document, indent=2))
    else:
        typer.secho(f"{model.space.name}: L = {model.equations.lagrangian.expression}", bold=True)
        typer.echo(f"{reduction}\n")
        typer.echo(right_aligned(names, WIDTH))
        for row in some_rows(len(solution.times)):
            cells = [number_text(float(table[name][row]), _error(solution, name)) for name in names]
            typer.echo(right_aligned([cell[: WIDTH - 2] for cell in cells], WIDTH))
        typer.echo(f"\n{solution if shooting is None else shooting}")
        if proof is not None:
            typer.echo(str(proof))
        if budget is not None:
            typer.echo(f"\n{budget}")
    if output is not None:
        files = _written(solution, output)
        say_written(files if budget is None else files + write_budget(budget, output, "png"))


def _column(solution: Solution, name: str) -> np.ndarray:
    """Values of a state or an output, or of the variable where it is the time."""
    return solution.times if name == solution.problem.time_name else solution[name]


def _error(solution: Solution, name: str) -> float:
    """The absolute error with which a column is printed, of at least the printed digits."""
    values = np.abs(_column(solution, name))
    relative = 0.0 if name == solution.problem.time_name else solution.error_of(name)
    return float(values.max()) * max(relative, 10.0**-DIGITS)


def _written(solution: Solution, folder: Path) -> list[Path]:
    """The files of a solution."""
    make_folder(folder)
    paths = [folder / "solution.npz"]
    solution.save(paths[0])
    if can_draw():
        paths.append(folder / "solution.png")
        save(solution.plot(), paths[1])
    return paths


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
