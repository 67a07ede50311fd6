"""Equations: laws of motion, each in one formula over any frame, and a law written out in a chart.

Written out it is a system of first-order equations.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import sympy as sp

from geomtorsion.codegen import Graph, Products, graph
from geomtorsion.curves.atlas import Chart
from geomtorsion.curves.kinetic import fractions_of, lowered, raising, weighted
from geomtorsion.errors import ChartEdgeError, StartError
from geomtorsion.exact.form import of_same_sign
from geomtorsion.geometry import from_nonmetricity, from_torsion
from geomtorsion.ode.rates import CLOCK
from geomtorsion.ode.system import System
from geomtorsion.support.caching import cached_property
from geomtorsion.support.copies import only_fields

if TYPE_CHECKING:
    from geomtorsion.geometry import Connection, Frame

Number = TypeVar("Number")
TORSION = "torsion force, by which an autoparallel differs from a geodesic"
NONMETRICITY = "nonmetricity, which changes the length of the velocity"


@dataclass(frozen=True)
class Rates:
    """Rates of u^0 ... u^(n-1); constants are extra parameters with their exact values.

    clock: name of the curve parameter where the rates depend on it; it counts in units of CLOCK.
    """

    products: tuple[Products, ...]
    constants: Mapping[str, Fraction] = field(default_factory=dict)
    clock: str = ""


class Law(Protocol):
    """A law of motion for the frame velocities u^i.

    needs_frame: whether the law is about this very frame field, not only its metric.
    needs_chart: whether it names the coordinates of one chart, as a force does.
    is_quadratic: whether all rates are quadratic in the velocities, so that a motion from twice the
        velocity is the same path in half the time.
    text: its equation, in one line.
    effects: key -> description of what can be omitted from it.
    """

    @property
    def needs_frame(self) -> bool:
        """Whether another frame of the same metric would have another law."""
        ...

    @property
    def needs_chart(self) -> bool:
        """Whether it names the coordinates of one chart."""
        ...

    @property
    def is_quadratic(self) -> bool:
        """Whether all rates are quadratic in the velocities."""
        ...

    @property
    def text(self) -> str:
        """The equation in one line."""
        ...

    @property
    def effects(self) -> Mapping[str, str]:
        """Key -> description of what can be omitted."""
        ...

    def without(self, effects: frozenset[str]) -> Law:
        """The law without some of its effects."""
        ...

    def rates(self, frame: Frame, names: Sequence[str]) -> Rates | None:
        """Rates of the velocities of these names; None: they are constant."""
        ...

    def invariants(self, frame: Frame, names: Sequence[str]) -> dict[str, Products]:
        """Quantities that the law keeps, by name."""
        ...


@dataclass(frozen=True)
class CartanAutoparallel:
    """Autoparallels of the Cartan connection: all frame velocities are constant."""

    needs_frame = is_quadratic = True
    needs_chart = False
    text = "u'^k = 0"

    @property
    def effects(self) -> Mapping[str, str]:
        """The torsion."""
        return {"torsion": TORSION}

    def without(self, effects: frozenset[str]) -> Law:
        """Geodesics, if the torsion is omitted."""
        return Geodesic() if "torsion" in effects else self

    def rates(self, frame: Frame, names: Sequence[str]) -> Rates | None:
        """None: constant."""
        return None

    def invariants(self, frame: Frame, names: Sequence[str]) -> dict[str, Products]:
        """Nothing except the velocities themselves."""
        return {}


@dataclass(frozen=True)
class Autoparallel:
    """Autoparallels of any connection: u'^k = - omega_ij^k u^i u^j."""

    connection: Connection

    needs_frame = is_quadratic = True
    needs_chart = False
    text = "u'^k = -omega_ij^k u^i u^j"

    @property
    def effects(self) -> Mapping[str, str]:
        """Torsion and nonmetricity, as far as they do not vanish."""
        effects = {} if self.connection.torsion.S.is_zero else {"torsion": TORSION}
        metric = self.connection.kind != "general" or self.connection.metric_compatible is True
        return effects if metric else {**effects, "nonmetricity": NONMETRICITY}

    def without(self, effects: frozenset[str]) -> Law:
        """The law of the connection with only one of both, or geodesics."""
        rest, frame = {*self.effects} - effects, self.connection.frame
        if not rest:
            return Geodesic()
        if not effects:
            return self
        if "torsion" in rest:
            return Autoparallel(from_torsion(frame, self.connection.torsion))
        return Autoparallel(from_nonmetricity(frame, self.connection.nonmetricity))

    def rates(self, frame: Frame, names: Sequence[str]) -> Rates | None:
        """Symmetrised: each product u^i u^j occurs once."""
        collected: dict[tuple[int, int, int], list[Any]] = {}
        omega = self.connection.spin_connection.in_frame().components.nonzero
        for (i, j, k), value in omega.items():
            collected.setdefault((k, min(i, j), max(i, j)), []).append((-1, value))
        return Rates(_products(frame, collected, names))

    def invariants(self, frame: Frame, names: Sequence[str]) -> dict[str, Products]:
        """The length of the velocity, if the connection is metric."""
        if self.connection.kind == "general" and not self.connection.metric_compatible:
            return {}
        return {"norm": _square(frame, None, names)}


@dataclass(frozen=True)
class Geodesic:
    """Geodesics of eta, or of a constant kinetic metric G in the frame (Boltzmann, Hamel).

    p'_k = C_kj^i u^j p_i with p = G u                        READING, sections 3 and 4, no force.
    metric: G_ij as fractions, and as exact constants such as sqrt(2); None for eta.
    """

    metric: tuple[tuple[Fraction | sp.Expr, ...], ...] | None = None

    is_quadratic = True
    needs_chart = False
    text = "G_kl u'^l = C_kj^i u^j G_im u^m"

    @property
    def effects(self) -> Mapping[str, str]:
        """Nothing can be omitted."""
        return {}

    def without(self, effects: frozenset[str]) -> Law:
        """The law itself."""
        return self

    @property
    def needs_frame(self) -> bool:
        """A kinetic metric of its own belongs to one frame field."""
        return self.metric is not None

    def rates(self, frame: Frame, names: Sequence[str]) -> Rates | None:
        """u'^l = G^lk C_kj^i G_im u^j u^m, each product of velocities once."""
        twist = frame.anholonomy.components.nonzero
        fractions = () if self.metric is None else fractions_of(self.metric)
        if fractions:
            return Rates(*weighted(frame, fractions, twist, names))
        up, down = raising(frame, self.metric), lowered(frame, self.metric)
        collected: dict[tuple[int, int, int], list[Any]] = {}
        for (k, j, i), value in twist.items():
            for row, first in up[k]:
                for m, second in down[i]:
                    place = (row, min(j, m), max(j, m))
                    collected.setdefault(place, []).append((1, first, value, second))
        return Rates(_products(frame, collected, names))

    def invariants(self, frame: Frame, names: Sequence[str]) -> dict[str, Products]:
        """Energy, momenta of coordinates that do not occur, and the size of the momentum."""
        invariants = {"energy" if self.metric else "norm": _square(frame, self.metric, names)}
        lower = lowered(frame, self.metric)
        for mu in _cyclic(frame):
            terms = []
            for (i, column), value in frame.coframe.components.nonzero.items():
                if column == mu:
                    terms += [(value * entry, (names[j],)) for j, entry in lower[i]]
            invariants[f"momentum of {frame.coordinates[mu]}"] = tuple(terms)
        if _is_bi_invariant(frame):
            terms = []
            for row in lower:
                for i, one in row:
                    terms += [(one * two, (names[i], names[j])) for j, two in row]
            invariants["angular momentum squared"] = tuple(terms)
        return invariants


def _cyclic(frame: Frame) -> tuple[int, ...]:
    """Places of the coordinates that do not occur in the coframe."""
    rows = frame.coframe.components.nonzero.values()
    return tuple(
        mu
        for mu, symbol in enumerate(frame.coordinates)
        if all(value.free_of(symbol) for value in rows)
    )


def _products(
    frame: Frame, collected: Mapping[tuple[int, int, int], list[Any]], names: Sequence[str]
) -> tuple[Products, ...]:
    """Sums of collected terms as product sums, row by row."""
    rates: list[list[Any]] = [[] for _ in range(frame.dimension)]
    for (k, i, j), terms in sorted(collected.items(), key=lambda item: item[0]):
        value = frame.field.sum(terms)
        if not value.is_zero:
            rates[k].append((value, (names[i], names[j])))
    return tuple(map(tuple, rates))


def _square(frame: Frame, metric: Any, names: Sequence[str]) -> Products:
    """G_ij u^i u^j."""
    rows = lowered(frame, metric)
    return tuple((x, (names[i], names[j])) for i, row in enumerate(rows) for j, x in row)


def _is_bi_invariant(frame: Frame) -> bool:
    """Whether C_kj^i = - C_ij^k: then the sum of p_k^2 is constant for any G."""
    twist = frame.anholonomy.components
    if not twist.nonzero:
        return False
    for (k, j, i), value in twist.nonzero.items():
        opposite = twist.get((i, j, k))
        if opposite is None or value != -opposite:
            return False
    return True


@dataclass(frozen=True, eq=False)
class Equations:
    """A law in a chart: coordinates, velocities (unless constant), a clock, then carried states.

    chart: the chart, or None if only velocities are followed.
    states, parameters: names, as in a `System`.
    rates: for each state a sum of products (element, names that multiply it).
    groups: indices of states that are measured together: time; other coordinates; velocities; ...
        not the clock.
    velocities: names of u^i; states or, if constant, parameters.
    carried: names of states that are carried along (transported vectors, a deviation).
    constants: parameters that the law brought, with exact values.
    invariants: sums of products over states and parameters that do not change.
    clock: name of the state that is the curve parameter in units of CLOCK, where rates depend on
        it; empty otherwise.
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
    clock: str = ""

    def __getstate__(self) -> dict[str, object]:
        return only_fields(self)

    @cached_property
    def system(self) -> System:
        """Equations for the engines, with the margin of the chart as guard."""
        arguments = (*self.states, *self.parameters)
        rates = graph(arguments, self.rates, self.parameters)
        margin, end = self.guard_terms
        groups, clock = self.groups, None
        if self.clock:
            groups, clock = (*groups, (self.states.index(self.clock),)), (self.clock, CLOCK)
        if not margin:
            return System(self.states, self.parameters, rates, groups, clock=clock)
        guard, final = (graph(arguments, terms, self.parameters) for terms in (margin, end))
        return System(self.states, self.parameters, rates, groups, guard, final, clock)

    @property
    def guard_terms(self) -> tuple[list[Any], list[Any]]:
        """Functions that fall through zero at the margin of the chart, and at its very end."""
        if self.chart is None or not self.chart.edges:
            return [], []
        edges = [edge.element for edge in self.chart.edges]
        margin = Fraction(self.chart.margin)
        count = len(edges) - len(self.chart.edges_of_law)
        inner: list[Any] = [((edge, ()), (edge.field.rational(-margin), ())) for edge in edges]
        inner[count:] = edges[count:]
        # At the very end only the sign matters: quotients and even powers are omitted. But
        # engines want to watch something that moves.
        shorter = [of_same_sign(edge) for edge in edges]
        ends = [one if one.symbols else edge for one, edge in zip(shorter, edges, strict=True)]
        return inner if margin else edges, ends

    @property
    def moves(self) -> bool:
        """Whether velocities are states."""
        return self.velocities[0] in self.states

    @property
    def width(self) -> int:
        """Number of coordinates that are states."""
        return 0 if self.chart is None else len(self.chart.coordinates)

    @property
    def plain_width(self) -> int:
        """Number of states without the transported vectors."""
        return len(self.states) - len(self.carried)

    @cached_property
    def terms(self) -> Mapping[str, list[tuple[sp.Expr, tuple[str, ...]]]]:
        """Rates as sums of (coefficient, names that multiply it), in the time of users."""
        return {
            name: [(self._in_time(c.sympy), names) for c, names in rate]
            for name, rate in zip(self.states, self.rates, strict=True)
            if name != self.clock
        }

    def _in_time(self, coefficient: sp.Expr) -> sp.Expr:
        """A coefficient over the curve parameter instead of the clock."""
        ticks = {s: s / CLOCK for s in coefficient.free_symbols if str(s) == self.clock}
        return coefficient.xreplace(ticks)

    @cached_property
    def expressions(self) -> Mapping[str, sp.Expr]:
        """Rates of coordinates, velocities and carried quantities, over real symbols by name."""
        real = {name: sp.Symbol(name, real=True) for name in (*self.states, *self.parameters)}
        values = {real[name]: sp.Rational(x) for name, x in self.constants.items() if name in real}
        table: dict[str, sp.Expr] = {}
        for name, rate in self.terms.items():
            total = sp.Add(*(sp.Mul(c, *(real[x] for x in names)) for c, names in rate))
            own = {s: real[s.name] for s in total.free_symbols if isinstance(s, sp.Symbol)}
            table[name] = total.xreplace(own).xreplace(values)
        # Constant velocities are parameters of the equations.
        return table | {name: sp.S.Zero for name in self.velocities if name not in table}

    def numbers(
        self, parameters: Mapping[str, Number], velocities: Iterable[Number]
    ) -> list[Number | Fraction]:
        """Parameter values in order: space, law, constant velocities."""
        table: dict[str, Number | Fraction] = {**parameters, **self.constants}
        if not self.moves:
            table |= dict(zip(self.velocities, velocities, strict=True))
        return [table[name] for name in self.parameters]

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
    terms = []
    for element, factors in products:
        symbol = next((s for s in element.field.symbols if s.name == name), None)
        if symbol is not None:
            slope = element.diff(symbol)
            if not slope.is_zero:
                terms.append((slope, factors))
        count = factors.count(name)
        if count:
            rest = list(factors)
            rest.remove(name)
            terms.append((element * count, tuple(rest)))
    return tuple(terms)


def velocity_names(frame: Frame) -> tuple[str, ...]:
    """u1 ... un, with another letter where the frame uses that one."""
    taken = {symbol.name for symbol in frame.field.symbols}
    for letter in ("u", "w", "Omega", "velocity"):
        names = tuple(f"{letter}{k + 1}" for k in range(frame.dimension))
        if not taken & set(names):
            return names
    raise StartError(
        "expected a free name for the velocities, got a frame that uses u1, w1, Omega1, velocity1 "
        "... Rename a coordinate."
    )


def written(frame: Frame, law: Law, chart: Chart | None) -> Equations:
    """A law in a chart of the space of a frame; chart None: only velocities."""
    names = velocity_names(frame)
    base = chart.frame if chart is not None and chart.frame is not None else frame
    _check_frame(frame, base, law, chart)
    rates = law.rates(base, names)
    if rates is not None and not any(rates.products):
        rates = None
    if rates is not None and (chart is None or chart.frame is None):
        _need_constant(rates.products, frame, chart)
    states, products, groups = [], [], []
    if chart is not None:
        states += chart.names
        products += [tuple((value, (names[i],)) for i, value in row) for row in chart.legs]
        groups += chart.groups
    if rates is not None:
        groups.append(tuple(range(len(states), len(states) + len(names))))
        states += names
        products += rates.products
        if rates.clock:
            states.append(rates.clock)
            products.append(((base.field.rational(1, CLOCK), ()),))
    constants: Mapping[str, Fraction] = {} if rates is None else rates.constants
    of_law = {} if rates is None else law.invariants(base, names)
    invariants = _invariants(frame, of_law, chart)
    ends = () if chart is None else tuple((edge.element, ()) for edge in chart.edges)
    every = [*products, *invariants.values(), ends]
    extra = names if rates is None else ()
    parameters = (*symbols_in(every, states), *extra, *constants)
    return Equations(
        chart, tuple(states), parameters, tuple(products), tuple(groups), names, (), constants,
        invariants, "" if rates is None else rates.clock,
    )  # fmt: skip


def _check_frame(frame: Frame, base: Frame, law: Law, chart: Chart | None) -> None:
    """Refuse a law that depends on the frame in a chart with another frame, base."""
    if chart is None or base is frame or chart.keeps_frame or not law.needs_frame:
        return
    raise ChartEdgeError(
        f"the equation {law.text} depends on the frame {frame.name!r}, and chart "
        f"{chart.name!r} has another frame. Use a chart of the same frame field."
    )


def _invariants(
    frame: Frame, of_law: Mapping[str, Products], chart: Chart | None
) -> dict[str, Products]:
    """Invariants in a chart; without coordinates, only the ones that do not depend on them."""
    invariants = dict(of_law)
    if chart is None or chart.frame is None:
        invariants = {k: v for k, v in invariants.items() if _is_constant(v, frame)}
    if chart is not None and chart.kept is not None:
        invariants["unit"] = ((chart.kept, ()),)
    return invariants


def symbols_in(products: Iterable[Products], states: Sequence[str]) -> tuple[str, ...]:
    """Names of the parameters that occur in the coefficients, in a fixed order."""
    names = {s.name for terms in products for element, _ in terms for s in element.symbols}
    return tuple(sorted(names - set(states)))


def _is_constant(products: Products, frame: Frame) -> bool:
    """Whether no coefficient depends on a coordinate."""
    inside = set(frame.coordinates)
    return all(not (element.symbols & inside) for element, _ in products)


def _need_constant(rates: Sequence[Products], frame: Frame, chart: Chart | None) -> None:
    """Refuse to omit the coordinates where the velocities depend on them."""
    if all(_is_constant(products, frame) for products in rates):
        return
    what = "start=None (only velocities)" if chart is None else f"chart {chart.name!r}"
    raise StartError(
        f"{what}: expected velocity equations without coordinates, as on a Lie group, got "
        "equations that depend on the coordinates. Give a start."
    )
