"""Forces: a law of motion with forces and potentials, projected on the permitted legs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TypeAlias

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.codegen import Products
from geomtorsion.curves.equations import Geodesic, Law, Rates, velocity_names
from geomtorsion.curves.kinetic import raising
from geomtorsion.errors import ArgumentError, ChartEdgeError, ExpressionError, ShapeError
from geomtorsion.exact import Element, Field, parse_expression
from geomtorsion.geometry import Connection, Frame
from geomtorsion.geometry.domain_edges import Edge
from geomtorsion.ode.pieces import ends, pieces, without_kinks, without_piecewise
from geomtorsion.ode.rates import CLOCK
from geomtorsion.ode.terms import KINKED
from geomtorsion.support import checks

FORCE = "force of the problem"
POTENTIAL = "force of a potential"
# Names of the curve parameter in a force: the first that no coordinate or parameter has.
TIMES = ("t", "tau", "lambda_")
# Places in a message and expressions.
Row: TypeAlias = list[tuple[str, sp.Expr]]


@dataclass(frozen=True, eq=False)
class Force:
    """One of the forces on a motion.

    name: its key. acceleration: F^k in the frame, one for each leg; zero along forbidden legs.
    potential: V with F_k = -E_k(V), zero for a force that never does work, or None.
    is_potential: whether it was given by its potential.
    """

    name: str
    acceleration: tuple[Element, ...]
    potential: Element | None = field(default=None, repr=False)
    is_potential: bool = False

    @property
    def content(self) -> tuple[object, ...]:
        """Name and expressions."""
        terms = (*self.acceleration, self.potential)
        return self.name, *(None if x is None else x.sympy for x in terms)


@dataclass(frozen=True, eq=False)
class Forced:
    """A law with accelerations that depend on position, velocity and time.

    law: the law without the forces.
    frame: the frame in whose coordinates the forces are given.
    forces: at least one.
    field: of their elements; the field of the frame where they depend on its symbols only.
    parameters: symbols that occur only in the forces.
    clock: name of the curve parameter where a force depends on it; empty otherwise.
    edges: where roots change the signs with which they were read in the forces.
    """

    law: Law
    frame: Frame
    forces: tuple[Force, ...]
    field: Field
    parameters: tuple[sp.Symbol, ...] = ()
    clock: str = ""
    edges: tuple[Edge, ...] = ()

    needs_frame = needs_chart = True
    is_quadratic = False

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Forced):
            return NotImplemented
        if (self.law, self.frame, self.clock) != (other.law, other.frame, other.clock):
            return False
        return self.content == other.content

    def __hash__(self) -> int:
        return hash((self.law, self.frame))

    @property
    def content(self) -> tuple[object, ...]:
        """Expressions of all forces, and where they hold."""
        return *(x.content for x in self.forces), *(edge.condition for edge in self.edges)

    @property
    def acceleration(self) -> tuple[Element, ...]:
        """F^k of all forces together, one for each leg."""
        columns = zip(*(one.acceleration for one in self.forces), strict=True)
        return tuple(self.field.sum([(1, x) for x in column]) for column in columns)

    @property
    def potential(self) -> Element | None:
        """V of all forces together; None if one of them has none, or it changes with time."""
        heights = [one.potential for one in self.forces if one.potential is not None]
        if len(heights) < len(self.forces):
            return None
        total = self.field.sum([(1, x) for x in heights])
        return None if any(symbol.name == self.clock for symbol in total.symbols) else total

    @property
    def unknown(self) -> str:
        """Name of a function in the forces without values (pieces or a table); else empty."""
        terms = (x.sympy for x in self.acceleration)
        names = {str(part.func) for term in terms for part in term.atoms(AppliedUndef)}
        return min(names, default="")

    @property
    def text(self) -> str:
        """The equation in one line."""
        return f"{self.law.text} + F^k".replace("= 0 +", "=")

    @property
    def effects(self) -> Mapping[str, str]:
        """Effects of the law, and each force."""
        words = {x.name: POTENTIAL if x.is_potential else FORCE for x in self.forces}
        return {**self.law.effects, **words}

    def without(self, effects: frozenset[str]) -> Law:
        """The law without some effects; with no force left, the law that remains."""
        law = self.law.without(effects)
        forces = tuple(one for one in self.forces if one.name not in effects)
        if not forces:
            return law
        return replace(self, law=law, forces=forces)

    def rates(self, frame: Frame, names: Sequence[str]) -> Rates | None:
        """The rates of the law, and the acceleration."""
        if frame is not self.frame:
            raise ChartEdgeError(
                "the force is given in one chart only, and the motion leaves it. Choose a start "
                "farther from its edge, or a shorter time."
            )
        free = self.law.rates(frame, names)
        rows = ((),) * frame.dimension if free is None else free.products
        acceleration = self.acceleration
        pushed = [
            (*row, *(() if value.is_zero else ((value, ()),)))
            for row, value in zip(rows, acceleration, strict=True)
        ]
        used = {symbol.name for value in acceleration for symbol in value.symbols}
        clock = self.clock if self.clock in used else ""
        return Rates(tuple(pushed), {} if free is None else free.constants, clock)

    def invariants(self, frame: Frame, names: Sequence[str]) -> dict[str, Products]:
        """The energy, where there is a potential."""
        kept, height = self.law.invariants(frame, names), self.potential
        square = kept.get("norm") or kept.get("energy")
        if square is None or height is None:
            return {}
        halves = tuple((value * frame.field.rational(1, 2), which) for value, which in square)
        return {"energy": (*halves, (height, ()))}


@dataclass(frozen=True, eq=False)
class _Setting:
    """What a force may depend on.

    frame: its coordinates and parameters. velocities: names of u^i, u^i = e^i_mu q'^mu.
    time: name of the curve parameter. parameters: names of the values that were given.
    """

    frame: Frame
    velocities: tuple[str, ...]
    time: str
    parameters: tuple[str, ...]

    @property
    def own(self) -> dict[str, sp.Symbol]:
        """Symbols of the frame by name."""
        return {symbol.name: symbol for symbol in self.frame.field.symbols}

    @property
    def symbols(self) -> dict[str, sp.Symbol]:
        """All symbols by name; the frame has precedence."""
        more = (*self.velocities, self.time, *self.parameters)
        return {name: sp.Symbol(name, real=True) for name in more} | self.own

    def words(self, *, moving: bool) -> str:
        """Names in a sentence."""
        coordinates = ", ".join(symbol.name for symbol in self.frame.coordinates)
        known = {symbol.name for symbol in self.frame.coordinates}
        names = dict.fromkeys((*self.own, *self.parameters))
        others = ", ".join(name for name in names if name not in known)
        text = f"Use the coordinates {coordinates}"
        if moving:
            text += f", the velocities {', '.join(self.velocities)} along the legs"
        text += f", the curve parameter {self.time}"
        text += f", the parameters {others}" if others else ""
        return f"{text}, or give a parameter its value: parameters={{'name': 1}}."

    def read(self, where: str, value: object, *, moving: bool) -> sp.Expr:
        """An expression over `symbols`; other symbols of sympy become parameters."""
        table = self.symbols
        if not moving:
            table = {k: x for k, x in table.items() if k in self.own or k not in self.velocities}
        reader = partial(
            parse_expression, symbols=table, functions=KINKED, where=where,
            unknown=self.words(moving=moving), undeclared=True,
        )  # fmt: skip
        read = self._in_pieces(checks.expression(value, where, read=reader), where)
        # A parameter keeps the assumptions of the user's symbol.
        bound = {x: table[x.name] for x in read.free_symbols if x.name in table}
        read = read.xreplace({x: y for x, y in bound.items() if y.name not in self.parameters})
        if not moving and {x.name for x in read.free_symbols} & {*self.velocities} - {*self.own}:
            raise ExpressionError(
                f"{where}: expected a function of position and time, got {checks.shown(value)}, "
                "which depends on the velocity. Give it as a force."
            )
        return read

    def _in_pieces(self, expr: sp.Expr, where: str) -> sp.Expr:
        """Kinks and pieces as a function of the name `pieces`, which `to_ode` reads."""
        moving = {*self.velocities, self.time, *(x.name for x in self.frame.coordinates)}
        # A parameter has one sign in a motion, which the field states as a branch.
        fixed = {
            x: sp.Dummy(real=True)
            for x in expr.atoms(sp.Abs)
            if not moving & {symbol.name for symbol in x.free_symbols}
        }
        whole = without_kinks(without_piecewise(expr.xreplace(fixed), where))
        for kind in (pieces, ends):
            whole = whole.replace(kind, sp.Function(kind.__name__))
        return whole.xreplace({dummy: x for x, dummy in fixed.items()})

    def field(self, entries: Iterable[sp.Expr]) -> tuple[Field, tuple[sp.Symbol, ...], str]:
        """The field of some expressions, the parameters that only they have, and their clock.

        Signs with which roots are read hold for these expressions only, not for the frame.
        """
        frame, own = self.frame, set(self.frame.field.symbols)
        entries = list(entries)
        used = {x for one in entries for x in one.free_symbols} - own
        if not used and not any(map(_has_branches, entries)):
            return frame.field, (), ""
        new = sorted(used, key=lambda symbol: symbol.name)
        clock = self.time if any(x.name == self.time for x in new) else ""
        constant = tuple(x for x in new if x.name not in {*self.velocities, clock})
        return frame.field.exact.with_symbols(new), constant, clock


def forced(
    law: Law,
    connection: Connection | Frame,
    force: object,
    potential: object,
    parameters: Iterable[str] = (),
) -> Law:
    """The law with forces F_k and potentials V; one each, or by name.

    parameters: names that have a value.

    Raises
    ------
    ShapeError
        A force does not have one component for each leg.
    ExpressionError
        A name in it is unknown, or a potential depends on a velocity.
    ArgumentError
        A name is empty, occurs twice, or is an effect of the law.
    """
    named = _by_name(law, force, potential)
    if not named:
        return law
    frame = connection if isinstance(connection, Frame) else connection.frame
    setting = _setting(frame, parameters)
    rows = _one_symbol_each([_components(setting, *one) for one in named])
    over, own, clock = setting.field(x for row in rows for _, x in row)
    projection = _Projection(law, connection, over)
    forces = []
    for (name, _, is_potential), row in zip(named, rows, strict=True):
        pairs = [(place, _on_clock(x, clock)) for place, x in row]
        values = frame.read(pairs) if over is frame.field else _read(over, pairs, setting)
        make = projection.of_potential if is_potential else projection.of_force
        forces.append(make(name, values, setting.velocities))
    edges = () if over is frame.field else tuple(_edges(over, frame))
    return Forced(law, frame, tuple(forces), over, own, clock, edges)


def _has_branches(entry: sp.Expr) -> bool:
    """Whether functions in it may be read with one of two signs."""
    functions = entry.atoms(sp.Function) - entry.atoms(sp.sin, sp.cos, sp.exp, sp.sinh, sp.cosh)
    return bool(functions) or any(not power.exp.is_integer for power in entry.atoms(sp.Pow))


def _edges(over: Field, frame: Frame) -> Iterator[Edge]:
    """Where roots in a force change the signs with which they were read."""
    of_frame = {branch.radical for branch in frame.branches}
    for branch in over.branches:
        if branch.holds is not None and branch.radical not in of_frame:
            yield Edge(branch.holds, str(branch), str(branch))


def _setting(frame: Frame, parameters: Iterable[str]) -> _Setting:
    """The names of a frame, and names of further parameters."""
    names = {symbol.name for symbol in frame.field.symbols}
    more = tuple(name for name in parameters if name not in names)
    free = (name for name in TIMES if name not in names and name not in more)
    velocities = velocity_names(frame)
    time = next(free, "")
    for name in more:
        if name in velocities:
            raise ArgumentError(
                f"parameters: expected names that are not velocities, got {name}: "
                f"{', '.join(velocities)} are the velocities along the legs. Rename it."
            )
    return _Setting(frame, velocities, time, more)


def _read(
    over: Field, pairs: Sequence[tuple[str, sp.Expr]], setting: _Setting
) -> Sequence[Element]:
    """Expressions in a field of their own; roots that change sign with the velocity are refused."""
    values = over.read_all(pairs)
    moving = {*setting.velocities, setting.time}
    for branch in over.branches:
        if moving & {symbol.name for symbol in branch.radical.free_symbols}:
            raise ExpressionError(
                f"{pairs[0][0]}: {branch.radical} is not smooth where {branch.read_as} changes "
                "sign. Write the side that holds, or a smooth function."
            )
    return values


def _one_symbol_each(rows: Sequence[Row]) -> list[Row]:
    """Expressions where each name is one symbol: the declared one, if there is one."""
    table: dict[str, sp.Symbol] = {}
    every = {x for row in rows for _, one in row for x in one.free_symbols}
    for symbol in sorted(every, key=sp.srepr):
        if table.get(symbol.name) in (None, sp.Symbol(symbol.name, real=True)):
            table[symbol.name] = symbol
    twins = {x: table[x.name] for x in every}
    return [[(place, one.xreplace(twins)) for place, one in row] for row in rows]


def _on_clock(expr: sp.Expr, clock: str) -> sp.Expr:
    """An expression whose curve parameter is read off the clock of the motion."""
    return expr.xreplace({x: CLOCK * x for x in expr.free_symbols if x.name == clock})


def _by_name(law: Law, force: object, potential: object) -> list[tuple[str, object, bool]]:
    """Names, values and whether they are potentials; a value without name has its kind's name."""
    named: list[tuple[str, object, bool]] = []
    for values, kind in ((force, "force"), (potential, "potential")):
        if isinstance(values, Mapping):
            names = [checks.text(name, f"name of a {kind}", ArgumentError) for name in values]
            pairs = zip(names, values.values(), strict=True)
        else:
            pairs = [] if values is None else [(kind, values)]
        named += [(name, value, kind == "potential") for name, value in pairs]
    taken = [*law.effects, *(name for name, _, _ in named)]
    for name in taken:
        if taken.count(name) > 1:
            raise ArgumentError(
                f"force, potential: expected different names, got {checks.shown(name)} twice. "
                f"{', '.join(law.effects) or 'Nothing'} is a name of the law."
            )
    return named


def _components(setting: _Setting, name: str, value: object, is_potential: bool) -> Row:
    """Places in a message and expressions: of a potential, or of the components F_k of a force."""
    if is_potential:
        return [(name, setting.read(name, value, moving=False))]
    entries = checks.entries(value, name, ShapeError)
    checks.check_one_each(entries, setting.frame.dimension, "legs", name, ShapeError)
    places = [f"{name}[{k}]" for k in range(len(entries))]
    return [(p, setting.read(p, x, moving=True)) for p, x in zip(places, entries, strict=True)]


@dataclass(frozen=True, eq=False)
class _Projection:
    """Accelerations F^k from forces F_k: raised with the kinetic metric, on the permitted legs."""

    law: Law
    connection: Connection | Frame
    field: Field

    @property
    def frame(self) -> Frame:
        """The frame of the components."""
        one = self.connection
        return one if isinstance(one, Frame) else one.frame

    def _over(self, element: Element) -> Element:
        """An element of the frame in the field of the forces."""
        return element if element.field is self.field else self.field.read(element.sympy)

    def of_force(self, name: str, values: Sequence[Element], velocities: Sequence[str]) -> Force:
        """A force from its components F_k."""
        speeds = {s.name: self.field.symbol(s) for s in self.field.symbols if s.name in velocities}
        pushed = [(x, u) for x, u in zip(values, velocities, strict=True) if not x.is_zero]
        height = None
        # The power of F_k along a velocity on which no force depends does not cancel.
        if pushed and all(u in speeds for _, u in pushed):
            power = self.field.sum([(1, value, speeds[u]) for value, u in pushed])
            height = self.field.zero if power.is_zero else None
        return Force(name, self._raised(values), height)

    def of_potential(self, name: str, values: Sequence[Element], _: Sequence[str]) -> Force:
        """The force F_k = -E_k(V)."""
        (height,), frame = values, self.frame
        slopes: dict[int, list[tuple[int, Element, Element]]] = {}
        for (mu, k), leg in frame.legs.components.nonzero.items():
            slope = height.diff(frame.coordinates[mu])
            slopes.setdefault(k, []).append((-1, self._over(leg), slope))
        rows = [self.field.sum(slopes.get(k, [])) for k in range(frame.dimension)]
        return Force(name, self._raised(rows), height, is_potential=True)

    def _raised(self, values: Sequence[Element]) -> tuple[Element, ...]:
        """F^k along the permitted legs."""
        frame, allowed = self.frame, None
        if isinstance(self.connection, Connection):
            allowed = self.connection.allowed
        permitted = range(frame.dimension) if allowed is None else allowed
        rows = raising(frame, self.law.metric if isinstance(self.law, Geodesic) else None)
        return tuple(
            self.field.sum([(1, self._over(x), values[j]) for j, x in rows[k]])
            if k in permitted
            else self.field.zero
            for k in range(frame.dimension)
        )
