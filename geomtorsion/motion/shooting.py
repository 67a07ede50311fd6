"""Shooting: the motion that leads from one point to another."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import EndpointError, GeomtorsionError
from geomtorsion.motion.curves import autoparallel
from geomtorsion.motion.problem import Problem
from geomtorsion.motion.solution import Solution
from geomtorsion.motion.solving import solve
from geomtorsion.motion.start import checked_numbers, checked_start

if TYPE_CHECKING:
    import numpy as np

    from geomtorsion.geometry import Connection
    from geomtorsion.motion.engines import Engine
    from geomtorsion.motion.system import Numbers

# Newton steps until a shot has hit or is given up.
SHOTS = 40
# Below this ratio of singular values the end hardly depends on one direction: a conjugate point.
CONJUGATE = 1e-6


@dataclass(frozen=True, eq=False)
class Connecting:
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


def connecting(
    connection: Connection,
    start: Numbers,
    end: Numbers,
    *,
    guess: Numbers | None = None,
    parameters: Mapping[Any, Any] | None = None,
    accuracy: float = 1e-10,
    engine: Engine | None = None,
) -> Connecting:
    """The motion from one point to another in unit time: the inverse of the exponential map.

    Newton shooting, the derivative of the end by central differences. Without a guess it is sent
    off in several directions; near the cut locus, where more than one of the
    shortest comes back with the same length, there is no unique answer, and it says so.

    Parameters
    ----------
    connection, start
        as in `exponential_map`.
    end
        q^mu to be reached, shape (n,).
    guess
        frame velocity to begin with, to choose among several answers.

    Raises
    ------
    EndpointError
        no motion was found; or several equally short ones; or the end is conjugate to the start.

    Examples
    --------
    >>> from geomtorsion.geometry import levi_civita
    >>> from geomtorsion.spaces import load
    >>> plane = levi_civita(load("flat_polar").frame)
    >>> connecting(plane, [1, 0], [1, 0.5]).vector.round(6).tolist()
    [-0.122417, 0.479426]
    """
    import numpy as np

    frame = connection.frame
    n = frame.dimension
    problem = autoparallel(connection, start, frame_velocity=[0] * n, parameters=parameters)
    target = np.array([float(x) for x in checked_start(frame, end, problem.parameters)])
    if guess is not None:
        first = np.array([float(x) for x in checked_numbers(guess, n, "guess")])
        found = _shoot(problem, target, first, accuracy, engine)
        if found is None:
            raise EndpointError(
                f"no motion from {list(start)} to {list(end)} was found from the guess "
                f"{list(guess)}. Give another guess, or none."
            )
        return found
    answers = [
        answer
        for first in _directions(problem, target)
        if (answer := _shoot(problem, target, first, accuracy, engine)) is not None
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


def _directions(problem: Problem, target: Any) -> list[Any]:
    """Initial velocities to try: straight there in coordinates, and that turned and lengthened."""
    import numpy as np

    from geomtorsion.motion.crossing import coframe_at

    assert problem.start is not None
    here = np.array([float(x) for x in problem.start])
    found = []
    point = dict(zip(problem.coordinates, here, strict=True))
    e = coframe_at(problem.frame, point, problem.parameters)
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


def _angular(problem: Problem) -> set[int]:
    """Coordinates on which neither sine nor cosine can tell a full turn: bounded by two pi."""
    import sympy as sp

    found = set()
    for k, symbol in enumerate(problem.frame.coordinates):
        for relation in problem.frame.domain:
            if relation.free_symbols == {symbol} and 2 * sp.pi in relation.args:
                found.add(k)
    return found


def _shoot(
    problem: Problem, target: Any, first: Any, accuracy: float, engine: Engine | None
) -> Connecting | None:
    """Newton's iteration on the initial velocity, damped; None if it does not hit."""
    import numpy as np

    vector, miss, best = first, np.inf, None
    for shot in range(1, SHOTS + 1):
        try:
            solution = solve(problem.moved(frame_velocity=vector), [1.0], accuracy / 10, engine)
            gap = _gap(problem, solution.coordinates[-1], target)
        except GeomtorsionError:
            if best is None:
                return None
            vector = (vector + best[0]) / 2
            continue
        size = float(np.linalg.norm(gap))
        scale = max(1.0, float(np.linalg.norm(target)))
        if size <= 10 * accuracy * scale:
            return Connecting(vector, size, solution, shot)
        if size >= miss and best is not None:
            vector = (vector + best[0]) / 2
            if np.linalg.norm(vector - best[0]) < 1e-14 * max(1.0, np.linalg.norm(vector)):
                return None
            continue
        miss, best = size, (vector, gap)
        slopes = _slopes(problem, vector, accuracy, engine)
        if slopes is None:
            return None
        u, s, vt = np.linalg.svd(slopes)
        if s[-1] < CONJUGATE * s[0]:
            return None
        step = vt.T @ ((u.T @ gap) / s)
        limit = max(1.0, 2 * float(np.linalg.norm(vector)))
        vector = vector - step * min(1.0, limit / max(float(np.linalg.norm(step)), 1e-300))
    return None


def _gap(problem: Problem, here: Any, target: Any) -> Any:
    """Coordinate difference, whole turns of angles taken out."""
    import numpy as np

    gap = np.asarray(here, dtype=float) - target
    for k in _angular(problem):
        gap[k] = np.remainder(gap[k] + np.pi, 2 * np.pi) - np.pi
    return gap


def _slopes(problem: Problem, vector: Any, accuracy: float, engine: Engine | None) -> Any:
    """d end^mu / d u^i by central differences of the end point."""
    import numpy as np

    n = len(vector)
    size = max(float(np.linalg.norm(vector)), 1e-3)
    h = 1e-3 * size
    columns = []
    for i in range(n):
        ends = []
        for sign in (1, -1):
            shifted = vector.copy()
            shifted[i] += sign * h
            try:
                found = solve(problem.moved(frame_velocity=shifted), [1.0], 1e-8, engine)
                ends.append(found.coordinates[-1])
            except GeomtorsionError:
                return None
        columns.append(_gap(problem, ends[0], np.asarray(ends[1], dtype=float)) / (2 * h))
    return np.array(columns).T
