"""Front: the rows of the speed table in the README.

    python -m tests.benchmarks.front

Prints the table as Markdown. A time is the best processor time of several runs in a warm process
(code of motions and loops compiled, frames of tensors fresh), or of several fresh processes with
their imports. Needs the extra `fast`.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable

import geomtorsion as gt
from tests.benchmarks.cases import load
from tests.benchmarks.cold import fresh
from tests.benchmarks.compare import seconds
from tests.benchmarks.geometry import whole_geometry
from tests.benchmarks.motions import kerr
from tests.benchmarks.test_crystal_speed import specimens

ROUNDS = 5
FIRST_ORBIT = """
import json, time
import geomtorsion as gt
orbit = gt.geodesic(
    gt.spaces.load("kerr").frame, [0, 8.0, 1.4, 0], frame_velocity=[1.2, 0.05, 0.2, 0.36],
    parameters={"M": 1, "a": 0.6}, causal=None,
)
assert gt.solve(orbit, 1500.0, 1e-9).error <= 1e-9
print(json.dumps([time.process_time()]))
"""


def best(call: Callable[[], object]) -> float:
    """Processor time of the fastest run, after one that compiles."""
    call()
    times: list[float] = []
    for _ in range(ROUNDS):
        start = time.process_time()
        call()
        times.append(time.process_time() - start)
    return min(times)


def rows() -> dict[str, Callable[[], object]]:
    """The measured call of each row, by its text in the table."""
    so3 = gt.spaces.load("so3").frame
    loop = gt.Loop.circle([0.3, 1.0, 0.2], 1e-3)
    straight = gt.autoparallel(gt.cartan(so3), [0.3, 1.0, 0.2], [0.9, 0.4, 0.7])
    orbit = kerr()
    atoms, cell = specimens()["lines"]
    case = load("kerr_carter")
    return {
        "Kerr: both connections, torsion, contortion, both curvatures, exact": lambda: (
            whole_geometry(case)
        ),
        "Autoparallel on SO(3) to t = 50, accuracy 1e-9": lambda: gt.solve(straight, 50.0, 1e-9),
        "Kerr orbit to t = 1500, accuracy 1e-9": lambda: gt.solve(orbit, 1500.0, 1e-9),
        "Burgers vector of a circle of radius 1e-3, accuracy 1e-12": lambda: gt.burgers_vector(
            so3, loop
        ),
        f"Dislocation lines of {len(atoms):,} atoms": lambda: gt.crystals.Crystal(
            atoms, cell, lattice="bcc"
        ).dislocations(),
    }


def first_orbit() -> float:
    """Processor time of a Kerr orbit in a fresh process, imports included."""
    with tempfile.TemporaryDirectory() as bytecode:
        return min(one for (one,) in fresh(FIRST_ORBIT, "", ROUNDS, bytecode))


def main() -> None:
    """Print the table."""
    print("| task | processor time |\n|---|---|")
    for words, call in rows().items():
        print(f"| {words} | {seconds(best(call))} |", flush=True)
        if words.startswith("Kerr orbit"):
            again = "The same in a fresh process, imports and compilation included"
            print(f"| {again} | {seconds(first_orbit())} |", flush=True)


if __name__ == "__main__":
    main()
