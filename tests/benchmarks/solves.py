"""Solves: twenty-eight motions, and a worker that solves them for `two_checkouts`.

It runs with the checkout of the package that is first on the path. Each name that differs between
checkouts is in the first part of this file only.
"""

from __future__ import annotations

import dataclasses
import gc
import json
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

if __name__ == "__main__" and "--without-heyoka" in sys.argv:
    sys.modules["heyoka"] = None  # type: ignore[assignment]

import numpy as np
import sympy as sp

import geomtorsion as gt

# -- names that differ between checkouts -------------------------------------------------------


NEW = "ODE" in gt.__all__


def ode(
    rates: Any, start: Any, parameters: Any = None, *, switches: Any = (), unit: Any = ()
) -> Any:
    """An initial value problem; switches are (time, new values), unit are groups of unit length."""
    package: Any = gt
    numbers = parameters or {}
    if NEW:
        events = [package.At(*switch) for switch in switches]
        return package.ODE.of(rates, start, parameters=numbers, events=events, normalized=unit)
    return package.flow(rates, start, parameters=numbers, switches=switches, unit=unit)


def gap(one: Any, two: Any) -> float:
    """Largest difference of two solutions, by the error measure of the checkout."""
    one, two = (getattr(solution, "solution", solution) for solution in (one, two))
    if NEW:
        compare = import_module("geomtorsion.ode.error_estimate").difference
        return compare(one.problem, one.trajectory, two.trajectory)
    if hasattr(one, "journey"):
        return import_module("geomtorsion.motion.compare").difference(one.journey, two.journey)[0]
    return import_module("geomtorsion.motion.flows.compare").difference(one.trip, two.trip)[0]


def forgetting() -> Callable[[], None]:
    """A function that deletes what earlier solutions have taught the systems, if they keep it."""
    kept = [thing for thing in gc.get_objects() if type(thing).__name__ == "System"]

    def forget() -> None:
        for thing in kept:
            thing.__dict__.pop("_learned", None)

    return forget


# -- problems ----------------------------------------------------------------------------------

MOMENTS, SPIN, ANGLES = (1.1, 2.2, 3.3), (0.9, 0.4, 0.7), (0.3, 1.0, 0.2)
HOLE = {"M": 1, "a": 0.6}
ORBIT = {"frame_velocity": [1.2, 0.05, 0.2, 0.36], "parameters": HOLE, "causal": None}


@dataclass(frozen=True)
class Case:
    """A problem, which `make` makes again for each use, and its final time."""

    make: Callable[[], Any]
    t: float

    def asked(self, accuracy: float) -> Any:
        """The problem; a scene contains its own accuracy."""
        problem = self.make()
        return (
            dataclasses.replace(problem, accuracy=accuracy)
            if type(problem).__name__ == "Scene"
            else problem
        )

    def solve(self, problem: Any, accuracy: float, engine: Any) -> Any:
        """A solution with its error estimate."""
        if type(problem).__name__ == "Scene":
            return problem.run(engine=engine)
        return gt.solve(problem, self.t, accuracy, engine)


def frame(name: str) -> gt.Frame:
    """Frame of a shipped space."""
    return gt.spaces.load(name).frame


def geodesic(name: str, start: Any, u: Any, **more: Any) -> Any:
    """Geodesic from frame velocities."""
    return gt.geodesic(frame(name), start, frame_velocity=u, **more)


def between(name: str, start: Any, u: Any, **more: Any) -> Any:
    """Autoparallel of the mean of the Levi-Civita and the Cartan connection."""
    given = frame(name)
    connection = gt.blend(gt.levi_civita(given), gt.cartan(given), sp.Rational(1, 2))
    return gt.autoparallel(connection, start, frame_velocity=u, **more)


def top() -> Any:
    """A free top with its attitude."""
    return geodesic("so3", ANGLES, SPIN, metric=MOMENTS)


def heavy_top() -> Any:
    """Lagrange's heavy top."""
    rates = {
        "x": "((A - C)*y*z + w*n2)/A", "y": "((C - A)*z*x - w*n1)/A", "z": "0",
        "n1": "n2*z - n3*y", "n2": "n3*x - n1*z", "n3": "n1*y - n2*x",
    }  # fmt: skip
    return ode(rates, [*SPIN, 0.6, 0.0, 0.8], {"A": 2.2, "C": 1.1, "w": 1.5})


def attitude() -> Any:
    """Euler's equations with a quaternion of length one."""
    rates = {
        "a": "(B - C)/A*b*c", "b": "(C - A)/B*c*a", "c": "(A - B)/C*a*b",
        "q0": "-(q1*a + q2*b + q3*c)/2", "q1": "(q0*a + q2*c - q3*b)/2",
        "q2": "(q0*b + q3*a - q1*c)/2", "q3": "(q0*c + q1*b - q2*a)/2",
    }  # fmt: skip
    numbers = dict(zip("ABC", MOMENTS, strict=True))
    return ode(rates, [*SPIN, 1, 0, 0, 0], numbers, unit=[("q0", "q1", "q2", "q3")])


def kepler(eccentricity: float) -> Any:
    """Kepler orbit from the pericentre."""
    e = eccentricity
    rates = {"x": "u", "y": "v", "u": "-x/(x^2+y^2)^(3/2)", "v": "-y/(x^2+y^2)^(3/2)"}
    return ode(rates, [1 - e, 0, 0, float(np.sqrt((1 + e) / (1 - e)))])


def scene(name: str, t: float, **more: Any) -> Any:
    """A shipped scene with another final time."""
    return dataclasses.replace(gt.scenes.load(name), t=t, samples=65, **more)


def one(rates: Any, start: Any, t: float, **more: Any) -> Case:
    """A case with equations given by text."""
    return Case(lambda: ode(rates, start, **more), t)


LORENZ = {"x": "10*(y - x)", "y": "x*(28 - z) - y", "z": "x*y - 8*z/3"}
PUSHES = [(1 / 3, {"a": 3}), (0.5, {"a": 0}), (2.0, {"a": -1}), (7.5, {"a": 0})]
SPHERE = {"parameters": {"R": 1.3}}

CASES: dict[str, Case] = {
    # Curves in spaces
    "Euler rates": Case(lambda: geodesic("so3", None, SPIN, metric=MOMENTS), 100.0),
    "attitude": Case(top, 100.0),
    "attitude in angles": Case(lambda: top().with_charts("so3"), 100.0),
    "so3 autoparallel": Case(
        lambda: gt.autoparallel(gt.cartan(frame("so3")), ANGLES, frame_velocity=SPIN), 50.0
    ),
    "so3 between": Case(lambda: between("so3", ANGLES, SPIN), 20.0),
    "s2 geodesic": Case(lambda: geodesic("s2", [1.0, 0.5], [0.7, 0.9], **SPHERE), 20.0),
    "s3 geodesic": Case(lambda: geodesic("s3", [0.7, 0.2, 0.3], SPIN), 10.0),
    "sl2r between": Case(lambda: between("sl2r", [0.1, 0.2, 0.3], [0.3, 0.1, 0.2]), 5.0),
    "sol geodesic": Case(lambda: geodesic("sol", [0.1, 0.2, 0.3], SPIN), 5.0),
    "r3xso3 geodesic": Case(
        lambda: geodesic("r3xso3", [*ANGLES, 1, 2, 3], [*SPIN, 0.3, 0.2, 0.1]), 10.0
    ),
    "Schwarzschild": Case(
        lambda: geodesic(
            "schwarzschild", [0, 9.0, 1.1, 0.4], [1.3, 0.1, 0.3, 0.4], parameters={"M": 1}
        ),
        50.0,
    ),
    "Kerr": Case(lambda: gt.geodesic(frame("kerr"), [0, 8.0, 1.4, 0], **ORBIT), 300.0),
    "Kerr, long": Case(
        lambda: gt.geodesic(frame("kerr"), [0, 8.0, 1.4, 0], **ORBIT).with_charts("kerr"), 1500.0
    ),
    "transport on s2": Case(
        lambda: gt.parallel_transport(geodesic("s2", [1.0, 0.5], [0.7, 0.9], **SPHERE), [1, 2]),
        10.0,
    ),
    "deviation on s2": Case(
        lambda: gt.geodesic_deviation(
            geodesic("s2", [1.0, 0.5], [0.6, 0.8], **SPHERE), [0.1, 0.2], [0.3, 0.1]
        ),
        5.0,
    ),
    # Equations given by text
    "heavy top": Case(heavy_top, 100.0),
    "attitude by hand": Case(attitude, 50.0),
    "pendulum": one({"x": "v", "v": "-sin(x)"}, [2.0, 0.0], 50.0),
    "forced": one({"x": "v", "v": "-x - x^3 - v/10 + cos(t)/2"}, [1, 0], 50.0),
    "Kepler 0.3": Case(lambda: kepler(0.3), 50.0),
    "Kepler 0.9": Case(lambda: kepler(0.9), 20.0),
    "Lorenz": one(LORENZ, [1, 1, 20], 8.0),
    "switches": one(
        {"x": "v", "v": "-x - v/10 + a"}, [1, 0], 20.0, parameters={"a": 0}, switches=PUSHES
    ),
    # Scenes
    "cusps": Case(lambda: scene("lagrange_cusp", 1.0, watch=("matrix", "energy")), 1.0),
    "missile": Case(lambda: scene("missile", 3.0), 3.0),
    "rolling disc": Case(lambda: scene("rolling_disc", 2.0), 2.0),
    "satellite": Case(lambda: scene("gyrostat_satellite", 600.0), 600.0),
    "Chaplygin's sleigh": Case(lambda: scene("chaplygin_sleigh", 5.0), 5.0),
}
ENGINES = {"default": lambda: None, "RungeKutta": gt.RungeKutta}


# Accuracy of the true solution, beyond double precision.
TRUTH = 1e-20

# -- worker ------------------------------------------------------------------------------------


def seconds(call: Callable[[], Any], before: Callable[[], None], length: float) -> float:
    """Least CPU time of a call: at least three calls, and as many as fit into `length` seconds."""
    least, spent, count = np.inf, 0.0, 0
    while spent < length or count < 3:
        before()
        began = time.process_time()
        call()
        took = time.process_time() - began
        least, spent, count = min(least, took), spent + took, count + 1
    return float(least)


class Worker:
    """Problems of this process, each made once, and their solutions in a hundred bits."""

    def __init__(self) -> None:
        self.problems: dict[tuple[str, float], Any] = {}
        self.truths: dict[str, Any] = {}

    def call(self, name: str, accuracy: float, engine: str) -> Callable[[], Any]:
        """A function that solves; it has solved nothing yet."""
        if (name, accuracy) not in self.problems:
            self.problems[name, accuracy] = CASES[name].asked(accuracy)
        problem = self.problems[name, accuracy]
        return lambda: CASES[name].solve(problem, accuracy, ENGINES[engine]())

    def warm(self, name: str, accuracy: float, engine: str, length: float) -> dict[str, Any]:
        """Least CPU seconds of a repeated solve without remembered step sizes."""
        call = self.call(name, accuracy, engine)
        call()
        return {"seconds": seconds(call, forgetting(), length)}

    def cold(self, name: str, accuracy: float, engine: str) -> dict[str, Any]:
        """CPU seconds of the first solve in this process."""
        call = self.call(name, accuracy, engine)
        began = time.process_time()
        call()
        return {"seconds": time.process_time() - began}

    def error(self, name: str, accuracy: float, engine: str) -> dict[str, Any]:
        """Error estimate and true error of a solution."""
        solution = self.call(name, accuracy, engine)()
        if name not in self.truths:
            exact = CASES[name].asked(TRUTH)
            self.truths[name] = CASES[name].solve(exact, TRUTH, gt.Taylor(113))
        return {"claimed": float(solution.error), "real": gap(solution, self.truths[name])}


def main() -> None:
    """Answer each JSON line of the input with one line: {"do": "warm", "name": ..., ...}."""
    if sys.modules.get("heyoka", True) is not None:
        import heyoka  # code compiled by other processes must not count

        heyoka.llvm_state.set_diskcache_enabled(False)
    worker = Worker()
    for line in sys.stdin:
        asked = json.loads(line)
        try:
            answer = getattr(worker, asked.pop("do"))(**asked)
        except gt.GeomtorsionError as refused:
            answer = {"refused": str(refused)}
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
