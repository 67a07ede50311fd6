"""Motions to race: each with a hand-written heyoka integrator and scipy on Christoffel symbols."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
import sympy as sp
from scipy.integrate import solve_ivp

from geomtorsion.accuracy.truth import truth_of
from geomtorsion.geometry import Frame, cartan, levi_civita
from geomtorsion.motion import Problem, autoparallel, geodesic
from geomtorsion.motion.engines import Taylor
from geomtorsion.motion.journey import travel
from geomtorsion.spaces import load

MOMENTS = (1.1, 2.2, 3.3)
SPIN = (0.9, 0.4, 0.7)
ANGLES = (0.3, 1.0, 0.2)
SAMPLES = 65


@dataclass(frozen=True)
class Case:
    """A problem, how far it goes, a rival's equations and its own second-order form."""

    name: str
    problem: Problem
    t: float
    by_hand: Callable[[Any], tuple[list[Any], list[float], list[float]]]
    connection: Any = None


def euler_rates(hy: Any) -> tuple[list[Any], list[float], list[float]]:
    """I u' = I u x u."""
    x, y, z = hy.make_vars("x", "y", "z")
    a, b, c = MOMENTS
    p = hy.par
    rates = [(x, p[0] * y * z), (y, p[1] * z * x), (z, p[2] * x * y)]
    return rates, list(SPIN), [(b - c) / a, (c - a) / b, (a - b) / c]


def attitude(hy: Any) -> tuple[list[Any], list[float], list[float]]:
    """Euler's rates and the quaternion."""
    x, y, z, q0, q1, q2, q3 = hy.make_vars("x", "y", "z", "q0", "q1", "q2", "q3")
    rates, spin, values = euler_rates(hy)
    more = [
        (q0, -0.5 * (q1 * x + q2 * y + q3 * z)),
        (q1, 0.5 * (q0 * x + q2 * z - q3 * y)),
        (q2, 0.5 * (q0 * y + q3 * x - q1 * z)),
        (q3, 0.5 * (q0 * z + q1 * y - q2 * x)),
    ]
    return [*more, *rates], [*_quaternion(), *spin], values


def angles(hy: Any) -> tuple[list[Any], list[float], list[float]]:
    """The attitude in Euler angles, Euler's rates with it."""
    f1, f2, f3, x, y, z = hy.make_vars("f1", "f2", "f3", "x", "y", "z")
    rates, spin, values = euler_rates(hy)
    return [*_angle_rates(hy, f1, f2, x, y, z, f3), *rates], [*ANGLES, *spin], values


def straight(hy: Any) -> tuple[list[Any], list[float], list[float]]:
    """The autoparallel: angles with constant body rates."""
    f1, f2, f3 = hy.make_vars("f1", "f2", "f3")
    p = hy.par
    return _angle_rates(hy, f1, f2, p[0], p[1], p[2], f3), list(ANGLES), list(SPIN)


def kerr_orbit(hy: Any) -> tuple[list[Any], list[float], list[float]]:
    """The frame form of a Kerr geodesic, written with the library's own exact coefficients."""
    problem = kerr()
    engine = Taylor()
    equations = problem.equations("kerr")
    system = equations.system.without_edge
    variables = hy.make_vars(*system.states)
    from geomtorsion.exact.engine_code import HeyokaWriter

    known = dict(zip(system.states, variables, strict=True))
    known |= {name: hy.par[k] for k, name in enumerate(system.parameters)}
    writer = HeyokaWriter(known, lambda p, q: hy.expression(p / q))
    rates = [(v, writer.products(r)) for v, r in zip(variables, system.rates, strict=True)]
    values = [float(problem.parameters[name]) for name in system.parameters]
    assert problem.start is not None
    assert engine.precision == 53
    return rates, [*problem.start, *problem.frame_velocity], values


def _angle_rates(hy: Any, f1: Any, f2: Any, x: Any, y: Any, z: Any, f3: Any) -> list[Any]:
    across = (hy.sin(f1) * y - hy.cos(f1) * x) / hy.sin(f2)
    return [
        (f1, z - across * hy.cos(f2)),
        (f2, hy.sin(f1) * x + hy.cos(f1) * y),
        (f3, across),
    ]


def _quaternion() -> list[float]:
    from scipy.spatial.transform import Rotation

    q = Rotation.from_euler("ZYZ", ANGLES[::-1]).as_quat()
    return [q[3], q[0], q[1], q[2]]


def kerr() -> Problem:
    """A bound orbit off the equator."""
    return geodesic(
        load("kerr").frame,
        [0, 8.0, 1.4, 0],
        frame_velocity=[1.2, 0.05, 0.2, 0.6],
        parameters={"M": 1, "a": 0.6},
        causal=None,
    )


def kinetic_frame() -> Frame:
    """so3 with the kinetic metric of the top, for the rival's Christoffel symbols."""
    so3 = load("so3").frame
    weights = [sp.sqrt(sp.Rational(str(x))) for x in MOMENTS]
    rows = [[weights[i] * so3.coframe[i, mu] for mu in range(3)] for i in range(3)]
    return Frame(so3.coordinates, rows)


def cases() -> list[Case]:
    """Five problems of the table in the issue that have no forces."""
    so3 = load("so3").frame
    top = geodesic(so3, ANGLES, frame_velocity=SPIN, metric=MOMENTS)
    line = autoparallel(cartan(so3), ANGLES, frame_velocity=SPIN)
    rates = geodesic(so3, frame_velocity=SPIN, metric=MOMENTS)
    bent = levi_civita(kinetic_frame())
    return [
        Case("Euler rates", rates, 100.0, euler_rates),
        Case("attitude of the top", top, 100.0, attitude, bent),
        Case("the same in angles", top.with_charts("so3"), 100.0, angles, bent),
        Case("so3 autoparallel", line, 50.0, straight, levi_civita(so3)),
        Case(
            "Kerr orbit", kerr().with_charts("kerr"), 100.0, kerr_orbit, levi_civita(kerr().frame)
        ),
    ]


def best_time(function: Callable[[], Any], seconds: float = 0.15) -> float:
    """CPU seconds of the fastest of many calls."""
    best, began = float("inf"), time.perf_counter()
    while time.perf_counter() - began < seconds or best == float("inf"):
        start = time.process_time_ns()
        function()
        best = min(best, (time.process_time_ns() - start) * 1e-9)
    return best


def heyoka_by_hand(case: Case, accuracy: float) -> float | None:
    """CPU seconds of the loosest tolerance that reaches the accuracy, compiled and warm."""
    hy = import_module("heyoka")

    rates, start, values = case.by_hand(hy)
    grid = np.linspace(0, case.t, SAMPLES)
    truth = _truth(rates, start, values, grid)
    for power in range(4, 19):
        integrator = hy.taylor_adaptive(rates, start, pars=values, tol=10.0**-power)

        def run(integrator: Any = integrator) -> Any:
            integrator.time = 0.0
            integrator.state[:] = start
            return integrator.propagate_grid(grid)[5]

        if _error(run(), truth) <= accuracy:
            return best_time(run)
    return None


def _truth(rates: Any, start: Any, values: Any, grid: Any) -> Any:
    """The rival's own equations to 1e-18."""
    hy = import_module("heyoka")

    tight = hy.taylor_adaptive(
        rates,
        [np.longdouble(x) for x in start],
        pars=[np.longdouble(x) for x in values],
        fp_type=np.longdouble,
        tol=np.longdouble(1e-19),
        compact_mode=True,
    )
    return tight.propagate_grid(grid.astype(np.longdouble))[5]


def _error(states: Any, truth: Any) -> float:
    """Largest difference over the largest value."""
    return float(np.abs(states - truth).max() / np.abs(truth).max())


def scipy_on_christoffel(case: Case, accuracy: float, limit: float = 20.0) -> float | None:
    """CPU seconds of scipy's DOP853 on lambdified Christoffel symbols; None if out of reach."""
    if case.connection is None:
        return None
    frame = case.problem.frame
    n = frame.dimension
    q, v = list(frame.coordinates), list(sp.symbols(f"v0:{n}"))
    gamma = case.connection.coefficients.nonzero()
    right = [sp.S.Zero] * n
    for (a, b, c), value in gamma.items():
        right[c] -= value * v[a] * v[b]
    numbers = {s: float(case.problem.parameters[s.name]) for s in frame.parameters}
    # The rival takes what sympy.lambdify makes of it, common subexpressions shared.
    function = sp.lambdify([*q, *v], [x.subs(numbers) for x in right], "numpy", cse=True)
    start = np.concatenate(
        ([float(x) for x in case.problem.start or ()], np.asarray(case.problem.velocity))
    )
    grid = np.linspace(0, case.t, SAMPLES)
    journey = travel(case.problem, Taylor(64), 1e-18, grid * case.problem.speed)
    truth = np.concatenate([s.states for s in journey.segments])[:, :n].astype(float)
    if journey.segments[0].chart != case.problem.atlas.home:
        from geomtorsion.motion import solve

        truth = solve(case.problem.with_charts(case.problem.atlas.home), grid, 1e-12).coordinates

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
            return best_time(run, 0.3)
        if time.perf_counter() - began > limit:
            return None
    return None


def true_error(case: Case, solution: Any) -> float:
    """Error of one of our solutions against closed form or quadruple precision."""
    return truth_of(case.problem, case.t).error(solution)
