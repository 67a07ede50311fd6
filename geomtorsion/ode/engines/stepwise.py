"""Stepwise: an integration step by step, with samples and guard; steps are ours or scipy's."""

from __future__ import annotations

import math
import time
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, TypeAlias

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.ode.engines.stepper import (
    Polynomial,
    Steps,
    stage_count,
    step_of,
    too_many_evaluations,
)
from geomtorsion.ode.numbers import Real, floats
from geomtorsion.ode.roundings import Changes
from geomtorsion.ode.system import (
    STEPS_AT_ONCE,
    Dense,
    Run,
    System,
    Watch,
    WorkLimitError,
    eigenvalues,
)
from geomtorsion.support.allowance import check_limits
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import EPS

# Smaller differences are rounding errors in generated code, and scipy accepts no smaller relative
# tolerance.
LEAST = 1e-15
FLOOR = 100 * EPS

# Implicit steps follow a state down to this fraction of its size, because other states may depend
# on it, as fast reactions depend on their supply.
DECAYED = 1e-6


class Pace:
    """Longest step from a time on: a share of the step of a run to the least tolerance there.

    Errors of steps below that tolerance cannot be measured; they shrink with the order of the
    method. times: of the run, in order; limit: of all steps.
    """

    def __init__(
        self, times: Sequence[float], tolerance: float, least: float, limit: float = math.inf
    ) -> None:
        self._sign: float = 1.0 if times[-1] >= times[0] else -1.0
        self._times: list[float] = [self._sign * time for time in times]
        self._share: float = (tolerance / least) ** 0.125
        self._limit: float = limit

    def __call__(self, time: float) -> float:
        """The longest step from a time on."""
        k = min(bisect_right(self._times, self._sign * time), len(self._times) - 1)
        return min(self._share * (self._times[k] - self._times[k - 1]), self._limit)


def limited(longest: float) -> Callable[[float], float]:
    """The same longest step at all times."""
    return lambda _: longest


@cache
def paced_dop853() -> Any:
    """scipy's DOP853 with longest steps that change on the way."""

    class Paced(scipy.integrate.DOP853):
        def __init__(self, *given: Any, longest: Callable[[float], float], **more: Any) -> None:
            super().__init__(*given, max_step=longest(given[1]), **more)
            self._longest = longest

        def _step_impl(self) -> tuple[bool, str | None]:
            self.max_step = self._longest(self.t)
            return super()._step_impl()

    return Paced


class Piece:
    """Dense output of one step, computed on first use, which must precede the next step."""

    def __init__(self, solver: Any) -> None:
        self.t: float = float(solver.t_old)
        self.h: float = float(solver.t - solver.t_old)
        self.width: int = int(solver.n)
        self._solver: Any = solver

    @cached_property
    def _polynomial(self) -> Any:
        polynomial = self._solver.dense_output()
        self._solver = None
        return polynomial

    def __call__(self, times: np.ndarray) -> np.ndarray:
        """States at times within the step, shape (m, n)."""
        return self._polynomial(np.asarray(times)).T


class ScipySteps:
    """Steps of a solver of scipy from a start on; an implementation of `Steps`."""

    def __init__(
        self,
        method: str,
        system: System,
        values: Sequence[float],
        y0: Sequence[float],
        span: tuple[float, float],
        tolerance: float,
        scales: Sequence[float],
        longest: Callable[[float], float],
        most: int,
    ) -> None:
        rates = counted(system.scalar_rates(values), most, abs(span[1] - span[0]))
        options: dict[str, Any] = {}
        self.time: float
        self.time, end = span
        if method == "DOP853":
            options["longest"] = longest
        else:
            options["max_step"] = longest(self.time)
            options["jac"] = lambda _, y: system.jacobian(y.tolist(), values)
        self.sign: float = 1.0 if end >= self.time else -1.0
        self.state: Sequence[float] = tuple(y0)
        self.count: int = 0
        self.stuck: str = ""
        least = tolerance if method == "DOP853" else max(DECAYED * tolerance, FLOOR)
        floors = least * np.asarray(scales)
        self._solver: Any = None
        try:
            with np.errstate(all="ignore"):
                solver = paced_dop853() if method == "DOP853" else getattr(scipy.integrate, method)
                self._solver = solver(
                    rates, self.time, np.array(y0), end, rtol=tolerance, atol=floors, **options
                )
        except (ValueError, np.linalg.LinAlgError):
            self.stuck = NO_JACOBIAN

    @property
    def evaluations(self) -> int:
        """Evaluations of the rates."""
        return 0 if self._solver is None else int(self._solver.nfev)

    def move(self, state: Sequence[float]) -> None:
        """Continue from another state at the same time; LSODA keeps its own, and does not."""
        self.state = tuple(state)
        self._solver.y = np.array(state)
        self._solver.f = np.asarray(self._solver.fun(self._solver.t, self._solver.y))

    def advance(self) -> Piece | None:
        """One accepted step; None if no step is possible, see `stuck`."""
        solver = self._solver
        if solver is None:
            return None
        try:
            with np.errstate(all="ignore"):
                message = solver.step()
        except WorkLimitError:
            # It is also a ValueError.
            raise
        except (ValueError, np.linalg.LinAlgError):
            # scipy refuses to solve linear equations with NaN.
            message = NO_JACOBIAN
        if solver.status == "failed" or message or not np.isfinite(solver.y).all():
            self.stuck = (message or "the states are no longer finite").rstrip(".")
            return None
        self.time, self.state = float(solver.t), tuple(solver.y.tolist())
        self.count += 1
        return Piece(solver)


NO_JACOBIAN = "the Jacobian has no finite value"


def counted(function: Callable[[float, np.ndarray], Any], most: int, duration: float) -> Any:
    """The rates, with a limit on calls; NaN if time makes no progress.

    scipy then gives up with what it has, as it does where the rates themselves end.
    """
    calls, mark, stalled = 0, float("-inf"), False
    looks = STEPS_AT_ONCE * stage_count()

    def rates(t: float, y: np.ndarray) -> Sequence[float] | np.ndarray:
        nonlocal calls, mark, stalled
        calls += 1
        if calls % looks == 0:
            check_limits()
            stalled = stalled or abs(t - mark) < 1e-6 * duration
            mark = t
            if calls > most:
                raise too_many_evaluations(most, t)
        return y * float("nan") if stalled else function(t, y)

    return rates


Pieces: TypeAlias = list[Polynomial | Piece]


class Edge:
    """The guard of a system along a run, which ends where the guard falls through zero."""

    def __init__(self, system: System, values: Sequence[float], state: Sequence[float]) -> None:
        self._system, self._values = system, values
        self._inside: bool = self._guard(state) > 0

    def _guard(self, state: Sequence[float]) -> float:
        """The guard at a state."""
        return self._system.guard_at(state, self._values)

    def crossing(
        self, piece: Polynomial | Piece, end: float, state: Sequence[float]
    ) -> float | None:
        """The time of the crossing within a step with this end; None without a crossing."""
        value = self._guard(state)
        # Roots touch zero, but are nowhere below.
        falls = self._inside and value <= 0
        self._inside = value > 0
        return self._root(piece, end) if falls else None

    def _root(self, piece: Polynomial | Piece, end: float) -> float:
        """The time within a step at which the guard is zero."""

        def value(t: float) -> float:
            return self._guard(piece(np.array([t]))[0].tolist())

        if value(piece.t) <= 0 or value(end) >= 0:
            return end
        tiny = 4 * np.finfo(float).eps
        # Its declared type includes the pair that it returns with a report.
        return float(scipy.optimize.brentq(value, piece.t, end, xtol=tiny, rtol=tiny))  # type: ignore[arg-type]


class Record:
    """Record of a run: samples, dense output, the longest step, and how it ended.

    edge: the guard to compare after each step; dense: whether to keep the output of each step.
    """

    def __init__(
        self, times: np.ndarray, y0: Sequence[float], sign: float, edge: Edge | None, dense: bool
    ) -> None:
        self.times: np.ndarray = times
        self.states: np.ndarray = np.empty((len(times), len(y0)))
        self.states[0] = y0
        self.done: int = 1
        self.outcome: str = "done"
        self.reached: float = float(times[-1])
        self.last: np.ndarray | None = None
        self.longest_step: float = 0.0
        self._sign, self._order = sign, (times * sign).tolist()
        self._edge, self._dense = edge, dense
        self._pieces: Pieces = []

    def add(self, piece: Polynomial | Piece, walk: Steps | ScipySteps, before: float) -> None:
        """Add the step of a walk from a time before."""
        self.longest_step = max(self.longest_step, abs(walk.time - before))
        if self._dense:
            # Worked out now: some solvers forget a step with the next one.
            piece(np.array([walk.time]))
            self._pieces.append(piece)
        crossing = None
        if self._edge is not None:
            crossing = self._edge.crossing(piece, walk.time, walk.state)
        end = walk.time if crossing is None else crossing
        count = bisect_right(self._order, self._sign * end, self.done)
        if count > self.done:
            self.states[self.done : count] = piece(self.times[self.done : count])
            if self._order[count - 1] == self._sign * walk.time:
                self.states[count - 1] = walk.state
            self.done = count
        if crossing is not None:
            self.end("edge", end, piece(np.array([end]))[0])

    def end(self, outcome: str, reached: float, last: Sequence[float] | np.ndarray) -> None:
        """End the run before its last time."""
        self.outcome, self.reached, self.last = outcome, reached, np.array(last)

    def run(self, steps: int, evaluations: int, reason: str, seconds: tuple[float, float]) -> Run:
        """The result; seconds: to compile, and to run."""
        last = self.states[-1].copy() if self.last is None else self.last
        return Run(
            self.times[: self.done], self.states[: self.done], self.reached, last, self.outcome,
            steps, evaluations, *seconds, _joined(self._pieces) if self._pieces else None, reason,
            self.longest_step,
        )  # fmt: skip


@dataclass(frozen=True)
class Stepwise:
    """Integration step by step.

    method: "generated" steps of DOP853; or "DOP853", "Radau", "LSODA" of scipy.
    most: evaluations of the rates; a run that needs more raises an error.
    """

    method: str
    most: int

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
        """See `Engine.run`."""
        began = time.perf_counter()
        y0, values = floats(start), floats(parameters)
        times = np.asarray(times, dtype=float)
        first, last = float(times[0]), float(times[-1])
        rates = np.asarray(system.scalar_rates(values)(first, np.array(y0)), dtype=float)
        if self.method == "generated":
            step_of(system)
        ready = time.perf_counter()
        if first == last:
            return _unmoved(times, y0, "done", "", ready - began)
        if not np.isfinite(rates).all():
            reason = "the rates are not finite at the start"
            return _unmoved(times, y0, "stuck", reason, ready - began)
        walks_from = self._walks(system, y0, values, rates, (first, last), tolerance)
        pace = self._pace(walks_from, y0, first, last, tolerance, longest)
        walk = walks_from(first, y0, pace, self.method)
        walks = [walk]
        edge = None if system.guard is None else Edge(system, values, walk.state)
        record = Record(times, y0, walk.sign, edge, dense)
        while walk.time != last and record.outcome == "done":
            before = walk.time
            piece = walk.advance()
            if piece is None and self.method == "LSODA" and len(walks) == 1:
                # Where rates end, LSODA takes no shorter step back; Radau comes to the very place.
                walk = walks_from(walk.time, walk.state, pace, "Radau")
                walks.append(walk)
                piece = walk.advance()
            if piece is None:
                record.end("stuck", walk.time, walk.state)
                break
            if watch is not None:
                watch(walk.time)
            record.add(piece, walk, before)
            if changes is not None and changes.due():
                walk.move(changes.made(np.array(walk.state), record.states[0]).tolist())
        seconds = ready - began, time.perf_counter() - ready
        steps, evaluations = sum(x.count for x in walks), sum(x.evaluations for x in walks)
        return record.run(steps, evaluations, walk.stuck, seconds)

    def _walks(
        self,
        system: System,
        y0: Sequence[float],
        values: Sequence[float],
        rates: np.ndarray,
        span: tuple[float, float],
        tolerance: float,
    ) -> Walks:
        """Walks to the end of a span from any time, state and pace on; rates: at the start."""
        duration = span[1] - span[0]
        if self.method in ("Radau", "LSODA"):
            duration = _settling(system.jacobian(y0, values), duration)
        scales = error_scales(system, np.array(y0), values, rates, duration).tolist()
        tolerance = max(tolerance, self._least)

        def walks_from(
            begin: float, state: Sequence[float], pace: Callable[[float], float], by: str
        ) -> Steps | ScipySteps:
            arguments = system, values, state, (begin, span[1]), tolerance, scales, pace, self.most
            return Steps(*arguments) if by == "generated" else ScipySteps(by, *arguments)

        return walks_from

    @property
    def _least(self) -> float:
        """The least tolerance of a step."""
        return LEAST if self.method == "generated" else FLOOR

    def _pace(
        self,
        walks_from: Walks,
        y0: Sequence[float],
        first: float,
        last: float,
        tolerance: float,
        longest: float,
    ) -> Callable[[float], float]:
        """The longest step from a time on; a tolerance below the least needs a trial run."""
        even = limited(longest)
        if tolerance >= self._least:
            return even
        trial = walks_from(first, y0, even, self.method)
        passed = [first]
        while trial.time != last and trial.advance() is not None:
            passed.append(trial.time)
        return even if trial.stuck else Pace(passed, tolerance, self._least, longest)


Walks: TypeAlias = Callable[
    [float, Sequence[float], Callable[[float], float], str], Steps | ScipySteps
]


def _unmoved(
    times: np.ndarray, y0: Sequence[float], outcome: str, reason: str, seconds: float
) -> Run:
    """The run without a step; seconds: to compile."""
    here = np.array(y0)
    first = float(times[0])
    return Run(times[:1], here[None, :], first, here, outcome, 0, 1, seconds, 0.0, None, reason)


def _joined(pieces: Pieces) -> Dense:
    """Dense output of all steps."""
    begins = np.array([piece.t for piece in pieces])
    sign = 1.0 if pieces[0].h > 0 else -1.0
    kind = pieces[0](begins[:1]).dtype

    def values(t: np.ndarray) -> np.ndarray:
        flat = np.atleast_1d(np.asarray(t, dtype=float))
        place = np.clip(np.searchsorted(sign * begins, sign * flat, "right") - 1, 0, None)
        states = np.empty((len(flat), pieces[0].width), dtype=kind)
        order = np.argsort(place, kind="stable")
        numbers, first = np.unique(place[order], return_index=True)
        for k, index in zip(numbers.tolist(), np.split(order, first[1:]), strict=True):
            states[index] = pieces[k](flat[index])
        return states

    return values


def _settling(jacobian: np.ndarray, duration: float) -> float:
    """The time after which the fastest part has settled: rates do not last any longer."""
    own = eigenvalues(jacobian)
    if own is None:
        return duration
    fastest = float(np.abs(own).max())
    return duration if fastest * abs(duration) < 1 else 1 / fastest


def error_scales(
    system: System,
    y0: np.ndarray,
    numbers: Sequence[float] | Sequence[np.ndarray],
    rates: Sequence[float] | np.ndarray,
    duration: float,
) -> np.ndarray:
    """The size of each state for absolute tolerances: the size of its group, now or soon.

    numbers: values of the parameters. A state that starts at zero has the scale of the terms of its
    rate; if they cancel, no step would be short enough for the remainder.
    """
    scales = np.empty(y0.shape)
    for group in system.groups:
        index = list(group)
        size = np.abs(y0[index]).max(axis=0)
        # Endless sizes count as unknown below.
        with np.errstate(over="ignore"):
            soon = np.abs(np.asarray(rates)[index]).max(axis=0)
            # A rounding of what it soon becomes is as good as zero.
            still = size <= EPS * soon * abs(duration)
            if np.any(still):
                terms = np.abs(system.rates.sizes(*y0, *numbers)[index]).max(axis=0)
                size = np.where(still, terms * abs(duration), size)
        scales[index] = np.where(np.isfinite(size) & (size > 0), size, 1.0)
    return scales
