"""CurveProblem: a law of motion in a space, with a checked start, followed from chart to chart."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from geomtorsion.codegen import graph
from geomtorsion.codegen.expression_graph import branch_check
from geomtorsion.curves import readout
from geomtorsion.curves.atlas import Atlas, Chart, MovingPoint, atlas_of
from geomtorsion.curves.derivatives import Beginning
from geomtorsion.curves.equations import Equations, Law, velocity_names, written
from geomtorsion.curves.forces import Forced
from geomtorsion.curves.readout import laid_out, start_lists
from geomtorsion.curves.stops import (
    Stop,
    check_stops,
    in_chart,
    stopped,
    terms_in_chart,
    with_stops,
)
from geomtorsion.curves.to_ode import ode_of, without_values
from geomtorsion.curves.transported import Carried, Derivatives, carrying
from geomtorsion.errors import (
    AccuracyError,
    ArgumentError,
    BranchError,
    ChartEdgeError,
    ExpressionError,
    GeomtorsionError,
    MissingValueError,
    SingularPointError,
    StartError,
    UnknownNameError,
)
from geomtorsion.geometry.assumption import assumption_latex
from geomtorsion.geometry.domain_edges import Edge
from geomtorsion.geometry.evaluation import sign_of
from geomtorsion.geometry.relations import broken_relations
from geomtorsion.ode.derivatives import term_slopes
from geomtorsion.ode.members import Members, Rows
from geomtorsion.ode.moment import Moment, Term
from geomtorsion.ode.numbers import (
    Numbers,
    Real,
    checked_numbers,
    divided,
    floats,
    perturbed,
    precision_of,
)
from geomtorsion.ode.poles import AT_A_POLE
from geomtorsion.ode.problem import ODE
from geomtorsion.ode.rates import CLOCK
from geomtorsion.ode.roots import nearest_to_zero
from geomtorsion.ode.terms import At, When, expression, symbol_table
from geomtorsion.ode.trajectory import Event, Segment, Stage, State, Trajectory
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.copies import ByContent
from geomtorsion.support.displays import drawn_by, latex_of
from geomtorsion.support.hints import attribute_hints
from geomtorsion.support.precision import CALCULATED, EPS

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame
    from geomtorsion.ode.system import System


@attribute_hints(solve="gt.solve(problem, times)")
@dataclass(frozen=True, eq=False)
class CurveProblem(ByContent):
    """Curve to solve for: law, frame and start; made by `geodesic`, `autoparallel`, ...

    name: of the curve.
    frame: its coordinates and frame vectors are those in which start and answer are given.
    law: how the frame velocities change.
    start: coordinates q^mu at t = 0; None where only velocities are requested.
    frame_velocity: u^i = e^i_mu q'^mu at t = 0.
    parameters: name -> number.
    atlas: charts of the space.
    carried: quantities carried along: transported vectors, a deviation or derivatives.
    coordinate_velocity: q'^mu at t = 0 where that was given; more digits of u^i come from it.
    stops: expressions; the curve ends where one of them decreases through zero.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> from geomtorsion.geometry import cartan
    >>> from geomtorsion.curves import autoparallel
    >>> so3 = load("so3").frame
    >>> print(autoparallel(cartan(so3), [0.3, 1.0, 0.2], frame_velocity=[1, 0, 0]))
    autoparallel on so3: q'^mu = E_i^mu u^i, u'^k = 0
    """

    name: str
    frame: Frame
    law: Law
    start: tuple[Real, ...] | None
    frame_velocity: tuple[Real, ...]
    parameters: Mapping[str, Real]
    atlas: Atlas
    carried: Carried | None = None
    coordinate_velocity: tuple[Real, ...] | None = None
    stops: tuple[Stop, ...] = ()
    _written: dict[tuple[str, ...], Equations] = field(default_factory=dict, repr=False)
    _stages: dict[tuple[int, float], Stage] = field(default_factory=dict, repr=False, init=False)
    _systems: dict[str, System] = field(default_factory=dict, repr=False, init=False)
    _beginnings: dict[int, tuple[str, MovingPoint]] = field(
        default_factory=dict, repr=False, init=False
    )

    # Its name in files.
    kind = "curve"

    # -- equations ---------------------------------------------------------------------------------

    def equations(self, chart: str | None = None) -> Equations:
        """The equations in a chart (the home chart if none is named), computed once."""
        name = "" if self.start is None else chart or self.atlas.home
        key = (name, *(self.carried.names() if self.carried else ()))
        if key not in self._written:
            place = self.chart(name) if name else None
            plain = written(self.frame, self.law, place)
            self._written[key] = carrying(plain, self.carried) if self.carried else plain
        return self._written[key]

    def to_ode(
        self,
        *,
        events: Iterable[At | When] = (),
        tables: Mapping[str, object] | None = None,
        time: str = "",
    ) -> ODE:
        """The curve as first-order equations in its home chart, with forces in pieces and tables.

        The states are the coordinates and the frame velocities u^i, or coordinates only if the
        velocities are constant. The conditions of `stop` end it, and so do edges of the chart.

        events, tables: see `ODE.of`; the names of tables are functions in the forces. time: the
        name of the curve parameter; by default the name that the forces use.

        Raises
        ------
        ArgumentError
            the curve has no start, or carries vectors along.

        Examples
        --------
        >>> from geomtorsion.curves import geodesic
        >>> from geomtorsion.geometry import Frame
        >>> from geomtorsion.ode import solve
        >>> line = Frame("x", [[1]])
        >>> pushed = geodesic(line, [0], [1], force=["pieces(x, 0, 1, 2)"]).to_ode()
        >>> round(float(solve(pushed, 3.0)["x"][-1]), 9)
        7.0
        """
        if self.start is None or self.carried:
            raise ArgumentError(
                "expected a curve with a start and without vectors carried along, got "
                f"{checks.shown(self)}. Give its start, or solve the curve itself."
            )
        equations = self.equations()
        start = dict(zip(self.coordinates, self.start, strict=True))
        speeds = dict(zip(equations.velocities, self.frame_velocity, strict=True))
        every = [*(When(stop.term) for stop in self.stops), *events]
        edges = self.chart(self.atlas.home).edges
        return ode_of(equations, start, speeds, self.parameters, every, tables, time, edges)

    def chart(self, name: str) -> Chart:
        """A chart of the atlas, with the edges of a law that has its own."""
        chart = self.atlas.chart(name)
        if not isinstance(self.law, Forced) or not self.law.edges or chart.frame is not self.frame:
            return chart
        return self._home_chart

    @cached_property
    def _home_chart(self) -> Chart:
        assert isinstance(self.law, Forced)
        return replace(self.atlas.chart(self.atlas.home), edges_of_law=self.law.edges)

    @cached_property
    def charts(self) -> tuple[str, ...]:
        """Names of the charts in which this motion can be computed, by preference."""
        if self.start is None:
            return ("",)
        charts = []
        for name in self.atlas.names:
            bound = self.law.needs_chart or (self.carried and not self.carried.any_chart)
            if name != self.atlas.home and bound:
                continue
            stated = all(
                in_chart(stop, self.atlas, name, velocity_names(self.frame)) is not None
                for stop in self.stops
            )
            if name == self.atlas.home or (
                stated and (not self.law.needs_frame or self.chart(name).keeps_frame)
            ):
                charts.append(name)
        return tuple(charts) or (self.atlas.home,)

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates."""
        return tuple(symbol.name for symbol in self.frame.coordinates)

    @property
    def time_name(self) -> str:
        """Name of the curve parameter in messages."""
        return "t"

    @property
    def time_unit(self) -> float:
        """A power of two near the largest frame velocity: time is measured in its inverse.

        With a force the path depends on the speed, and the unit is one.
        """
        # Types do not take a cached property for the property of `Problem`.
        return self._time_unit

    @cached_property
    def _time_unit(self) -> float:
        if not self.law.is_quadratic:
            return 1.0
        size = max((abs(float(u)) for u in self.frame_velocity), default=0.0)
        return 2.0 ** round(math.log2(size)) if size else 1.0

    @cached_property
    def velocity(self) -> np.ndarray:
        """Coordinate velocities q'^mu at the start."""
        if self.start is None:
            raise StartError(
                "expected a problem with coordinates, got one without. Give it a start."
            )
        chart = self.chart(self.atlas.home)
        column = np.array([[float(u)] for u in self.frame_velocity])
        return chart.frame_vectors.applied(self.floats(), column)[:, 0]

    def floats(self) -> dict[str, float]:
        """Coordinates at the start and parameters, by name, as floats."""
        values = {name: float(value) for name, value in self.parameters.items()}
        if self.start is not None:
            values |= {n: float(x) for n, x in zip(self.coordinates, self.start, strict=True)}
        return values

    # -- variants --------------------------------------------------------------------------------

    def with_start(
        self,
        start: Numbers | None = None,
        velocity: Numbers | None = None,
        frame_velocity: Numbers | None = None,
    ) -> CurveProblem:
        """The same law from another start; nothing is compiled again.

        Examples
        --------
        >>> from geomtorsion.spaces import load
        >>> from geomtorsion.curves import geodesic
        >>> p = geodesic(load("s2").frame, [1.0, 0.0], [0.0, 1.0], parameters={"R": 1})
        >>> p.with_start(velocity=[1.0, 0.0]).frame_velocity
        (1.0, 0.0)
        """
        place = self.start if start is None else checked_start(self.frame, start, self.parameters)
        if velocity is None and frame_velocity is None:
            return replace(self, start=place, coordinate_velocity=None)._renewed()
        speeds, rates = frame_velocities(
            self.frame, place, velocity, frame_velocity, self.parameters
        )
        moved = replace(self, start=place, frame_velocity=speeds, coordinate_velocity=rates)
        return moved._renewed()

    def _renewed(self) -> CurveProblem:
        """The same curve; derivatives, if it has some, belong to its start."""
        if not isinstance(self.carried, Derivatives):
            return self
        return replace(self, carried=self._given.derivatives(self.carried.by))

    @property
    def _given(self) -> Beginning:
        """The numbers at the start, as they were given."""
        names = self.coordinates if self.start is not None else ()
        speeds = self.frame_velocity, self.coordinate_velocity
        return Beginning(self.frame, names, self.start or (), *speeds, self.parameters)

    @property
    def variables(self) -> dict[str, Real]:
        """Parameters and numbers at the start, by name: what derivatives and fits may vary.

        Velocities are r', ... where a coordinate velocity was given, else u1, u2, ...

        Examples
        --------
        >>> from geomtorsion.spaces import load
        >>> from geomtorsion.curves import geodesic
        >>> p = geodesic(load("s2").frame, [1.0, 0.0], [0.0, 1.0], parameters={"R": 1})
        >>> list(p.variables)
        ['R', 'theta', 'phi', "theta'", "phi'"]
        """
        return self._given.variables

    def with_values(self, values: Mapping[str, Real]) -> CurveProblem:
        """The same law with other `variables`, by name; nothing is compiled again.

        Examples
        --------
        >>> from geomtorsion.spaces import load
        >>> from geomtorsion.curves import geodesic
        >>> p = geodesic(load("s2").frame, [1.0, 0.0], [0.0, 1.0], parameters={"R": 1})
        >>> p.with_values({"R": 2.0, "theta": 1.2}).variables["R"]
        2.0
        """
        parameters, place, speeds = self._given.changed(values)
        changed, start = replace(self, parameters=parameters), place or None
        if self.coordinate_velocity is None:
            return changed.with_start(start, frame_velocity=speeds)
        return changed.with_start(start, velocity=speeds)

    def with_derivatives(self, by: object) -> CurveProblem:
        """The same curve with its derivatives by some of its `variables`, in its home chart.

        The derivative of r by M is `solution["dr_dM"]`, by the r' at the start `dr_drdot`. A
        coordinate velocity that was given is held fixed, and so are frame velocities if these were.

        Raises
        ------
        UnknownNameError, StartError
            a name is unknown, repeated or missing, or vectors are carried along.

        Examples
        --------
        >>> from geomtorsion.spaces import load
        >>> from geomtorsion.curves import geodesic
        >>> from geomtorsion.ode import solve
        >>> p = geodesic(load("s2").frame, [1.0, 0.0], [0.0, 1.0], parameters={"R": 1})
        >>> solution = solve(p.with_derivatives(["theta"]), 3.0)
        >>> sorted(solution)[:3]
        ['dphi_dtheta', 'dtheta_dtheta', 'du1_dtheta']
        """
        if self.carried is not None:
            raise StartError(
                "derivatives: expected a curve without vectors carried along, got one with them. "
                "Solve the two problems one after the other."
            )
        return replace(self, carried=self._given.derivatives(by))

    @property
    def effects(self) -> Mapping[str, str]:
        """Key -> description of each effect that `without` can omit: torsion, forces.

        Examples
        --------
        >>> from geomtorsion.spaces import load
        >>> from geomtorsion.curves import autoparallel
        >>> p = autoparallel("flat_polar", [1.0, 0.0], [0.0, 1.0], potential="r**2/2")
        >>> list(p.effects), p.without("torsion", "potential").law.text
        (['torsion', 'potential'], "G_kl u'^l = C_kj^i u^j G_im u^m")
        """
        return self.law.effects

    @property
    def main_names(self) -> tuple[str, ...]:
        """Names of first interest: coordinates, or frame velocities where there are none."""
        return self.coordinates if self.start is not None else velocity_names(self.frame)

    def without(self, *effects: str) -> CurveProblem:
        """The same start without some of its effects.

        Raises
        ------
        UnknownNameError
            the law has no such effect.
        """
        for key in effects:
            checks.known_name(key, self.effects, "effect", UnknownNameError)
        if not effects:
            return self
        return replace(self, law=self.law.without(frozenset(effects)), _written={})

    def carry(self, carried: Carried) -> CurveProblem:
        """The same motion with transported vectors or a deviation."""
        return replace(self, carried=carried, _written={})

    def with_charts(self, *names: str) -> CurveProblem:
        """The same motion, followed in these charts only, in this order of preference."""
        return replace(self, atlas=self.atlas.only(*names), _written={})

    # -- showing ---------------------------------------------------------------------------------

    @property
    def text(self) -> str:
        """The equations of motion, written out line by line."""
        equations = self.equations()
        lines = []
        for name, rate in equations.terms.items():
            terms = " + ".join("*".join([f"({c})", *names]) for c, names in rate)
            lines.append(f"{name}' = {terms or '0'}")
        if not equations.moves:
            lines += [f"{name}' = 0" for name in equations.velocities]
        return "\n".join(lines)

    @property
    def latex(self) -> str:
        """The equations of motion in LaTeX."""
        equations = self.equations()
        lines = []
        for name, rate in equations.terms.items():
            total = sp.Add(*(sp.Mul(c, *(sp.Symbol(n) for n in names)) for c, names in rate))
            lines.append(f"\\dot{{{latex_of(sp.Symbol(name))}}} &= {latex_of(total)}")
        if not equations.moves:
            lines += [f"\\dot{{{latex_of(sp.Symbol(n))}}} &= 0" for n in equations.velocities]
        constants = [c for rate in equations.terms.values() for c, _ in rate]
        remark = assumption_latex(self.frame, constants)
        lines += [f"&{remark}"] * bool(remark)
        return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"

    def _repr_latex_(self) -> str:
        return f"$${self.latex}$$"

    _repr_html_ = drawn_by("notebook_tables", "equations_html")

    def __str__(self) -> str:
        where = f" on {self.frame.name}" if self.frame.name else ""
        if self.start is None:
            return f"{self.name}{where}: {self.law.text}"
        return f"{self.name}{where}: q'^mu = E_i^mu u^i, {self.law.text}"

    def __repr__(self) -> str:
        return str(self)

    def check_parameters(self, chart: str) -> None:
        """Raise an error if a parameter in the equations of a chart has no value."""
        equations = self.equations(chart)
        needed = [
            name
            for name in equations.parameters
            if name not in equations.velocities and name not in equations.constants
        ]
        remedy = "Give parameters={'{missing}': 1.0}, for example."
        checks.check_values(needed, self.parameters, "parameters", StartError, remedy)

    # -- for the solver --------------------------------------------------------------------------

    def check_start(self) -> None:
        """Refuse piecewise forces and a start beyond an edge, and find the first chart."""
        self._check_values()
        if self.start is None:
            self._check_stops({})
            return
        chart, point = self.chart(self.atlas.home), self.floats()
        edges = chart.edges if chart.edge is None else ()
        for edge, value in zip(edges, chart.at_edges(point).tolist() if edges else (), strict=True):
            if not value > 0:
                place = ", ".join(f"{name} = {point[name]:.6g}" for name in self.coordinates)
                raise StartError(
                    f"expected a start inside the domain of the frame, {edge.condition}, got "
                    f"{place}. Start inside, or state a domain (and with it the branches of roots) "
                    "around the start."
                )
        self._check_stops(point)
        self._beginning(53)

    def _check_values(self) -> None:
        """Refuse forces in pieces and functions without values."""
        if isinstance(self.law, Forced) and self.law.unknown:
            raise ExpressionError(without_values(self.law.unknown))

    def _check_stops(self, point: Mapping[str, float]) -> None:
        """Refuse a start at which a condition to stop has fallen already."""
        if self.stops:
            speeds = zip(velocity_names(self.frame), self.frame_velocity, strict=True)
            check_stops(self.stops, {**point, **{name: float(u) for name, u in speeds}})

    @property
    def stop_texts(self) -> tuple[str, ...]:
        """The conditions that end the curve, as text."""
        return tuple(stop.text for stop in self.stops)

    def first_stage(self, precision: int, perturbation: float) -> Stage:
        """The first part of the motion; perturbation: relative change of the start."""
        key = precision, perturbation
        if key not in self._stages:
            label, point = self._beginning(precision)
            self._stages[key] = self._stage(label, point, 0.0, precision, perturbation)
        return self._stages[key]

    def _beginning(self, precision: int) -> tuple[str, MovingPoint]:
        """The chart in which to begin, and the point there, computed once."""
        if precision in self._beginnings:
            return self._beginnings[precision]
        velocities = [divided(u, self.time_unit) for u in self._starting_velocity(precision)]
        carried: list[Real] = []
        if self.carried is not None:
            carried = [
                divided(x, self.time_unit) if power else x
                for x, power in zip(self.carried.start, self.carried.speed_powers, strict=True)
            ]
        name, point = "", MovingPoint(list(self.start or ()), velocities, carried)
        if self.start is not None:
            home, numbers = self.atlas.home, self.parameters
            best = self.atlas.best_chart(
                self.charts, home, point, numbers, precision, starting=True
            )
            name = best or home
            point = self.atlas.moved(home, name, point, numbers, precision)
        self._beginnings[precision] = name, point
        return name, point

    def _starting_velocity(self, precision: int) -> Sequence[Real]:
        """u^i at the start, computed from q'^mu where more digits are needed."""
        rates = self.coordinate_velocity
        if precision <= 53 or rates is None or self.start is None:
            return self.frame_velocity
        chart = self.chart(self.atlas.home)
        point = dict(zip(chart.names, self.start, strict=True)) | dict(self.parameters)
        return chart.coframe.precisely(point, rates, precision + 20)

    def _stage(
        self, label: str, point: MovingPoint, begin: float, precision: int, perturbation: float
    ) -> Stage:
        """The motion in one chart from a time on, and the stage after it where the chart ends."""
        equations = self.equations(label)
        moving = point.velocities if equations.moves else []
        numbers: Sequence[Real] | np.ndarray = equations.numbers(self.parameters, point.velocities)
        states: Sequence[Real] | np.ndarray = [*point.coordinates, *moving, *point.carried]
        if perturbation:
            if not begin:
                states = perturbed(states, perturbation, precision, all_of_them=True)
            numbers = perturbed(numbers, perturbation, precision, all_of_them=False)
        if equations.clock:
            # It begins exactly where it does.
            place, rows = len(point.coordinates) + len(moving), list(states)
            states = [*rows[:place], begin / CLOCK, *rows[place:]]
        if precision == 53:
            states, numbers = (np.array(floats(row)) for row in (states, numbers))
        follow = stop = None
        if len(self.charts) > 1:
            follow = self._follower(label, point.velocities, precision, perturbation)
        system = self.system(label)
        if self.stops:
            stop = partial(stopped, self.stops, system, states, numbers)
        event = Event(None, follow, self._ender(label, floats(states)), stop)
        groups = equations.groups
        return Stage(label, system, states, numbers, begin, (event,), groups=groups)

    def stop_terms(self, label: str) -> list[sp.Expr]:
        """The conditions that end the curve, over the states of a chart."""
        equations = self.equations(label)
        return terms_in_chart(self.stops, self.atlas, label, equations, self.time_unit)

    def system(self, label: str) -> System:
        """Equations for the engines in a chart, with the conditions that end the curve."""
        if label not in self._systems:
            self._check_values()
            equations, single = self.equations(label), len(self.charts) == 1
            system = equations.system.to_the_end if single else equations.system
            if self.stops:
                system = with_stops(
                    system, equations, self.stops, self.atlas, label, self.time_unit, single=single
                )
            self._systems[label] = system
        return self._systems[label]

    def _follower(
        self, label: str, velocities: Numbers, precision: int, perturbation: float
    ) -> Callable[[float, State], Stage | None]:
        """The stage after a chart: the motion in the next one."""

        def follow(time: float, state: State) -> Stage | None:
            point = self._taken_apart(label, state, velocities)
            target = self.atlas.best_chart(self.charts, label, point, self.parameters, precision)
            if target is None:
                return None
            there = self.atlas.moved(label, target, point, self.parameters, precision)
            return self._stage(target, there, time, precision, perturbation)

        return follow

    def _ender(
        self, label: str, start: Sequence[float]
    ) -> Callable[[float, State], tuple[str, str]]:
        """How a motion ends at the edge of its chart, at the nearest one if there are several."""

        def ending(_: float, state: State) -> tuple[str, str]:
            edges = self.chart(label).edges if label else ()
            if not edges:
                return "stuck", "no other chart of the space reaches further"
            chart = self.chart(label)
            numbers = {name: float(value) for name, value in self.parameters.items()}
            here, there = (
                chart.at_edges(numbers | dict(zip(chart.names, place, strict=False)))
                for place in (floats(list(state)), start)
            )
            return "stuck", edges[nearest_to_zero(here, there)].words

        return ending

    def _taken_apart(self, label: str, state: State, velocities: Numbers) -> MovingPoint:
        """Coordinates, velocities and carried quantities, from a vector of states."""
        equations, values = self.equations(label), list(state)
        width, n = equations.width, len(velocities)
        if equations.moves:
            carried = values[equations.plain_width :]
            return MovingPoint(values[:width], values[width : width + n], carried)
        return MovingPoint(values[:width], velocities, values[width:])

    def rows(self, segment: Segment, states: np.ndarray, label: str) -> np.ndarray:
        """States of a segment in another chart, angles as the maps give them."""
        if segment.label == label:
            return states
        bits = precision_of(states)
        q, u, carried = readout.taken_apart(self, [(segment, states)], bits)
        q, u = readout.mapped(self, segment.label, label, q, u, bits)
        moving = [u] if self.equations(label).moves else []
        return np.concatenate([q, *moving, carried], axis=1)

    def _own_velocities(self, segment: Segment) -> list[Real]:
        """u^i of a segment where they are constant (in units of the time), else zeros."""
        equations = self.equations(segment.label)
        if equations.moves:
            return [0.0] * len(equations.velocities)
        table = dict(zip(equations.parameters, segment.stage.parameters, strict=True))
        return [table[name] for name in equations.velocities]

    def _edge_approached(self, trajectory: Trajectory) -> Edge | None:
        """The edge to which a motion only tends: rounding errors have carried it across.

        The distance to such an edge shrinks by a fixed fraction per time, so that a rounding error
        in it lasts as long as the motion did. A motion that reaches an edge crosses it at once.
        """
        segment = trajectory.segments[-1]
        chart = self.chart(segment.label) if segment.label else None
        if chart is None or not chart.edges:
            return None
        point = self._taken_apart(segment.label, segment.last, self._own_velocities(segment))
        numbers = {name: float(value) for name, value in self.parameters.items()}
        last, first = np.array(floats(point.coordinates)), np.array(floats(segment.stage.first))
        first = first[: len(last)]
        start, end, inside = (
            numbers | dict(zip(chart.names, place.tolist(), strict=True))
            for place in (first, last, last + EPS * (first - last))
        )
        before, left, room = (chart.at_edges(place) for place in (start, end, inside))
        k = nearest_to_zero(left, before)
        if not abs(left[k]) <= trajectory.tolerance * abs(before[k]):
            return None
        change = abs(chart.edge_rates(inside, point.velocities)[k] * trajectory.reached)
        # The part used up per time: some ten in an exponential, 1 / EPS^(1 / p) in a power p.
        return chart.edges[k] if change <= EPS ** (-1 / 4) * room[k] else None

    def stuck_error(self, trajectory: Trajectory) -> ChartEdgeError | AccuracyError:
        """Error that reports where and why a motion ended, with a remedy."""
        edge = self._edge_approached(trajectory)
        if edge is not None:
            return AccuracyError(
                f"expected a motion to t = {trajectory.reached / self.time_unit:.6g} and beyond, "
                f"got rounding errors larger than the remaining {edge.element.sympy}: "
                f"{edge.condition}, and the motion approaches the edge without reaching it. Use "
                "Taylor(precision=113) or more, a coordinate that is the logarithm of "
                f"{edge.element.sympy}, or a shorter time. The computed part is in the error's "
                "`solution`."
            )
        segment = trajectory.segments[-1]
        label = segment.label
        chart = self.chart(label) if label else None
        names = chart.names if chart else self.equations("").velocities
        last = floats(segment.last)[: len(names)]
        pairs = zip(names, last, strict=True)
        place = ", ".join(f"{name} = {x:.6g}" for name, x in pairs if math.isfinite(x))
        advice = "The space has one chart only; give an atlas with another, or stop earlier."
        if len(self.charts) > 1:
            advice = "No other chart of the space reaches further; stop earlier."
        elif len(self.atlas.makers) > 1 and self.law.needs_frame:
            advice = (
                "The equation depends on the frame itself, so it cannot continue in another chart. "
                "Stop earlier."
            )
        elif self.carried is not None and not self.carried.any_chart:
            advice = (
                "The transported vectors are given in this frame, which ends here; stop earlier."
            )
        elif self.stops and len(self.atlas.makers) > 1:
            terms = ", ".join(stop.text for stop in self.stops)
            advice = (
                f"Other charts cannot state the condition to stop ({terms}); use coordinates that "
                "they give without jumps, or stop earlier."
            )
        elif len(self.atlas.makers) > 1:
            advice = f"Allow another chart of {', '.join(self.atlas.makers)}, or stop earlier."
        # A coordinate may also be called t.
        which = " (the curve parameter), in coordinates" if "t" in names else ","
        return ChartEdgeError(
            f"the motion stops at t = {trajectory.reached / self.time_unit:.6g}{which} at {place}: "
            f"chart {label!r} ends there ({self._end_in_words(trajectory)}). "
            f"{chart.end if chart else ''}"
            f"{advice} The computed part is in the error's `solution`."
        )

    def _end_in_words(self, trajectory: Trajectory) -> str:
        """The reason why a motion ended; for a pole of the rates the edge that it has reached."""
        segment = trajectory.segments[-1]
        chart = self.chart(segment.label) if segment.label else None
        if trajectory.reason != AT_A_POLE or chart is None or not chart.edges:
            return trajectory.reason
        numbers = {name: float(value) for name, value in self.parameters.items()}
        states = (floats(x)[: len(chart.names)] for x in (segment.stage.first, segment.last))
        before, left = (
            chart.at_edges(numbers | dict(zip(chart.names, state, strict=True))) for state in states
        )
        k = nearest_to_zero(left, before)
        reached = abs(left[k]) <= math.sqrt(EPS) * abs(before[k])
        return chart.edges[k].words if reached else trajectory.reason

    # -- reading a solution ----------------------------------------------------------------------

    def moment(
        self,
        times: np.ndarray,
        pieces: Sequence[tuple[Segment, np.ndarray]],
        shape: tuple[int, ...],
        bits: int,
        names: Collection[str] | None = None,
    ) -> Moment:
        """Coordinates, velocities and carried quantities in the home chart; `names`: only these."""
        if names is not None and not set(names) - {*self.coordinates, *self.parameters, "t"}:
            return readout.places(self, times, pieces, shape)
        return readout.moment(self, times, pieces, shape, bits)

    def read_gaps(
        self, one: Trajectory, two: Trajectory, count: int, accuracy: float
    ) -> list[tuple[np.ndarray, float]]:
        """Differences of coordinates and velocities in the home chart, each with its size."""
        return readout.gaps(self, one, two, count, accuracy)

    def member_gaps(
        self, members: Members, one: Rows, two: Rows, accuracy: float
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """Pairs of values of two runs of members in the home chart, each (number, m, n)."""
        return readout.member_gaps(self, members, one, two, accuracy)

    def together(self, name: str) -> tuple[str, ...]:
        """Coordinates, velocities or carried components that share one size in error estimates."""
        equations = self.equations(self.atlas.home)
        if name in equations.velocities:
            return tuple(equations.velocities)
        groups = ([equations.states[k] for k in group] for group in equations.groups)
        return next((tuple(group) for group in groups if name in group), ())

    def in_chart(self, trajectory: Trajectory, name: str) -> np.ndarray:
        """Coordinates of all samples in a chart."""
        self.chart(name)
        return readout.in_chart(self, trajectory, name)

    def continued(self, points: np.ndarray, chart: str) -> np.ndarray:
        """Points of the curve in a chart, shape (m, n), without jumps of angles by full turns."""
        return readout.continued(self, chart, points)

    def invariant_changes(self, trajectory: Trajectory) -> dict[str, np.ndarray]:
        """Relative change of each invariant at each sample, counted separately in each chart."""
        return readout.invariant_changes(self, trajectory)

    def term(self, term: object) -> Term:
        """A function of moments for a coordinate, a velocity or an expression over these."""
        equations = self.equations(self.charts[0])
        names = (*(self.coordinates if self.start is not None else ()), *equations.velocities)
        names = (*names, *equations.carried)
        every = tuple(dict.fromkeys((*names, *self.parameters, "t")))
        read = expression(term, "event_times", symbol_table(every), smooth=False)
        used = sorted(symbol.name for symbol in read.free_symbols)
        function = graph(used, [read], factor=False).numpy()
        numbers = {name: float(value) for name, value in self.parameters.items()}

        def values(moment: Moment) -> np.ndarray:
            table = {"t": moment.time} | numbers
            return function(*(moment[name] if name in names else table[name] for name in used))[0]

        return Term(values, frozenset(used))

    def slopes(self, term: object, by: str, moment: Moment) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives of a term by a parameter at fixed times, and by the curve parameter."""
        equations = self.equations(self.charts[0])
        rates = equations.expressions
        times = ("t", *((equations.clock,) if equations.clock else ()))
        every = tuple(dict.fromkeys((*rates, *self.parameters, *times)))
        read = expression(term, "event_times", symbol_table(every), smooth=False)
        terms = term_slopes(read, rates, by, "t", tuple(self.parameters))
        function = graph(every, list(terms), factor=False).numpy()
        numbers = {name: float(value) for name, value in self.parameters.items()}
        table = dict.fromkeys(times, moment.time) | numbers | {x: moment[x] for x in rates}
        across, along = function(*(table[name] for name in every))
        return across, along

    def breaks(self) -> tuple[float, ...]:
        """Times of jumps: none."""
        return ()

    def pulses(self, end: float) -> tuple[float, ...]:
        """No times: rates depend on the place."""
        return ()

    def columns(self, moment: Moment) -> dict[str, np.ndarray]:
        """Named columns for tables: t, coordinates, coordinate and frame velocities."""
        table = {"t": moment.time}
        names = self.coordinates if self.start is not None else ()
        table |= {name: moment[name] for name in names}
        table |= {f"{x}'": moment.velocity[..., k] for k, x in enumerate(names)}
        equations = self.equations(self.charts[0])
        return table | {x: moment[x] for x in (*equations.velocities, *equations.carried)}

    def described(self) -> dict[str, Any]:
        """Law, space, start and numbers as plain text, for files."""
        return {
            "name": self.name,
            "law": self.law.text,
            "space": self.frame.name,
            "equations": self.text,
            "coordinates": list(self.coordinates),
            "parameters": {name: _number(value) for name, value in self.parameters.items()},
            "start": None if self.start is None else [_number(x) for x in self.start],
            "frame_velocity": [_number(x) for x in self.frame_velocity],
            "carried": [_number(x) for x in self.carried.start] if self.carried else [],
            "charts": list(self.charts),
            "stops": [stop.text for stop in self.stops],
        }

    # -- many starts -----------------------------------------------------------------------------

    def bundle(self, columns: Mapping[str, np.ndarray]) -> dict[str, object]:
        """Arguments of `solve_many` for members that differ in some coordinates and velocities.

        columns: one of `variables` without the parameters -> its values, shape (number,).

        Raises
        ------
        UnknownNameError
            the start has no such coordinate or velocity.
        """
        names = [name for name in self.variables if name not in self.parameters]
        own = {name: float(self.variables[name]) for name in names}
        number = len(next(iter(columns.values())))
        for name in columns:
            checks.known_name(name, own, "start", UnknownNameError)
        table = own | dict(columns)
        rows = np.array([np.broadcast_to(table[name], number) for name in names]).T
        width = 0 if self.start is None else len(self.start)
        kind = "frame_velocities" if self.coordinate_velocity is None else "velocities"
        lists: dict[str, object] = {kind: rows[:, width:]}
        return lists if self.start is None else lists | {"starts": rows[:, :width]}

    def members(
        self, starts: object, velocities: object = None, frame_velocities: object = None
    ) -> Members:
        """Members of an ensemble, from lists of numbers; see `solve_many`."""
        place, speed = start_lists(self, starts, velocities, frame_velocities)
        return laid_out(self, place, speed)

    def member(self, members: Members, k: int) -> CurveProblem:
        """One member as a problem of its own."""
        place = members.varied.get("start")
        return replace(
            self,
            start=None if place is None else tuple(place[k].tolist()),
            frame_velocity=tuple(members.varied["frame_velocity"][k].tolist()),
            coordinate_velocity=None,
        )

    def read_members(
        self, members: Members, rows: Rows, times: np.ndarray
    ) -> dict[str, np.ndarray]:
        """Coordinates and frame velocities, shapes (number, m, n), and each by its name.

        times: the same for all members, shape (m,), or of each, shape (number, m).
        """
        return readout.read_members(self, members, rows, times)


def _number(value: Real) -> str:
    return value.hex() if isinstance(value, float) else str(value)


CAUSAL = ("timelike", "null", "spacelike")


def checked_parameters(
    frame: Frame, parameters: Mapping[Any, Any] | None, more: Iterable[sp.Symbol] = ()
) -> dict[str, Real]:
    """Parameters by name, each one known to the frame, finite and as it was declared.

    more: parameters that occur only in forces.
    """
    symbols = {s.name: s for s in (*frame.field.symbols, *more) if s not in frame.coordinates}
    numbers: dict[str, Real] = {}
    for name, value in checks.by_name(parameters, "parameters", StartError).items():
        kind = "a parameter of this frame"
        checks.known_name(name, symbols, "parameters", StartError, expected=kind)
        checked_numbers([value], 1, f"parameter {name}")
        checks.check_declared(symbols[name], value)
        numbers[name] = value
    return numbers


def in_order(values: object, names: Sequence[str], what: str) -> object:
    """Values with names (a mapping, a Series) in the order of the names; lists as given.

    Raises
    ------
    StartError
        A name is unknown or has no value.
    """
    named = checks.labelled(values)
    if named is None:
        return values
    by_name = checks.known_keys(named, names, what, StartError)
    checks.check_values(names, by_name, what, StartError, "Add it.")
    return [by_name[name] for name in names]


def checked_start(frame: Frame, start: object, parameters: Mapping[str, Real]) -> tuple[Real, ...]:
    """Coordinates at which the frame is regular."""
    names = [symbol.name for symbol in frame.coordinates]
    start = in_order(start, names, "start")
    place = checked_numbers(start, frame.dimension, f"start ({', '.join(names)})")
    for symbol, value in zip(frame.coordinates, place, strict=True):
        if sign_of(frame, symbol):
            checks.check_declared(symbol, value)
    point = {s.name: float(x) for s, x in zip(frame.coordinates, place, strict=True)}
    where = ", ".join(f"{name} = {value:.6g}" for name, value in point.items())
    point |= _of_frame(frame, parameters)
    try:
        size = abs(complex(frame.determinant.element().evaluate(point)))
        if not _has_legs(frame, point):
            frame.legs.at(point)
    except MissingValueError as error:
        # The error names the parameter, and how to add it to a point, which is the start here.
        missing = str(error).partition(" Add ")[0]
        raise StartError(f"{missing} Give parameters={{...}}.") from None
    except BranchError as error:
        # The frame may be regular there, but was read for the other side.
        raise StartError(f"start {where}: {error}") from None
    except (SingularPointError, ZeroDivisionError):
        size = 0.0
    if size == 0.0 or not math.isfinite(size):
        raise StartError(
            f"the frame {frame.name or ''}".rstrip() + f" is singular at the start {where}: its "
            f"determinant vanishes or has no value. {_advice(frame, point)}"
        )
    return place


def _of_frame(frame: Frame, parameters: Mapping[str, Real]) -> dict[str, float]:
    """Values of the parameters of the frame, without parameters of forces."""
    names = {symbol.name for symbol in frame.field.symbols}
    return {name: float(value) for name, value in parameters.items() if name in names}


def _advice(frame: Frame, point: Mapping[str, float]) -> str:
    """Where to start instead of at a point where the frame is singular."""
    symbols = (*frame.coordinates, *frame.parameters)
    values = {symbol: point[symbol.name] for symbol in symbols}
    outside = broken_relations(frame.domain, values)
    if not outside:
        around = _charts_around(frame, point)
        return f"{around}Start {'there, or ' if around else ''}away from the edge of the chart."
    return f"The domain is {', '.join(map(str, outside))}. Start inside."


def _charts_around(frame: Frame, point: Mapping[str, float]) -> str:
    """Which other charts hold at a point where the home chart ends, and its coordinates there."""
    atlas, hints = atlas_of(frame), []
    place = [point[symbol.name] for symbol in frame.coordinates]
    for name in atlas.names:
        if name == atlas.home or atlas.chart(name).frame is None:
            continue
        there: Any = place
        for change in atlas.route(atlas.home, name):
            there = change(there, point)
        chart = atlas.chart(name)
        values = {key: float(x) + 0.0 for key, x in zip(chart.names, there, strict=True)}
        if np.isfinite(there).all() and not (chart.at_edges({**point, **values}) <= 0).any():
            listed = ", ".join(f"{key} = {value:.6g}" for key, value in values.items())
            hints.append(
                f"Chart {name!r} covers this point, at {listed}; its frame is "
                f"problem.atlas.chart({name!r}).frame of any curve of this space. "
            )
    return "".join(hints)


def _has_legs(frame: Frame, point: Mapping[str, float]) -> bool:
    """Whether doubles give all legs at a point, on the right branches; exact work takes longer."""
    atlas = atlas_of(frame)
    try:
        values = atlas.chart(atlas.home).frame_vectors.values(point)
    except (KeyError, GeomtorsionError):
        # Exact work names the missing value.
        return False
    branches = branch_check([frame.field], list(point))
    on_branches = branches is None or not branches.broken(*point.values()).any()
    return on_branches and not frame.complex and bool(np.isfinite(values).all())


def frame_velocities(
    frame: Frame,
    start: Sequence[Real] | None,
    velocity: object,
    frame_velocity: object,
    parameters: Mapping[str, Real],
) -> tuple[tuple[Real, ...], tuple[Real, ...] | None]:
    """u^i, as given or from the coordinate velocity, and that velocity if it was given."""
    if (velocity is None) == (frame_velocity is None):
        came = "none" if velocity is None else "both"
        raise StartError(
            f"expected either velocity (q'^mu) or frame_velocity (u^i), got {came}. Give one of "
            "them."
        )
    if velocity is None:
        ordered = in_order(frame_velocity, velocity_names(frame), "frame_velocity")
        return checked_numbers(ordered, frame.dimension, "frame_velocity"), None
    names = [symbol.name for symbol in frame.coordinates]
    rates = checked_numbers(in_order(velocity, names, "velocity"), frame.dimension, "velocity")
    if start is None:
        raise StartError(
            "velocity: expected a start with it, got none. Give a start, or frame_velocity (u^i)."
        )
    point = {s.name: float(x) for s, x in zip(frame.coordinates, start, strict=True)}
    point |= _of_frame(frame, parameters)
    coframe = frame.coframe.at(point)
    speeds = np.real(coframe) @ np.array(floats(rates))
    return tuple(speeds.tolist()), rates


def check_causal(frame: Frame, velocity: Sequence[Real], causal: str | None) -> None:
    """Refuse a velocity without the requested causal character."""
    if causal is None:
        return
    checks.choice(causal, CAUSAL, "causal", StartError)
    eta = np.real(frame.eta.at({}))
    squares = np.linalg.eigvalsh(eta)
    if squares.min() > 0:
        raise StartError(
            f"causal={causal!r}: expected a metric with time, got a Euclidean one. Omit causal."
        )
    u = np.array([float(x) for x in velocity])
    norm, size = float(u @ eta @ u), float(abs(eta).max() * (u @ u))
    # Null up to rounding: the norm is negligible against its terms.
    is_null = abs(norm) <= CALCULATED * size
    # Time is the one direction whose square has the other sign; in two dimensions the negative one.
    time = 1 if (squares > 0).sum() == 1 < (squares < 0).sum() else -1
    nature = "null" if is_null else ("timelike" if time * norm > 0 else "spacelike")
    if nature != causal:
        raise StartError(
            f"expected a {causal} velocity, got a {nature} one: eta_ij u^i u^j = {norm:.6g}. Give "
            "another velocity, or causal=None."
        )
