"""Campaign: random motions of eight families, solved, proved, and their errors judged.

python -m tests.proofs.campaign --motions 100 --seed 1
"""

# pyright: reportArgumentType=false

from __future__ import annotations

import argparse
import random
from collections.abc import Callable
from dataclasses import dataclass

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError, ProofError

ACCURACIES = (1e-6, 1e-10, 1e-13)
SO3 = gt.spaces.load("so3").frame
Motion = tuple[object, float]


def pendulum(draw: random.Random) -> Motion:
    """A pendulum near the separatrix, on both sides."""
    near = draw.choice([1e-3, 1e-6, 1e-9, 1e-12]) * draw.uniform(0.5, 2)
    speed = 2 + draw.choice([-1, 1]) * near
    return gt.ODE.of({"x": "v", "v": "-sin(x)"}, [0, speed]), draw.uniform(5, 60)


def lorenz(draw: random.Random) -> Motion:
    """A chaotic motion of Lorenz's equations."""
    start = [draw.uniform(-10, 10), draw.uniform(-10, 10), draw.uniform(5, 40)]
    rates = {"x": "10*(y-x)", "y": "x*(28-z)-y", "z": "x*y-8*z/3"}
    return gt.ODE.of(rates, start), draw.uniform(1, 18)


def henon_heiles(draw: random.Random) -> Motion:
    """Two coupled oscillators."""
    rates = {"x": "px", "y": "py", "px": "-x-2*x*y", "py": "-y-x**2+y**2"}
    start = [draw.uniform(-0.3, 0.3) for _ in range(3)]
    return gt.ODE.of(rates, [*start, draw.uniform(-0.2, 0.2)]), draw.uniform(5, 60)


def top(draw: random.Random) -> Motion:
    """A free top, through the charts of the rotations."""
    start = [draw.uniform(0, 6), draw.uniform(0.3, 2.8), draw.uniform(0, 6)]
    speed = [draw.uniform(-1, 1) for _ in range(3)]
    return gt.geodesic(SO3, start, frame_velocity=speed, metric=[1, 2, 3]), draw.uniform(5, 60)


def wall(draw: random.Random) -> Motion:
    """A rate that changes within a short time."""
    steep = draw.choice([1, 2, 5, 10, 20])
    problem = gt.ODE.of({"x": "2+tanh(k*x)"}, [draw.uniform(-60, -20)], parameters={"k": steep})
    return problem, draw.uniform(20, 80)


def duffing(draw: random.Random) -> Motion:
    """A driven oscillator: its rates contain the time."""
    rates = {"x": "v", "v": "x-x**3-v/10+0.35*cos(1.2*t)"}
    return gt.ODE.of(rates, [draw.uniform(-1, 1), draw.uniform(-1, 1)]), draw.uniform(5, 40)


def kepler(draw: random.Random) -> Motion:
    """Orbits from nearly circular to almost straight."""
    e = draw.choice([0.3, 0.6, 0.9])
    rates = {"x": "u", "y": "v", "u": "-x/(x**2+y**2)**(3/2)", "v": "-y/(x**2+y**2)**(3/2)"}
    return gt.ODE.of(rates, [1 - e, 0, 0, ((1 + e) / (1 - e)) ** 0.5]), draw.uniform(5, 30)


def van_der_pol(draw: random.Random) -> Motion:
    """A limit cycle with jumps."""
    start = [draw.uniform(-2, 2), draw.uniform(-2, 2)]
    rates = {"x": "v", "v": "m*(1-x**2)*v-x"}
    problem = gt.ODE.of(rates, start, parameters={"m": draw.choice([1, 3, 8])})
    return problem, draw.uniform(5, 30)


FAMILIES: tuple[Callable[[random.Random], Motion], ...] = (
    pendulum, lorenz, henon_heiles, top, wall, duffing, kepler, van_der_pol,
)  # fmt: skip


@dataclass(frozen=True)
class Finding:
    """One motion.

    family, time, accuracy: the solved motion; words: the reason without a proof, or nothing.
    claimed, proved: the reported error, and the proved bound.
    """

    family: str
    time: float
    accuracy: float
    words: str = ""
    claimed: float = 0.0
    proved: float = 0.0
    holds: bool | None = None

    def __str__(self) -> str:
        head = f"{self.family:14}t = {self.time:5.2f} at {self.accuracy:.0e}: "
        if self.words:
            return head + self.words
        verdict = {True: "holds", False: "DOES NOT HOLD", None: "undecided"}[self.holds]
        return head + f"claimed {self.claimed:.2e}, proved {self.proved:.2e}, {verdict}"


def campaign(motions: int, seed: int) -> list[Finding]:
    """Findings of this number of motions, family after family."""
    draw, found = random.Random(seed), []
    for k in range(motions):
        family = FAMILIES[k % len(FAMILIES)]
        problem, time = family(draw)
        accuracy = draw.choice(ACCURACIES)
        time = round(time, 2)
        name = family.__name__
        try:
            solution = gt.solve(problem, time, accuracy)
        except GeomtorsionError as error:
            found.append(Finding(name, time, accuracy, f"not solved: {error}"))
            continue
        try:
            proof = gt.prove(solution)
        except ProofError as error:
            found.append(Finding(name, time, accuracy, f"not proved: {error}"))
            continue
        found.append(Finding(name, time, accuracy, "", solution.error, proof.error, proof.holds))
    return found


def main() -> None:
    """Run a campaign and list the errors that do not hold."""
    parser = argparse.ArgumentParser(description="Random motions, proved.")
    parser.add_argument("--motions", type=int, default=80)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    found = campaign(options.motions, options.seed)
    for finding in found:
        print(finding)
    broken = [x for x in found if x.holds is False]
    print(f"{len(found)} motions, {sum(bool(x.words) for x in found)} without a proof, "
          f"{len(broken)} errors that do not hold")  # fmt: skip


if __name__ == "__main__":
    main()
