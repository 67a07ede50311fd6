"""Linear: curves whose equations are linear are exponentials of a constant matrix."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import mpmath
import numpy as np

from geomtorsion.codegen import graph
from geomtorsion.curves.equations import derivative
from geomtorsion.ode.numbers import Real, mpf
from geomtorsion.support.precision import CONSTANT_BITS, working_precision

if TYPE_CHECKING:
    from geomtorsion.curves.problem import CurveProblem


def closed_form(
    problem: CurveProblem,
) -> tuple[str, Callable[[Sequence[float] | np.ndarray], list[list[mpmath.mpf]]]] | None:
    """Chart and function of times that gives exact states in it; None if none is known.

    Known: linear equations with constant coefficients. These are the one-parameter subgroups of
    the rotations in quaternions, straight lines in Cartesian coordinates, and velocities without
    coordinates.

    Examples
    --------
    >>> from math import cos
    >>> from geomtorsion.geometry import cartan
    >>> from geomtorsion.curves import autoparallel
    >>> from geomtorsion.spaces import load
    >>> p = autoparallel(cartan(load("so3").frame), [0, 1, 0], frame_velocity=[0, 1, 0])
    >>> chart, states = closed_form(p)
    >>> chart, round(float(states([0.5])[0][0]), 9) == round(cos(0.75), 9)
    ('quaternion', True)
    """
    stage = problem.first_stage(CONSTANT_BITS, 0.0)
    equations = problem.equations(stage.label)
    if equations.clock:
        return None
    slopes = [derivative(rate, name) for rate in equations.rates for name in equations.states]
    if any(derivative(slope, name) for slope in slopes for name in equations.states):
        return None
    arguments = (*equations.states, *equations.parameters)
    n = len(equations.states)
    values: list[Real] = [0] * n + [mpf(x, CONSTANT_BITS) for x in stage.parameters]
    entries = graph(arguments, slopes, factor=False).exactly(values, CONSTANT_BITS)
    offset = graph(arguments, equations.rates, factor=False).exactly(values, CONSTANT_BITS)
    with working_precision(CONSTANT_BITS):
        # One more row carries the constant part of the rates.
        matrix = mpmath.zeros(n + 1, n + 1)
        for k in range(n):
            for j in range(n):
                matrix[k, j] = mpf(entries[k * n + j], CONSTANT_BITS)
            matrix[k, n] = mpf(offset[k], CONSTANT_BITS)
        start = mpmath.matrix([*(mpf(x, CONSTANT_BITS) for x in stage.start), 1])

    def states(times: Sequence[float] | np.ndarray) -> list[list[mpmath.mpf]]:
        """States at times of the problem, as mpmath numbers, one list per time."""
        with working_precision(CONSTANT_BITS):
            rows = []
            for t in times:
                scaled = matrix * (mpf(t, CONSTANT_BITS) * mpf(problem.time_unit, CONSTANT_BITS))
                end = mpmath.expm(scaled, method="taylor") * start
                rows.append([end[k] for k in range(n)])
        return rows

    return stage.label, states
