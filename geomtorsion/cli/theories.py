"""theories: a Lagrangian and connections of a space, from options of the command line."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from geomtorsion import gravity
from geomtorsion.files import read_toml
from geomtorsion.geometry import Connection, cartan, levi_civita
from geomtorsion.gravity import FieldEquations, Model
from geomtorsion.gravity.vocabulary import THEORIES
from geomtorsion.spaces import Space, names

RIEMANNIAN = ("general_relativity", "gauss_bonnet")


class Over(StrEnum):
    """The connection from which the Lagrangian is built."""

    own = "own"
    cartan = "cartan"
    levi_civita = "levi-civita"


LagrangianOption = Annotated[
    str | None,
    typer.Option(
        "-L",
        "--lagrangian",
        metavar="TEXT",
        show_default=False,
        help="Formula in T, T1, T2, T3, R, Q, P1 ... and constants that multiply them, or the name "
        f"of a theory: {', '.join(THEORIES)}.",
    ),
]
ConstantsOption = Annotated[
    str,
    typer.Option(
        "--constants",
        metavar="NAMES",
        show_default=False,
        help='Other constants in the formula, such as "n v" for T**n + v. Lambda needs none.',
    ),
]
ConnectionOption = Annotated[
    list[Over] | None,
    typer.Option(
        "--connection",
        "-c",
        help="own: of the space, or Cartan if it has none. May be repeated; with several, names of "
        "the Levi-Civita connection end in bar.",
        show_default=False,
    ),
]


def model_of(source: str) -> Model | None:
    """The theory in a file, if there is one."""
    path = Path(source)
    if source in names() or not path.exists():
        return None
    return gravity.read_model(path) if "theory" in read_toml(path).data else None


def field_equations(
    space: Space, lagrangian: str, connections: Sequence[Over] | None, constants: str = ""
) -> FieldEquations:
    """The field equations of a Lagrangian or of a named theory on a space."""
    theory = getattr(gravity, lagrangian) if lagrangian in THEORIES else lagrangian
    chosen = connections or [Over.levi_civita if lagrangian in RIEMANNIAN else Over.own]
    own = [_connection(space, one) for one in chosen]
    return gravity.equations(own, theory, constants=constants)


def _connection(space: Space, over: Over) -> Connection:
    """A connection of a space."""
    if over is Over.levi_civita:
        return levi_civita(space.frame)
    if over is Over.own and space.connection is not None:
        return space.connection
    return cartan(space.frame)
