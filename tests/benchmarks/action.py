"""Action: cases whose equations of motion are timed, each with a fresh frame in each run.

python -m tests.benchmarks.action prints the time of the first derivation in a process.
"""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import sympy as sp

import geomtorsion as gt

U = sp.symbols("u1:7")
MOMENTS = sp.symbols("I1 I2 I3", positive=True)
MASS, GRAVITY, STIFFNESS = sp.symbols("m g k", positive=True)
SPIN = sp.Add(*(i * u**2 for i, u in zip(MOMENTS, U[:3], strict=True))) / 2
FLIGHT = SPIN + MASS * (U[3] ** 2 + U[4] ** 2 + U[5] ** 2) / 2

Case = tuple[gt.Frame, sp.Expr, tuple[sp.Expr, ...]]


def fresh(name: str) -> gt.Frame:
    """A shipped frame that has computed nothing yet."""
    known = gt.spaces.load(name).frame
    return gt.Frame(known.coordinates, known.coframe.to_sympy(), domain=known.domain)


def so3() -> Case:
    """Euler's equations."""
    return fresh("so3"), SPIN, ()


def r3xso3() -> Case:
    """The free body that rotates and moves."""
    return fresh("r3xso3"), FLIGHT, ()


def potential() -> Case:
    """Six dimensions with gravity, a spring to a point of the body and a coupling of angles."""
    frame = fresh("r3xso3")
    phi, place = frame.coordinates[:3], frame.coordinates[3:]
    spring = STIFFNESS * sum(x**2 for x in place) / 2
    tilt = STIFFNESS * place[0] * sp.sin(phi[1]) * sp.cos(phi[2])
    return frame, FLIGHT - MASS * GRAVITY * place[2] - spring - tilt, ()


def offset() -> Case:
    """A body with a full inertia tensor about a point that is not its centre: M is 6 x 6."""
    tensor = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"J{min(i, j)}{max(i, j)}"))
    centre, turn, speed = (sp.Matrix(row) for row in (sp.symbols("c1:4"), U[:3], U[3:]))
    moved = speed + turn.cross(centre)
    energy = (turn.T * tensor * turn)[0] / 2 + MASS * moved.dot(moved) / 2
    frame = fresh("r3xso3")
    return frame, energy - MASS * GRAVITY * frame.coordinates[5], ()


def disc() -> Case:
    """A disc that rolls: three constraints in six dimensions."""
    frame = fresh("r3xso3")
    phi1, phi2 = frame.coordinates[:2]
    radius = sp.Symbol("R", positive=True)
    # Vector from the centre to the lowest point of the rim, in the axes of the body.
    contact = radius * sp.Matrix([sp.cos(phi1), -sp.sin(phi1), 0])
    rolling = sp.Matrix(U[3:]) + sp.Matrix(U[:3]).cross(contact)
    energy = FLIGHT.subs(MOMENTS[1], MOMENTS[0]) - MASS * GRAVITY * radius * sp.sin(phi2)
    return frame, energy, tuple(rolling)


CASES: dict[str, Callable[[], Case]] = {
    case.__name__: case for case in (so3, r3xso3, potential, offset, disc)
}


def derived(case: Case) -> Any:
    """Boltzmann and Hamel: momenta, residuals and accelerations, as exact elements."""
    frame, lagrangian, constraints = case
    return gt.equations_of_motion(frame, lagrangian, constraints=constraints or None)


def whole(case: Case) -> Any:
    """The equations in sympy, proved against Euler and Lagrange, with conserved quantities."""
    found = derived(case)
    _ = found.rates
    assert found.agrees is True
    assert "energy" in found.invariants
    return found


def main() -> None:
    """Print the milliseconds of the first derivation in a fresh process, for each case."""
    if len(sys.argv) > 1:
        case = CASES[sys.argv[1]]()
        start = time.perf_counter()
        derived(case)
        print(1e3 * (time.perf_counter() - start))
        return
    for name in CASES:
        command = [sys.executable, "-m", "tests.benchmarks.action", name]
        runs = [subprocess.run(command, check=True, capture_output=True) for _ in range(3)]
        print(f"{name:10} {min(float(run.stdout) for run in runs):7.1f} ms")


if __name__ == "__main__":
    main()
