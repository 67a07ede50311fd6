"""Motion rivals: heyoka and scipy by hand, and scipy on Christoffel symbols."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any

import numpy as np
import sympy as sp
from scipy.integrate import solve_ivp

from geomtorsion.curves import CurveProblem
from geomtorsion.ode import ODE, Taylor, solve
from tests.benchmarks.motions import SAMPLES, Case, exact


def best_times(functions: Sequence[Callable[[], Any]], seconds: float = 0.4) -> list[float]:
    """CPU seconds of the fastest of many calls of each function; calls alternate under one load."""
    best, began, rounds = [float("inf")] * len(functions), time.process_time(), 0
    while rounds < 3 or time.process_time() - began < seconds:
        for k, function in enumerate(functions):
            start = time.process_time_ns()
            function()
            best[k] = min(best[k], (time.process_time_ns() - start) * 1e-9)
        rounds += 1
    return best


Run = Callable[[], Any]


def heyoka_by_hand(case: Case, accuracy: float) -> tuple[Run, Run] | None:
    """heyoka, compiled, at the loosest tolerance that reaches the accuracy; plain and checked run.

    A user would not know that tolerance; here a comparison with the truth finds it. The check is
    a second integration with a hundredth of the tolerance, and the largest difference.
    """
    hy = import_module("heyoka")

    rates, start, values = case.by_hand(hy)
    grid = np.linspace(0, case.t, SAMPLES)
    truth = exact(rates, start, values, grid)

    def made(power: int) -> Run:
        integrator = hy.taylor_adaptive(rates, start, pars=values, tol=10.0**-power)

        def run() -> Any:
            integrator.time = 0.0
            integrator.state[:] = start
            return integrator.propagate_grid(grid)[5]

        return run

    for power in range(4, 19):
        run = made(power)
        if _error(run(), truth, case.blocks) <= accuracy:
            return run, _checked(run, made(power + 2))
    return None


def _checked(run: Run, finer: Run) -> Run:
    """A run and a finer run; returns their largest difference."""
    return lambda: np.abs(run() - finer()).max()


def _error(states: Any, truth: Any, blocks: Sequence[slice] = (slice(None),)) -> float:
    """Largest difference divided by the largest value, the maximum over the blocks."""
    if len(states) < len(truth):
        return float("inf")
    gaps = np.abs(states - truth)
    return max([float(gaps[:, b].max() / np.abs(truth[:, b]).max()) for b in blocks])


def _second_order(case: Case, n: int) -> tuple[list[Any], list[Any]]:
    """Velocities of n coordinates, and their rates with Christoffel symbols."""
    v = list(sp.symbols(f"v0:{n}"))
    right = [sp.S.Zero] * n
    for (a, b, c), value in case.connection.coefficients.nonzero().items():
        right[c] -= value * v[a] * v[b]
    return v, right


def christoffel_ode(case: Case) -> ODE | None:
    """The geodesic in its coordinates, with Christoffel symbols, for one of our engines."""
    if case.connection is None or not isinstance(case.problem, CurveProblem):
        return None
    q = case.problem.frame.coordinates
    v, right = _second_order(case, len(q))
    used = {symbol.name for rate in right for symbol in rate.free_symbols}
    return ODE.of(
        dict(zip([x.name for x in (*q, *v)], [*v, *right], strict=True)),
        [*map(float, case.problem.start or ()), *map(float, case.problem.velocity)],
        parameters={name: x for name, x in case.problem.parameters.items() if name in used},
        time="parameter",
        norm_groups=[[x.name for x in q], [x.name for x in v]],
        name=f"{case.name}, with Christoffel symbols",
    )


def scipy_on_christoffel(case: Case, accuracy: float, limit: float = 20.0) -> float | None:
    """CPU seconds of scipy's DOP853 on lambdified Christoffel symbols; None if out of reach."""
    if case.connection is None or not isinstance(case.problem, CurveProblem):
        return None
    frame = case.problem.frame
    n, q = frame.dimension, list(frame.coordinates)
    v, right = _second_order(case, n)
    numbers = {s: float(case.problem.parameters[s.name]) for s in frame.parameters}
    # The rival uses the function of sympy.lambdify, with common subexpressions shared.
    function = sp.lambdify([*q, *v], [x.subs(numbers) for x in right], "numpy", cse=True)
    start = np.concatenate(
        ([float(x) for x in case.problem.start or ()], np.asarray(case.problem.velocity))
    )
    grid = np.linspace(0, case.t, SAMPLES)
    home = case.problem.with_charts(case.problem.atlas.home)
    truth = solve(home, grid, 1e-14, Taylor(64)).coordinates.astype(float)

    def rates(_: float, y: Any) -> Any:
        return np.concatenate((y[n:], function(*y)))

    for power in range(4, 14):
        tolerance = 10.0**-power

        def run(tolerance: float = tolerance) -> Any:
            return solve_ivp(
                rates, (0, case.t), start, "DOP853", t_eval=grid, rtol=tolerance, atol=tolerance
            ).y.T

        began = time.perf_counter()
        states = run()
        if len(states) == SAMPLES and _error(states[:, :n], truth) <= accuracy:
            return best_times([run])[0]
        if time.perf_counter() - began > limit:
            return None
    return None


def scipy_by_hand(case: Case, accuracy: float) -> tuple[Run, Run] | None:
    """scipy's DOP853 on heyoka's equations in plain Python: a plain and a checked run.

    sympy.lambdify shares common subexpressions and calls the math module, so the rates make no
    small arrays.
    """
    hy = import_module("heyoka")
    equations, start, values = case.by_hand(hy)
    names = [hy.to_sympy(variable) for variable, _ in equations]
    numbers = {f"par[{k}]": value for k, value in enumerate(values)}
    rates = [hy.to_sympy(rate) for _, rate in equations]
    known = {s: numbers[s.name] for x in rates for s in x.free_symbols if s.name in numbers}
    rates = [sp.nsimplify(x, rational=True).subs(known) for x in rates]
    function = sp.lambdify(names, rates, "math", cse=True)
    grid = np.linspace(0, case.t, SAMPLES)
    truth = exact(equations, start, values, grid)

    def made(power: int) -> Run:
        return lambda: solve_ivp(
            lambda _, y: function(*y.tolist()), (0, case.t), start, "DOP853",
            t_eval=grid, rtol=10.0**-power, atol=10.0**-power,
        ).y.T  # fmt: skip

    for power in range(4, 14):
        run = made(power)
        if _error(run(), truth, case.blocks) <= accuracy:
            return run, _checked(run, made(min(power + 2, 13)))
    return None
