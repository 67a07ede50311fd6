"""Equations: a law of motion written out in one chart, as a system of first order."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING

from geomtorsion.errors import ChartEdgeError, StartError
from geomtorsion.exact.engine_code import Products
from geomtorsion.motion.charts import Chart
from geomtorsion.motion.laws import Law, Momenta
from geomtorsion.motion.system import System

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame
    from geomtorsion.motion.reduced.runs import Reduction


@dataclass(frozen=True, eq=False)
class Equations:
    """A law in a chart: coordinates first, then velocities (unless constant), then passengers.

    chart: the chart, or None if only velocities are followed.
    system: the equations of first order.
    velocities: names of u^i; states or, if constant, parameters.
    passengers: names of states that ride along (a transported vector, a separation).
    constants: parameters that the law brought, with exact values.
    invariants: product sums over states and parameters that do not change.
    momenta: what momenta along coordinates that do not occur are made of, if they are constant.
    """

    chart: Chart | None
    system: System
    velocities: tuple[str, ...]
    passengers: tuple[str, ...] = ()
    constants: Mapping[str, Fraction] = field(default_factory=dict)
    invariants: Mapping[str, Products] = field(default_factory=dict)
    momenta: Momenta | None = None

    @cached_property
    def reduction(self) -> Reduction | None:
        """A smaller system with momenta as constants, for engines; None where it would not pay."""
        from geomtorsion.motion.reduced.runs import reduction

        return reduction(self)

    @property
    def moves(self) -> bool:
        """Whether velocities are states."""
        return self.velocities[0] in self.system.states

    @property
    def width(self) -> int:
        """Number of coordinates that are states."""
        return 0 if self.chart is None else len(self.chart.coordinates)


def velocity_names(frame: Frame) -> tuple[str, ...]:
    """u1 ... un, with another letter where the frame uses that one."""
    taken = {symbol.name for symbol in frame.field.symbols}
    for letter in ("u", "w", "Omega", "velocity"):
        names = tuple(f"{letter}{k + 1}" for k in range(frame.dimension))
        if not taken & set(names):
            return names
    raise StartError("the frame uses all names for velocities: u1, w1, Omega1, velocity1 ...")


def written(frame: Frame, law: Law, chart: Chart | None) -> Equations:
    """A law in a chart of the space of a frame; chart None: velocities alone."""
    names = velocity_names(frame)
    base = chart.frame if chart is not None and chart.frame is not None else frame
    home = base is frame
    if not home and law.keeps_frame and chart is not None and not chart.keeps_frame:
        raise ChartEdgeError(
            f"the law {law.text} is about the frame {frame.name!r}; chart {chart.name!r} has "
            "another frame. Use a chart of the same frame field."
        )
    rates = law.rates(base, names)
    if rates is not None and not any(rates.products):
        rates = None
    if rates is not None and (chart is None or chart.frame is None):
        _need_constant(rates.products, frame, chart)
    states, products = [], []
    if chart is not None:
        states += chart.names
        products += [tuple((value, (names[i],)) for i, value in row) for row in chart.legs]
    width = len(states)
    constants: Mapping[str, Fraction] = {}
    extra: list[str] = []
    if rates is None:
        extra += names
    else:
        states += names
        products += rates.products
        constants = rates.constants
    blocks = [tuple(range(width))] if width else []
    if rates is not None:
        blocks.append(tuple(range(width, len(states))))
    edge = None
    if chart is not None and chart.edge is not None:
        edge = ((chart.edge, ()),)
        if chart.margin:
            edge = (*edge, (chart.field.rational(-Fraction(chart.margin)), ()))
    invariants = dict(law.invariants(base, names)) if rates is not None else {}
    if chart is None:
        invariants = {k: v for k, v in invariants.items() if _is_constant(v, frame)}
    elif chart.frame is None:
        invariants = {k: v for k, v in invariants.items() if _is_constant(v, frame)}
        if chart.kept is not None:
            invariants["unit"] = ((chart.kept, ()),)
    every = [*products, *invariants.values(), edge or ()]
    parameters = (*symbols_in(every, states), *extra, *constants)
    system = System(tuple(states), parameters, tuple(products), tuple(blocks), edge)
    inside = rates is not None and chart is not None and chart.frame is not None
    momenta = law.momenta(base) if inside else None
    return Equations(chart, system, names, (), constants, invariants, momenta)


def symbols_in(products: Iterable[Products], states: Sequence[str]) -> tuple[str, ...]:
    """Names of the parameters that occur in the coefficients, in a fixed order."""
    found = {s.name for terms in products for element, _ in terms for s in element.symbols}
    return tuple(sorted(found - set(states)))


def _is_constant(products: Products, frame: Frame) -> bool:
    """Whether no coefficient depends on a coordinate."""
    inside = set(frame.coordinates)
    return all(not (element.symbols & inside) for element, _ in products)


def _need_constant(rates: Sequence[Products], frame: Frame, chart: Chart | None) -> None:
    """Refuse to leave out the coordinates where the velocities depend on them."""
    if all(_is_constant(products, frame) for products in rates):
        return
    what = "start=None (velocities alone)" if chart is None else f"chart {chart.name!r}"
    raise StartError(
        f"{what} needs velocity equations that stand alone, as on a Lie group; here they depend "
        "on the coordinates. Give a start."
    )
