"""Proofs: the table of proofs on the page of theorems.

    python -m tests.benchmarks.proofs

Prints the table as Markdown: problem, digits, and the processor time of a run in a warm process.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.ode import Solution

SWING = gt.ODE.of({"x": "v", "v": "-sin(x)"}, [1, 0], invariants={"E": "v**2/2-cos(x)"})
LORENZ = gt.ODE.of({"x": "10*(y-x)", "y": "x*(28-z)-y", "z": "x*y-8*z/3"}, [-13.7, -19.5, 27])
ROESSLER = gt.ODE.of({"x": "-y-z", "y": "x+y/5", "z": "1/5+z*(x-57/10)"}, [0, -6.233, 0.03064])
CYCLE = gt.ODE.of({"x": "v", "v": "(1-x**2)*v-x"}, [2, 0])


def star() -> Solution:
    """A polytrope p = 100 q^2 in general relativity, to its surface."""
    t, r, theta, phi = sp.symbols("t r theta phi")
    a, b = (sp.Function(name)(r) for name in "AB")
    static = gt.Frame([t, r, theta, phi], sp.diag(a, b, r, r * sp.sin(theta)), (-1, 1, 1, 1))
    fluid = gravity.fluid("q(r) + K*q(r)**2", "K*q(r)**2", [1, 0, 0, 0])
    equations = gravity.equations(gt.levi_civita(static), "R/(16*pi)", fluid)
    return gravity.solve(
        equations, "r", 100, {"A": 1, "q": "0.00128"}, {"K": 100}, near={"B": 1},
        outputs={"m": "r*(1-1/B**2)/2"}, events=[gt.When("q")],
    )  # fmt: skip


def rows() -> list[tuple[str, int, Callable[[int], object]]]:
    """Problem, digits, and the proof with these digits."""
    swing, chaos, sphere = gt.solve(SWING, [10.0]), gt.solve(LORENZ, [10.0]), star()
    top = gt.solve(
        gt.geodesic("so3", [0.3, 1, 0.2], frame_velocity=[1, 2, 3], metric=[1, 2, 3]), [10.0]
    )
    small = gt.burgers_vector(gt.spaces.load("so3").frame, gt.Loop.circle([0.3, 1, 0.2], 1e-12))
    axis = np.linspace(-1, 1, 33)
    x, y = np.meshgrid(axis, axis, indexing="ij")
    grid = SampledFrame([axis, axis], np.array([[-y * x**2, x + y**3]]))
    measured = grid.burgers(gt.Loop.circle([0, 0], 0.5))
    energy = {"section": "v", "conserved": ["E"]}
    return [
        ("Burgers vector of a circle of 1e-12, SO(3)", 15, lambda n: gt.prove(small, n)),
        ("Burgers vector of a grid of 33 x 33 nodes", 15, lambda n: gt.prove(measured, n)),
        ("pendulum, t = 10", 15, lambda n: gt.prove(swing, n)),
        ("pendulum, t = 10", 100, lambda n: gt.prove(swing, n)),
        ("pendulum, t = 10, derivatives by the start", 30,
         lambda n: gt.prove(swing, n, derivatives=["x", "v"])),
        ("free top through charts, t = 10", 15, lambda n: gt.prove(top, n)),
        ("Lorenz, t = 10", 15, lambda n: gt.prove(chaos, n)),
        ("mass and radius of a polytrope", 15, lambda n: gt.prove(sphere, n)),
        ("first return of the pendulum", 15, lambda n: gt.poincare(SWING, "-v", 5, digits=n)),
        ("closed orbit: pendulum", 15, lambda n: gt.closed_orbit(SWING, 6.5, digits=n, **energy)),
        ("closed orbit: pendulum", 100, lambda n: gt.closed_orbit(SWING, 6.5, digits=n, **energy)),
        ("closed orbit: van der Pol", 15,
         lambda n: gt.closed_orbit(CYCLE, 6.5, section="v", digits=n)),
        ("closed orbit: Lorenz", 15,
         lambda n: gt.closed_orbit(LORENZ, 1.56, section="z-27", digits=n)),
        ("closed orbit: Roessler, period 3", 15,
         lambda n: gt.closed_orbit(ROESSLER, 17.5, section="x", digits=n)),
    ]  # fmt: skip


def main() -> None:
    """Print the table."""
    print("| problem | digits | seconds |\n|---|---|---|")
    for text, digits, proof in rows():
        proof(digits)
        start = time.process_time()
        proof(digits)
        print(f"| {text} | {digits} | {time.process_time() - start:.2g} |", flush=True)


if __name__ == "__main__":
    main()
