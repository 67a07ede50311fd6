"""Solution: a motion that was solved, with its error, its cost and everything read off it."""

from __future__ import annotations

import math
from collections.abc import (
    Callable,
    Collection,
    ItemsView,
    Iterator,
    KeysView,
    Mapping,
    Sequence,
    ValuesView,
)
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

import numpy as np

from geomtorsion.codegen.arrays import BLOCK
from geomtorsion.codegen.steps import ROUNDINGS
from geomtorsion.errors import ArgumentError, ExpressionError, TimeError
from geomtorsion.ode.changes import change_times
from geomtorsion.ode.derivatives import EventDerivative
from geomtorsion.ode.error_estimate import (
    CHANCE,
    UNALIKE,
    Comparison,
    combined,
    difference,
    rounding,
)
from geomtorsion.ode.moment import Moment, Term
from geomtorsion.ode.numbers import PARTS, times_between
from geomtorsion.ode.roots import crossings
from geomtorsion.ode.trajectory import Segment, Stage, Trajectory, close_times
from geomtorsion.ode.writing import pandas_table, plain_columns, write_solution, xarray_dataset
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.copies import only_fields
from geomtorsion.support.csv_table import write_csv
from geomtorsion.support.displays import Plot, drawn_by, figure_by, key_completions
from geomtorsion.support.hints import attribute_hints
from geomtorsion.support.outgoing import json_number, size_text
from geomtorsion.support.precision import EPS, GOLDEN

if TYPE_CHECKING:
    from geomtorsion.errors import GeomtorsionError


@dataclass(frozen=True)
class Cost:
    """Steps and seconds that a solution took.

    steps, evaluations: of the answer, without the run that gave the error estimate.
    compile_seconds: compilation in all runs; zero if the compiled code was in memory.
    run_seconds: integration of the answer.
    check_seconds: integration of all other runs: finer runs, and answers that were not accurate
        enough.
    """

    steps: int
    evaluations: int
    compile_seconds: float
    run_seconds: float
    check_seconds: float

    @classmethod
    def of(cls, answer: Trajectory, runs: Sequence[Trajectory]) -> Cost:
        """The cost of an answer among all runs that were made."""
        running = answer.run_seconds
        return cls(
            answer.steps,
            answer.evaluations,
            sum([run.compile_seconds for run in runs]),
            running,
            sum([run.run_seconds for run in runs]) - running,
        )

    def __str__(self) -> str:
        return (
            f"{self.steps} steps, {self.evaluations} evaluations, "
            f"compiled in {self.compile_seconds:.3g} s, ran in {self.run_seconds:.3g} s, "
            f"checked in {self.check_seconds:.3g} s"
        )


# Doubles hold numbers to this part; solutions to a finer accuracy keep their longer numbers.
DOUBLE = EPS / 2
# The first point between two times that is examined, in units of their distance: at the
# golden section, off the middle and off the ends.
SHIFT = 1 - GOLDEN


class Problem(Protocol):
    """A problem for a solver: a curve in a space, or first-order equations of any kind."""

    @property
    def time_unit(self) -> float:
        """Trajectories count time in units of 1/time_unit."""
        ...

    @property
    def time_name(self) -> str:
        """Name of the time in messages."""
        ...

    @property
    def stop_texts(self) -> tuple[str, ...]:
        """The conditions that end the motion, as text."""
        ...

    def check_start(self) -> None:
        """Raise an error for a start from which no motion continues."""
        ...

    def first_stage(self, precision: int, perturbation: float) -> Stage:
        """The equations with their start; perturbation: relative change of the start."""
        ...

    def rows(self, segment: Segment, states: np.ndarray, label: str) -> np.ndarray:
        """States of a segment in the coordinates of a label."""
        ...

    def read_gaps(
        self, one: Trajectory, two: Trajectory, count: int, accuracy: float, /
    ) -> list[tuple[np.ndarray, float]]:
        """Differences at the first samples as a reader sees them, and the size of all."""
        ...

    def together(self, name: str) -> tuple[str, ...]:
        """Names that share one size with a name; empty for values computed from states."""
        ...

    def moment(
        self,
        times: np.ndarray,
        pieces: Sequence[tuple[Segment, np.ndarray]],
        shape: tuple[int, ...],
        bits: int,
        names: Collection[str] | None = None,
    ) -> Moment:
        """Everything at the times of some pieces; or these names, nan where one has no value."""
        ...

    def invariant_changes(self, trajectory: Trajectory) -> Mapping[str, np.ndarray]:
        """Relative change of each invariant at the samples of a trajectory."""
        ...

    def term(self, term: object) -> Term:
        """A function of moments for a name or an expression."""
        ...

    def slopes(self, term: object, by: str, moment: Moment) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives of a term by a parameter at fixed times, and by the time."""
        ...

    def breaks(self) -> tuple[float, ...]:
        """Times at which something may jump."""
        ...

    def pulses(self, end: float) -> tuple[float, ...]:
        """Times up to an end around narrow pulses of the rates."""
        ...

    def columns(self, moment: Moment) -> Mapping[str, np.ndarray]:
        """Named columns for tables."""
        ...

    @property
    def kind(self) -> str:
        """ "ode", which can be read from a file again, or "curve"."""
        ...

    def described(self) -> dict[str, Any]:
        """The problem as plain text and numbers, for files."""
        ...

    def with_derivatives(self, by: object) -> Any:
        """The same motion with its derivatives by parameters and numbers at the start."""
        ...

    def stuck_error(self, trajectory: Trajectory) -> GeomtorsionError:
        """The error for a motion that cannot continue, with the position and a remedy."""
        ...


@attribute_hints(
    t="solution.times",
    y="solution.states",
    sol="solution.at",
    success="solution.complete",
    to_numpy="numpy.array(solution)",
    to_dict="dict(solution)",
    to_dataframe="to_pandas",
)
@dataclass(frozen=True, eq=False)
class Solution:
    """A solved motion: of a curve in a space, of a scene, of any first-order equations.

    problem: the solved problem.
    times: shape (m,), as requested, or 65 of them up to the requested time; they end where the
        motion was stopped.
    accuracy: the requested accuracy, relative to the size of the solution.
    error: estimate of the largest error at `times`. The error of each group of states (coordinates,
        frame velocities, ...) is relative to the largest size of the group, or, if the group is
        zero except for rounding, to the sum of the terms of its rates. Coordinates and velocities
        are skipped where the distance from the edge of their chart is within the accuracy, because
        they have no definite values there (the angle at the origin). Quantities derived from the
        states, such as velocities in coordinates or outputs, may have a smaller or larger error:
        see `error_of`. The same holds for `at` between the times: see `error_between`.
    engine, reason: the engine, and why it was chosen.
    cost: steps, evaluations, seconds.
    trajectory: the integration.
    comparisons: the finer run with which it was compared, and a run with changes on the way where
        roundings matter. The error is twice the first difference, or the first and a multiple of
        the second together, whichever is larger.

    Numbers are floats unless an accuracy finer than 1.1e-16 was requested, which floats do not
    hold. Then all arrays are of the type of the engine: NumPy's long double, or heyoka's longer
    numbers, whose arrays know most functions of NumPy. `str` of one of them has all its digits,
    for mpmath and others; `x.astype(float)` gives floats.

    Examples
    --------
    >>> from geomtorsion.ode import ODE, RungeKutta, solve
    >>> fall = ODE.of({"z": "v", "v": "-g"}, {"z": 20, "v": 0}, parameters={"g": 10})
    >>> solution = solve(fall, 2.0, accuracy=1e-9, engine=RungeKutta())
    >>> solution.error < 1e-9, round(float(solution.at(1.0)["z"]), 9)
    (True, 15.0)
    """

    problem: Any  # a Problem; users know which one they posed
    times: np.ndarray
    accuracy: float
    error: float
    engine: str
    reason: str
    cost: Cost
    trajectory: Trajectory
    comparisons: tuple[Comparison, ...] = ()

    def __getstate__(self) -> dict[str, object]:
        return only_fields(self)

    @property
    def outcome(self) -> str:
        """ "done"; "stopped" by an event that ends the motion; "stuck" where it cannot continue."""
        return self.trajectory.outcome

    @property
    def stopped_by(self) -> str:
        """The condition that ended the motion, as text; empty where none did."""
        return self.trajectory.reason if self.outcome == "stopped" else ""

    @property
    def complete(self) -> bool:
        """Whether the motion was followed to its end: the last time, or where it stops."""
        return self.outcome in ("done", "stopped")

    # -- at the times ----------------------------------------------------------------------------

    @cached_property
    def moment(self) -> Moment:
        """Everything at the times."""
        pieces = []
        # The start is always a sample.
        first = self._with_end.count - len(self.times)
        for segment in self._with_end.segments:
            states = segment.states[first:] if first else segment.states
            first = max(first - segment.count, 0)
            if len(states):
                pieces.append((segment, states))
        return self._read(self.times, pieces, self.times.shape)

    @cached_property
    def _with_end(self) -> Trajectory:
        """The trajectory, with the place where it was stopped as its last sample."""
        path, end = self.trajectory, self.trajectory.segments[-1]
        last = next((x for x in reversed(path.segments) if x.count), None)
        if path.outcome != "stopped" or (last is not None and last.times[-1] == path.reached):
            return path
        times = np.append(end.times.astype(float), path.reached)
        states = np.concatenate((end.states, end.last[None, :]))
        return replace(path, segments=(*path.segments[:-1], end.resampled(times, states)))

    def _read(
        self,
        times: np.ndarray,
        pieces: Sequence[tuple[Segment, np.ndarray]],
        shape: tuple[int, ...],
        names: Collection[str] | None = None,
    ) -> Moment:
        bits = self.trajectory.engine.precision
        moment = self.problem.moment(times, pieces, shape, bits, names)
        if self.accuracy < DOUBLE or bits == 53:
            return moment
        # Rounded last: quantities derived from rounded states may lose all of their digits.
        rounded = {name: np.asarray(x).astype(float) for name, x in moment.values.items()}
        return replace(moment, values=rounded)

    def __getitem__(self, name: str) -> np.ndarray:
        """A state, coordinate, velocity or output by name, shape (m,) or (m, k).

        Raises
        ------
        UnknownNameError
            nothing has this name.
        """
        return self.moment[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.moment)

    def __contains__(self, name: object) -> bool:
        return name in self.moment

    def keys(self) -> KeysView[str]:
        """Names of the states, coordinates, velocities and outputs."""
        return dict.fromkeys(self.moment).keys()

    def values(self) -> ValuesView[np.ndarray]:
        """The values of each name, in the order of `keys`."""
        return dict(self.moment).values()

    def items(self) -> ItemsView[str, np.ndarray]:
        """Pairs of a name and its values."""
        return dict(self.moment).items()

    def __len__(self) -> int:
        """The number of names."""
        return len(self.moment)

    def __bool__(self) -> bool:
        """True, with and without values."""
        return True

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        """The table of `to_pandas`: a row for each time, the time first, shape (m, columns)."""
        columns = self.problem.columns(self.moment).values()
        return np.column_stack([np.asarray(x).astype(float) for x in columns]).astype(dtype)

    @property
    def states(self) -> np.ndarray:
        """All states of first-order equations, shape (m, size)."""
        return self.moment.states

    @property
    def coordinates(self) -> np.ndarray:
        """q^mu of a curve in the chart of its problem, shape (m, n).

        Angles are within half a turn of the start if the motion was followed in another chart.

        Raises
        ------
        ChartEdgeError
            the motion went where this chart does not reach; use `in_chart`.
        """
        return self.moment.coordinates

    @property
    def velocity(self) -> np.ndarray:
        """q'^mu of a curve in the chart of its problem, shape (m, n)."""
        return self.moment.velocity

    @property
    def frame_velocity(self) -> np.ndarray:
        """u^i = e^i_mu q'^mu of a curve, shape (m, n)."""
        return self.moment.frame_velocity

    @property
    def transported(self) -> np.ndarray:
        """Transported vectors (frame) or deviation (offset, rate), shape (m, number)."""
        return self.moment.transported

    @property
    def charts(self) -> tuple[str, ...]:
        """Names of the charts through which a curve was followed, in order."""
        return self.trajectory.labels

    def in_chart(self, name: str) -> np.ndarray:
        """Coordinates of a curve in another chart, shape (m, number of coordinates there).

        Raises
        ------
        UnknownNameError
            there is no such chart.
        ChartEdgeError
            the motion went where that chart does not reach.
        """
        skip = self._with_end.count - len(self.times)
        return self.problem.in_chart(self._with_end, name)[skip:]

    # -- between the times -----------------------------------------------------------------------

    def at(self, time: Any) -> Moment:
        """Everything at any time up to the last, or at an array of times.

        Between the times of the solution states are interpolated by the engine. `error` covers only
        the times; `error_between` also covers values between them. Taylor series are as accurate
        between the times; RungeKutta and Stiff interpolate to a lower order than they step, and may
        be less accurate.

        Raises
        ------
        TimeError
            a time is outside of the solution.
        """
        return self._at(time)

    def _at(self, time: Any, names: Collection[str] | None = None) -> Moment:
        """Everything at any time, or these names, not a number where the home chart ends."""
        request = times_between(time)
        flat = np.atleast_1d(request).ravel()
        unit = self.problem.time_unit
        last = self.trajectory.reached / unit
        low, high = min(0.0, last), max(0.0, last)
        edge = 1e-15 * abs(last)
        bad = ~(np.isfinite(flat) & (flat >= low - edge) & (flat <= high + edge))
        if bad.any():
            raise TimeError(
                f"expected {self.problem.time_name} from 0 to {last:.6g}, the range of the "
                f"solution, got {flat[bad][0]:.6g}. Solve to a later time, or request a time "
                "within the range."
            )
        parts = self.trajectory.at(flat * unit)
        order = np.argsort(np.concatenate([index for _, _, index in parts]), kind="stable")
        pieces = [(segment, states) for segment, states, _ in parts]
        if len(parts) > 1:
            moment = self._read(flat[np.argsort(order)], pieces, flat.shape, names)
            values = {name: moment.values[name][order] for name in moment.values}
            shaped = {name: x.reshape((*request.shape, *x.shape[1:])) for name, x in values.items()}
            return Moment(request, shaped, moment.whole)
        return self._read(flat, pieces, request.shape, names)

    def event_times(self, term: object, direction: int = 0) -> np.ndarray:
        """All times at which a term crosses zero, in order.

        Crossings by a jump do not count, nor a zero at the very beginning or end.

        Parameters
        ----------
        term
            a name that `at` gives, or an expression over these names, parameters and the time.
            Coordinates of a curve refer to the chart of its problem, also on parts that were
            computed in another chart, where they have a value there.
        direction
            1: only upwards; -1: only downwards; 0: both.

        Raises
        ------
        ExpressionError, UnknownNameError
            the term cannot be read, is not a single number, or has no finite value somewhere.

        Examples
        --------
        >>> from geomtorsion.ode import ODE, solve
        >>> swing = solve(ODE.of({"x": "v", "v": "-x"}, [1, 0]), 10.0)
        >>> swing.event_times("x").round(6).tolist()
        [1.570796, 4.712389, 7.853982]
        """
        if checks.whole(direction) not in (-1, 0, 1):
            raise ArgumentError(
                f"direction: expected 1 (upwards), -1 (downwards) or 0 (both), got "
                f"{checks.shown(direction)}."
            )
        read = self.problem.term(term)

        def function(times: np.ndarray) -> np.ndarray:
            return np.broadcast_to(read.values(self._at(times, read.names)), len(times))

        zeros = [np.zeros(0)]
        stretches = _stretches(self)
        for k, times in enumerate(stretches):
            blocks = range(0, len(times), BLOCK)
            values = np.concatenate([function(times[j : j + BLOCK]) for j in blocks])
            if not np.isfinite(values).all():
                raise ExpressionError(
                    f"{term!r} has no finite value at {self.problem.time_name} = "
                    f"{times[~np.isfinite(values)][0]:.6g}. Request other times."
                )
            largest = np.abs(values).max()
            if k == 0 and abs(values[0]) <= ROUNDINGS * EPS * largest:
                # A zero at the start may be read as a rounding of either sign.
                values[0] = 0.0
            jumps = [*([0] if k else []), *([-1] if k < len(stretches) - 1 else [])]
            for end in jumps:
                if abs(values[end]) <= self.error * largest:
                    # So may a zero at a jump, as at the bounce of a ball.
                    values[end] = 0.0
            zeros.append(crossings(function, times, values, direction))
        return np.concatenate(zeros)

    @property
    def change_times(self) -> np.ndarray:
        """Times at which conditions changed the motion, or pieces met, in order, shape (m,).

        Examples
        --------
        >>> from geomtorsion.ode import ODE, When, solve
        >>> ball = ODE.of({"z": "v", "v": "-10"}, [5, 0], events=[When("z", {"v": "-v/2"})])
        >>> solve(ball, 2.5).change_times.round(9).tolist()
        [1.0, 2.0]
        """
        return np.array(change_times(self.trajectory)) / self.problem.time_unit

    def event_derivatives(self, term: object, by: str, direction: int = 0) -> EventDerivative:
        """How the times at which a term crosses zero depend on a parameter or the start.

        The motion was solved with `derivatives=[by]`.

        Equation
        --------
        dt/dp = -(dg/dp at a fixed time) / (dg/dt), for the term g

        Parameters
        ----------
        term, direction
            see `event_times`. Names of derivatives cannot occur in the term.
        by
            the parameter, or the number at the start.

        Raises
        ------
        UnknownNameError
            the motion was solved without these derivatives.
        ExpressionError
            the term cannot be read, or has no derivative.

        Examples
        --------
        >>> from geomtorsion.ode import ODE, solve
        >>> fall = ODE.of({"z": "v", "v": "-g"}, {"z": 20, "v": 0}, parameters={"g": 10})
        >>> landing = solve(fall, 3.0, derivatives=["g"]).event_derivatives("z", "g")
        >>> landing.times.round(9).tolist(), landing.values.round(9).tolist()
        ([2.0], [-0.1])
        """
        times = self.event_times(term, direction)
        values = self._event_slopes(term, by, times)
        size = float(np.abs(values).max(initial=0.0))
        apart = self._apart(
            values, lambda one: one._event_slopes(term, by, one.event_times(term, direction))
        )
        error = max(apart, self.error * size)
        return EventDerivative(times, values, error)

    def _event_slopes(self, term: object, by: str, times: np.ndarray) -> np.ndarray:
        """dt/dp at the times of events."""
        across, along = self.problem.slopes(term, by, self.at(times))
        with np.errstate(all="ignore"):
            return np.broadcast_to(-np.asarray(across) / along, times.shape).astype(float)

    # -- how good it is --------------------------------------------------------------------------

    @cached_property
    def invariant_changes(self) -> Mapping[str, np.ndarray]:
        """Change of each known invariant at each of `times`, shape (m,), by name.

        It is relative to the size of the terms of the invariant; NaN where the invariant has no
        value, as on the edge of a chart.
        """
        first = self._with_end.count - len(self.times)
        changes = self.problem.invariant_changes(self._with_end)
        return {name: x[first:] for name, x in changes.items()}

    @cached_property
    def drift(self) -> Mapping[str, float]:
        """Largest change of each known invariant, relative to the size of its terms, by name.

        For first-order equations this size is at least the change of the invariant if all states
        changed by their whole size, as `error` counts it. Errors of the states therefore explain a
        drift up to `error`, for any powers in the invariant.

        The start always counts. After an event at a given time the count restarts, because a push
        may change an invariant.
        """
        return {
            name: float(np.nanmax(change)) if np.isfinite(change).any() else float("nan")
            for name, change in self.problem.invariant_changes(self._with_end).items()
        }

    def error_of(self, name: str) -> float:
        """Estimate of the largest error at `times` of a named quantity, relative to its size.

        A state, coordinate or velocity is measured against the largest size in its group, such as
        all velocities: `error` is the largest of these. An output is measured against its own
        largest size, and may have a smaller or larger error. Infinite where no finer run reached
        all of the times.

        Raises
        ------
        UnknownNameError
            nothing has this name.

        Examples
        --------
        >>> from geomtorsion.ode import ODE, solve
        >>> swing = solve(ODE.of({"x": "v", "v": "-x"}, [1, 0]), 10.0, accuracy=1e-8)
        >>> 0 < swing.error_of("x") < 1e-8
        True
        """
        here = self[name]
        apart = self._apart(here, lambda one: one[name])
        if apart == math.inf:
            return apart
        # A smaller difference of a single name may be chance.
        few = CHANCE * rounding(self.trajectory.engine, self.trajectory.steps)
        least = min(few, self.error)
        if apart == 0:
            return least
        together = self.problem.together(name)
        size = max(float(np.abs(self[word]).max()) for word in together or (name,))
        # If a value is NaN, or nothing remains to compare with, the error is unknown.
        error = apart / size if size > 0 else math.inf
        if together and error > UNALIKE:
            # `error` knows the size of states that are only noise.
            return self.error
        return max(least, error)

    def resolves(self, name: str) -> bool:
        """Whether a state or output is more than zero and rounding noise.

        In rounding noise, the compared runs agree in no digit.

        Raises
        ------
        UnknownNameError
            nothing has this name.

        Examples
        --------
        >>> from geomtorsion.ode import ODE, solve
        >>> rest = solve(ODE.of({"x": "-x", "y": "0"}, [1, 0]), 10.0)
        >>> rest.resolves("x"), rest.resolves("y")
        (True, False)
        """
        here = self[name]
        size = float(np.abs(here).max(initial=0.0))
        return size > 0 and self._apart(here, lambda one: one[name]) <= UNALIKE * size

    @property
    def reference(self) -> Trajectory | None:
        """The finer run with which it was compared."""
        return self.comparisons[0].run if self.comparisons else None

    @cached_property
    def _others(self) -> list[Solution]:
        """What each comparison makes of the same times."""
        return [replace(self, trajectory=x.run, comparisons=()) for x in self.comparisons]

    def _apart(self, here: np.ndarray, read: Callable[[Solution], np.ndarray]) -> float:
        """Estimate of the error of some values; infinite where there is nothing to compare with."""
        gaps = []
        for other in self._others:
            if other.trajectory.count != self.trajectory.count:
                return math.inf
            there = read(other)
            if there.shape != here.shape:
                return math.inf
            gaps.append(np.abs(here - there).max(initial=0.0).astype(float))
        error = float(combined(gaps, self.comparisons)) if gaps else math.inf
        # A difference may be NaN.
        return error if math.isfinite(error) else math.inf

    @cached_property
    def error_between(self) -> float:
        """Estimate of the largest error of `at`, also between the times; relative like `error`.

        Computed on first use, from dense output of the solution and of its comparison run, at
        about a hundred times between the first and the last: it costs as much as the solution.
        """
        if not self.comparisons:
            return math.inf
        one, (two, factor) = self.trajectory, self.comparisons[0]
        reached = min(one.reached, two.reached, key=abs)
        knots = np.concatenate(([0.0], self.times.astype(float) * self.problem.time_unit))
        knots = np.unique(knots[np.abs(knots) <= abs(reached)])
        if len(knots) < 2:
            return self.error
        count = -(-PARTS // (len(knots) - 1))
        parts = (np.arange(count) + SHIFT) / count
        times = (knots[:-1, None] + parts * np.diff(knots)[:, None]).ravel()
        gap = difference(self.problem, _sampled(one, times), _sampled(two, times), self.accuracy)
        return max(self.error, factor * gap)

    def __str__(self) -> str:
        ended = {"stopped": ", where it stops", "stuck": f", stuck: {self.trajectory.reason}"}
        last = float(self.times[-1]) if len(self.times) else 0.0
        reach = f"to {self.problem.time_name} = {last:.6g}{ended.get(self.outcome, '')}"
        lines = [
            str(self.problem),
            f"{reach}, {len(self.times)} times, by {self.engine} ({self.reason})",
            f"error below {self.error:.2g} (requested: {self.accuracy:.2g}); {self.cost}",
        ]
        drifts = ", ".join(f"{name} {size_text(value)}" for name, value in self.drift.items())
        return "\n".join([*lines, f"drift: {drifts}"] if drifts else lines)

    def __repr__(self) -> str:
        return str(self)

    _repr_html_ = drawn_by("notebook_pictures", "solution_html")
    plot: ClassVar[Plot] = figure_by("solutions", "draw_solution")

    _ipython_key_completions_ = key_completions

    # -- taking it elsewhere ---------------------------------------------------------------------

    def to_pandas(self) -> Any:  # pandas is not a dependency
        """A pandas table: times, and everything that has a name.

        Raises
        ------
        MissingExtraError
            pandas is not installed.
        """
        return pandas_table(self.problem.columns(self.moment))

    def to_xarray(self) -> Any:  # xarray is not a dependency
        """An xarray Dataset along the time: everything that has a name; attributes hold the error.

        Raises
        ------
        MissingExtraError
            xarray is not installed.
        """
        remarks = {"error": self.error, "accuracy": self.accuracy, "engine": str(self.engine)}
        return xarray_dataset(self.problem.columns(self.moment), remarks)

    def to_csv(self, path: str | Path) -> None:
        """Write times and everything that has a name as a table, every digit kept."""
        write_csv(checks.file_name(path), self.problem.columns(self.moment))

    def to_json(self) -> dict[str, Any]:
        """Columns of everything that has a name, the error and the drift as plain data.

        Numbers are doubles; None where JSON has no number, as for an infinite error.

        Examples
        --------
        >>> from geomtorsion.ode import ODE, solve
        >>> data = solve(ODE.of({"x": "-x"}, [1]), [0.0, 1.0]).to_json()
        >>> data["outcome"], [round(x, 9) for x in data["solution"]["x"]]
        ('done', [1.0, 0.367879441])
        """
        return {
            "solution": plain_columns(self.problem.columns(self.moment)),
            "outcome": self.outcome,
            "error": json_number(self.error),
            "accuracy": self.accuracy,
            "engine": self.engine,
            "drift": {name: json_number(change) for name, change in self.drift.items()},
        }

    def save(self, path: str | Path) -> None:
        """Write an NPZ file with arrays (as doubles) and metadata; `SavedSolution.load` reads it.

        A file name that ends in .csv gets the table of `to_csv`.

        Examples
        --------
        >>> import tempfile
        >>> from geomtorsion.ode import ODE, SavedSolution, solve
        >>> file = Path(tempfile.mkdtemp(), "decay.npz")
        >>> solve(ODE.of({"x": "-x"}, [1]), 1.0).save(file)
        >>> round(float(SavedSolution.load(file).at(0.5)["x"]), 9)
        0.60653066
        """
        if checks.file_name(path).suffix.lower() == ".csv":
            self.to_csv(path)
            return
        words = ("accuracy", "error", "engine", "reason", "outcome")
        metadata = {word: getattr(self, word) for word in words}
        metadata |= {"kind": self.problem.kind, "problem": self.problem.described()}
        metadata["cost"] = {name: float(value) for name, value in vars(self.cost).items()}
        metadata["drift"] = {name: float(value) for name, value in self.drift.items()}
        unit = self.problem.time_unit
        write_solution(path, self.times, self.moment, self.trajectory, unit, metadata)


def _sampled(trajectory: Trajectory, times: np.ndarray) -> Trajectory:
    """A trajectory with its dense output as samples."""
    order = times if trajectory.reached > 0 else times[::-1]
    segments = []
    for segment, states, index in trajectory.at(order):
        segments.append(segment.resampled(order[index], states))
    return Trajectory(trajectory.engine, trajectory.tolerance, tuple(segments), "done")


def read_at(solution: Solution, time: float) -> Solution:
    """The motion up to one time, which is its only sample, read from the dense output.

    Raises
    ------
    TimeError
        The time is outside of the solution.
    """
    solution.at(time)
    path, scaled = solution.trajectory, time * solution.problem.time_unit
    ((last, states, _),) = path.at(np.array([scaled]))
    segments = []
    for segment in path.segments:
        if segment is last:
            segments.append(segment.resampled(np.array([scaled]), states))
            break
        segments.append(segment.resampled(segment.times[:0], segment.states[:0]))
    sampled = Trajectory(path.engine, path.tolerance, tuple(segments), "done")
    return replace(solution, times=np.array([time]), trajectory=sampled, comparisons=())


def _stretches(solution: Solution) -> list[np.ndarray]:
    """Times close enough to see each crossing, for each stretch in which nothing jumps."""
    unit, breaks = solution.problem.time_unit, solution.problem.breaks()
    stretches: list[list[np.ndarray]] = []
    changes = 0
    for segment in solution.trajectory.segments:
        begin, end = float(segment.stage.begin), float(segment.run.reached)
        if begin == end:
            continue
        times = close_times(begin, end, segment.run) / unit
        jumped, changes = segment.stage.changes > changes, segment.stage.changes
        if stretches and begin / unit not in breaks and not jumped:
            stretches[-1].append(times[1:])
        else:
            if stretches:
                # A sample at the time of a jump belongs to the part after it.
                stretches[-1][-1][-1] = np.nextafter(times[0], stretches[-1][-1][-2])
            stretches.append([times])
    return [np.concatenate(parts) for parts in stretches]
