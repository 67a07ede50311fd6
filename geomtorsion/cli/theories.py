"""theories: a Lagrangian and connections of a space, from options of the command line."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from geomtorsion import gravity
from geomtorsion.cli.options import option
from geomtorsion.cli.values import assigned
from geomtorsion.geometry import Connection, cartan, from_torsion, levi_civita
from geomtorsion.gravity import (
    FieldEquations,
    Lagrangian,
    Model,
    maxwell,
    scalar_field,
)
from geomtorsion.gravity.theory.matter import MatterField
from geomtorsion.gravity.theory.vocabulary import THEORIES
from geomtorsion.spaces import Space, names
from geomtorsion.support.files import read_toml
from geomtorsion.support.typed_text import separated


class Over(StrEnum):
    """The connection from which the Lagrangian is built."""

    own = "own"
    cartan = "cartan"
    levi_civita = "levi-civita"
    invariant = "invariant"
    invariant_torsion = "invariant-torsion"


LagrangianOption = Annotated[
    str | None,
    option(
        "-L",
        "--lagrangian",
        metavar="TEXT",
        text="Formula in T, T1, T2, T3, R, Q, P1 ..., contractions such as R_ab R^ab, and "
        f"constants that multiply them, the name of a theory ({', '.join(THEORIES)}), or a theory "
        "file (.toml).",
    ),
]
ConstantsOption = Annotated[
    str,
    option(
        "--constants",
        metavar="NAMES",
        text='Other constants in the formula, such as "n v" for T**n + v. Lambda needs none.',
    ),
]
InvariantOption = Annotated[
    list[str] | None,
    option(
        "--invariant",
        metavar="NAME=FORMULA",
        text='An invariant with indices for the formula, such as "Y = R_abcd R^abdc". May be '
        "repeated.",
    ),
]
ScalarNames = Annotated[
    str, option("--scalars", metavar="NAMES", text='Scalar fields, such as "phi chi".')
]
Couplings = Annotated[
    list[str] | None,
    option("--set", metavar="NAME=VALUE", text="Value of a coupling. May be repeated."),
]
ScalarOption = Annotated[
    list[str] | None,
    option(
        "--scalar",
        metavar="NAME=VALUE",
        text='A scalar field, such as "phi = u(t)", for X, phi and phi_a in the formula. May be '
        "repeated.",
    ),
]
MaxwellOption = Annotated[
    list[str] | None,
    option(
        "--maxwell",
        metavar="A,A,...",
        text='Potential of a Maxwell field, such as "q/r, 0, 0, 0", for F2, F_ab and A_a in the '
        "formula. May be repeated.",
    ),
]
ConnectionOption = Annotated[
    list[Over] | None,
    typer.Option(
        "--connection",
        "-c",
        help="own: of the space, or Cartan if it has none. invariant: the most general connection "
        "that all Killing vectors keep, with unknown functions u1, u2 ...; invariant-torsion: the "
        "most general metric one. May be repeated; with several, names of the Levi-Civita "
        "connection end in bar.",
        show_default=False,
    ),
]


def model_of(source: str) -> Model | None:
    """The theory in a file, if there is one."""
    path = Path(source)
    if source in names() or not path.exists():
        return None
    return gravity.read_model(path) if "theory" in read_toml(path).data else None


def invariants_of(texts: Sequence[str] | None) -> list[gravity.Invariant]:
    """Invariants with indices, as typed: NAME=FORMULA."""
    named = [assigned(one, "--invariant", "Y = R_abcd R^abdc") for one in texts or ()]
    return [gravity.invariant(name, formula) for name, formula in named]


def theory_of(lagrangian: str) -> Lagrangian | str:
    """A named theory, the theory in a file, or the formula itself."""
    if lagrangian.endswith(".toml"):
        return gravity.read_theory(lagrangian)
    return getattr(gravity, lagrangian) if lagrangian in THEORIES else lagrangian


def field_equations(
    space: Space,
    lagrangian: str,
    connections: Sequence[Over] | None,
    constants: str = "",
    invariants: Sequence[str] | None = None,
    scalars: Sequence[str] | None = None,
    potentials: Sequence[str] | None = None,
) -> FieldEquations:
    """The field equations of a Lagrangian, of a named theory or of a theory file on a space."""
    theory = theory_of(lagrangian)
    riemannian = isinstance(theory, Lagrangian) and theory.geometry == "riemannian"
    chosen = connections or [Over.levi_civita if riemannian else Over.own]
    own = [connection_of(space, one) for one in chosen]
    return gravity.equations(
        own,
        theory,
        matter_of(scalars, potentials),
        constants=constants,
        invariants=invariants_of(invariants),
    )


def matter_of(scalars: Sequence[str] | None, potentials: Sequence[str] | None) -> list[MatterField]:
    """Scalar and Maxwell fields, as typed."""
    fields = [assigned(one, "--scalar", "phi = u(t)") for one in scalars or ()]
    return [
        *(scalar_field(value, None if name == "phi" else name) for name, value in fields),
        *(maxwell(separated(one)) for one in potentials or ()),
    ]


def connection_of(space: Space, over: Over) -> Connection:
    """A connection of a space."""
    if over is Over.levi_civita:
        return levi_civita(space.frame)
    if over is Over.invariant:
        return gravity.invariant_connection(space.frame)
    if over is Over.invariant_torsion:
        return from_torsion(space.frame, gravity.invariant_torsion(space.frame))
    if over is Over.own and space.connection is not None:
        return space.connection
    return cartan(space.frame)
