"""Logarithm map: the curve that leads from one point to another, by Newton shooting."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from geomtorsion import checks
from geomtorsion.curves.constructors import autoparallel
from geomtorsion.curves.edges import full_turn
from geomtorsion.curves.problem import CurveProblem, checked_start
from geomtorsion.curves.readout import converted
from geomtorsion.errors import ChartEdgeError, EndpointError, GeomtorsionError
from geomtorsion.geometry import Connection
from geomtorsion.ode.engines import Engine, RungeKutta, Taylor
from geomtorsion.ode.engines.taylor import is_available
from geomtorsion.ode.numbers import Numbers, checked_accuracy, checked_engine, checked_numbers
from geomtorsion.ode.solution import Solution
from geomtorsion.ode.solve import solve
from geomtorsion.ode.trajectory import integrate

# Newton steps until a shot has hit or is given up.
SHOTS = 40
# Below this ratio of singular values the end hardly depends on one direction: a conjugate point.
CONJUGATE = 1e-6
# Slopes are taken anew where a shot misses by more than this part of the last miss.
STALE = 0.05


@dataclass(frozen=True, eq=False)
class LogMap:
    """A motion that leads from one point to another in unit time.

    vector: its initial frame velocity u^i; its length is the length of the motion.
    miss: distance of its end from the target, in frame components.
    solution: the motion.
    shots: how many were needed.
    """

    vector: np.ndarray
    miss: float
    solution: Solution
    shots: int


def log_map(
    connection: Connection,
    start: Numbers,
    end: Numbers,
    *,
    guess: Numbers | None = None,
    parameters: Mapping[Any, Any] | None = None,
    accuracy: float = 1e-10,
    engine: Engine | None = None,
) -> LogMap:
    """The motion from one point to another in unit time: the inverse of the exponential map.

    Newton shooting, the derivative of the end by central differences. Without a guess it starts in
    several directions, and the shortest motion found is the answer. Where two that differ have that
    length, the end lies on the cut locus: an error says so.

    Parameters
    ----------
    connection, start
        as in `exponential_map`.
    end
        q^mu to be reached, shape (n,).
    guess
        frame velocity to begin with, to choose among several answers.
    parameters, accuracy, engine
        as in `exponential_map`; the end is hit to ten times the accuracy.

    Raises
    ------
    EndpointError
        no motion was found; or several equally short ones; or the end is conjugate to the start.

    Examples
    --------
    >>> from geomtorsion.geometry import levi_civita
    >>> from geomtorsion.spaces import load
    >>> plane = levi_civita(load("flat_polar").frame)
    >>> log_map(plane, [1, 0], [1, 0.5]).vector.round(6).tolist()
    [-0.122417, 0.479426]
    """
    frame = checks.instance(connection, Connection, "connection").frame
    n = frame.dimension
    accuracy = checked_accuracy(accuracy)
    checked_engine(engine)
    problem = autoparallel(connection, start, frame_velocity=[0] * n, parameters=parameters)
    target = np.array([float(x) for x in checked_start(frame, end, problem.parameters)])
    solver = engine or (Taylor() if is_available() else RungeKutta())
    shooter = _Shooter(problem, solver, solver.first(accuracy / 10), frozenset(_angular(problem)))
    if guess is not None:
        first = np.array([float(x) for x in checked_numbers(guess, n, "guess")])
        found = _shoot(shooter, target, first, accuracy, engine)
        if found is None:
            raise EndpointError(
                f"no motion from {list(start)} to {list(end)} was found from the guess "
                f"{list(guess)}. Give another guess, or none."
            )
        return found
    answers = [
        answer
        for first in _directions(problem, target)
        if (answer := _shoot(shooter, target, first, accuracy, engine)) is not None
    ]
    if not answers:
        raise EndpointError(
            f"no motion from {list(start)} to {list(end)} was found. Give a guess (initial frame "
            "velocity), or a nearer end."
        )
    answers.sort(key=lambda answer: float(np.linalg.norm(answer.vector)))
    best = answers[0]
    length = float(np.linalg.norm(best.vector))
    for other in answers[1:]:
        same = np.linalg.norm(other.vector - best.vector) < 1e-5 * max(length, 1e-300)
        if not same and np.linalg.norm(other.vector) < length * (1 + 1e-6):
            raise EndpointError(
                f"no unique answer: at least two motions of length {length:.9g} lead from "
                f"{list(start)} to {list(end)}, with initial frame velocities "
                f"{best.vector.round(6).tolist()} and {other.vector.round(6).tolist()}. "
                "The end lies on the cut locus; give a guess to choose one."
            )
    return best


def _directions(problem: CurveProblem, target: np.ndarray) -> list[np.ndarray]:
    """Initial velocities to try: straight there in coordinates, and that turned and lengthened."""
    assert problem.start is not None
    here = np.array([float(x) for x in problem.start])
    found = []
    point = dict(zip(problem.coordinates, here, strict=True))
    numbers = {key: float(value) for key, value in problem.parameters.items()}
    e = problem.atlas.chart(problem.atlas.home).coframe.at(point | numbers)
    for k in range(len(here)):
        for turn in (0.0, 2 * np.pi, -2 * np.pi) if k in _angular(problem) else (0.0,):
            step = target - here
            step[k] += turn
            if not any(np.allclose(step, other) for other in found):
                found.append(step)
    vectors = [e @ step for step in found]
    length = np.linalg.norm(vectors[0])
    vectors += [-vectors[0], 0.3 * vectors[0]]
    for i in range(len(here)):
        side = np.zeros(len(here))
        side[i] = length
        vectors += [side, -side]
    return vectors


def _angular(problem: CurveProblem) -> set[int]:
    """Coordinates that count modulo 2 pi: their domain is a full turn."""
    frame = problem.frame
    return {k for k, x in enumerate(frame.coordinates) if full_turn(frame, x) is not None}


@dataclass(frozen=True, eq=False)
class _Shooter:
    """Where motions from one point end, as a function of the initial velocity: q at t = 1.

    tolerance: of the engine; the motion that hits is checked when all is done.
    angular: coordinates that count modulo two pi.
    """

    problem: CurveProblem
    engine: Engine
    tolerance: float
    angular: frozenset[int]

    def end(self, vector: np.ndarray) -> np.ndarray:
        """Coordinates at t = 1."""
        member = replace(self.problem, frame_velocity=tuple(vector.tolist()))
        stage = member.first_stage(self.engine.precision, 0.0)
        times = np.array([0.0, member.time_unit])
        trajectory = integrate(stage, times, self.tolerance, self.engine)
        if trajectory.outcome != "done":
            raise ChartEdgeError("the motion ends before t = 1")
        segment = trajectory.segments[-1]
        equations = member.equations(segment.label)
        last = np.asarray(segment.last, dtype=float)[None, :]
        q = last[:, : equations.width]
        if segment.label != member.atlas.home:
            u = vector[None, :]
            if equations.moves:
                u = last[:, equations.width : equations.width + len(vector)]
            q, _ = converted(member, segment.label, member.atlas.home, q, u)
        return q[0]

    def gap(self, here: np.ndarray, target: np.ndarray) -> np.ndarray:
        """Coordinate difference, whole turns of angles taken out."""
        gap = np.asarray(here, dtype=float) - target
        for k in self.angular:
            gap[k] = np.remainder(gap[k] + np.pi, 2 * np.pi) - np.pi
        return gap

    def slopes(self, vector: np.ndarray) -> np.ndarray:
        """d end^mu / d u^i by central differences."""
        # Ends are off by about the tolerance: here what that does and the third derivative balance.
        h = self.tolerance ** (1 / 3) * max(float(np.linalg.norm(vector)), 1e-3)
        sides = h * np.eye(len(vector))
        rows = [self.gap(self.end(vector + x), self.end(vector - x)) for x in sides]
        return np.array(rows).T / (2 * h)


def _shoot(
    shooter: _Shooter, target: np.ndarray, first: np.ndarray, accuracy: float, engine: Engine | None
) -> LogMap | None:
    """Newton's iteration on the initial velocity, damped; None if it does not hit."""
    vector, miss, best, inverse, shot = first, np.inf, None, None, 0
    scale = max(1.0, float(np.linalg.norm(target)))
    while True:
        shot += 1
        try:
            gap = shooter.gap(shooter.end(vector), target)
            size = float(np.linalg.norm(gap))
            if size <= accuracy * scale:
                break
            if shot >= SHOTS:
                return None
            if size >= miss and best is not None:
                vector, inverse = (vector + best) / 2, None
                if np.linalg.norm(vector - best) < 1e-14 * max(1.0, np.linalg.norm(vector)):
                    return None
                continue
            # Slopes are used again as long as they lead closer quickly.
            if inverse is None or size > STALE * miss:
                u, s, vt = np.linalg.svd(shooter.slopes(vector))
                if s[-1] < CONJUGATE * s[0]:
                    return None
                inverse = vt.T @ np.diag(1 / s) @ u.T
        except GeomtorsionError:
            if best is None or shot >= SHOTS:
                return None
            vector = (vector + best) / 2
            continue
        miss, best = size, vector
        step = inverse @ gap
        limit = max(1.0, 2 * float(np.linalg.norm(vector)))
        vector = vector - step * min(1.0, limit / max(float(np.linalg.norm(step)), 1e-300))
    try:
        solution = solve(
            shooter.problem.with_start(frame_velocity=vector), [1.0], accuracy / 10, engine
        )
        gap = shooter.gap(solution.coordinates[-1], target)
    except GeomtorsionError:
        return None
    size = float(np.linalg.norm(gap))
    return LogMap(vector, size, solution, shot) if size <= 10 * accuracy * scale else None
