"""Equations: a law of motion written out in one chart, as first-order equations."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property, partial
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from geomtorsion.codegen import Graph, Products, graph
from geomtorsion.copies import only_fields
from geomtorsion.curves.atlas import Chart
from geomtorsion.curves.cyclic import CyclicReduction, cost
from geomtorsion.curves.laws import Law, Momenta
from geomtorsion.curves.separated import SeparatedReduction, separated
from geomtorsion.errors import ChartEdgeError, StartError
from geomtorsion.exact.form import of_same_sign
from geomtorsion.ode.members import Members, Part
from geomtorsion.ode.system import System

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame


# Smaller systems that stand in the place of the equations of frame velocities.
Reduction: TypeAlias = CyclicReduction | SeparatedReduction
# Longer rates (values in a graph) belong to frames whose inverse metric is too long to work with.
LONGEST = 100


@dataclass(frozen=True, eq=False)
class Equations:
    """A law in a chart: coordinates first, then velocities (unless constant), then what is carried.

    chart: the chart, or None if only velocities are followed.
    states, parameters: names, as in a `System`.
    rates: for each state a sum of products (element, names that multiply it).
    groups: indices of states that are measured together: time; other coordinates; velocities; ...
    velocities: names of u^i; states or, if constant, parameters.
    carried: names of states that are carried along (transported vectors, a deviation).
    constants: parameters that the law brought, with exact values.
    invariants: sums of products over states and parameters that do not change.
    momenta: what momenta along coordinates that do not occur are made of, if they are constant.
    """

    chart: Chart | None
    states: tuple[str, ...]
    parameters: tuple[str, ...]
    rates: tuple[Products, ...]
    groups: tuple[tuple[int, ...], ...]
    velocities: tuple[str, ...]
    carried: tuple[str, ...] = ()
    constants: Mapping[str, Fraction] = field(default_factory=dict)
    invariants: Mapping[str, Products] = field(default_factory=dict)
    momenta: Momenta | None = None

    def __getstate__(self) -> dict[str, object]:
        return only_fields(self)

    @cached_property
    def system(self) -> System:
        """What engines integrate, with the margin of the chart as guard."""
        arguments = (*self.states, *self.parameters)
        rates = graph(arguments, self.rates, self.parameters)
        guard, end = self.guards(arguments, self.parameters)
        return System(self.states, self.parameters, rates, self.groups, guard, end)

    def guards(
        self, arguments: Sequence[str], parameters: Sequence[str]
    ) -> tuple[Graph | None, Graph | None]:
        """What falls through zero at the margin of the chart, and at its very end."""
        if self.chart is None or not self.chart.edges:
            return None, None
        edges = [edge.element for edge in self.chart.edges]
        margin = Fraction(self.chart.margin)
        inner = [((edge, ()), (edge.field.rational(-margin), ())) for edge in edges]
        guard = graph(arguments, inner if margin else edges, parameters)
        # At the very end only the sign matters: quotients and even powers are left out. But
        # engines want to watch something that moves.
        shorter = [of_same_sign(edge) for edge in edges]
        ends = [one if one.symbols else edge for one, edge in zip(shorter, edges, strict=True)]
        return guard, graph(arguments, ends, parameters)

    @cached_property
    def reductions(self) -> tuple[Reduction, ...]:
        """Smaller systems in the place of this one that cost less; the cheapest first."""
        if self.momenta is None or not self.momenta.cyclic or self.chart is None:
            return ()
        # Where a root of the frame vanishes, momenta may grow without bound; velocities do not.
        if any(edge.is_root for edge in self.chart.edges):
            return ()
        if len(self.system.rates.steps) > LONGEST:
            return ()
        cyclic = CyclicReduction(self, self.momenta)
        offered = [one for one in (separated(cyclic), cyclic) if one is not None]
        costs = {id(one): cost(one.system.rates) for one in (self, *offered)}
        paying = [one for one in offered if costs[id(one)] < costs[id(self)]]
        return tuple(sorted(paying, key=lambda one: costs[id(one)]))

    def parts(self, members: Members) -> Iterator[Part]:
        """Members of an ensemble, each by the first smaller system by which it loses no digits."""
        rest, several = np.arange(len(members.states)), members.system is self.system
        for one in self.reductions:
            start, numbers, kept = one.reduced(members.states[rest], members.parameters[rest])
            if kept.any():
                own = numbers[kept]
                system = one.system if several else one.system.to_the_end
                yield Part(rest[kept], system, start[kept], own, partial(one.lifted, own))
            rest = rest[~kept]
        if len(rest):
            full = members.states[rest], members.parameters[rest]
            yield Part(rest, members.system, *full, lambda rows: rows)

    @property
    def moves(self) -> bool:
        """Whether velocities are states."""
        return self.velocities[0] in self.states

    @property
    def width(self) -> int:
        """Number of coordinates that are states."""
        return 0 if self.chart is None else len(self.chart.coordinates)

    @cached_property
    def invariant_graphs(self) -> Mapping[str, tuple[Graph, Graph]]:
        """For each invariant its value, and its terms without the states that multiply them."""
        arguments = (*self.states, *self.parameters)
        return {
            name: (
                graph(arguments, [products], factor=False),
                graph(arguments, [element for element, _ in products], factor=False),
            )
            for name, products in self.invariants.items()
        }


def derivative(products: Products, name: str) -> Products:
    """The derivative of a sum of products with respect to a state, by name."""
    found = []
    for element, factors in products:
        symbol = next((s for s in element.field.symbols if s.name == name), None)
        if symbol is not None:
            slope = element.diff(symbol)
            if not slope.is_zero:
                found.append((slope, factors))
        count = factors.count(name)
        if count:
            rest = list(factors)
            rest.remove(name)
            found.append((element * count, tuple(rest)))
    return tuple(found)


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
    if not home and law.needs_frame and chart is not None and not chart.keeps_frame:
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
    groups = [] if chart is None else coordinate_groups(chart)
    if rates is not None:
        groups.append(tuple(range(width, len(states))))
    invariants = dict(law.invariants(base, names)) if rates is not None else {}
    if chart is None or chart.frame is None:
        invariants = {k: v for k, v in invariants.items() if _is_constant(v, frame)}
    if chart is not None and chart.kept is not None:
        invariants["unit"] = ((chart.kept, ()),)
    ends = () if chart is None else tuple((edge.element, ()) for edge in chart.edges)
    every = [*products, *invariants.values(), ends]
    parameters = (*symbols_in(every, states), *extra, *constants)
    inside = rates is not None and chart is not None and chart.frame is not None
    momenta = law.momenta(base) if inside else None
    return Equations(
        chart, tuple(states), parameters, tuple(products), tuple(groups), names, (), constants,
        invariants, momenta,
    )  # fmt: skip


def coordinate_groups(chart: Chart) -> list[tuple[int, ...]]:
    """Coordinates that are measured together: all of them, but time, which grows without bound.

    Time stands in the place of the one leg whose square has the other sign.
    """
    places = tuple(range(len(chart.coordinates)))
    if chart.frame is None:
        return [places]
    signs = [chart.frame.eta.element(i, i) for i in places]
    # In two dimensions it is the negative one.
    times = [i for i in places if signs[i] == -1 and signs.count(-1) == 1]
    times = times or [i for i in places if signs[i] == 1 and signs.count(1) == 1]
    if not times or len(places) == 1:
        return [places]
    return [(times[0],), tuple(i for i in places if i != times[0])]


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
