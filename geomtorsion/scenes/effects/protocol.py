"""Protocol: what an effect is given, and what it adds to the equations."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Any, ClassVar

import sympy as sp

from geomtorsion.scenes.body import Body, Number
from geomtorsion.scenes.context import GROUPS, Context
from geomtorsion.scenes.effects.surroundings import Surroundings

Triple = tuple[sp.Expr, sp.Expr, sp.Expr] | tuple[sp.Expr, ...]
# Time, and the new values of parameters or states.
Switch = tuple[Number, Mapping[str, Number]]


@dataclass(frozen=True)
class Constraint:
    """Constraint linear in the velocities: it expresses the motion by fewer speeds.

    The equations are projected on the speeds that remain (d'Alembert, Kane), so that forces of
    constraint never appear.

    speeds: names of the states that remain: "Omega1".."Omega3" or names of the effect's own.
    omega: body angular velocity, body axes (rad/s), linear in the speeds.
    velocity: velocity of the centre of mass, in BODY axes (m/s), linear in the speeds; may depend
        on the attitude or the vertical.
    position: of the centre of mass, space axes (m), where the constraint fixes it; components
        that follow from the velocity are the symbols themselves. None: all of them.
    arm: from a point that is fixed in space to the centre of mass, body axes (m); angular momentum
        then counts about that point. None: about the centre of mass.
    start: speeds of the effect's own -> value at the start.

    Examples
    --------
    A point `arm` away from the centre of mass is held: velocity = Omega x arm, and
    position = R arm. A ball rolls: velocity = Omega x (radius * vertical).
    """

    speeds: tuple[str, ...]
    omega: Triple
    velocity: Triple
    position: Triple | None = None
    arm: Triple | None = None
    start: Mapping[str, Number] = field(default_factory=dict)


@dataclass(frozen=True)
class Contribution:
    """Terms that one effect adds to the equations of a body; each is zero by default.

    moment: torque about the centre of mass, body axes (N m).
    force: force at the centre of mass, space axes (N). If a constraint ties the centre of mass
        to the rotation, the torque of the force is computed.
    momentum: internal angular momentum, body axes (N m s), added to I Omega (a rotor); the
        resulting torque, -Omega x h - h', is computed.
    inertia: 3 x 3, added to the body's inertia tensor (kg m^2).
    states, start: states of its own -> rate, and -> value at the start.
    energy: energy stored in it (J): potentials, energy of rotors.
    power: input of power (W; negative for drag). None: if energy is given, its explicit change with
        time (0 unless it contains t), else torque . Omega + force . velocity.
    outputs: further quantities that can be watched -> expression or several.
    switches: ((time, {name: value}), ...): parameters (as `context.parameter` named them) or
        states that change at exact times.
    constraint: on the velocities; None for an effect that is not a constraint.
    replaces: state -> rate, instead of the derived rate: for laws outside of mechanics.
    stop: the motion stops where this falls through zero.
    naive: whether Omega x L is omitted from the equations, L the whole angular momentum.
    """

    moment: Triple | None = None
    force: Triple | None = None
    momentum: Triple | None = None
    inertia: Sequence[Sequence[sp.Expr]] | None = None
    states: Mapping[str, sp.Expr] = field(default_factory=dict)
    start: Mapping[str, Number] = field(default_factory=dict)
    energy: sp.Expr | None = None
    power: sp.Expr | None = None
    outputs: Mapping[str, sp.Expr | Sequence[sp.Expr]] = field(default_factory=dict)
    switches: tuple[Switch, ...] = ()
    constraint: Constraint | None = None
    replaces: Mapping[str, sp.Expr] = field(default_factory=dict)
    stop: sp.Expr | None = None
    naive: bool = False


@dataclass(frozen=True)
class Effect:
    """Interface of an effect: a frozen dataclass whose fields are numbers with units (`unit`).

    key: its name in files and dotted paths ("gravity").
    title: one line for tables.
    several: whether a scene may have more than one of the kind.
    excludes: keys of effects that contradict it.
    wrong: whether it is a wrong law, shipped for comparison; drifts then measure the quantities
        that the right law keeps.

    Examples
    --------
    >>> from geomtorsion.scenes.effects import Gravity
    >>> Gravity.key, Gravity.units(), sorted(Gravity(9.81).needs())
    ('gravity', {'g': 'm/s^2'}, ['position'])
    """

    key: ClassVar[str] = ""
    title: ClassVar[str] = ""
    several: ClassVar[bool] = False
    excludes: ClassVar[frozenset[str]] = frozenset()
    wrong: ClassVar[bool] = False

    def adds(self, context: Context) -> Contribution:
        """Terms that it adds to the equations, in the symbols of the context."""
        raise NotImplementedError

    def called(self, context: Context) -> str:
        """Name in errors and outputs: the key, numbered if a scene has several of the kind."""
        return context.key or self.key

    def needs(self, body: Body | None = None) -> frozenset[str]:
        """Groups of states that its contribution depends on, read off the expressions.

        Some of "omega", "vertical", "attitude", "position", "velocity", "time".
        """
        context = Context(body or Body(mass=1.0, moments=(2, 3, 4)))
        return groups_in(context, self.adds(context))

    @classmethod
    def typical(cls, body: Body, surroundings: Surroundings) -> Typical | None:
        """The effect with numbers that follow from body and surroundings; None if none follow."""
        return None

    @classmethod
    def units(cls) -> dict[str, str]:
        """Field -> unit (SI); "" for pure numbers; other fields are omitted."""
        return {item.name: item.metadata["unit"] for item in fields(cls) if "unit" in item.metadata}


@dataclass(frozen=True)
class Typical:
    """An effect with numbers that follow from the body and its surroundings.

    effect: with its numbers; formula: how they follow; assumption: when it holds.
    at_surface: whether it acts at the surface of the planet, and not only on an orbit.
    """

    effect: Effect
    formula: str
    assumption: str
    at_surface: bool = True


def unit(text: str) -> dict[str, str]:
    """Metadata of a dataclass field whose numbers are in this unit: field(metadata=unit("m"))."""
    return {"unit": text}


def groups_in(context: Context, contribution: Contribution) -> frozenset[str]:
    """Groups of states that occur in a contribution, except in its outputs."""
    symbols = symbols_in(replace(contribution, outputs={}))
    own = {name for name, members in GROUPS.items() if members & symbols}
    # Who has the whole attitude has the vertical with it.
    return frozenset(own - {"vertical"} if "attitude" in own else own)


def symbols_in(thing: Any) -> set[sp.Symbol]:
    """All symbols in expressions, however they are nested in dataclasses, mappings, sequences."""
    parts: Iterable[object] = ()
    if isinstance(thing, sp.Basic | sp.MatrixBase):
        return set(thing.free_symbols)
    if isinstance(thing, Mapping):
        parts = thing.values()
    elif is_dataclass(thing):
        parts = [getattr(thing, item.name) for item in fields(thing)]
    elif isinstance(thing, tuple | list):
        parts = thing
    return set().union(*map(symbols_in, parts))
