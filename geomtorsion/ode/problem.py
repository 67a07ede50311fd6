"""ODE: first-order equations with a start, events, outputs and invariants, and their maker."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Protocol, TypeVar

import mpmath
import numpy as np
import sympy as sp

from geomtorsion.codegen import Graph, graph
from geomtorsion.errors import ExpressionError, StartError, StuckError, UnknownNameError
from geomtorsion.ode import constructor
from geomtorsion.ode.centre import Centre
from geomtorsion.ode.changes import change_times
from geomtorsion.ode.derivatives import Motion, term_slopes
from geomtorsion.ode.engines import Taylor
from geomtorsion.ode.members import Members, Rows
from geomtorsion.ode.moment import Moment, Term
from geomtorsion.ode.numbers import Numbers, Real, floats, mpf, perturbed
from geomtorsion.ode.pieces import BranchedGraph, has_pieces, term_graph
from geomtorsion.ode.pulses import pulses
from geomtorsion.ode.rates import CLOCK, Rates, names_in
from geomtorsion.ode.roots import shares_left
from geomtorsion.ode.stages import Stages
from geomtorsion.ode.switching import Switching
from geomtorsion.ode.system import System
from geomtorsion.ode.terms import At, Terms, When, moments
from geomtorsion.ode.trajectory import Event, Segment, Stage, State, Trajectory
from geomtorsion.ode.uniqueness import undecided_root
from geomtorsion.ode.writing import number_text, numbers_text, term_text, terms_text
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.copies import ByContent
from geomtorsion.support.displays import drawn_by, latex_of
from geomtorsion.support.hints import attribute_hints
from geomtorsion.support.precision import HALF, working_precision

_Changing = TypeVar("_Changing", At, When)


class Maker(Protocol):
    """Source of equations that contain effects, such as the force on a spin.

    title: its name. effects: key -> description of each effect that can be omitted.
    watch: names of the states and outputs of first interest.
    """

    @property
    def title(self) -> str:
        """Its name."""
        ...

    @property
    def effects(self) -> Mapping[str, str]:
        """Key -> description of each effect that can be omitted."""
        ...

    @property
    def watch(self) -> tuple[str, ...]:
        """Names of the states and outputs of first interest."""
        ...

    def without(self, ode: ODE, effects: frozenset[str]) -> ODE:
        """The equations without some effects, with the numbers of an ODE of this maker."""
        ...

    def moved(self, ode: ODE, part: float) -> ODE:
        """The equations from a start that is moved by a part of its size, within constraints."""
        ...


@attribute_hints(solve="gt.solve(problem, times)")
@dataclass(frozen=True, eq=False)
class ODE(ByContent):
    """First-order equations x' = f(x, parameters, t) with a start; made by `ODE.of`.

    rates: the equations.
    start: numbers in the order of the states, at t = 0.
    parameters: name -> number, the initial values.
    invariants, outputs: name -> expression, or expressions that make a vector.
    events: changes at times; first those at numbers, in order.
    normalized: groups of states that form a unit vector, such as the four of a quaternion.
    name: used in tables and files.
    switches: conditions with changes.
    resting: states that are constant between these changes.
    varied: names with respect to which the last states are derivatives; see `with_derivatives`.
    maker: the object that made the equations and can omit effects from them, or None; comparisons
        ignore it.
    centre: the pole of the rates beside which they start, for `prove`, or None.

    Examples
    --------
    >>> from geomtorsion.ode import ODE, solve
    >>> swing = ODE.of({"x": "v", "v": "-k*x"}, {"x": 1, "v": 0}, parameters={"k": 4},
    ...                invariants={"energy": "v**2/2 + k*x**2/2"})
    >>> print(swing)
    ODE of x, v
    >>> solution = solve(swing, 1.0)
    >>> round(float(solution["x"][-1]), 9)
    -0.416146837
    """

    rates: Rates
    start: tuple[Real, ...]
    parameters: Mapping[str, Real]
    invariants: Mapping[str, Terms]
    outputs: Mapping[str, Terms]
    events: tuple[At, ...] = ()
    normalized: tuple[tuple[str, ...], ...] = ()
    name: str = ""
    switches: tuple[When, ...] = ()
    resting: tuple[str, ...] = ()
    varied: tuple[str, ...] = ()
    maker: Maker | None = field(default=None, compare=False, repr=False)
    centre: Centre | None = field(default=None, compare=False, repr=False)
    _stages: dict[tuple[int, float], Stage] = field(default_factory=dict, repr=False, init=False)

    # Trajectories count time as users do.
    time_unit = 1.0
    # What files call it.
    kind = "ode"

    @classmethod
    def of(
        cls,
        rates: object,
        start: Mapping[str, object] | Numbers,
        *,
        parameters: Mapping[str, object] | None = None,
        invariants: Mapping[str, object] | None = None,
        outputs: Mapping[str, object] | None = None,
        time: str | sp.Symbol = "t",
        events: Iterable[At | When] = (),
        norm_groups: Sequence[Sequence[str]] | None = None,
        normalized: Sequence[Sequence[str]] = (),
        name: str = "",
        tables: Mapping[str, object] | None = None,
    ) -> ODE:
        """Equations from the input of a user, checked once; names may be symbols of sympy.

        Parameters
        ----------
        rates
            state -> expression (text, sympy, exact element or number) over states, parameters
            and the time; or an object with such `rates`, and `invariants` if it knows some.
            pieces(x, a, 1, b) is a for x < 1 and b from there on, with more levels as needed;
            sympy's Piecewise is read in the same way. The solver restarts at each level.
        start
            state -> number at t = 0, or numbers in the order of the rates.
        parameters
            name -> number; other numbers later need no new compilation.
        invariants
            name -> expression (or expressions) that should not change; a solution gives their
            drift.
        outputs
            name -> expression, or expressions that make a vector; they are read off a solution.
        time
            the name of the time in all these.
        events
            `At(time, {name: value})`: from exactly this time on a parameter has a new value, or a
            state starts from a new one. `When(expression)`: where it falls through zero the
            motion ends; `When(expression, {name: value})`: there it changes. Values and times may
            be expressions. A parameter whose change depends on the motion becomes a state.
        norm_groups
            groups of states whose errors are measured against their common size; by default
            those whose names differ in a number or in x, y, z at the end.
        normalized
            groups of states that form a unit vector, such as a quaternion; their length is kept.
        name
            name of the equations in tables and files.
        tables
            name -> `Table`, a function in all expressions: {"F": table} and "F(t)/m".

        Raises
        ------
        ExpressionError
            an expression cannot be read, or contains a name that is not known.
        StartError, ShapeError, UnknownNameError
            numbers are missing, too many or not finite, or names are unknown.
        TimeError
            an event has no time, or one before the start.
        CoordinateError
            a number contradicts the assumptions of a parameter, a symbol of sympy in the rates.

        Examples
        --------
        >>> top = ODE.of(
        ...     {"Omega1": "-Omega2*Omega3", "Omega2": "Omega1*Omega3", "Omega3": 0},
        ...     [1, 0, 2],
        ...     invariants={"energy": "Omega1**2 + Omega2**2 + Omega3**2"},
        ... )
        >>> print(top.text)
        Omega1' = -Omega2*Omega3
        Omega2' = Omega1*Omega3
        Omega3' = 0
        """
        time = constructor.named(time)
        normalized = [[constructor.named(x) for x in group] for group in normalized]
        if norm_groups is not None:
            norm_groups = [[constructor.named(x) for x in group] for group in norm_groups]
        try:
            fields = constructor.read(
                rates, start, parameters, invariants, outputs, time, events, norm_groups,
                normalized, tables,
            )  # fmt: skip
            groups = tuple(tuple(group) for group in normalized)
            problem = cls(*fields[:6], groups, name, *fields[6:])
            problem.check_lengths()
            # Made now, so that what cannot be compiled is reported here.
            _ = problem.system
        except RecursionError:
            raise ExpressionError(
                "rates: an expression is nested too deeply to be read. Write it with fewer nested "
                "functions or brackets."
            ) from None
        return problem

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states."""
        return self.rates.states

    @property
    def time_name(self) -> str:
        """Name of the time in messages."""
        return self.rates.time

    @cached_property
    def size(self) -> int:
        """Number of states."""
        return len(self.rates.states)

    @property
    def system(self) -> System:
        """The system for engines: the states, and a clock if the rates depend on time.

        If the equations change on the way, the first of their systems.
        """
        return self.first_stage(53, 0.0).system if self.is_switched else self.rates.system

    @cached_property
    def is_switched(self) -> bool:
        """Whether the equations change at levels of terms, or at times that parameters shift."""
        expressions = any(
            isinstance(x, sp.Expr) for one in self.events for x in (one.time, *one.changes.values())
        )
        terms = (*self.rates.expressions.values(), *self.rates.stops)
        return bool(self.switches) or expressions or has_pieces(terms)

    @cached_property
    def _switching(self) -> Switching:
        return Switching(self)

    @cached_property
    def timed(self) -> list[tuple[At, int]]:
        """Events with numbers for their times, in order, each with its index in `events`."""
        return moments(self.events, self.parameters)

    # -- variants --------------------------------------------------------------------------------

    def with_start(
        self,
        start: Mapping[str, object] | Numbers | None = None,
        parameters: Mapping[str, object] | None = None,
        events: Iterable[At] | None = None,
    ) -> ODE:
        """The same equations from another start or with other numbers, without new compilation.

        Parameters
        ----------
        start
            name -> number for the states that change, or all numbers in order.
        parameters
            name -> number for the parameters that change.
        events
            all changes at given times; they replace the earlier ones.

        Examples
        --------
        >>> fall = ODE.of({"z": "v", "v": "-g"}, [0, 1], parameters={"g": 9.81})
        >>> fall.with_start(start={"v": 5}, parameters={"g": 1.6}).start
        (0, 5)
        """
        new_start, numbers, timed = self.start, dict(self.parameters), self.events
        if start is not None:
            new_start = constructor.start_numbers(self.states, start, self.start)
        if parameters is not None:
            table = checks.by_name(parameters, "parameters", StartError)
            resting = {name: x for name, x in table.items() if name in self.resting}
            new_start = constructor.start_numbers(self.states, resting, new_start)
            table = {name: x for name, x in table.items() if name not in resting}
            numbers |= constructor.parameter_numbers(self.rates.parameters, table)
        if events is not None:
            timed = constructor.timed_events((*self.states, *self.rates.parameters), events)
        for values in (numbers, *map(constructor.numbers_in, timed)):
            constructor.check_declared(self.rates.declared, values)
        # Other numbers have another series at a pole.
        centre = self.centre if start is None and parameters is None else None
        problem = replace(self, start=new_start, parameters=numbers, events=timed, centre=centre)
        problem.check_lengths()
        # Outputs and invariants are the same expressions: their code is made once.
        if "term_graphs" in vars(self):
            vars(problem)["term_graphs"] = self.term_graphs
        return problem

    @property
    def variables(self) -> dict[str, Real]:
        """Parameters and numbers at the start, by name: what derivatives and fits may vary.

        A state of a normalized group has no start of its own, and does not count.

        Examples
        --------
        >>> ODE.of({"x": "k*x"}, [1], parameters={"k": 2}).variables
        {'k': 2, 'x': 1}
        """
        held = {name for group in self.normalized for name in group}
        states = zip(self.states, self.start, strict=True)
        return dict(self.parameters) | {name: x for name, x in states if name not in held}

    def with_values(self, values: Mapping[str, object]) -> ODE:
        """The same equations with other `variables`, by name; nothing is compiled again.

        Examples
        --------
        >>> ODE.of({"x": "k*x"}, [1], parameters={"k": 2}).with_values({"k": 3}).variables
        {'k': 3, 'x': 1}
        """
        table = checks.known_keys(values, self.variables, "values", StartError)
        numbers = {name: x for name, x in table.items() if name in self.rates.parameters}
        start = {name: x for name, x in table.items() if name not in numbers}
        return self.with_start(start or None, numbers or None)

    def with_derivatives(self, by: object) -> ODE:
        """The same motion with its derivatives by parameters, or by the start of states.

        The derivative of x by k is the state `dx_dk`; outputs also have derivatives. `variables`
        lists what may vary.

        Equation
        --------
        (dx/dp)' = (df/dx) (dx/dp) + df/dp

        Raises
        ------
        UnknownNameError, StartError
            a name is unknown, repeated or missing.
        ExpressionError
            the equations have no derivative, or its name is taken.

        Examples
        --------
        >>> growth = ODE.of({"x": "k*x"}, [1], parameters={"k": 2})
        >>> print(growth.with_derivatives(["k"]).text)
        x' = k*x
        dx_dk' = dx_dk*k + x
        """
        fields = self.rates, self.start, self.parameters, self.outputs, self.events
        parts = Motion(*fields, tuple(self.variables)).derivatives(by)
        return replace(self, **parts, maker=None, centre=None)

    @property
    def effects(self) -> Mapping[str, str]:
        """Key -> description of each effect that `without` can omit.

        Equations of `spinning` and of `gravity.solve` have some, equations of `ODE.of` have none.
        """
        return {} if self.maker is None else self.maker.effects

    @property
    def main_names(self) -> tuple[str, ...]:
        """Names of first interest: what the maker names, otherwise all states."""
        return self.states if self.maker is None else self.maker.watch

    def without(self, *effects: str) -> ODE:
        """The same motion without some of its effects.

        Raises
        ------
        UnknownNameError
            it has no such effect.

        Examples
        --------
        >>> from geomtorsion.curves import spinning
        >>> start, velocity = [0, 10, 1.5707963267948966, 0], [1.2, 0, 0, 0.04]
        >>> top = spinning("schwarzschild", start, velocity, [0, 0, -0.1, 0],
        ...                coupling="orbital", parameters={"M": 1})
        >>> list(top.effects), list(top.without("spin_force").effects)
        (['spin_force', 'hidden_momentum'], ['hidden_momentum'])
        """
        for key in effects:
            checks.known_name(key, self.effects, "effect", UnknownNameError)
        if self.maker is None or not effects:
            return self
        return self.maker.without(self, frozenset(effects))

    def restricted(self, names: Iterable[str]) -> ODE:
        """The same motion with only the states on which some states and outputs depend.

        Invariants and other outputs that need more states are omitted.

        Raises
        ------
        UnknownNameError
            nothing has this name.

        Examples
        --------
        >>> print(ODE.of({"x": "v", "v": "-x", "work": "v**2"}, [1, 0, 0]).restricted(["v"]))
        ODE of x, v
        """
        every = {name: flat({name: terms}) for name, terms in self.outputs.items()}
        every |= {name: [sp.Symbol(name, real=True)] for name in self.states}
        listed = checks.entries(names, "names", UnknownNameError)
        words = [checks.known_name(name, every, "names", UnknownNameError) for name in listed]
        falls = [x for one in self.switches for x in (one.falls, *_expressions(one.changes))]
        moved = [x for one in self.events for x in _expressions(one.changes)]
        asked = [x for word in words for x in every[word]]
        needed = self.rates.needed_by([*asked, *falls, *moved], self.normalized)
        if len(needed) == self.size:
            return self

        def remaining(table: Mapping[str, Terms]) -> dict[str, Terms]:
            return {key: x for key, x in table.items() if not lost & names_in(flat({key: x}))}

        lost = {*self.states} - needed
        events = [_without_changes(one, lost) for one in self.events]
        switches = [_without_changes(one, lost) for one in self.switches]
        pairs = zip(self.states, self.start, strict=True)
        return replace(
            self,
            rates=self.rates.restricted(needed),
            start=tuple(x for name, x in pairs if name in needed),
            invariants=remaining(self.invariants),
            outputs=remaining(self.outputs),
            events=tuple(one for one in events if one.changes),
            switches=tuple(one for one in switches if one.changes),
            resting=tuple(x for x in self.resting if x in needed),
            normalized=tuple(group for group in self.normalized if not lost & {*group}),
            maker=None,
        )

    def check_lengths(self) -> None:
        """Raise an error if a normalized group does not have length one at the start."""
        constructor.check_lengths(self.states, self.start, self.normalized)

    # -- showing ---------------------------------------------------------------------------------

    @property
    def text(self) -> str:
        """The equations, line by line."""
        return "\n".join(f"{name}' = {rate}" for name, rate in self.rates.expressions.items())

    @property
    def latex(self) -> str:
        """The equations in LaTeX."""
        lines = [
            f"\\dot{{{latex_of(sp.Symbol(name))}}} &= {latex_of(rate)}"
            for name, rate in self.rates.expressions.items()
        ]
        return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"

    def _repr_latex_(self) -> str:
        return f"$${self.latex}$$"

    _repr_html_ = drawn_by("notebook_tables", "equations_html")

    def __str__(self) -> str:
        return f"{self.name or 'ODE'} of {', '.join(self.states)}"

    def __repr__(self) -> str:
        return str(self)

    # -- for the solver --------------------------------------------------------------------------

    @property
    def stop_texts(self) -> tuple[str, ...]:
        """The conditions that end the motion, as text."""
        return tuple(map(str, self.rates.stops))

    def check_start(self) -> None:
        """Raise an error if a condition that ends the motion holds at the start."""
        for stop, room in self._rooms(0.0, self.start, self.parameters).items():
            if not room >= 0:
                raise self._stopped_at_once(stop, room)
        root = undecided_root(self.rates, self.start, self.parameters)
        if root is not None:
            raise StartError(
                f"start: expected a start with one motion, got {root.base} = 0, where {root} lets "
                "a motion rest or leave at any time. Start beside it, or use equations of second "
                "order."
            )
        if self.is_switched:
            self.first_stage(53, 0.0)

    def _stopped_at_once(self, stop: str, room: float, member: str = "") -> StartError:
        """The error of a start at which a condition has fallen already."""
        return StartError(
            f"expected stop above zero at the start, got {stop} = {room:.6g}{member}. "
            "The motion ends where it decreases through zero, so start where it is positive."
        )

    def _check_members(
        self, states: np.ndarray, parameters: Mapping[str, Real | np.ndarray]
    ) -> None:
        """As `check_start`, for each member."""
        stop = self.rates.stop_graph
        if stop is None:
            return
        numbers = [np.asarray(parameters[x], dtype=float) for x in self.rates.parameters]
        rooms = stop.numpy()(*states.T, *numbers, 0.0)
        for text, row in zip(self.stop_texts, rooms, strict=True):
            room = np.broadcast_to(row, len(states))
            bad = np.flatnonzero(~(room >= 0))
            if len(bad):
                raise self._stopped_at_once(text, float(room[bad[0]]), f" for member {bad[0]}")

    def _rooms(
        self, time: float, states: State, parameters: Mapping[str, Real]
    ) -> dict[str, float]:
        """How far the motion is from each of its stops; below zero it is there."""
        stop = self.rates.stop_graph
        if stop is None:
            return {}
        values = [*states, *(parameters[name] for name in self.rates.parameters), time]
        rooms = stop.numpy()(*[float(x) for x in values]).tolist()
        return dict(zip(self.stop_texts, rooms, strict=True))

    def _ending(
        self, parameters: Mapping[str, Real], start: list[float], time: float, state: State
    ) -> tuple[str, str]:
        """How the motion ends: where it stops, or where a function in its equations ends."""
        if not self.rates.edges and len(self.rates.stops) == 1:
            return "stopped", self.stop_texts[0]
        guard = self.rates.guard_graph
        numbers = [float(parameters[name]) for name in self.rates.parameters]
        rows = [[*[float(x) for x in row[: self.size]], *numbers, time] for row in (state, start)]
        if not np.isfinite(rows[0]).all():
            return "stuck", "a state exceeds the range of floats"
        here, there = (np.array(guard.numpy()(*row)) for row in rows)
        if not np.isfinite(here).all():
            # Rounding has taken it just beyond; how far it was has a size in complex numbers.
            with suppress(ZeroDivisionError):
                here = np.array([float(abs(x)) for x in guard.exactly(rows[0])])
        shares = shares_left(here, there)
        stops = len(self.rates.stops)
        if stops:
            rooms, shares = shares[:stops], shares[stops:]
            # A stop that vanishes where a function in it ends does so as a power of the edge.
            if min(rooms) <= math.sqrt(min(shares, default=1.0)):
                return "stopped", self.stop_texts[int(np.argmin(rooms))]
        return "stuck", list(self.rates.edges.values())[int(np.argmin(shares))]

    def first_stage(self, precision: int, perturbation: float) -> Stage:
        """The first part of the motion; perturbation: relative change of the start."""
        key = precision, perturbation
        if self.is_switched and key not in self._stages:
            self._stages[key] = Stages(self._switching, precision, perturbation).first()
        if key not in self._stages:
            # A change at t = 0 comes before anything else.
            now = [event for event in self.events if event.time == 0]
            later = tuple(event for event in self.events if event.time != 0)
            parameters, start = dict(self.parameters), list(self.start)
            for event in now:
                parameters |= self._parameter_changes(event)
                start = self._jumped(start, event)
            if perturbation:
                start = perturbed(start, perturbation, precision, all_of_them=True)
            self._stages[key] = self._stage(0.0, start, parameters, later, precision, perturbation)
        return self._stages[key]

    def _stage(
        self,
        begin: float,
        start: list[Real],
        parameters: Mapping[str, Real],
        later: tuple[At, ...],
        precision: int,
        perturbation: float,
    ) -> Stage:
        """The stage from a time on, with the event that ends it."""
        start = self.normalized_state(start, precision)
        numbers: Sequence[Real] | np.ndarray = self.run_numbers(parameters)
        if perturbation:
            numbers = perturbed(numbers, perturbation, precision, all_of_them=False)
        states: Sequence[Real] | np.ndarray = start
        if self.rates.has_clock:
            states = [*start, begin / CLOCK]
        if precision == 53:
            states, numbers = (np.array(floats(row)) for row in (states, numbers))
        ending = partial(self._ending, dict(parameters), [float(x) for x in states])
        events = [] if self.system.guard is None else [Event(None, None, ending)]
        if later:
            follow = self._follower(parameters, later, precision, perturbation)
            beyond = partial(self._jumped_beyond, dict(parameters), later[0])
            events.append(Event(later[0].time, follow, beyond))
        groups = self.system.groups[:-1] if self.rates.has_clock else self.system.groups
        return Stage(
            "", self.system, states, numbers, begin, tuple(events), groups=groups,
            kept=self.normalizer(precision),
        )  # fmt: skip

    def normalized_state(self, state: Sequence[Real], precision: int) -> list[Real]:
        """A state with its normalized groups rescaled to length one."""
        values = list(state)
        for places in self._unit_places:
            _normalize(values, places, precision)
        return values

    def normalizer(self, precision: int) -> Callable[[State], State] | None:
        """The function `Stage.kept` for states of the system."""
        return partial(self._normalized, precision=precision) if self._unit_places else None

    def _normalized(self, state: State, precision: int) -> State:
        """A state of the system with its normalized groups rescaled to length one."""
        values = self.normalized_state(list(state), precision)
        return np.array(values, dtype=float) if precision == 53 else values

    def _follower(
        self,
        parameters: Mapping[str, Real],
        later: tuple[At, ...],
        precision: int,
        perturbation: float,
    ) -> Callable[[float, State], Stage | None]:
        """The stage after the next event."""
        event, rest = later[0], later[1:]
        changed = dict(parameters) | self._parameter_changes(event)

        def follow(_: float, state: State) -> Stage | None:
            start = self._jumped(list(state[: self.size]), event)
            if min(self._rooms(event.time, start, changed).values(), default=0.0) < 0:
                return None
            return self._stage(event.time, start, changed, rest, precision, perturbation)

        return follow

    def _jumped_beyond(
        self, parameters: Mapping[str, Real], event: At, _: float, state: State
    ) -> tuple[str, str]:
        """How the motion ends where a change at a time carries it beyond a stop."""
        changed = {**parameters, **self._parameter_changes(event)}
        start = self._jumped(list(state[: self.size]), event)
        rooms = self._rooms(event.time, start, changed)
        return "stopped", min(rooms, key=lambda text: rooms[text], default="")

    def _parameter_changes(self, event: At) -> dict[str, Real]:
        return {name: x for name, x in event.changes.items() if name in self.rates.parameters}

    def _jumped(self, states: list[Real], event: At) -> list[Real]:
        for name, value in event.changes.items():
            if name in self.states:
                states[self.states.index(name)] = value
        return states

    @cached_property
    def _unit_places(self) -> tuple[list[int], ...]:
        return tuple([self.states.index(name) for name in group] for group in self.normalized)

    def run_numbers(self, parameters: Mapping[str, Real]) -> list[Real]:
        """The run-time numbers of the system for values of the parameters."""
        return list(self.rates.numbers.exactly([parameters[x] for x in self.rates.parameters]))

    def rows(self, segment: Segment, states: np.ndarray, label: str) -> np.ndarray:
        """States of a segment, normalized groups rescaled to length one."""
        return self.unit_rows(states[:, : self.size])

    def read_gaps(self, *_trajectories: object) -> list[tuple[np.ndarray, float]]:
        """Empty: only states and outputs are read at the samples."""
        return []

    def member_gaps(self, *_rows: object) -> list[tuple[np.ndarray, np.ndarray]]:
        """Empty: only states and outputs are read from members."""
        return []

    def together(self, name: str) -> tuple[str, ...]:
        """States whose errors share the size of a state; empty for an output."""
        groups = ([self.states[k] for k in group] for group in self.first_stage(53, 0.0).groups)
        return next((tuple(group) for group in groups if name in group), ())

    def unit_rows(self, states: np.ndarray) -> np.ndarray:
        """Rows of states with normalized groups rescaled to length one, at their own precision."""
        if not self._unit_places or not len(states):
            return states
        states = states.copy()
        for places in self._unit_places:
            part = states[:, places]
            with np.errstate(all="ignore"):
                states[:, places] = part / np.sqrt((part * part).sum(axis=1))[:, None]
        return states

    # -- reading a solution ----------------------------------------------------------------------

    def moment(
        self,
        times: np.ndarray,
        pieces: Sequence[tuple[Segment, np.ndarray]],
        shape: tuple[int, ...],
        bits: int,
        names: Collection[str] | None = None,
    ) -> Moment:
        """States and outputs at the times of some pieces, in the requested shape."""
        parts = [self.rows(segment, states, "") for segment, states in pieces]
        states = np.concatenate(parts) if parts else np.empty((0, self.size))
        values: dict[str, np.ndarray] = {
            name: states[:, k].reshape(shape) for k, name in enumerate(self.states)
        }
        for name, value in self.read_outputs(times, states, bits).items():
            values[name] = value.reshape((*shape, *value.shape[1:]))
        values["states"] = states.reshape((*shape, self.size))
        return Moment(times.reshape(shape), values, whole=("states",))

    def arguments(
        self,
        times: np.ndarray,
        states: np.ndarray,
        varied: Mapping[str, np.ndarray] | None = None,
    ) -> list[np.ndarray]:
        """Values of states, parameters as they are at the times, and times, each shape (m,).

        states: shape (m, size); varied: parameters that differ from row to row, shape (m,).
        """
        values: list = list(states.T)
        numbers: Mapping[str, Any] = dict(self.parameters) | dict(varied or {})
        for name in self.rates.parameters:
            column: Any = numbers[name]
            if not isinstance(column, np.ndarray):
                column = float(column)
            for event in self.events:
                if name in event.changes and len(times):
                    after = times >= self._times_of(event, numbers)
                    if after.any():
                        column = np.where(after, float(event.changes[name]), column)
            values.append(column)
        return [*values, times]

    def _times_of(self, event: At, numbers: Mapping[str, Any]) -> Any:
        """The time of an event, or the times for arrays of parameters."""
        if not isinstance(event.time, sp.Expr):
            return event.time
        given = [np.asarray(numbers[x], dtype=float) for x in self.rates.parameters]
        return graph(self.rates.parameters, [event.time], factor=False).numpy()(*given)[0]

    @cached_property
    def term_graphs(self) -> tuple[Graph | BranchedGraph, Graph | BranchedGraph]:
        """Outputs and invariants over states, parameters and time."""
        first, second = (
            term_graph(self.rates.names, flat(terms)) for terms in (self.outputs, self.invariants)
        )
        return first, second

    def read_outputs(
        self, times: np.ndarray, states: np.ndarray, bits: int = 53
    ) -> dict[str, np.ndarray]:
        """Each output at the times, shape (m,) or (m, k)."""
        if not self.outputs:
            return {}
        if bits > 53:
            values = self._long_outputs(times, states, bits)
        else:
            values = self.term_graphs[0].numpy()(*self.arguments(times, states))
        return {
            name: rows.T if several else rows[0]
            for name, rows, several in _cut(self.outputs, values)
        }

    def _long_outputs(self, times: np.ndarray, states: np.ndarray, bits: int) -> np.ndarray:
        """Outputs in numbers with a number of bits, shape (size, m)."""
        engine, columns = Taylor(bits), []
        for time, row in zip(times.tolist(), states, strict=True):
            table = dict(self.parameters)
            for event, _ in self.timed:
                if time >= event.time:
                    table |= self._parameter_changes(event)
            values = [*row, *(table[name] for name in self.rates.parameters), time]
            try:
                exact = self.term_graphs[0].exactly(values, 2 * bits)
            except ZeroDivisionError:
                exact = [math.nan] * self.term_graphs[0].size
            real = [math.nan if isinstance(x, mpmath.mpc) else x for x in exact]
            columns.append(engine.array(real))
        return np.array(columns).T

    def invariant_changes(self, trajectory: Trajectory) -> dict[str, np.ndarray]:
        """Change of each invariant at the samples of a trajectory; see `changes`."""
        if not self.invariants:
            return {}
        pairs = [(one.times, self.rows(one, one.states, "")) for one in trajectory.segments]
        times, states = (np.concatenate([pair[k] for pair in pairs]) for k in range(2))
        jumps = change_times(trajectory)
        return self.changes(times.astype(float), np.asarray(states).astype(float), jumps)

    def changes(
        self, times: np.ndarray, states: np.ndarray, jumps: Sequence[float] = ()
    ) -> dict[str, np.ndarray]:
        """Change of each invariant since the start, shape (m,).

        It is relative to the size of the terms of the invariant, or, if that is larger, to its
        change if all states changed by their whole size. Relative errors of the states therefore
        explain a change of at most this size. After an event the count restarts, because a push may
        change an invariant; jumps: further times at which it restarts.
        """
        if not self.invariants or not len(times):
            return {}
        # Times need not begin with the start, changes do.
        moments = sorted([*(event.time for event, _ in self.timed), *jumps])
        before = int(times[0] != 0 and 0 not in moments)
        at = np.concatenate(([0.0] * before, times))
        start = np.array([[float(x) for x in self.start]] * before).reshape(before, self.size)
        arguments = self.arguments(at, np.concatenate((start, states[:, : self.size])))
        function = self.term_graphs[1].numpy()
        values, sizes = (
            np.asarray(x) for x in (function(*arguments), self.term_graphs[1].sizes(*arguments))
        )
        weights = np.zeros_like(values)
        for group in self.first_stage(53, 0.0).groups:
            extent = max(float(np.abs(arguments[k]).max()) for k in group)
            for k in group:
                moved = [*arguments[:k], arguments[k] + HALF * extent, *arguments[k + 1 :]]
                with np.errstate(all="ignore"):
                    change = np.abs(np.asarray(function(*moved)) - values) / HALF
                weights += np.where(np.isfinite(change), change, 0.0)
        interval = np.searchsorted(moments, at, "right")
        first = np.searchsorted(interval, interval)
        scales = {name: rows for name, rows, _ in _cut(self.invariants, sizes)}
        moves = {name: rows for name, rows, _ in _cut(self.invariants, weights)}
        table = {}
        for name, rows, _ in _cut(self.invariants, values):
            size = max(float(np.abs(scales[name]).max()), float(moves[name].max()))
            change = np.abs(rows - rows[:, first]).max(axis=0)[before:]
            table[name] = change / size if size else change
        return table

    def term(self, term: object) -> Term:
        """A function of moments for an output, or an expression over what may occur."""
        read = constructor.term(self.outputs, self.rates.names, term)
        function = term_graph(self.rates.names, [read]).numpy()

        def values(moment: Moment) -> np.ndarray:
            return function(*self.arguments(moment.time, moment["states"]))[0]

        return Term(values)

    def slopes(self, term: object, by: str, moment: Moment) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives of a term by a parameter at fixed times, and by the time, at a moment."""
        read = constructor.term(self.outputs, self.rates.names, term)
        rates, names = self.rates.expressions, self.rates.names
        terms = term_slopes(read, rates, by, self.rates.time, self.rates.parameters)
        function = term_graph(names, list(terms)).numpy()
        across, along = function(*self.arguments(moment.time, moment["states"]))
        return across, along

    def breaks(self) -> tuple[float, ...]:
        """Times at which something may jump."""
        return tuple(event.time for event, _ in self.timed)

    def pulses(self, end: float) -> tuple[float, ...]:
        """Times up to an end around narrow pulses of the rates."""
        return pulses(self.rates, self.parameters, end)

    def described(self) -> dict[str, Any]:
        """The equations as plain text, and numbers as text, for files."""
        events = [[_time_text(one.time), numbers_text(one.changes)] for one in self.events]
        switches = [[term_text(one.falls), numbers_text(one.changes)] for one in self.switches]
        declared = constructor.declarations(self.rates.declared)
        return {
            "rates": {name: term_text(rate) for name, rate in self.rates.expressions.items()},
            "start": [number_text(x) for x in self.start],
            "parameters": numbers_text(self.parameters),
            "invariants": {name: terms_text(term) for name, term in self.invariants.items()},
            "outputs": {name: terms_text(term) for name, term in self.outputs.items()},
            "time": self.rates.time,
            "events": events,
            "stop": _stop_texts(self.rates.stops),
            "norm_groups": [list(group) for group in self.rates.norm_groups],
            "normalized": [list(group) for group in self.normalized],
            "name": self.name,
            **({"declared": declared} if declared else {}),
            **({"switches": switches} if switches else {}),
            **({"resting": list(self.resting)} if self.resting else {}),
            **({"varied": list(self.varied)} if self.varied else {}),
        }

    def columns(self, moment: Moment) -> dict[str, np.ndarray]:
        """Named columns for tables."""
        table = {self.rates.time: moment.time}
        for name in (*self.states, *self.outputs):
            value = moment[name]
            if value.ndim == 1:
                table[name] = value
            else:
                table |= {f"{name}[{k}]": value[:, k] for k in range(value.shape[1])}
        return table

    def stuck_error(self, trajectory: Trajectory) -> StuckError:
        """The error for a motion that got stuck: the place, the reason, a remedy."""
        segment = trajectory.segments[-1]
        last = np.array([float(x) for x in segment.last])[: self.size]
        reached = float(trajectory.reached)
        pairs = zip(self.states, last.tolist(), strict=True)
        place = ", ".join(f"{name} = {x:.6g}" for name, x in pairs if math.isfinite(x))
        values = self.rates.rate_graph.numpy()(*self.arguments(np.array([reached]), last[None, :]))
        rates = zip(self.states, np.asarray(values)[:, 0].tolist(), strict=True)
        bad = [f"{name}' = {x:.3g}" for name, x in rates if not math.isfinite(x)]
        why = f"{trajectory.reason}; {', '.join(bad)}" if bad else trajectory.reason
        return StuckError(
            f"the motion cannot continue at {self.time_name} = {reached:.6g}, at {place}: {why}. "
            "Stop earlier, or give When(...) for its end. The computed part is in the error's "
            "`solution`."
        )

    # -- many starts -----------------------------------------------------------------------------

    def bundle(self, columns: Mapping[str, np.ndarray]) -> dict[str, object]:
        """Arguments of `solve_many` for members that differ in some states and parameters."""
        return {"starts": columns}

    def members(
        self, starts: object, velocities: object = None, frame_velocities: object = None
    ) -> Members:
        """Members of an ensemble, from lists of numbers; see `solve_many`."""
        if velocities is not None or frame_velocities is not None:
            raise StartError(
                "velocities: expected none for an ODE, which has only states. Give all states in "
                "starts."
            )
        states, varied = constructor.start_columns(
            self.states, self.start, self.rates.parameters, starts
        )
        constructor.check_many_lengths(self.states, states, self.normalized)
        constructor.check_declared(self.rates.declared, varied)
        parameters: dict[str, Real | np.ndarray] = dict(self.parameters) | varied
        states = self.unit_rows(states)
        self._check_members(states, parameters)
        if self.is_switched:
            return self._separate_members(states, varied)
        return self._members(0.0, states, parameters, self.events)

    def _separate_members(self, states: np.ndarray, varied: dict[str, np.ndarray]) -> Members:
        """Members whose equations change at different times, followed one by one."""
        number, system = len(states), self.system
        wide = np.zeros((number, system.size))
        wide[:, : self.size] = states
        numbers = np.zeros((number, len(system.parameters)))
        return Members(
            system, system.groups, wide, numbers, np.ones(number), np.abs(wide).sum(axis=1), 0.0,
            None, None, varied=varied, are_separate=True,
        )  # fmt: skip

    def _members(
        self,
        begin: float,
        states: np.ndarray,
        parameters: Mapping[str, Real | np.ndarray],
        later: tuple[At, ...],
    ) -> Members:
        """Members from a time on, up to the next event."""
        table = dict(parameters)
        while later and later[0].time == begin:
            table |= self._parameter_changes(later[0])
            states = states.copy()
            for name, value in later[0].changes.items():
                if name in self.states:
                    states[:, self.states.index(name)] = float(value)
            later = later[1:]
        states = self.unit_rows(states)
        number = len(states)
        start = states
        if self.rates.has_clock:
            start = np.concatenate((states, np.full((number, 1), begin / CLOCK)), axis=1)

        def follow(last: np.ndarray) -> Members:
            return self._members(later[0].time, last[:, : self.size], table, later)

        groups = self.system.groups[:-1] if self.rates.has_clock else self.system.groups
        return Members(
            self.system,
            groups,
            start,
            self._number_columns(table, number),
            np.ones(number),
            np.abs(start).sum(axis=1),
            begin,
            later[0].time if later else None,
            follow if later else None,
            varied={k: x for k, x in table.items() if isinstance(x, np.ndarray)},
        )

    def _number_columns(self, table: Mapping[str, Real | np.ndarray], number: int) -> np.ndarray:
        """The run-time numbers of the system for each member, shape (number, parameters)."""
        values = [table[name] for name in self.rates.parameters]
        if not any(isinstance(value, np.ndarray) for value in values):
            exact = self.rates.numbers.exactly(values)
            return np.tile(np.array(floats(exact), dtype=float), (number, 1))
        columns = [x if isinstance(x, np.ndarray) else float(x) for x in values]
        numbers = self.rates.numbers.numpy()(*columns)
        return np.array([np.broadcast_to(x, number) for x in numbers], dtype=float).T

    def member(self, members: Members, k: int) -> ODE:
        """One member as a problem of its own."""
        table = dict(self.parameters) | {
            name: float(value[k]) for name, value in members.varied.items()
        }
        start = tuple(members.states[k, : self.size].tolist())
        return replace(self, start=start, parameters=table, centre=None)

    def read_members(
        self, members: Members, rows: Rows, times: np.ndarray
    ) -> dict[str, np.ndarray]:
        """States and outputs by name, shapes (number, m) or (number, m, k).

        times: the same for all members, shape (m,), or of each, shape (number, m).
        """
        number, m = len(members), times.shape[-1]
        states = rows.states[:, -m:, : self.size]
        flat_states = states.reshape(number * m, self.size)
        with np.errstate(all="ignore"):
            flat_states = self.unit_rows(flat_states)
        states = flat_states.reshape(number, m, self.size)
        table = {name: states[..., k] for k, name in enumerate(self.states)} | {"states": states}
        if not self.outputs:
            return table
        at = np.broadcast_to(times, (number, m)).ravel()
        varied = {name: np.repeat(value, m) for name, value in members.varied.items()}
        values = self.term_graphs[0].numpy()(*self.arguments(at, flat_states, varied))
        for name, lines, several in _cut(self.outputs, values):
            table[name] = lines.T.reshape(number, m, -1) if several else lines[0].reshape(number, m)
        return table


def _expressions(changes: Mapping[str, object]) -> list[sp.Expr]:
    """The changes that are expressions."""
    return [x for x in changes.values() if isinstance(x, sp.Expr)]


def _without_changes(one: _Changing, lost: Collection[str]) -> _Changing:
    """An event without its changes of some states."""
    return replace(one, changes={k: x for k, x in one.changes.items() if k not in lost})


def _time_text(time: Any) -> float | str:
    """The time of an event for files: a number, or an expression."""
    return term_text(time) if isinstance(time, sp.Expr) else time


def _stop_texts(stops: Sequence[sp.Expr]) -> str | list[str] | None:
    """Stops for files: one text, as files have always held it, or several."""
    texts = [term_text(stop) for stop in stops]
    return (texts[0] if len(texts) == 1 else texts) if texts else None


def flat(terms: Mapping[str, Terms]) -> list[sp.Expr]:
    """All expressions in a row."""
    return [x for term in terms.values() for x in (term if isinstance(term, tuple) else (term,))]


def _cut(terms: Mapping[str, Terms], found: np.ndarray) -> Iterable[tuple[str, np.ndarray, bool]]:
    """For each term its rows of values, and whether it is a vector."""
    place = 0
    for name, term in terms.items():
        parts = len(term) if isinstance(term, tuple) else 1
        yield name, found[place : place + parts], isinstance(term, tuple)
        place += parts


def _normalize(state: list[Real], places: Sequence[int], precision: int) -> None:
    """Bring some of the states to length one, to rounding at any precision."""
    values = [state[k] for k in places]
    scaled: list[Real]
    if precision == 53:
        numbers = [float(value) for value in values]
        length = math.hypot(*numbers)
        scaled = [value / length for value in numbers]
    else:
        bits = precision + 20
        with working_precision(bits):
            exact_values = [mpf(value, bits) for value in values]
            size = mpmath.sqrt(sum(value * value for value in exact_values))
            scaled = [value / size for value in exact_values]
    for place, value in zip(places, scaled, strict=True):
        state[place] = value
