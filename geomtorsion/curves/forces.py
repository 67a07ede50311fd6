"""Forces: a law of motion with a force or a potential, projected on the permitted legs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

from geomtorsion.codegen import Products
from geomtorsion.curves.equations import Law, Rates
from geomtorsion.errors import ChartEdgeError, ShapeError
from geomtorsion.exact import Element, parse_expression
from geomtorsion.geometry import Connection, Frame
from geomtorsion.support import checks


@dataclass(frozen=True, eq=False)
class Forced:
    """A law with an acceleration that depends on the position.

    law: the law without the force.
    frame: the frame in whose coordinates the acceleration is given.
    acceleration: F^k in the frame, one for each leg; zero along forbidden legs.
    potential: V with F_k = -E_k(V), where the force has no other part.
    """

    law: Law
    frame: Frame
    acceleration: tuple[Element, ...]
    potential: Element | None = field(default=None, repr=False)

    needs_frame = True
    is_quadratic = False

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Forced):
            return NotImplemented
        if (self.law, self.frame) != (other.law, other.frame):
            return False
        return self._components == other._components

    def __hash__(self) -> int:
        return hash((self.law, self.frame))

    @property
    def _components(self) -> list[object]:
        """The acceleration and the potential as expressions."""
        return [None if x is None else x.sympy for x in (*self.acceleration, self.potential)]

    @property
    def text(self) -> str:
        """The equation in one line."""
        return f"{self.law.text} + F^k".replace("= 0 +", "=")

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
        norm = self.law.invariants(frame, names).get("norm")
        if norm is None or self.potential is None:
            return {}
        halves = tuple((value * frame.field.rational(1, 2), which) for value, which in norm)
        return {"energy": (*halves, (self.potential, ()))}


def forced(law: Law, connection: Connection, force: object, potential: object) -> Law:
    """The law with a force F_k and a potential V, both functions of the coordinates.

    Raises
    ------
    ShapeError
        The force has not one component for each leg.
    """
    if force is None and potential is None:
        return law
    frame = connection.frame
    names = {symbol.name: symbol for symbol in frame.field.symbols}

    def read(where: str, value: object) -> tuple[str, object]:
        reader = partial(parse_expression, symbols=names, where=where)
        return where, checks.expression(value, where, read=reader)

    n = frame.dimension
    entries = [0] * n if force is None else checks.entries(force, "force", ShapeError)
    checks.check_one_each(entries, n, "legs", "force", ShapeError)
    values = frame.read([read(f"force[{k}]", value) for k, value in enumerate(entries)])
    height = None if potential is None else frame.read([read("potential", potential)])[0]
    if height is not None:
        legs = frame.legs.components.nonzero.items()
        slopes: Mapping[tuple[int, int], Element] = {
            (mu, k): leg * height.diff(frame.coordinates[mu]) for (mu, k), leg in legs
        }
        values = [
            frame.field.sum([(1, value), *((-1, x) for (_, j), x in slopes.items() if j == k)])
            for k, value in enumerate(values)
        ]
    permitted = range(n) if connection.allowed is None else connection.allowed
    raised = frame.inverse_eta.components.rows
    acceleration = [
        frame.field.sum([(1, x, values[j]) for j, x in raised[k]])
        if k in permitted
        else frame.field.zero
        for k in range(n)
    ]
    return Forced(law, frame, tuple(acceleration), None if force is not None else height)
