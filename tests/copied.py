"""Copied: an object of each public kind, and the questions that a test asks of its copies."""

from __future__ import annotations

import hashlib
import pickle
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp

import geomtorsion as gt

ODE_TIME, CURVE_TIME = 1.0, 2.0
X, Y, T = sp.symbols("x y t")


def things() -> dict[str, Any]:
    """One object of each kind, by name."""
    so3, kerr = gt.spaces.load("so3").frame, gt.spaces.load("kerr").frame
    start, velocity = [0.3, 1.0, 0.2], [0.1, 0.5, -0.2]
    straight = gt.autoparallel(gt.cartan(so3), start, velocity)
    orbit = gt.geodesic(kerr, [0, 8, 1.5, 0], [1.3, 0, 0, 0.05], parameters={"M": 1, "a": 0.9})
    swing = gt.ODE.of(
        {"x": "v", "v": "-x"}, {"x": 1, "v": 0}, events=[gt.At(0.5, {"v": 0.1})],
        invariants={"energy": "x**2 + v**2"},
    )  # fmt: skip
    loop = gt.Loop.circle([0.3, 1.0, 0.2], 0.1)
    surface = [[sp.Function(f"{a}{b}")(X, Y) for b in "12"] for a in "gh"]
    surface[1][0] = surface[0][1]
    root = gt.Frame([X, Y], [[1, 0], [0, sp.sqrt(X**2)]], branches={sp.sqrt(X**2): -X})
    return {
        "frame": so3,
        "frame from legs": gt.Frame.from_frame([X, Y], [[1, 0], [Y, sp.exp(X)]], signature=(-1, 1)),
        "frame from a metric": gt.Frame.from_metric([X, Y], surface),
        "frame with a branch": root,
        "complex frame": gt.spaces.load("kerr_kinnersley").frame,
        "space with unknown functions": gt.spaces.load("frw"),
        "tensor": gt.cartan(so3).torsion.T,
        "scalar": gt.levi_civita(so3).curvature.scalar,
        "connection": gt.cartan(kerr),
        "connection of a metric": gt.levi_civita(so3),
        "blend": gt.blend(gt.cartan(so3), gt.levi_civita(so3), T),
        "torsion": gt.cartan(so3).torsion,
        "curvature": gt.levi_civita(so3).curvature,
        "plan": so3.plan("ricci"),
        "identities": gt.identities(gt.cartan(so3)),
        "curve": straight,
        "orbit": orbit,
        "equations": swing,
        "solved curve": gt.solve(straight, CURVE_TIME),
        "solved orbit": gt.solve(orbit, 20.0),
        "solved equations": gt.solve(swing, ODE_TIME),
        "solved by Runge and Kutta": gt.solve(swing, ODE_TIME, engine=gt.RungeKutta()),
        "ensemble": gt.solve_many(straight, [start, [0.4, 1.1, 0.2]], t=1.0),
        "loop": loop,
        "burgers vector": gt.burgers_vector(so3, loop),
        "closed form": gt.exact_burgers_vector(so3, loop),
        "development": gt.develop(gt.cartan(so3), loop),
        "scene": gt.scenes.load("dzhanibekov"),
        "scene in closed form": gt.scenes.load("dzhanibekov").run(),
        "scene result": gt.scenes.load("lagrange_cusp").run(),
        "exercise": gt.exercises.load("3.2", seed=4),
    }


def _moment(found: Any) -> dict[str, Any]:
    return {name: found.values[name] for name in found.values}


# Questions to an object, by the beginning of its name.
QUESTIONS: dict[str, Callable[[Any], Any]] = {
    "frame": lambda frame: [str(frame), gt.levi_civita(frame).curvature.scalar[()], frame.branches],
    "complex": lambda frame: [str(frame), frame.quantity("ricci").is_zero, frame.complex],
    "space": lambda space: [space.frame.quantity("einstein").nonzero(), space.story],
    "tensor": lambda tensor: [tensor.nonzero(), tensor.in_frame().nonzero(), repr(tensor)],
    "scalar": lambda scalar: [scalar == sp.Rational(3, 2), repr(scalar)],
    "connection": lambda one: [one.coefficients.nonzero(), one.torsion.S.nonzero(), one.is_flat],
    "blend": lambda one: [one.coefficients.nonzero(), one.curvature.scalar[()], one.name],
    "torsion": lambda one: [one.S.nonzero(), one.axial.nonzero()],
    "curvature": lambda one: [one.riemann.nonzero(), one.kretschmann[()]],
    "plan": str,
    "identities": str,
    "curve": lambda problem: _moment(gt.solve(problem, CURVE_TIME).moment),
    "orbit": lambda problem: _moment(gt.solve(problem, 20.0).moment),
    "equations": lambda problem: _moment(gt.solve(problem, ODE_TIME).moment),
    "solved": lambda found: [
        _moment(found.moment), _moment(found.at(0.37)), found.error, str(found), dict(found.drift),
    ],
    "ensemble": lambda found: [found.coordinates, found.errors, str(found)],
    "loop": lambda loop: [repr(loop), gt.burgers_vector(gt.spaces.load("so3").frame, loop).vector],
    "burgers": lambda found: [found.vector, found.error, found.to_json()],
    "closed": lambda found: found.vector,
    "development": lambda found: [found.burgers, found.frank],
    "scene": lambda scene: [scene.run()["omega"], str(scene.selection)],
    "scene in": lambda run: [dict(run.values), dict(run.at(0.3)), run.error],
    "scene result": lambda run: [dict(run.values), dict(run.at(0.3)), run.error, str(run)],
    "exercise": lambda one: [one.statement, one.answers()],
}  # fmt: skip


def answers(name: str, thing: Any) -> str:
    """The answers of an object as one text, to the last bit."""
    key = max((k for k in QUESTIONS if name.startswith(k)), key=len)
    return _written(QUESTIONS[key](thing))


def _written(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{k}: {_written(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_written, value)) + "]"
    if isinstance(value, np.ndarray) and value.dtype != object:
        return hashlib.sha256(value.tobytes()).hexdigest()
    return value.hex() if isinstance(value, float) else str(value)


def main(source: str, target: str) -> None:
    """Load pickled objects in this process and write their answers."""
    copies = pickle.loads(Path(source).read_bytes())
    found = {name: answers(name, thing) for name, thing in copies.items()}
    Path(target).write_bytes(pickle.dumps(found))


if __name__ == "__main__":
    main(*sys.argv[1:])
