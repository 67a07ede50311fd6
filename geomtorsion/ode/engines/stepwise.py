"""Stepwise: an integration step by step, with samples and guard; steps are ours or scipy's."""

from __future__ import annotations

import math
import time
from bisect import bisect_right
from collections.abc import Callable, Sequence
from functools import cache, partial
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
    """Dense output of one step, worked out on first use: before the next step."""

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
        """One accepted step; None where none is: see `stuck`."""
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


def stepwise_run(
    method: str,
    most: int,
    system: System,
    start: Sequence[Real] | np.ndarray,
    parameters: Sequence[Real] | np.ndarray,
    times: np.ndarray,
    tolerance: float,
    dense: bool,
    watch: Watch | None = None,
    longest: float = math.inf,
    changes: Changes | None = None,
) -> Run:
    """See `Engine.run`; method: "generated" steps of DOP853; or "DOP853", "Radau", "LSODA"."""
    began = time.perf_counter()
    generated = method == "generated"
    y0, values = floats(start), floats(parameters)
    times = np.asarray(times, dtype=float)
    first, last = float(times[0]), float(times[-1])
    first_rates = np.asarray(system.scalar_rates(values)(first, np.array(y0)), dtype=float)
    if generated:
        step_of(system)
    ready = time.perf_counter()
    if first == last or not np.isfinite(first_rates).all():
        outcome = "done" if first == last else "stuck"
        reason = "" if first == last else "the rates are not finite at the start"
        here = np.array(y0)
        return Run(
            times[:1], here[None, :], first, here, outcome, 0, 1, ready - began, 0.0, None, reason
        )
    span = last - first
    if method in ("Radau", "LSODA"):
        span = _settling(system.jacobian(y0, values), span)
    scales = error_scales(system, np.array(y0), values, first_rates, span).tolist()
    least = LEAST if generated else FLOOR
    pace: Callable[[float], float] = limited(longest)

    def steps(begin: float, state: Sequence[float], by: str) -> Steps | ScipySteps:
        used = max(tolerance, least)
        arguments = (system, values, state, (begin, last), used, scales, pace, most)
        return Steps(*arguments) if generated else ScipySteps(by, *arguments)

    if tolerance < least:
        trial = steps(first, y0, method)
        passed = [first]
        while trial.time != last and trial.advance() is not None:
            passed.append(trial.time)
        if not trial.stuck:
            pace = Pace(passed, tolerance, least, longest)
    walk = steps(first, y0, method)
    guard = None if system.guard is None else partial(_guard, system, values)
    samples = np.empty((len(times), len(y0)))
    samples[0] = y0
    order = (times * walk.sign).tolist()
    pieces: Pieces = []
    done, outcome, longest_step = 1, "done", 0.0
    reached, where = last, None
    inside = guard is None or guard(walk.state) > 0
    count_before = evaluations_before = 0
    while walk.time != last:
        before = walk.time
        piece = walk.advance()
        if piece is None and method == "LSODA" and not count_before:
            count_before, evaluations_before = walk.count, walk.evaluations
            # Where rates end, LSODA takes no shorter step back; Radau comes to the very place.
            walk = steps(walk.time, walk.state, "Radau")
            piece = walk.advance()
        if piece is None:
            outcome, reached, where = "stuck", walk.time, np.array(walk.state)
            break
        end = walk.time
        longest_step = max(longest_step, abs(end - before))
        if watch is not None:
            watch(end)
        if dense:
            # Worked out now: some solvers forget a step with the next one.
            piece(np.array([end]))
            pieces.append(piece)
        if guard is not None:
            value = guard(walk.state)
            # Roots touch zero, but are nowhere below.
            if inside and value <= 0:
                outcome, end = "edge", _crossing(guard, piece, walk.time)
                reached, where = end, piece(np.array([end]))[0]
            inside = value > 0
        count = bisect_right(order, walk.sign * end, done)
        if count > done:
            samples[done:count] = piece(times[done:count])
            if order[count - 1] == walk.sign * walk.time:
                samples[count - 1] = walk.state
            done = count
        if outcome == "edge":
            break
        if changes is not None and changes.due():
            walk.move(changes.made(np.array(walk.state), samples[0]).tolist())
    if where is None:
        where = samples[-1].copy()
    ended = time.perf_counter()
    return Run(
        times[:done],
        samples[:done],
        reached,
        where,
        outcome,
        count_before + walk.count,
        evaluations_before + walk.evaluations,
        ready - began,
        ended - ready,
        _joined(pieces) if pieces else None,
        walk.stuck,
        longest_step,
    )


def _guard(system: System, values: Sequence[float], state: Sequence[float]) -> float:
    """The guard at a state."""
    return system.guard_at(state, values)


def _crossing(
    guard: Callable[[Sequence[float]], float], piece: Polynomial | Piece, after: float
) -> float:
    """The time within a step at which the guard falls through zero."""

    def value(t: float) -> float:
        return guard(piece(np.array([t]))[0].tolist())

    if value(piece.t) <= 0 or value(after) >= 0:
        return after
    tiny = 4 * np.finfo(float).eps
    # Its declared type includes the pair that it returns with a report.
    return float(scipy.optimize.brentq(value, piece.t, after, xtol=tiny, rtol=tiny))  # type: ignore[arg-type]


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
