"""System: first-order equations, what engines make of them, and units of their own size."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Protocol, TypeAlias

import numpy as np

from geomtorsion.codegen import Graph
from geomtorsion.errors import LimitError, StartError
from geomtorsion.ode.ends import Ends
from geomtorsion.ode.numbers import Real, divided, floats, multiplied
from geomtorsion.ode.roundings import Changes
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.copies import only_fields
from geomtorsion.support.precision import EXACT_BITS

# Functions that have a value everywhere.
ENTIRE = ("sin", "cos", "sinh", "cosh", "exp")
# What a scalar function raises where it has no value.
NO_VALUE = (ZeroDivisionError, ValueError, OverflowError)
ScalarRates = Callable[[float, np.ndarray], Sequence[float]]


def columns(parts: Sequence[np.ndarray], values: Iterable[Any]) -> np.ndarray:
    """States in doubles, part after part, above the parameters: what functions of arrays take.

    parts: rows of states, each (m_k, size). values: of the parameters, the same for all.

    Examples
    --------
    >>> columns([np.array([[1.0, 2.0]]), np.array([[3.0, 4.0], [5.0, 6.0]])], [7]).tolist()
    [[1.0, 3.0, 5.0], [2.0, 4.0, 6.0], [7.0, 7.0, 7.0]]
    """
    states = np.concatenate(parts).astype(float)
    numbers = np.array([float(x) for x in values])
    return np.concatenate([states.T, np.repeat(numbers[:, None], len(states), axis=1)])


@dataclass(frozen=True, eq=False)
class System:
    """Rates of named states; the values of the parameters come with each run.

    states: names of the unknowns, in order.
    parameters: names of everything else that occurs.
    rates: graph over states, then parameters, with one output for each state.
    groups: indices of states whose errors are measured against their common size (coordinates;
        velocities; a quaternion); each state is in one of them.
    guard: graph over the same arguments; a run ends where one of its outputs falls through zero.
    end: the guard of the end of a chart, if `guard` belongs to its margin.
    clock: (state, unit) where a state is the time in such units; an engine may replace that
        state, which rounds at every step, by its own time.
    stops: indices of those outputs of the guard that end a motion of a batch; at the others it
        leaves the batch.
    """

    states: tuple[str, ...]
    parameters: tuple[str, ...]
    rates: Graph
    groups: tuple[tuple[int, ...], ...]
    guard: Graph | None = None
    end: Graph | None = None
    clock: tuple[str, int] | None = None
    stops: tuple[int, ...] = ()

    def __getstate__(self) -> dict[str, object]:
        return only_fields(self)

    @property
    def size(self) -> int:
        """Number of states."""
        return len(self.states)

    @cached_property
    def groups_but_clock(self) -> tuple[tuple[int, ...], ...]:
        """The groups without the state that is the time."""
        clock = None if self.clock is None else self.states.index(self.clock[0])
        groups = (tuple(k for k in group if k != clock) for group in self.groups)
        return tuple(group for group in groups if group)

    @cached_property
    def key(self) -> tuple[str, str | None, int | None]:
        """Key that two systems share exactly if one compiled integrator serves both."""
        clock = None if self.clock is None else self.states.index(self.clock[0])
        return self.rates.key, None if self.guard is None else self.guard.key, clock

    @cached_property
    def scalar_function(self) -> Callable[..., tuple[float, ...]]:
        """f(*states, *parameters) on plain floats; raises one of NO_VALUE."""
        return self.rates.python()

    @cached_property
    def array_function(self) -> Callable[..., np.ndarray]:
        """f(*states, *parameters) on arrays, shape (size, ...)."""
        return self.rates.numpy()

    def scalar_rates(self, values: Sequence[float]) -> ScalarRates:
        """f(t, y) for one motion, on plain floats; not a number where there is no value."""
        inner = self.scalar_function
        bad = [float("nan")] * self.size

        def rates(_: float, y: np.ndarray) -> Sequence[float]:
            try:
                return inner(*y.tolist(), *values)
            except NO_VALUE:
                return bad

        return rates

    @cached_property
    def _jacobian(self) -> Callable[..., tuple[float, ...]]:
        return self.rates.derivative(self.states).python()

    def jacobian(self, state: Sequence[float], values: Sequence[float]) -> np.ndarray:
        """df_i/dy_j, shape (size, size); not a number where there is no value."""
        n = self.size
        try:
            # Numbers may be long doubles, which may be beyond doubles.
            with np.errstate(over="ignore"):
                matrix = np.array(self._jacobian(*state, *values), dtype=float)
            return matrix.reshape(n, n)
        except NO_VALUE:
            return np.full((n, n), np.nan)

    def damping(self, state: Sequence[float], values: Sequence[float]) -> float:
        """The largest rate at which a neighbour approaches; 0 where others part as fast.

        Every direction that decays has one that grows beside it where a motion conserves an energy.
        """
        spectrum = eigenvalues(self.jacobian(state, values))
        if spectrum is None:
            return 0.0
        real = np.real(spectrum)
        return float(-real.min()) if -real.min() > 2 * real.max() else 0.0

    @cached_property
    def has_series(self) -> bool:
        """Whether heyoka knows the Taylor series of all that it would have to follow."""
        return all(graph.has_series for graph in (self.rates, self.guard) if graph is not None)

    @cached_property
    def guard_is_entire(self) -> bool:
        """Whether the guard has a value, and a series, at all states but poles."""
        steps = () if self.guard is None else self.guard.steps
        return all(
            step.detail in ENTIRE if step.kind == "call" else step.kind != "root" for step in steps
        )

    @cached_property
    def _guard_above_rounding(self) -> Graph | None:
        # Motions that come to rest on an edge stay within rounding of it, with ever shorter steps.
        return None if self.guard is None else self.guard.above_rounding()

    @cached_property
    def _scalar_guard(self) -> Callable[..., tuple[float, ...]] | None:
        guard = self._guard_above_rounding
        return None if guard is None else guard.python()

    def guard_at(self, state: Sequence[float], values: Sequence[float]) -> float:
        """The smallest output of the guard at one state, minus its rounding error.

        It is negative where the guard has no value. For a root, its radicand is used.
        """
        inner = self._scalar_guard
        if inner is None:
            return float("inf")
        try:
            least = min(inner(*state, *values))
        except NO_VALUE:
            return -1.0
        return least if least == least else -1.0

    def guard_along(self, states: np.ndarray, values: Sequence[float] | np.ndarray) -> np.ndarray:
        """The same on arrays of states, shape (size, ...)."""
        return _least(self._guard_above_rounding, states, values)

    def plain_guard_along(
        self, states: np.ndarray, values: Sequence[float] | np.ndarray
    ) -> np.ndarray:
        """The smallest output of the guard itself on arrays of states, shape (size, ...)."""
        return _least(self.guard, states, values)

    def stops_along(self, states: np.ndarray, values: Sequence[float] | np.ndarray) -> np.ndarray:
        """The outputs of the guard that end a motion on arrays of states, shape (stops, ...)."""
        assert self.guard is not None
        with np.errstate(all="ignore"):
            outputs = self.guard.numpy()(*states, *values)
        return np.broadcast_to(outputs, (self.guard.size, *states.shape[1:]))[list(self.stops)]

    @cached_property
    def hoisted(self) -> Hoisted:
        """The equations for an engine of series, with what makes all their numbers."""
        names, parts, constant_graphs = self.parameters, list[Graph](), list[Graph]()
        for k, part in enumerate((self.rates, self.guard)):
            if part is not None:
                wide = replace(part, arguments=(*self.states, *names))
                rest, constants = wide.hoisted(self.size, f"constant {k}")
                names = rest.arguments[self.size :]
                parts.append(rest)
                if constants.size:
                    constant_graphs.append(constants)
        rates = replace(parts[0], arguments=(*self.states, *names))
        guard = None if self.guard is None else parts[1]
        wide = replace(self, parameters=names, rates=rates, guard=guard, end=None)
        return Hoisted(wide, tuple(constant_graphs))

    @cached_property
    def unguarded(self) -> System:
        """The same equations without a guard."""
        return self if self.guard is None else replace(self, guard=None, end=None, stops=())

    @cached_property
    def to_the_end(self) -> System:
        """The same equations, watched up to where the chart ends and not to its margin."""
        return self if self.end is None else replace(self, guard=self.end, end=None)


@dataclass(frozen=True, eq=False)
class Hoisted:
    """A system whose constants are further parameters, and the only route to their values.

    A constant contains only parameters and numbers, such as sqrt(2)*a or 1/(2*pi).

    system: the equations over all parameters: first of the plain system, then the constants.
    constants: graphs of the constants, each over all parameters before it.
    """

    system: System
    constants: tuple[Graph, ...]

    def numbers(self, values: Sequence[Any] | np.ndarray, bits: int = 53) -> np.ndarray | list[Any]:
        """Values of all parameters of `system`, from the parameters of the plain system.

        values: of one motion, or an array with one row for each motion.
        bits: above 53 the constants of one motion are computed with this number of bits.
        """
        if isinstance(values, np.ndarray) and values.ndim == 2:
            for part in self.constants:
                # Constants that contain only numbers are the same in all rows.
                further = part.numpy()(*values.T).reshape(part.size, -1).T
                rows = (len(values), part.size)
                values = np.concatenate((values, np.broadcast_to(further, rows)), axis=1)
            return values
        if bits > 53:
            return self._long_numbers(list(values), bits + 20)
        # One motion: arrays would take ten times as long.
        row = floats(values)
        for part in self.constants:
            try:
                row += part.python()(*row)
            except NO_VALUE:
                # An infinite intermediate result may still give a finite value.
                row += part.numpy()(*row).tolist()
        return np.array(row)

    def _long_numbers(self, row: list[Any], bits: int) -> list[Any]:
        """The numbers of one motion with a number of bits."""
        for part in self.constants:
            try:
                row += part.exactly(row, bits)
            except NO_VALUE:
                row += [float("nan")] * part.size
        return row


# States (the largest of each group) and durations within this factor of one are run as they are.
# Coefficients of order n of a series grow like its n-th power: the highest stay far within the
# range of floats; and steps measured by the largest of states that differ by it still have ten
# digits of the others.
FAR = 2.0**20
# For each group of states its size, and where that is zero the size of its rates.
Extents: TypeAlias = list[tuple[float, float]]


# Frozen, it would take a microsecond to make, which short runs would notice.
@dataclass(eq=False, slots=True)
class Run:
    """Result of one integration, complete or not; see `Engine.run` for the duties of an engine.

    times, states: requested and reached; shapes (m,) and (m, size).
    reached, last: time and state at which it ended.
    outcome: "done", "edge" (the guard fell through zero), "beyond" (it did so at a place that is
        still to be found) or "stuck" (steps became too small, or there was no number).
    steps, evaluations: counted; for Taylor series an evaluation is one order of one step.
    compile_seconds, run_seconds: its cost.
    dense: states at any times; None if not requested.
    reason: why it is stuck.
    longest_step: in time; infinite where that is not known.
    """

    times: np.ndarray
    states: np.ndarray
    reached: float
    last: Sequence[Real] | np.ndarray
    outcome: str
    steps: int
    evaluations: int
    compile_seconds: float
    run_seconds: float
    dense: Dense | None = None
    reason: str = ""
    longest_step: float = math.inf


class WorkLimitError(LimitError):
    """A run reached its limit of steps or evaluations.

    args: the limit, the time reached, a remedy, and the name of the time.
    """

    def __str__(self) -> str:
        work, reached, advice, name = self.args
        return f"the solver needs more than {work}; it reached {name} = {reached:.6g}. {advice}"

    def counted(self, unit: float, name: str = "t") -> WorkLimitError:
        """The same error with its time in another unit, and with another name of the time."""
        work, reached, advice, _ = self.args
        return type(self)(work, reached * unit, advice, name)


class StiffnessError(WorkLimitError):
    """A run whose steps end with stability, and of which it needs too many.

    args: how many steps there may be, the time reached, how many are needed, the name of the time.
    """

    def __str__(self) -> str:
        most, reached, needed, name = self.args
        return (
            f"expected at most {most} steps, got equations that need about {needed}: they are "
            f"stiff at {name} = {reached:.6g}, where stability limits each step. "
            "Use engine=Stiff()."
        )


# If only accuracy limits a step, it may be this many times the time in which neighbours approach;
# explicit methods of order eight and more become unstable at some six.
STABLE = 2.0


def _least(
    guard: Graph | None, states: np.ndarray, values: Sequence[float] | np.ndarray
) -> np.ndarray:
    """The smallest output of a guard on arrays of states; below zero where it has no value."""
    assert guard is not None
    least = guard.numpy()(*states, *values).min(axis=0)
    return np.where(np.isnan(least), -1.0, least)


def refuse_stiff(
    system: System,
    state: Sequence[float],
    values: Sequence[float],
    pace: float,
    reached: float,
    left: float,
    most: int,
) -> None:
    """Refuse a run that would need too many steps limited by stability.

    pace: the mean of its last steps; left: the time to its end; most: the steps it may take.
    """
    if left > most * pace and pace * system.damping(state, values) > STABLE:
        raise StiffnessError(most, reached, f"{left / pace:.2g}", "t")


# Called with the number of members that are done.
Show: TypeAlias = Callable[[float], None] | None


@dataclass(frozen=True, eq=False)
class Batch:
    """Motions of equal equations that an engine runs at once, and arrays for their results.

    The engine fills the arrays below `longest` while it runs: after Ctrl-C they are kept as they
    are.

    system: the equations of all members.
    states, parameters: at the start, shapes (number, size) and (number, parameters).
    units: the times of a member are `times` multiplied by its unit, shape (number,).
    pace: how fast each member moves, shape (number,). Members that share an instruction wait for
        the slowest of them.
    times: monotone from 0 on, shape (m,).
    show: called with the number of members that are done.
    counted: whether `steps` is requested.
    longest: no step is longer, in the units of `times`.
    result: states at the times, shape (number, m, size); at first not a number.
    finished: members that came to the last time or were stopped, shape (number,).
    crossed: members that have to leave the batch where their guard fell through zero, shape
        (number,).
    steps: number of steps and the longest step as a part of the way, shape (2, number).
    ends: members that were stopped, at times in units of `times`. An engine that does not know
        stops marks these members as crossed.
    """

    system: System
    states: np.ndarray
    parameters: np.ndarray
    units: np.ndarray
    pace: np.ndarray
    times: np.ndarray
    show: Show
    counted: bool
    longest: float
    result: np.ndarray
    finished: np.ndarray
    crossed: np.ndarray
    steps: np.ndarray
    ends: Ends


class Engine(Protocol):
    """Integrates a system over given times, to a local tolerance.

    The solver uses only the members below. An engine that a user writes works in `solve`,
    `solve_many`, scenes, costs and checkpoints. A saved solution has its samples, but only
    solutions of the engines of this package can be integrated again from a file.

    An engine with the attribute `changes_on_the_way = True` takes `changes` in `run`; error
    estimates then include rounding errors of every step, not only of the start.

    An engine may have one more method, `batch(batch, tolerance) -> seconds of compilation`, which
    runs the members of a `Batch` at once; last digits may differ from `run`. `solve_many` calls it,
    and runs the members one by one with an engine that lacks it.
    """

    @property
    def name(self) -> str:
        """Its name in tables, files and checkpoints; the same name means the same bits of `run`."""
        ...

    @property
    def precision(self) -> int:
        """Bits of the mantissa: 53, 64, or from 113 on.

        With 53 bits times and states are arrays of doubles, with 64 of NumPy's long doubles, and
        above 64 of the numbers that `Taylor(precision).array` makes.
        """
        ...

    @property
    def finds_every_root(self) -> bool:
        """Whether it sees a guard that falls below zero and rises again within one step.

        False: it compares the guard at the ends of its steps. The solver then looks between them
        where that matters, by the dense output.
        """
        ...

    def first(self, accuracy: float) -> float:
        """The tolerance with which to try for an accuracy of the result."""
        ...

    def rung(self, tolerance: float) -> float:
        """The nearest tolerance of its ladder, so that few integrators are compiled."""
        ...

    def finer(self, tolerance: float) -> float | None:
        """The next tolerance of its ladder, a hundred times finer; None at the finest.

        The solver compares an answer with a run at the finer tolerance, so that the two finest
        tolerances of the ladder give no answer.
        """
        ...

    def run(
        self,
        system: System,
        start: Sequence[Real] | np.ndarray,
        parameters: Sequence[Real] | np.ndarray,
        times: np.ndarray,
        tolerance: float,
        *,
        dense: bool = False,
        watch: Watch | None = None,
        longest: float = math.inf,
        changes: Changes | None = None,
    ) -> Run:
        """Integrate from times[0] through all times.

        Parameters
        ----------
        times
            monotone, increasing or decreasing, shape (m,). They may begin at any time. A single
            time, or two equal ones, need no step.
        tolerance
            of one step, relative to the size of the state.
        dense
            whether `Run.dense` is requested. The solver asks for it in a further call from the
            first time to the time reached, without guard and without the times between. The steps
            must be the same.
        watch
            to be called now and then with the time reached. Errors that it raises end the run and
            pass through. Watching changes no bit of a result.
        longest
            no step is longer, in the units of `times`.
        changes
            after a step for which `changes.due()` holds the run continues from the state
            `changes.made(state, state at the start)`; `due` is called after each step. Only given
            to engines with `changes_on_the_way`.

        Returns
        -------
        Run
            A state at each of the times up to the time reached, the first and the last included:
            where the outcome is "done" there are as many states as times, and `reached` and `last`
            belong to the last time. Where `system.guard_at` falls through zero the run ends with
            outcome "edge": `reached` is the time of the root, and the samples are those before it.
            An engine that notices later that the guard fell may return "beyond"; the solver then
            finds the root by the dense output. Where no further step is possible the outcome is
            "stuck", with `reason`. `longest_step` is the longest step in units of `times`; where it
            is infinite, the solver takes more samples to see what steps may have missed.

        Raises
        ------
        WorkLimitError
            It took more steps than it is allowed.
        """
        ...


def checked_engine(engine: object) -> None:
    """Refuse what cannot run a motion, such as the name of an engine."""
    if engine is None:
        return
    if isinstance(engine, type) or not callable(getattr(engine, "run", 0)):
        raise StartError(
            f"engine = {checks.shown(engine)}: expected Taylor(), RungeKutta(), Stiff(), or "
            "None for an automatic choice."
        )
    members = [name for name in vars(Engine) if not name.startswith("_")]
    missing = [name for name in members if getattr(engine, name, None) is None]
    if missing:
        raise StartError(
            f"engine = {checks.shown(engine)}: expected {', '.join(members)}, got no "
            f"{', '.join(missing)}. Add the missing members; see Engine."
        )
    precision = checks.whole(getattr(engine, "precision", None))
    if precision not in (53, 64) and not 113 <= (precision or 0) <= EXACT_BITS:
        raise StartError(
            f"engine = {checks.shown(engine)}: expected a precision of 53, 64 or 113 to "
            f"{EXACT_BITS} bits, got {checks.shown(getattr(engine, 'precision', None))}."
        )


OUTCOMES = frozenset({"done", "edge", "beyond", "stuck"})


def checked_run(engine: Engine, run: Run, times: np.ndarray) -> Run:
    """The run, if the engine returned what `Engine.run` owes.

    Raises
    ------
    StartError
        Times, states and outcome do not fit together.
    """
    count, expected = len(run.times), ""
    if run.outcome not in OUTCOMES:
        expected = f"one of the outcomes {', '.join(sorted(OUTCOMES))}, got {run.outcome!r}"
    elif len(run.states) != count:
        expected = f"a state at each of {count} times, got {len(run.states)} states"
    elif count > len(times) or (run.outcome == "done" and count < len(times)):
        expected = f"samples at {len(times)} times, got {count}"
    elif run.outcome == "done" and float(run.reached) != float(times[-1]):
        expected = f"a run to {float(times[-1])!r}, got one to {float(run.reached)!r}"
    if expected:
        raise StartError(f"engine {engine.name}: expected {expected}. Compare with Engine.run.")
    return run


@dataclass(frozen=True, eq=False)
class Units:
    """Powers of two in which a run counts: sizes of its states, shape (size,), and of its times."""

    sizes: np.ndarray
    time: float

    @property
    def parameters(self) -> list[float]:
        """What the scaled system has besides: size of each state, and rate of each state."""
        return [*self.sizes.tolist(), *(self.time / self.sizes).tolist()]


def scaled_run(
    engine: Engine,
    system: System,
    start: Sequence[Real] | np.ndarray,
    parameters: Sequence[Real] | np.ndarray,
    times: np.ndarray,
    tolerance: float,
    *,
    extents: Extents | None = None,
    dense: bool = False,
    watch: Watch | None = None,
    longest: float = math.inf,
    changes: Changes | None = None,
) -> Run:
    """See `Engine.run`: the same, in units of its own size where numbers are far from one.

    extents: of the start, if known.
    """
    units = units_of(system, start, parameters, float(times[-1] - times[0]), extents)
    more = {} if changes is None else {"changes": changes}
    if units is None:
        run = engine.run(
            system, start, parameters, times, tolerance,
            dense=dense, watch=watch, longest=longest, **more,
        )  # fmt: skip
        return checked_run(engine, run, times)
    unit = units.time
    sizes = units.sizes.tolist()
    try:
        run = engine.run(
            scaled_system(system),
            [divided(x, size) for x, size in zip(start, sizes, strict=True)],
            [*parameters, *units.parameters],
            times / units.time,
            tolerance,
            dense=dense,
            watch=None if watch is None else lambda t: watch(t * unit),
            longest=longest / unit,
            **more,
        )
    except WorkLimitError as limit:
        raise limit.counted(unit) from None
    checked_run(engine, run, times / units.time)
    run.times = times[: len(run.times)]
    run.states = multiplied(run.states, units.sizes)
    run.last = multiplied(np.asarray(run.last)[None, :], units.sizes)[0]
    run.reached = run.reached * type(run.reached)(units.time)
    run.longest_step *= unit
    if run.dense is not None:
        run.dense = _unscaled(run.dense, units)
    return run


def member_units(
    system: System,
    states: np.ndarray,
    parameters: np.ndarray,
    durations: np.ndarray,
) -> tuple[np.ndarray, np.ndarray] | None:
    """Sizes (number, size) and times (number,) of members; None where all run as they are."""
    far = np.flatnonzero(~_run_as_they_are(system, states, parameters, np.abs(durations)))
    if not len(far):
        return None
    unit_list: list[Units | None] = [None] * len(states)
    for k in far:
        unit_list[k] = units_of(system, states[k], parameters[k], float(durations[k]))
    if all(units is None for units in unit_list):
        return None
    plain = Units(np.ones(states.shape[1]), 1.0)
    if system.clock is not None:
        plain.sizes[system.states.index(system.clock[0])] = 1 / system.clock[1]
    units = [one or plain for one in unit_list]
    return np.array([one.sizes for one in units]), np.array([one.time for one in units])


def _unscaled(dense: Dense, units: Units) -> Dense:
    """Dense output in the units of the problem."""
    return lambda t: multiplied(dense(np.asarray(t) / units.time), units.sizes)


def extents_of(
    system: System, start: Sequence[Real] | np.ndarray, parameters: Sequence[Real] | np.ndarray
) -> Extents:
    """Size of each group of states at a start; for a group at zero, the size of its rates."""
    # On lists, because it is computed for every start.
    groups, sizes = system.groups_but_clock, [abs(float(x)) for x in start]
    tops = [max([sizes[k] for k in group]) for group in groups]
    if all(tops):
        return [(top, 0.0) for top in tops]
    rates = system.scalar_rates(floats(parameters))(0.0, np.array(floats(start)))
    return [
        (top, 0.0 if top else max([abs(rates[k]) for k in group]))
        for top, group in zip(tops, groups, strict=True)
    ]


def eigenvalues(jacobian: np.ndarray) -> np.ndarray | None:
    """Eigenvalues of a Jacobian; None where it is not finite, or too large to have them found."""
    if not np.isfinite(jacobian).all():
        return None
    try:
        return np.linalg.eigvals(jacobian)
    except np.linalg.LinAlgError:
        return None


def units_of(
    system: System,
    start: Sequence[Real] | np.ndarray,
    parameters: Sequence[Real] | np.ndarray,
    duration: float,
    extents: Extents | None = None,
) -> Units | None:
    """The units of a run; None where it can be run as it is."""
    duration = abs(duration)
    extents = extents or extents_of(system, start, parameters)
    # What begins at zero is soon as large as its rates make it.
    sizes = [top or rate * duration for top, rate in extents]
    if (not duration or _is_near(duration)) and all(not x or _is_near(x) for x in sizes):
        return None
    groups, parameters = system.groups_but_clock, floats(parameters)
    values = np.abs(floats(start))
    if not duration or not np.isfinite(values).all():
        return None
    own = eigenvalues(system.jacobian(floats(start), parameters))
    if own is None:
        return None
    fastest = float(np.abs(own).max())
    time = 1 / fastest if fastest * duration > 1 else duration
    largest = values
    # What a state has after that time, where no terms cancel; velocities come before coordinates.
    for _ in range(2):
        terms = np.abs(np.ravel(system.rates.sizes(*largest.tolist(), *parameters))) * time
        largest = np.maximum(largest, np.where(np.isfinite(terms), terms, 0.0))
    scales = np.ones(len(values))
    for group in map(list, groups):
        top = float(largest[group].max())
        if top > 0:
            scales[group] = np.where(largest[group] < top / FAR, largest[group], top)
            scales[group] = np.where(scales[group] > 0, scales[group], top)
    # Below these, rates in units of the scales would overflow: a rounding of zero.
    scales[scales <= max(time, 1.0) * np.finfo(float).tiny] = 1.0
    if all(map(_is_near, (*scales.tolist(), time))):
        return None
    scales = 2.0 ** np.round(np.log2(scales))
    time = float(2.0 ** np.round(np.log2(time)))
    if system.clock is not None:
        scales[system.states.index(system.clock[0])] = time / system.clock[1]
    return Units(scales, time)


def _run_as_they_are(
    system: System, states: np.ndarray, parameters: np.ndarray, durations: np.ndarray
) -> np.ndarray:
    """Which members have numbers near one: the first question of `units_of`, all at once."""
    near = (durations == 0) | _are_near(durations)
    for group in map(list, system.groups_but_clock):
        tops = np.abs(states[:, group]).max(axis=1)
        still = np.flatnonzero(tops == 0)
        if len(still):
            shape = (system.size, len(still))
            with np.errstate(all="ignore"):
                rates = system.array_function(*states[still].T, *parameters[still].T)
                tops[still] = np.abs(np.broadcast_to(rates, shape)[group]).max(axis=0)
                tops[still] *= durations[still]
        near &= (tops == 0) | _are_near(tops)
    return near


def _are_near(sizes: np.ndarray) -> np.ndarray:
    """Which of many sizes are near enough to one."""
    return (sizes >= 1 / FAR) & (sizes <= FAR)


def _is_near(size: float) -> bool:
    """Whether a size is near enough to one."""
    return 1 / FAR <= size <= FAR


@lru_cache(maxsize=256)
def scaled_system(system: System) -> System:
    """The same equations for states and a time in units that are parameters."""
    sizes = tuple(f"size of {name}" for name in system.states)
    rates = tuple(f"rate of {name}" for name in system.states)
    more = (*sizes, *rates)
    scaled = system.rates.with_factors(dict(zip(system.states, sizes, strict=True)), rates, more)
    guards = [
        None if guard is None
        else guard.with_factors(dict(zip(system.states, sizes, strict=True)), (), more)
        for guard in (system.guard, system.end)
    ]  # fmt: skip
    clock = None if system.clock is None else (system.clock[0], 1)
    return replace(
        system, parameters=(*system.parameters, *more), rates=scaled, guard=guards[0],
        end=guards[1], clock=clock,
    )  # fmt: skip


# Called from time to time with the time that a run has reached; an exception ends the run.
Watch: TypeAlias = Callable[[float], object]
# A motion that advances by less than this fraction of its time makes no progress.
STANDSTILL = 1e-9
# Steps between two looks at whether it does.
STEPS_AT_ONCE = 2_000
# Places looked at in each step for a guard that falls and rises again.
PER_STEP = 8

# Function of times that gives states, shape (m, size).
Dense: TypeAlias = Callable[[np.ndarray], np.ndarray]
