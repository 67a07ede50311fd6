"""Custom: any moment, force, state, energy or quantity that a user writes down."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import sympy as sp

from geomtorsion.errors import ExpressionError, SceneError
from geomtorsion.ode import Table
from geomtorsion.scenes.body import Expression, Number
from geomtorsion.scenes.context import Context
from geomtorsion.scenes.effects.fields import check_vectors, read, read_three
from geomtorsion.scenes.effects.protocol import Contribution, Effect, Switch, unit
from geomtorsion.support import checks


@dataclass(frozen=True)
class Custom(Effect):
    """User-defined effect, written as expressions, which a restricted parser reads.

    Expressions may contain t, Omega1..3, n1..3 (upwards, seen from the body), R11..R23, q0..q3,
    x, y, z, vx, vy, vz, m, I1..3, and the names of `parameters` and `states`.

    Parameters
    ----------
    moment
        three expressions, body axes, N m.
    force
        three expressions, N, in the axes that `axes` names.
    axes
        "space" or "body": the axes of the force.
    parameters
        name -> number; a sweep or another start changes them without new equations.
    states
        name -> rate, for states of its own (a tank, a current, a controller).
    start
        name of such a state -> value at the start.
    energy
        potential or other stored energy, J. Without it, the power of torque and force counts as
        work done on the body.
    power
        input of power, W, if it differs from torque . Omega + force . velocity.
    outputs
        name -> expression, or three: further quantities to watch.
    switches
        (time, {parameter: value}) pairs: parameters change at exact times.
    stop
        the motion stops where this expression falls through zero.
    tables
        name -> `gt.Table`, its rows (place, value), a file of two columns, or a table with rows,
        interpolation and outside: functions in the expressions, such as "torque(t)".

    Raises
    ------
    SceneError
        a vector is not of three components, a state has no start or the reverse, axes or a
        switched name is unknown.
    ExpressionError
        an expression cannot be read, holds an unknown name, or is code.

    Examples
    --------
    >>> wire = Custom(moment=(0, 0, "-k*angle"), parameters={"k": 2.0},
    ...               states={"angle": "Omega3"}, start={"angle": 0.1}, energy="k*angle**2/2")
    >>> sorted(wire.needs())
    ['omega']
    """

    key: ClassVar[str] = "custom"
    title: ClassVar[str] = "effect of the user's own"
    several: ClassVar[bool] = True

    moment: Sequence[Expression] = field(default=(0, 0, 0), metadata=unit("N m"))
    force: Sequence[Expression] = field(default=(0, 0, 0), metadata=unit("N"))
    axes: str = "space"
    parameters: Mapping[str, Number] = field(default_factory=dict)
    states: Mapping[str, Expression] = field(default_factory=dict)
    start: Mapping[str, Number] = field(default_factory=dict)
    energy: Expression | None = None
    power: Expression | None = None
    outputs: Mapping[str, Expression | Sequence[Expression]] = field(default_factory=dict)
    switches: Sequence[Switch] = ()
    stop: Expression | None = None
    tables: Mapping[str, object] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check vectors, words and that states and starts agree."""
        check_vectors(self, "moment", "force")
        checks.choice(self.axes, ("space", "body"), "custom.axes", SceneError)
        for name in ("parameters", "states", "start", "outputs", "tables"):
            value, kind = getattr(self, name), "a table of names"
            checks.instance(value, Mapping, f"custom.{name}", SceneError, expected=kind)
        lost = set(self.states) ^ set(self.start)
        if lost:
            raise SceneError(
                f"custom: expected {', '.join(sorted(lost))} in both states and start, got it in "
                "one. Every state needs a rate and a start value."
            )
        object.__setattr__(self, "switches", _checked_switches(self.switches, self.parameters))
        tables = {name: _written(_table(name, value)) for name, value in self.tables.items()}
        object.__setattr__(self, "tables", tables)

    def adds(self, context: Context) -> Contribution:
        """The terms of the expressions, in symbols."""
        own = self._names(context)
        functions = {name: _table(name, value).function for name, value in self.tables.items()}

        def expression(value: Expression, what: str) -> sp.Expr:
            return read(value, context, what, f"{self.called(context)}.{what}", own, functions)

        def optional(value: Expression | None, what: str) -> sp.Expr | None:
            return None if value is None else expression(value, what)

        called = self.called(context)
        moment = read_three(self.moment, context, "M", f"{called}.moment", own, functions)
        force = read_three(self.force, context, "F", f"{called}.force", own, functions)
        if self.axes == "body":
            force = context.in_space(force)
        outputs = {
            name: tuple(expression(v, name) for v in value)
            if isinstance(value, Sequence) and not isinstance(value, str)
            else expression(value, name)
            for name, value in self.outputs.items()
        }
        return Contribution(
            moment=tuple(moment) if any(moment) else None,
            force=tuple(force) if any(force) else None,
            states={str(own[k]): expression(v, k) for k, v in self.states.items()},
            start=dict(self.start),
            energy=optional(self.energy, "energy"),
            power=optional(self.power, "power"),
            outputs=outputs,
            # The context may have given a parameter another name, where its own was taken.
            switches=tuple(
                (time, {str(own[name]): value for name, value in changes.items()})
                for time, changes in self.switches
            ),
            stop=optional(self.stop, "stop"),
        )

    def _names(self, context: Context) -> dict[str, sp.Expr]:
        """Name -> symbol (or 0) of the parameters and states of its own."""
        switched = {name for _, changes in self.switches for name in changes}
        own: dict[str, sp.Expr] = {}
        for name, value in self.parameters.items():
            # What a switch changes keeps its symbol even where it is 0 at first.
            make = context.switchable if name in switched else context.parameter
            own[name] = make(name, value)
        return own | {name: context.state(name) for name in self.states}


def _table(name: str, value: object) -> Table:
    """A table as it is, or from rows, a file, or a mapping with its fields."""
    options: dict[str, Any] = {}
    if isinstance(value, Mapping):
        kind = "rows, interpolation or outside"
        options = checks.known_keys(
            value, ("rows", "interpolation", "outside"), "custom.tables", SceneError, expected=kind
        )
        value = options.pop("rows", None)
    try:
        return value if isinstance(value, Table) else Table.of(value, **options)
    except ExpressionError as error:
        raise SceneError(f"custom.tables: {name}: {error}") from None


def _written(table: Table) -> object:
    """A table as files write it: rows, with the names of its rules where they are not the usual."""
    rows = tuple(zip(table.places.tolist(), table.values.tolist(), strict=True))
    if table == Table.of(rows):
        return rows
    return {"rows": rows, "interpolation": table.interpolation, "outside": table.outside}


def _checked_switches(
    switches: Sequence[Switch], parameters: Mapping[str, Number]
) -> tuple[Switch, ...]:
    """Pairs of a time and parameters to change."""
    pairs, subject, kind = [], "custom.switches", "a parameter of the effect"
    for each in switches:
        pair = checks.entries(each, subject, SceneError, 2, expected="(time, {name: value})")
        changes = checks.known_keys(pair[1], parameters, subject, SceneError, expected=kind)
        pairs.append((pair[0], changes))
    return tuple(pairs)
