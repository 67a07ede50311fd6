"""Claims: claimed and true errors of random and shipped motions, and their price in plain runs.

Run with `python -m tests.benchmarks.claims --number 400`. The truth is a run in 160 bits. Each
line: a family, claims below the truth (of states; of anything that a reader can ask for), the
median of true / claimed, the median and the largest price (operations of all runs relative to
the answer), and the CPU time of repeated solves.
"""

from __future__ import annotations

import argparse
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from importlib import import_module
from typing import Any
from unittest import mock

import numpy as np

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError
from geomtorsion.ode import ODE, Solution, Taylor, Trajectory, integrate
from geomtorsion.ode.error_estimate import difference
from tests.benchmarks.solves import CASES

BITS = 160
TRUTH = 1e-36
ACCURACIES = (1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-12)
# Doubles that are compared may differ by their own roundings.
LEAST = 4e-16
WHOLE = ("states", "coordinates", "velocity", "frame_velocity", "transported")
Random = np.random.Generator


def top(random: Random) -> tuple[Any, float]:
    """Attitude of a free top."""
    frame = gt.spaces.load("so3").frame
    start, spin = random.uniform(0.3, 2.5, 3), random.normal(size=3)
    metric = tuple(random.uniform(1, 3, 3).tolist())
    return gt.geodesic(frame, start, frame_velocity=spin, metric=metric), random.uniform(1, 100)


def top_in_angles(random: Random) -> tuple[Any, float]:
    """The same, in Euler angles only."""
    problem, t = top(random)
    return problem.with_charts("so3"), min(t, 20.0)


def near_gimbal_lock(random: Random) -> tuple[Any, float]:
    """A straight line in Euler angles that passes close to gimbal lock."""
    frame = gt.spaces.load("so3").frame
    start = [random.uniform(0, 6), random.uniform(0.005, 0.03), random.uniform(0, 6)]
    line = gt.autoparallel(gt.cartan(frame), start, frame_velocity=random.normal(size=3))
    return line.with_charts("so3"), random.uniform(0.5, 10)


def heavy_top(random: Random) -> tuple[Any, float]:
    """Any heavy top: it may be chaotic."""
    a, b, c = random.uniform(1, 3, 3)
    axis = random.normal(size=3)
    rates = {
        "x": f"({b - c}*y*z + n2)/{a}", "y": f"({c - a}*z*x - n1)/{b}", "z": f"({a - b}*x*y)/{c}",
        "n1": "n2*z - n3*y", "n2": "n3*x - n1*z", "n3": "n1*y - n2*x",
    }  # fmt: skip
    start = [*random.normal(size=3), *axis / np.linalg.norm(axis)]
    return ODE.of(rates, start), random.uniform(1, 40)


FORCE = {"u": "-x/(x*x + y*y)**(3/2)", "v": "-y/(x*x + y*y)**(3/2)"}


def orbit(e: float, end: float) -> tuple[Any, float]:
    """A Kepler orbit with a major half axis of about one."""
    start = {"x": 1 - e, "y": 0, "u": 0, "v": float(np.sqrt((1 + e) / (1 - e)))}
    return ODE.of({"x": "u", "y": "v", **FORCE}, start), end


def kepler(random: Random) -> tuple[Any, float]:
    """Orbits of all eccentricities, some over hundreds of turns."""
    return orbit(random.uniform(0.05, 0.9), float(10 ** random.uniform(0.5, 3.3)))


def henon(random: Random) -> tuple[Any, float]:
    """Henon and Heiles, regular and chaotic."""
    rates = {"x": "u", "y": "v", "u": "-x - 2*x*y", "v": "-y - x*x + y*y"}
    return ODE.of(rates, random.uniform(-0.3, 0.3, 4)), random.uniform(5, 200)


def lorenz(random: Random) -> tuple[Any, float]:
    """Lorenz's equations."""
    rates = {"x": "10*(y - x)", "y": "x*(28 - z) - y", "z": "x*y - 8*z/3"}
    return ODE.of(rates, random.uniform([-10, -10, 15], [10, 10, 35])), random.uniform(0.5, 12)


def pendulum(random: Random) -> tuple[Any, float]:
    """A pendulum."""
    return ODE.of({"x": "v", "v": "-sin(x)"}, random.normal(size=2)), random.uniform(1, 300)


def double_well(random: Random) -> tuple[Any, float]:
    """A damped forced double well."""
    rates = {"x": "v", "v": "x - x**3 - v/5 + 3*cos(t)/10"}
    return ODE.of(rates, random.uniform(-1, 1, 2)), random.uniform(2, 80)


def schwarzschild(random: Random) -> tuple[Any, float]:
    """Bound and unbound geodesics around a mass."""
    frame = gt.spaces.load("schwarzschild").frame
    u = np.array([1.3, 0.05, 0.25, 0.35]) + 0.05 * random.normal(size=4)
    start = [0, random.uniform(8, 12), random.uniform(0.8, 2), 0]
    problem = gt.geodesic(frame, start, frame_velocity=u, parameters={"M": 1}, causal=None)
    return problem, random.uniform(10, 300)


def kerr(random: Random) -> tuple[Any, float]:
    """Bound orbits around a turning mass."""
    u = np.array([1.2, 0.05, 0.2, 0.36]) * (1 + 0.03 * random.normal(size=4))
    problem = gt.geodesic(
        gt.spaces.load("kerr").frame, [0, 8.0, 1.4, 0], frame_velocity=u,
        parameters={"M": 1, "a": 0.6}, causal=None,
    )  # fmt: skip
    return problem.with_charts("kerr"), random.uniform(100, 1500)


FAMILIES: dict[str, Callable[[Random], tuple[Any, float]]] = {
    "top": top, "top in angles": top_in_angles, "gimbal lock": near_gimbal_lock,
    "heavy top": heavy_top, "Kepler": kepler, "Henon": henon, "Lorenz": lorenz,
    "pendulum": pendulum, "double well": double_well, "Schwarzschild": schwarzschild,
    "Kerr": kerr,
}  # fmt: skip


def near(random: Random) -> float:
    """A small distance from an unstable rest."""
    return float(10 ** random.uniform(-7, -1.5))


def saddle_top(random: Random) -> tuple[Any, float]:
    """A free top that begins near its middle axis."""
    rates = {"x": "-y*z", "y": "x*z", "z": "-x*y/3"}
    return ODE.of(rates, [near(random), 1, 0]), random.uniform(20, 90)


def saddle_top_in_angles(random: Random) -> tuple[Any, float]:
    """The same with its attitude."""
    frame = gt.spaces.load("so3").frame
    start, spin = random.uniform(0.5, 2.5, 3), [near(random), 1, near(random)]
    problem = gt.geodesic(frame, start, frame_velocity=spin, metric=(1, 2, 3))
    return problem, random.uniform(15, 70)


def separatrix(random: Random) -> tuple[Any, float]:
    """A pendulum that almost rests upside down."""
    return ODE.of({"x": "v", "v": "-sin(x)"}, [np.pi - near(random), 0]), random.uniform(15, 60)


def duffing(random: Random) -> tuple[Any, float]:
    """A double well from near its middle."""
    return ODE.of({"x": "v", "v": "x - x**3"}, [near(random), -near(random)]), random.uniform(
        15, 60
    )


def long_lorenz(random: Random) -> tuple[Any, float]:
    """Lorenz's equations for a longer time."""
    problem, _ = lorenz(random)
    return problem, random.uniform(5, 18)


def sleeping_top(random: Random) -> tuple[Any, float]:
    """A heavy symmetric top that turns too slowly to stay upright."""
    spin = random.uniform(0.5, 1.8)
    rates = {
        "x": f"-{spin}*y + n2", "y": f"{spin}*x - n1", "n1": f"n2*{spin} - n3*y",
        "n2": f"n3*x - n1*{spin}", "n3": "n1*y - n2*x",
    }  # fmt: skip
    tilt = near(random)
    return ODE.of(rates, [0, 0, np.sin(tilt), 0, np.cos(tilt)]), random.uniform(10, 40)


SADDLES: dict[str, Callable[[Random], tuple[Any, float]]] = {
    "saddle top": saddle_top, "saddle attitude": saddle_top_in_angles, "separatrix": separatrix,
    "Duffing": duffing, "long Lorenz": long_lorenz, "sleeping top": sleeping_top,
}  # fmt: skip


def hard() -> Iterator[tuple[str, Any, float, float]]:
    """Motions whose claims were below the truth at some time."""
    rates = {"x": "v", "v": "x - x**3 - v/5 + 3*cos(t)/10"}
    yield "double well", ODE.of(rates, [0.5, 0]), 60.0, 1e-9
    for end in (1700.0, 2000.0):
        yield f"Kepler to {end:g}", *orbit(0.8, end), 1e-8


@dataclass(frozen=True)
class Claim:
    """One motion: true errors over claimed ones, price in runs, CPU seconds of a solve."""

    name: str
    state: float
    anything: float
    named: float
    runs: float
    seconds: float
    text: str


def claim(name: str, problem: Any, end: float, accuracy: float) -> Claim | None:
    """Solve, measure, compare with the truth; None where the solver refuses."""
    try:
        solution: Solution = gt.solve(problem, end, accuracy)
    except GeomtorsionError:
        return None
    seconds: list[float] = []
    while len(seconds) < 3 or (sum(seconds) < 0.02 and len(seconds) < 10):
        began = time.process_time()
        gt.solve(problem, end, accuracy)
        seconds.append(time.process_time() - began)
    price = price_of(problem, end, accuracy, solution)
    grid = solution.times * problem.time_unit
    truth = integrate(problem.first_stage(BITS, 0.0), grid, TRUTH, Taylor(BITS))
    exact = replace(solution, trajectory=truth, comparisons=())
    state = difference(problem, solution.trajectory, truth) / solution.error
    anything, named, worst = 0.0, 0.0, ""
    for word in solution.moment.values:
        here, there = (np.asarray(x[word], dtype=float) for x in (solution, exact))
        together = problem.together(word) or (word,)
        size = max(float(np.abs(exact[x].astype(float)).max(initial=0.0)) for x in together)
        gap = float(np.abs(here - there).max(initial=0.0)) - LEAST * size
        if gap <= 0 or not size:
            continue
        if gap / size / solution.error_of(word) > named:
            named, worst = gap / size / solution.error_of(word), word
        if word in WHOLE:
            anything = max(anything, gap / size / solution.error)
    text = f"{problem} to {end:.4g} at {accuracy:.0e} by {solution.engine}: error "
    text += f"{solution.error:.2g}; true / claimed {state:.2g} of states, {anything:.2g} of all, "
    text += f"{named:.2g} of {worst}; {price:.1f} runs, {min(seconds):.2g} s"
    return Claim(name, state, anything, named, price, min(seconds), text)


# Cost of an operation in numbers of so many bits, relative to doubles.
SLOWER = {53: 1, 64: 10, 113: 80, 300: 200}


def price_of(problem: Any, end: float, accuracy: float, solution: Solution) -> float:
    """Operations of all runs relative to the operations of the answer."""

    def work(one: Trajectory) -> float:
        # A step of order n takes about n^2 operations.
        return one.evaluations**2 / max(one.steps, 1) * SLOWER[one.engine.precision]

    runs: list[Trajectory] = []

    def counted(*given: Any, **more: Any) -> Trajectory:
        runs.append(integrate(*given, **more))
        return runs[-1]

    with mock.patch.object(import_module("geomtorsion.ode.solve"), "integrate", counted):
        gt.solve(problem, end, accuracy)
    return sum(map(work, runs)) / work(solution.trajectory)


def motions(
    families: dict[str, Callable[[Random], tuple[Any, float]]], number: int, seed: int
) -> Iterator[tuple[str, Any, float, float]]:
    """Random motions, family after family."""
    for place, (name, family) in enumerate(families.items()):
        random = np.random.default_rng((seed, place))
        for _ in range(-(-number // len(families))):
            problem, end = family(random)
            accuracy = float(random.choice(ACCURACIES))
            if families is SADDLES:
                # Ladders begin at powers of ten: other numbers try all rungs.
                accuracy = float(10 ** random.uniform(-12, -4))
            yield name, problem, end, accuracy


def shipped() -> Iterator[tuple[str, Any, float, float]]:
    """The motions of `solves` and all shipped scenes, at each accuracy."""
    for name, case in CASES.items():
        problem = case.make()
        for accuracy in (1e-6, 1e-9, 1e-12):
            if not isinstance(problem, gt.Scene):
                yield name, problem, case.t, accuracy
    for name in gt.scenes.names():
        scene = gt.scenes.load(name)
        problem = scene.run().solution.problem
        for accuracy in (1e-6, 1e-9, 1e-12):
            yield f"scene {name}", problem, float(scene.times[-1]), accuracy


def table(claims: list[Claim]) -> str:
    """One line for each family, and one for all."""
    lines = []
    names = [*dict.fromkeys(x.name for x in claims), "all"]
    for name in names:
        some = [x for x in claims if name in (x.name, "all")]
        below = [sum(ratio > 1 for ratio in column) for column in (
            [x.state for x in some], [x.anything for x in some], [x.named for x in some]
        )]  # fmt: skip
        runs = np.array([x.runs for x in some])
        lines.append(
            f"{name:<24}{len(some):>4} motions, below truth {below[0]:>3} states {below[1]:>3} all "
            f"{below[2]:>3} by name; true/claimed {np.median([x.anything for x in some]):.2f}; "
            f"runs {np.median(runs):.1f}, 95 % {np.quantile(runs, 0.95):.1f}, {runs.max():.1f}; "
            f"{1e3 * np.median([x.seconds for x in some]):.2f} ms median, "
            f"{sum(x.seconds for x in some):.3f} s"
        )
    return "\n".join(lines)


def main() -> None:
    """Print each claim below the truth, and the table."""
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    parser.add_argument("--number", type=int, default=400)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--shipped", action="store_true", help="only the shipped motions")
    parser.add_argument("--saddles", action="store_true", help="motions near unstable rests")
    parser.add_argument("--all", action="store_true", help="print every motion")
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    chosen = [*shipped()] if asked.shipped else [*motions(SADDLES, asked.number, asked.seed)]
    if not (asked.shipped or asked.saddles):
        chosen = [*hard(), *motions(FAMILIES, asked.number, asked.seed)]
    claims: list[Claim] = []
    for motion in chosen:
        one = claim(*motion)
        if one is None:
            print("refused:", motion[0], *motion[2:])
            continue
        claims.append(one)
        if asked.all or max(one.state, one.anything, one.named) > 1:
            print(one.text, flush=True)
    print(table(claims))


if __name__ == "__main__":
    main()
