"""Model: a theory, matter and a start in the file of a space."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from typing import Any

from geomtorsion.errors import FileFormatError
from geomtorsion.geometry import Connection, Frame, cartan, from_torsion, levi_civita
from geomtorsion.gravity.motion.boundary import Shooting, shoot
from geomtorsion.gravity.motion.solving import solve
from geomtorsion.gravity.reduced.reduction import Reduction
from geomtorsion.gravity.theory.field_equations import FieldEquations, equations
from geomtorsion.gravity.theory.fluids import Fluid, fluid
from geomtorsion.gravity.theory.invariance import invariant_connection, invariant_torsion
from geomtorsion.gravity.theory.matter import MatterField, maxwell, scalar_field
from geomtorsion.gravity.theory.theory_files import invariants_of
from geomtorsion.ode import Solution, When
from geomtorsion.spaces import Space, read_file
from geomtorsion.support import checks
from geomtorsion.support.files import Decimal, read_toml

CONNECTIONS: dict[str, Callable[[Frame], Connection]] = {
    "cartan": cartan,
    "levi-civita": levi_civita,
    "invariant": invariant_connection,
    "invariant-torsion": lambda frame: from_torsion(frame, invariant_torsion(frame)),
}
TEXTS = ("lagrangian", "connection", "constants", "scalar", "end")
TABLES = ("start", "parameters", "near", "outputs", "boundary", "fluid", "invariants")
KEYS = (*TEXTS, *TABLES, "potential", "conditions", "free", "origin")
FLUID = ("density", "pressure")


@dataclass(frozen=True, eq=False, repr=False)
class Model:
    """Contents of a theory file: a space, field equations, and start values.

    space: with unknown functions. equations: of the theory. conditions: further equations.
    start, parameters, near, origin, outputs: as for `gravity.solve`.
    end: the solution stops when this expression falls to zero; "": at the last time.
    boundary, free: boundary values elsewhere, as for `gravity.shoot`; may be empty.
    """

    space: Space
    equations: FieldEquations
    conditions: Sequence[str]
    start: Mapping[str, object]
    parameters: Mapping[str, object]
    near: Mapping[str, object]
    outputs: Mapping[str, object]
    origin: object = 0
    end: str = ""
    boundary: Mapping[str, object] = field(default_factory=dict)
    free: Sequence[str] = ()

    def __repr__(self) -> str:
        return f"{self.space.name}: {self.equations!r}"

    def reduce(self, variable: str) -> Reduction:
        """The first-order equations and constraints of the model; see `FieldEquations.reduce`."""
        return self.equations.reduce(variable, self.conditions)

    def solve(self, variable: str, last: object, accuracy: float = 1e-10) -> Solution:
        """The solution from the start of the file to a last value of the variable.

        Raises
        ------
        GravityError, StartError
            as for `gravity.solve`.
        """
        numbers = self._numbers(accuracy)
        return solve(self.equations, variable, last, conditions=self.conditions, **numbers)

    def shoot(self, variable: str, last: object, accuracy: float = 1e-10) -> Shooting:
        """The solution that has the boundary values of the file at the last value of the variable.

        Raises
        ------
        GravityError, StartError, EndpointError
            as for `gravity.shoot`.
        """
        demands = {"boundary": self.boundary, "free": self.free}
        return shoot(self.reduce(variable), variable, last, **self._numbers(accuracy), **demands)

    def _numbers(self, accuracy: float) -> dict[str, Any]:
        """The start and what belongs to it, as arguments."""
        return {
            "start": self.start,
            "parameters": self.parameters,
            "near": self.near,
            "origin": self.origin,
            "outputs": self.outputs,
            "events": [When(self.end)] if self.end else [],
            "accuracy": accuracy,
        }


def read_model(path: str | PathLike[str]) -> Model:
    """Read a theory and its start from a tetrad file with a table [theory].

    Keys of [theory]
    ----------------
    lagrangian
        Text, as for `gravity.equations`. constants: names of other constants in it.
    connection
        "cartan", "levi-civita", "invariant" or "invariant-torsion", the most general connection or
        torsion with the symmetry of the metric; by default the connection of the file, or Cartan's.
    invariants
        Table name -> formula with indices, as of `invariant`: {Y = "R_abcd R^abdc"}.
    fluid
        {density = "rho(t)", pressure = "rho(t)/3"}: a perfect fluid at rest.
    scalar, potential
        A scalar field "phi(t)", whose names in the Lagrangian are X and phi; the components A_mu of
        a Maxwell field.
    conditions
        Further equations, ["N = 1"].
    start, parameters, near, outputs
        Tables as for `gravity.solve`; origin: the value of the variable at the start.
    end
        The solution stops when this expression falls to zero.
    boundary, free
        Values required at the end or at infinity, {"phi(oo)" = 0}, and the names of the numbers of
        the start or the parameters that follow from them, ["A"]; as for `gravity.shoot`.

    Raises
    ------
    FileFormatError
        The table [theory] is missing, or has an unknown key or a value of the wrong kind.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> text = '''
    ... coordinates = ["t", "x", "y", "z"]
    ... coframe = [[1, 0, 0, 0], [0, "a(t)", 0, 0], [0, 0, "a(t)", 0], [0, 0, 0, "a(t)"]]
    ... signature = [-1, 1, 1, 1]
    ... functions = {a = ["t"]}
    ... [theory]
    ... lagrangian = "R/2"
    ... connection = "levi-civita"
    ... fluid = {density = "rho(t)", pressure = 0}
    ... start = {a = 1, rho = 3}
    ... near = {a_1 = 1}
    ... '''
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "dust.toml")
    ...     _ = file.write_text(text)
    ...     model = read_model(file)
    >>> round(float(model.solve("t", 10)["a"][-1]), 9)
    6.349604208
    """
    path = checks.file_name(path)
    file = read_toml(path, decimals=True)
    data = file.data
    space = read_file(path)
    table = data.get("theory")
    if not isinstance(table, dict):
        raise FileFormatError(
            f"{path.name}: expected a table [theory] with a lagrangian, got none. Write [theory] "
            'below all other keys, and below it lagrangian = "R".'
        )
    _check(path.name, table)
    frame = space.frame
    connection = _connection(space, str(table.get("connection", "")), path.name)
    constants = str(table.get("constants", ""))
    theory = equations(
        connection,
        table["lagrangian"],
        _matter(frame, table),
        constants=constants,
        invariants=invariants_of(file, table),
    )
    named = {name: _numbers(table.get(name, {})) for name in TABLES[:5]}
    return Model(
        space,
        theory,
        tuple(table.get("conditions", ())),
        **named,
        origin=_number(table.get("origin", 0)),
        end=str(table.get("end", "")),
        free=tuple(table.get("free", ())),
    )


def _check(file: str, table: Mapping[str, object]) -> None:
    """Refuse unknown keys, and values of the wrong kind."""
    for key, value in table.items():
        if key not in KEYS:
            raise FileFormatError(
                f"{file}: theory: unknown key {checks.shown(key)}. "
                f"{checks.did_you_mean(key, KEYS)}Known are {', '.join(KEYS)}."
            )
        kind, words = (
            (str, "text in quotes")
            if key in TEXTS
            else (dict, "a table")
            if key in TABLES
            else (list, "a list")
            if key != "origin"
            else (str | int, "a number")
        )
        if not isinstance(value, kind):
            raise FileFormatError(
                f"{file}: theory: {key}: expected {words}, got {checks.shown(value)}."
            )
    if "lagrangian" not in table:
        raise FileFormatError(
            f'{file}: theory: expected a lagrangian, got none. Write lagrangian = "R".'
        )
    matter = table.get("fluid", {})
    if isinstance(matter, dict) and matter and sorted(matter) != sorted(FLUID):
        raise FileFormatError(
            f"{file}: theory: fluid: expected density and pressure, got {', '.join(matter)}. Write "
            'fluid = {density = "rho(t)", pressure = 0}.'
        )


def _connection(space: Space, name: str, file: str) -> Connection:
    """The connection by its name, of the space, or Cartan's."""
    if not name:
        return space.connection if space.connection is not None else cartan(space.frame)
    words = tuple(CONNECTIONS)
    return CONNECTIONS[checks.choice(name, words, f"{file}: theory: connection", FileFormatError)](
        space.frame
    )


def _matter(frame: Frame, table: Mapping[str, Any]) -> list[MatterField | Fluid]:
    """The fluid and the fields of a file."""
    matter: list[MatterField | Fluid] = []
    if table.get("fluid"):
        density, pressure = (_number(table["fluid"][name]) for name in FLUID)
        matter.append(fluid(density, pressure, _at_rest(frame)))
    if "scalar" in table:
        matter.append(scalar_field(table["scalar"]))
    if "potential" in table:
        matter.append(maxwell([_number(one) for one in table["potential"]]))
    return matter


def _at_rest(frame: Frame) -> list[int]:
    """The leg with a sign of its own, which is along time."""
    eta, legs = frame.eta.components.get, range(frame.dimension)
    signs = [eta((leg, leg)).as_fraction() for leg in legs]
    return [int(signs.count(sign) == 1) for sign in signs]


def _numbers(table: Mapping[str, Any]) -> dict[str, Any]:
    return {name: _number(value) for name, value in table.items()}


def _number(value: Any) -> Any:
    """Text for a decimal number; other values unchanged."""
    return str(value) if isinstance(value, Decimal) else value
