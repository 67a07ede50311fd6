"""scipy_run: one integration by scipy, its silent early ends told apart."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from geomtorsion.errors import LimitError
from geomtorsion.ode.engines.protocol import Dense, Run
from geomtorsion.ode.numbers import Real, floats
from geomtorsion.ode.system import ScalarRates, System

# scipy accepts no smaller relative tolerance.
FLOOR = 2.3e-14
# Evaluations between looks at whether time still moves.
STALL = 20_000


def scipy_run(
    method: str,
    most: int,
    system: System,
    start: Sequence[Real] | np.ndarray,
    parameters: Sequence[Real] | np.ndarray,
    times: np.ndarray,
    tolerance: float,
    dense: bool,
) -> Run:
    """One call of scipy's solve_ivp; its silent early ends are told apart."""
    began = time.perf_counter()
    y0, values = np.array(floats(start)), floats(parameters)
    plain = system.scalar_rates(values)
    options: dict[str, Any] = {}
    if method != "DOP853":
        options["jac"] = lambda _, y: system.jacobian(y.tolist(), values)
    if system.guard is not None:
        options["events"] = _GuardEvent(system, values)
    times = np.asarray(times, dtype=float)
    duration = abs(times[-1] - times[0])

    def fresh() -> Any:
        return _counted(plain, most, duration)

    rates = fresh()
    asked, tolerance = tolerance, max(tolerance, FLOOR)
    span = times[-1] - times[0]
    if method != "DOP853":
        span = _settling(system.jacobian(y0.tolist(), values), span)
    scales = error_scales(system, y0, rates(times[0], y0), span)
    ready = time.perf_counter()
    if times[0] == times[-1] or not np.isfinite(rates(times[0], y0)).all():
        stuck = times[0] != times[-1]
        outcome = "stuck" if stuck else "done"
        reason = "the rates are no numbers at the start" if stuck else ""
        states = y0[None, :]
        return Run(times[:1], states, times[0], y0, outcome, 0, 1, ready - began, 0.0, None, reason)
    if asked < FLOOR and method == "DOP853":
        # Dense output is of order 7: shorter steps help it where the tolerance no longer can.
        with np.errstate(all="ignore"):
            ends = (times[0], times[-1])
            trial = solve_ivp(fresh(), ends, y0, method, rtol=FLOOR, atol=FLOOR * scales)
        if trial.status == 0:
            options["max_step"] = duration / len(trial.t) * (asked / FLOOR) ** 0.125
    with np.errstate(all="ignore"):
        found = solve_ivp(
            rates,
            (times[0], times[-1]),
            y0,
            method,
            t_eval=times,
            rtol=tolerance,
            atol=tolerance * scales,
            dense_output=dense,
            **options,
        )
    ended = time.perf_counter()
    count, states = len(found.t), found.y.T
    outcome, reason, reached, last = "done", "", times[-1], states[-1] if count else y0
    if found.status == 1:
        outcome, reached, last = "edge", float(found.t_events[0][-1]), found.y_events[0][-1]
    elif count < len(times) or not np.isfinite(states).all():
        finite = np.isfinite(states).all(axis=1)
        count = count if finite.all() else int(np.argmin(finite))
        outcome, reason = "stuck", str(found.message).rstrip(".")
        options.pop("events", None)
        with np.errstate(all="ignore"):
            again = solve_ivp(
                fresh(), (times[0], times[-1]), y0, method,
                rtol=tolerance, atol=tolerance * scales, **options,
            )  # fmt: skip
        good = np.flatnonzero(np.isfinite(again.y).all(axis=0))[-1]
        reached, last = float(again.t[good]), again.y[:, good]
    return Run(
        times[:count],
        states[:count],
        reached,
        last,
        outcome,
        found.nfev // 12 if method == "DOP853" else found.njev,
        found.nfev,
        ready - began,
        ended - ready,
        _transposed(found.sol) if dense else None,
        reason,
    )


def _settling(jacobian: np.ndarray, duration: float) -> float:
    """The time after which the fastest part has settled: rates do not last any longer."""
    if not np.isfinite(jacobian).all():
        return duration
    fastest = float(np.abs(np.linalg.eigvals(jacobian)).max())
    return duration if fastest * abs(duration) < 1 else 1 / fastest


def error_scales(
    system: System, y0: np.ndarray, rates: Sequence[float] | np.ndarray, duration: float
) -> np.ndarray:
    """The size of each state for absolute tolerances: that of its group, now or soon."""
    scales = np.empty(y0.shape)
    for group in system.groups:
        index = list(group)
        size = np.abs(y0[index]).max(axis=0)
        if not np.all(size > 0):
            soon = np.abs(np.asarray(rates)[index]).max(axis=0) * abs(duration)
            size = np.where(size > 0, size, soon)
        scales[index] = np.where(np.isfinite(size) & (size > 0), size, 1.0)
    return scales


def _counted(function: ScalarRates, most: int, duration: float) -> Any:
    """The rates, refusing to be called without end; no numbers any more where time stands still.

    scipy then gives up with what it has, as it does where the rates themselves end.
    """
    calls, mark, stalled = 0, float("-inf"), False

    def rates(t: float, y: np.ndarray) -> Sequence[float] | np.ndarray:
        nonlocal calls, mark, stalled
        calls += 1
        if calls % STALL == 0:
            stalled = stalled or abs(t - mark) < 1e-6 * duration
            mark = t
            if calls > most:
                raise LimitError(
                    f"more than {most} evaluations of the rates were needed by t = {t:.6g}. "
                    "Ask for less accuracy or time, use engine=Stiff(), or raise max_evaluations."
                )
        return y * float("nan") if stalled else function(t, y)

    return rates


class _GuardEvent:
    """scipy event: the guard falls through zero."""

    terminal = True
    direction = -1

    def __init__(self, system: System, values: Sequence[float]) -> None:
        self.system = system
        self.values = values

    def __call__(self, _: float, y: np.ndarray) -> float:
        return float(self.system.guard_along(y, self.values))


def _transposed(solution: Any) -> Dense:
    """scipy's dense output with times first."""
    return lambda t: solution(t).T
