"""Motions: problems to race, each with a hand-written heyoka integrator."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
import sympy as sp
from scipy.spatial.transform import Rotation

from geomtorsion.curves import CurveProblem, autoparallel, geodesic
from geomtorsion.geometry import Frame, cartan, levi_civita
from geomtorsion.ode import ODE
from geomtorsion.prices import truth_of
from geomtorsion.spaces import load

MOMENTS = (1.1, 2.2, 3.3)
SPIN = (0.9, 0.4, 0.7)
ANGLES = (0.3, 1.0, 0.2)
SAMPLES = 65
# The heavy top: two equal moments (Lagrange's; the others are chaotic, and no solution keeps twelve
# digits to t = 100), mass times gravity times lever arm, and the vertical at the start.
LAGRANGE = (2.2, 2.2, 1.1)
WEIGHT = 1.5
UPRIGHT = (0.6, 0.0, 0.8)


@dataclass(frozen=True)
class Case:
    """A problem, its final time, a rival's equations and its connection for second-order equations.

    blocks: states of the rival whose error is measured together, as in our solutions.
    """

    name: str
    problem: CurveProblem | ODE
    t: float
    by_hand: Callable[[Any], tuple[list[Any], list[float], list[float]]]
    connection: Any = None
    blocks: tuple[slice, ...] = (slice(None),)


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
    """The attitude in Euler angles, with Euler's rates."""
    f1, f2, f3, x, y, z = hy.make_vars("f1", "f2", "f3", "x", "y", "z")
    rates, spin, values = euler_rates(hy)
    return [*_angle_rates(hy, f1, f2, x, y, z, f3), *rates], [*ANGLES, *spin], values


def straight(hy: Any) -> tuple[list[Any], list[float], list[float]]:
    """The autoparallel: Euler angles with constant body rates."""
    f1, f2, f3 = hy.make_vars("f1", "f2", "f3")
    p = hy.par
    return _angle_rates(hy, f1, f2, p[0], p[1], p[2], f3), list(ANGLES), list(SPIN)


def kerr_orbit(hy: Any) -> tuple[list[Any], list[float], list[float]]:
    """Carter's equations, differentiated once: no root, no sine, all constants precomputed.

    With S = r^2 + a^2 z^2, z = cos theta: S r' = x, S z' = -y, x' = R'(r) / 2S, y' = -Z'(z) / 2S,
    where x^2 = R(r) and y^2 = Z(z) are Carter's polynomials of degree four. Two other forms
    were tried (Hamilton's equations in r and theta, and with R(r)); this is faster by a half.
    """
    problem = kerr()
    start, values = carter(problem, problem.frame_velocity)
    t, r, z, phi, x, y = hy.make_vars("t", "r", "z", "phi", "x", "y")
    p = hy.par
    rr, zz = r * r, z * z
    w = (p[6] * rr + p[7]) / (rr - p[8] * r + p[9])
    inverse = (rr + p[9] * zz) ** -1.0
    rates = [
        (t, ((rr + p[9]) * w + p[11] + p[12] * zz) * inverse),
        (r, x * inverse),
        (z, -y * inverse),
        (phi, (p[10] / (1.0 - zz) - p[13] + p[14] * w) * inverse),
        (x, (p[0] + r * (p[1] + r * (p[2] + r * p[3]))) * inverse),
        (y, z * (p[4] - p[5] * zz) * inverse),
    ]
    return rates, start, values


def carter(problem: CurveProblem, velocity: Any) -> tuple[list[float], list[float]]:
    """Start and constants of Carter's equations, from frame velocities at the problem's start."""
    assert problem.start is not None
    t0, r0, theta, phi0 = (float(q) for q in problem.start)
    u = [float(x) for x in velocity]
    mass, a = (float(problem.parameters[name]) for name in ("M", "a"))
    c, s = np.cos(theta), np.sin(theta)
    rho, delta = np.sqrt(r0**2 + (a * c) ** 2), r0**2 - 2 * mass * r0 + a**2
    energy = (np.sqrt(delta) * u[0] + a * s * u[3]) / rho
    turn = (a * np.sqrt(delta) * s**2 * u[0] + (r0**2 + a**2) * s * u[3]) / rho
    size = u[0] ** 2 - u[1] ** 2 - u[2] ** 2 - u[3] ** 2
    separated = size * (a * c) ** 2 + (rho * u[2]) ** 2 + (turn / s - a * energy * s) ** 2
    lever, bend = a * (a * energy - turn), a**2 * (size - energy**2)
    values = [
        mass * separated,
        2 * energy * lever - separated - a**2 * size,
        3 * mass * size,
        2 * (energy**2 - size),
        separated - (turn - a * energy) ** 2 + bend + turn**2,
        2 * bend,
        energy, lever, 2 * mass, a**2, turn, -lever, a**2 * energy, a * energy, a,
    ]  # fmt: skip
    start = [t0, r0, c, phi0, rho * np.sqrt(delta) * u[1], rho * s * u[2]]
    return [float(q) for q in start], [float(q) for q in values]


def heavy_top(hy: Any) -> tuple[list[Any], list[float], list[float]]:
    """Body rates and the vertical in the body frame; the weight is on the third axis."""
    x, y, z, n1, n2, n3 = hy.make_vars("x", "y", "z", "n1", "n2", "n3")
    p = hy.par
    a, _, c = LAGRANGE
    rates = [
        (x, p[0] * y * z + p[1] * n2),
        (y, -p[0] * z * x - p[1] * n1),
        (z, 0.0 * z),
        (n1, n2 * z - n3 * y),
        (n2, n3 * x - n1 * z),
        (n3, n1 * y - n2 * x),
    ]
    return rates, [*SPIN, *UPRIGHT], [(a - c) / a, WEIGHT / a]


def heavy_ode() -> ODE:
    """The same equations for our solver: I u' = I u x u + w n x e3 with Ix = Iy, n' = n x u."""
    names = ("x", "y", "z", "n1", "n2", "n3")
    rates = {
        "x": "((A - C)*y*z + w*n2)/A",
        "y": "((C - A)*z*x - w*n1)/A",
        "z": "0",
        "n1": "n2*z - n3*y",
        "n2": "n3*x - n1*z",
        "n3": "n1*y - n2*x",
    }
    start: dict[str, float] = dict(zip(names, (*SPIN, *UPRIGHT), strict=True))
    across, _, along = LAGRANGE
    numbers = {"A": across, "C": along, "w": WEIGHT}
    return ODE.of(rates, start, parameters=numbers, name="heavy top")


def _angle_rates(hy: Any, f1: Any, f2: Any, x: Any, y: Any, z: Any, f3: Any) -> list[Any]:
    across = (hy.sin(f1) * y - hy.cos(f1) * x) / hy.sin(f2)
    return [
        (f1, z - across * hy.cos(f2)),
        (f2, hy.sin(f1) * x + hy.cos(f1) * y),
        (f3, across),
    ]


def _quaternion() -> list[float]:
    q = Rotation.from_euler("ZYZ", ANGLES[::-1]).as_quat()
    return [q[3], q[0], q[1], q[2]]


def kerr() -> CurveProblem:
    """A bound orbit off the equator, r from 7.5 to 10.8; about two hundred steps to t = 1500."""
    return geodesic(
        load("kerr").frame,
        [0, 8.0, 1.4, 0],
        frame_velocity=[1.2, 0.05, 0.2, 0.36],
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
    """The problems of the speed table; only the heavy top has a force."""
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
        Case("heavy top", heavy_ode(), 100.0, heavy_top),
        Case(
            "Kerr orbit",
            kerr().with_charts("kerr"),
            1500.0,
            kerr_orbit,
            levi_civita(kerr().frame),
            (slice(0, 4), slice(4, 6)),
        ),
    ]


def exact(rates: Any, start: Any, values: Any, grid: Any) -> Any:
    """Solution of a rival's equations to 1e-18."""
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


def true_error(case: Case, solution: Any) -> float:
    """Error of one of our solutions, from a closed form or extended precision."""
    grid = np.linspace(0, case.t, SAMPLES)
    if isinstance(case.problem, CurveProblem):
        return truth_of(case.problem, grid).error(solution)
    rates, start, values = case.by_hand(import_module("heyoka"))
    truth = exact(rates, start, values, grid)
    gap, worst = np.abs(solution.states - truth), 0.0
    for block in (slice(0, 3), slice(3, 6)):
        worst = max(worst, float(gap[:, block].max() / np.abs(truth[:, block]).max()))
    return worst
