"""Closed forms: motions whose equations are linear are exponentials of a constant matrix."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from geomtorsion.motion.journey import beginning, values_of
from geomtorsion.motion.system import derivative, evaluated, mpf

if TYPE_CHECKING:
    from collections.abc import Callable

    from geomtorsion.motion.problem import Problem

BITS = 160


def closed_form(problem: Problem) -> tuple[str, Callable[[Any], Any]] | None:
    """Chart and function of times that gives exact states in it; None if none is known.

    Known: linear equations with constant coefficients. These are the one-parameter subgroups of
    the rotations in quaternions, straight lines in Cartesian coordinates, and velocities alone.

    Examples
    --------
    >>> from geomtorsion.geometry import cartan
    >>> from geomtorsion.motion import autoparallel
    >>> from geomtorsion.spaces import load
    >>> p = autoparallel(cartan(load("so3").frame), [0, 1, 0], frame_velocity=[0, 1, 0])
    >>> chart, states = closed_form(p)
    >>> chart, round(float(states([0.5])[0][0]), 9) == round(__import__("math").cos(0.75), 9)
    ('quaternion', True)
    """
    import mpmath

    name, state = beginning(problem, BITS)
    equations = problem.equations(name)
    system = equations.system
    if not _is_linear(problem, name):
        return None
    values = [mpf(x, BITS) for x in values_of(problem, equations, state[1])]
    table: dict[str, Any] = dict.fromkeys(system.states, mpmath.mpf(0))
    table |= dict(zip(system.parameters, values, strict=True))
    with mpmath.workprec(BITS):
        entries = [evaluated([slope], table)[0] for slope in system.jacobian_system]
        offset = mpmath.matrix([evaluated([rate], table)[0] for rate in system.rates])
        n = system.size
        # One more row carries the constant part of the rates.
        matrix = mpmath.zeros(n + 1, n + 1)
        for k in range(n):
            for j in range(n):
                matrix[k, j] = entries[k * n + j]
            matrix[k, n] = offset[k]
        vector = [*state[0], *(state[1] if equations.moves else []), *state[2]]
        start = mpmath.matrix([*(mpf(x, BITS) for x in vector), 1])

    def states(times: Any) -> Any:
        """States at times of the problem, as mpmath numbers, one list per time."""
        with mpmath.workprec(BITS):
            found = []
            for t in times:
                scaled = matrix * (mpf(t, BITS) * mpf(problem.speed, BITS))
                end = mpmath.expm(scaled, method="taylor") * start
                found.append([end[k] for k in range(n)])
        return found

    return name, states


def _is_linear(problem: Problem, name: str) -> bool:
    """Whether every derivative of every rate is constant."""
    system = problem.equations(name).system

    def check() -> bool:
        return all(
            not derivative(slope, state)
            for slope in system.jacobian_system
            for state in system.states
        )

    return problem.kept(("linear", name), check)
