"""Errors of motions: for many spaces and starts the estimate is compared with the truth.

Run with `python -m pytest tests/benchmarks/test_motion_errors.py`; it takes minutes, mostly to
compile in quadruple precision.
"""

from __future__ import annotations

import numpy as np
import pytest

from geomtorsion.curves import autoparallel, geodesic
from geomtorsion.errors import ChartEdgeError
from geomtorsion.geometry import blend, cartan, levi_civita
from geomtorsion.ode import RungeKutta, Taylor, solve
from geomtorsion.prices import truth_of
from geomtorsion.spaces import load

pytest.importorskip("heyoka")
HOLE = [0, 9.0, 1.1, 0.4]
SPACES = {
    "so3": ([0.3, 1.0, 0.2], {}),
    "s2": ([1.0, 0.5], {"R": 1.3}),
    "s3": ([0.7, 0.2, 0.3], {}),
    "sol": ([0.1, 0.2, 0.3], {}),
    "sl2r": ([0.1, 0.2, 0.3], {}),
    "heisenberg": ([0.1, 0.2, 0.3], {}),
    "bianchi_v": ([0.1, 0.2, 0.3], {}),
    "r3xso3": ([0.3, 1.0, 0.2, 1, 2, 3], {}),
    "flat_spherical": ([1.2, 0.7, 0.4], {}),
    "schwarzschild": (HOLE, {"M": 1.0}),
    "kerr": (HOLE, {"M": 1.0, "a": 0.6}),
}


def _posed(kind, frame, start, u, numbers):
    given = {"frame_velocity": u, "parameters": numbers}
    if kind == "geodesic":
        return geodesic(frame, start, **given)
    connection = cartan(frame)
    if kind == "between":
        connection = blend(levi_civita(frame), connection)
    return autoparallel(connection, start, **given)


def _within(problem, t):
    """The time, or half of the time after which a motion leaves the only chart of its space."""
    try:
        solve(problem, t, 1e-3)
    except ChartEdgeError as ended:
        return 0.5 * float(ended.solution.times[-1])
    return t


@pytest.mark.parametrize("name", SPACES)
@pytest.mark.parametrize("kind", ["autoparallel", "geodesic", "between"])
def test_estimates_hold(name, kind):
    """The true error is within the accuracy; the estimate is 0.1 to 100 times the true error."""
    start, numbers = SPACES[name]
    frame = load(name).frame
    numbers = {symbol.name: 1.2 for symbol in frame.parameters} | numbers
    random = np.random.default_rng(sum(map(ord, name + kind)))
    checked = 0
    for _ in range(2):
        u = random.normal(size=frame.dimension)
        if len(start) == 4:
            u = np.array([1.3, 0.1, 0.3, 0.4]) + 0.1 * u
        problem = _posed(kind, frame, start, u, numbers)
        t = _within(problem, 5.0)
        truth = truth_of(problem, np.linspace(0, t, 65))
        for engine in (Taylor(), RungeKutta()):
            for accuracy in (1e-5, 1e-8, 1e-11):
                sol = solve(problem, t, accuracy, engine)
                error = truth.error(sol)
                assert error <= accuracy
                assert sol.error >= 0.1 * error
                assert sol.error <= max(100 * error, 2e-15)
                checked += 1
    assert checked == 12
