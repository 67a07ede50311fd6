"""Forces: a law of motion with forces and potentials, projected on the permitted legs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

from geomtorsion.codegen import Products
from geomtorsion.curves.equations import Law, Rates
from geomtorsion.errors import ArgumentError, ChartEdgeError, ShapeError
from geomtorsion.exact import Element, parse_expression
from geomtorsion.geometry import Connection, Frame
from geomtorsion.support import checks

FORCE = "force of the problem"
POTENTIAL = "force of a potential"


@dataclass(frozen=True, eq=False)
class Force:
    """One of the forces on a motion.

    name: its key. acceleration: F^k in the frame, one for each leg; zero along forbidden legs.
    potential: V with F_k = -E_k(V), or None.
    """

    name: str
    acceleration: tuple[Element, ...]
    potential: Element | None = field(default=None, repr=False)

    @property
    def content(self) -> tuple[object, ...]:
        """Name and expressions."""
        terms = (*self.acceleration, self.potential)
        return self.name, *(None if x is None else x.sympy for x in terms)


@dataclass(frozen=True, eq=False)
class Forced:
    """A law with accelerations that depend on the position.

    law: the law without the forces.
    frame: the frame in whose coordinates the forces are given.
    forces: at least one.
    """

    law: Law
    frame: Frame
    forces: tuple[Force, ...]

    needs_frame = needs_chart = True
    is_quadratic = False

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Forced):
            return NotImplemented
        if (self.law, self.frame) != (other.law, other.frame):
            return False
        return [x.content for x in self.forces] == [x.content for x in other.forces]

    def __hash__(self) -> int:
        return hash((self.law, self.frame))

    @property
    def acceleration(self) -> tuple[Element, ...]:
        """F^k of all forces together, one for each leg."""
        columns = zip(*(one.acceleration for one in self.forces), strict=True)
        return tuple(self.frame.field.sum([(1, x) for x in column]) for column in columns)

    @property
    def potential(self) -> Element | None:
        """V of all forces together; None if one of them has no potential."""
        heights = [one.potential for one in self.forces if one.potential is not None]
        if len(heights) < len(self.forces):
            return None
        return self.frame.field.sum([(1, x) for x in heights])

    @property
    def text(self) -> str:
        """The equation in one line."""
        return f"{self.law.text} + F^k".replace("= 0 +", "=")

    @property
    def effects(self) -> Mapping[str, str]:
        """Effects of the law, and each force."""
        words = {x.name: FORCE if x.potential is None else POTENTIAL for x in self.forces}
        return {**self.law.effects, **words}

    def without(self, effects: frozenset[str]) -> Law:
        """The law without some effects; with no force left, the law that remains."""
        law = self.law.without(effects)
        forces = tuple(one for one in self.forces if one.name not in effects)
        return Forced(law, self.frame, forces) if forces else law

    def rates(self, frame: Frame, names: Sequence[str]) -> Rates | None:
        """The rates of the law, and the acceleration."""
        if frame is not self.frame:
            raise ChartEdgeError(
                "the force is given in one chart only, and the motion leaves it. Choose a start "
                "farther from its edge, or a shorter time."
            )
        free = self.law.rates(frame, names)
        rows = ((),) * frame.dimension if free is None else free.products
        pushed = [
            (*row, *(() if value.is_zero else ((value, ()),)))
            for row, value in zip(rows, self.acceleration, strict=True)
        ]
        return Rates(tuple(pushed), {} if free is None else free.constants)

    def invariants(self, frame: Frame, names: Sequence[str]) -> dict[str, Products]:
        """The energy, where there is a potential."""
        norm, height = self.law.invariants(frame, names).get("norm"), self.potential
        if norm is None or height is None:
            return {}
        halves = tuple((value * frame.field.rational(1, 2), which) for value, which in norm)
        return {"energy": (*halves, (height, ()))}


def forced(law: Law, connection: Connection, force: object, potential: object) -> Law:
    """The law with forces F_k and potentials V, functions of the coordinates; one each, or by name.

    Raises
    ------
    ShapeError
        A force has not one component for each leg.
    ArgumentError
        A name is empty, occurs twice, or is an effect of the law.
    """
    given = [(*one, False) for one in _by_name(force, "force")]
    given += [(*one, True) for one in _by_name(potential, "potential")]
    if not given:
        return law
    taken = [*law.effects, *(name for name, _, _ in given)]
    for name in taken:
        if taken.count(name) > 1:
            raise ArgumentError(
                f"force, potential: expected different names, got {checks.shown(name)} twice. "
                f"{', '.join(law.effects) or 'Nothing'} is a name of the law."
            )
    forces = [
        _of_potential(connection, name, value) if height else _of_force(connection, name, value)
        for name, value, height in given
    ]
    return Forced(law, connection.frame, tuple(forces))


def _by_name(values: object, what: str) -> list[tuple[str, object]]:
    """Names and values: of a mapping, or of one value, whose name is what it is."""
    if values is None:
        return []
    if not isinstance(values, Mapping):
        return [(what, values)]
    return [
        (checks.text(name, f"name of a {what}", ArgumentError), x) for name, x in values.items()
    ]


def _read(frame: Frame, where: str, value: object) -> Element:
    names = {symbol.name: symbol for symbol in frame.field.symbols}
    reader = partial(parse_expression, symbols=names, where=where)
    (element,) = frame.read([(where, checks.expression(value, where, read=reader))])
    return element


def _of_force(connection: Connection, name: str, force: object) -> Force:
    """A force from its components F_k."""
    frame = connection.frame
    n = frame.dimension
    entries = checks.entries(force, name, ShapeError)
    checks.check_one_each(entries, n, "legs", name, ShapeError)
    values = [_read(frame, f"{name}[{k}]", value) for k, value in enumerate(entries)]
    return Force(name, _raised(connection, values))


def _of_potential(connection: Connection, name: str, potential: object) -> Force:
    """The force F_k = -E_k(V)."""
    frame = connection.frame
    height = _read(frame, name, potential)
    slopes: dict[int, list[tuple[int, Element]]] = {}
    for (mu, k), leg in frame.legs.components.nonzero.items():
        slopes.setdefault(k, []).append((-1, leg * height.diff(frame.coordinates[mu])))
    values = [frame.field.sum(slopes.get(k, [])) for k in range(frame.dimension)]
    return Force(name, _raised(connection, values), height)


def _raised(connection: Connection, values: Sequence[Element]) -> tuple[Element, ...]:
    """F^k along the permitted legs."""
    frame = connection.frame
    permitted = range(frame.dimension) if connection.allowed is None else connection.allowed
    raised = frame.inverse_eta.components.rows
    return tuple(
        frame.field.sum([(1, x, values[j]) for j, x in raised[k]])
        if k in permitted
        else frame.field.zero
        for k in range(frame.dimension)
    )
