"""gravity: the field equations of a Lagrangian on a space."""

from __future__ import annotations

import json
from enum import StrEnum
from typing import Annotated

import typer

from geomtorsion import gravity as theories
from geomtorsion.cli.exits import ExitCode
from geomtorsion.cli.options import Form, SpaceOrFile
from geomtorsion.cli.sources import open_space
from geomtorsion.cli.terminal import shows_greek, working
from geomtorsion.geometry import Connection, IdentityCheck, Tensor, cartan, levi_civita
from geomtorsion.gravity import FieldEquations
from geomtorsion.pictures.latex import text_label, text_marks
from geomtorsion.pictures.text import expression_text
from geomtorsion.spaces import Space


class Over(StrEnum):
    """The connection from which the Lagrangian is built."""

    own = "own"
    cartan = "cartan"
    levi_civita = "levi-civita"


def gravity(
    source: SpaceOrFile,
    lagrangian: Annotated[
        str,
        typer.Option(
            "-L",
            "--lagrangian",
            metavar="TEXT",
            help="Formula in T, T1, T2, T3, R, Q, P1 ... and parameters, or the name of a theory: "
            "tegr, stegr, einstein_cartan, general_relativity, gauss_bonnet.",
        ),
    ] = "tegr",
    connection: Annotated[
        list[Over] | None,
        typer.Option(
            "--connection",
            "-c",
            help="own: of the space, or Cartan if it has none. May be repeated; with several, "
            "names of the Levi-Civita connection end in bar.",
            show_default=False,
        ),
    ] = None,
    form: Annotated[
        Form, typer.Option("--format", help="text to read, json for programs.")
    ] = Form.text,
) -> None:
    """Show the field equations of a Lagrangian on a space.

    E is the equation of the coframe; E_[ij], its antisymmetric part, is the equation of the spin
    connection of a teleparallel theory. A space with its own connection also has C, the equation
    of the connection, and M, the equation of the metric. Indices count legs of the frame from 1;
    in JSON they count from 0. The command ends with 1 if a Noether identity fails.

    \b
    Examples:
      geomtorsion gravity frw -L "T + c*T**2"
      geomtorsion gravity kerr -L tegr
      geomtorsion gravity schwarzschild -c levi-civita -L "R + alpha*GB"
      geomtorsion gravity frw -c cartan -c levi-civita -L "f(T, Rbar)"
    """
    with working(source):
        space = open_space(source)
        known = {
            name: getattr(theories, name)
            for name in ("tegr", "stegr", "einstein_cartan", "general_relativity", "gauss_bonnet")
        }
        theory = known.get(lagrangian, lagrangian)
        default = Over.levi_civita if lagrangian in ("general_relativity", "gauss_bonnet") else None
        chosen = connection or [default or Over.own]
        found = theories.equations([_connection(space, one) for one in chosen], theory)
        identities = found.identities()
        parts = {"E": found.E, "E_[ij]": found.antisymmetric}
        kinds = {one.kind for one in found.connections}
        if kinds - {"cartan", "levi-civita"}:
            parts["C"] = found.C
        if "general" in kinds:
            parts["M"] = found.M
        # Components are computed here, so that limits and the progress line apply.
        zero = {name: tensor.is_zero for name, tensor in parts.items()}
    if form is Form.json:
        typer.echo(json.dumps(_data(space, found, parts, identities), indent=2))
    else:
        _show(space, found, parts, zero, identities)
    if any(check.holds is False for check in identities):
        raise typer.Exit(ExitCode.failed)


def _connection(space: Space, over: Over) -> Connection:
    """A connection of a space."""
    if over is Over.levi_civita:
        return levi_civita(space.frame)
    if over is Over.own and space.connection is not None:
        return space.connection
    return cartan(space.frame)


def _show(
    space: Space,
    found: FieldEquations,
    parts: dict[str, Tensor],
    zero: dict[str, bool | None],
    identities: list[IdentityCheck],
) -> None:
    greek = shows_greek()
    names = ", ".join(one.name for one in found.connections)
    typer.secho(f"{space.name}: L = {found.lagrangian.expression}", bold=True)
    typer.echo(names)
    for name, value in found.scalars.items():
        typer.echo(f"{name} = {expression_text(value, greek=greek)}")
    for name, tensor in parts.items():
        typer.echo()
        if zero[name]:
            typer.echo(f"{name} = 0")
            continue
        for index in tensor.components.independent:
            marks = text_marks(tensor, index, greek=greek)
            label = text_label(name[0], marks, tensor.slots)
            if name != name[0]:
                label = label.replace("{", "{[").replace("}", "]}")
            written = expression_text(found.frame.written(tensor.element(*index)), greek=greek)
            typer.echo(f"{label} = {written}")
    typer.echo()
    for check in identities:
        typer.echo(str(check))


def _data(
    space: Space,
    found: FieldEquations,
    parts: dict[str, Tensor],
    identities: list[IdentityCheck],
) -> dict[str, object]:
    """The result as plain data: indices count from 0, vanishing components are omitted."""
    return {
        "space": space.name,
        "lagrangian": str(found.lagrangian.expression),
        "connections": [one.name for one in found.connections],
        "scalars": {name: str(value) for name, value in found.scalars.items()},
        "equations": {
            name: {
                ",".join(map(str, index)): str(value) for index, value in tensor.nonzero().items()
            }
            for name, tensor in parts.items()
        },
        "identities": {check.name: check.holds for check in identities},
    }
