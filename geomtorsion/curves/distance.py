"""Distance: how far two solved curves are from each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.curves.readout import converted
from geomtorsion.errors import TimeError

if TYPE_CHECKING:
    from geomtorsion.curves.problem import CurveProblem
    from geomtorsion.ode.solution import Solution


def distance_apart(one: Solution, two: Solution, chart: str | None = None) -> np.ndarray:
    """How far two motions are from each other at each of the times of the first.

    Parameters
    ----------
    one, two
        solutions over the same space.
    chart
        chart in whose coordinates to measure; that of the problem if not given.

    Returns
    -------
    Array, shape (m,): length of e^i_mu (q_two - q_one)^mu, with the coframe half way between: the
    distance in the metric where the two are close. Lorentzian signs are taken as positive.

    Raises
    ------
    TimeError
        the second solution does not reach the times of the first.

    Examples
    --------
    >>> from geomtorsion.geometry import cartan
    >>> from geomtorsion.curves import autoparallel, geodesic
    >>> from geomtorsion.ode import solve
    >>> from geomtorsion.spaces import load
    >>> frame = load("so3").frame
    >>> start, turn = [0.3, 1.0, 0.2], [0.1, 0.5, -0.2]
    >>> straight = solve(autoparallel(cartan(frame), start, turn), 1.0)
    >>> shortest = solve(geodesic(frame, start, turn), 1.0)
    >>> bool(distance_apart(straight, shortest).max() < 1e-9)
    True
    """
    last, other = float(one.times[-1]), float(two.times[-1])
    if abs(other) < abs(last) or last * other < 0:
        raise TimeError(
            f"the second solution ends at t = {other:.6g}, the first at {last:.6g}. "
            "Solve both to the same time."
        )
    return _gaps(one, two, chart)


def _gaps(one: Solution, two: Solution, chart: str | None) -> np.ndarray:
    """Lengths of the differences of coordinates at the times of the first solution."""
    problem = one.problem
    name = chart or problem.atlas.home
    first = one.in_chart(name).astype(float)
    second = two.at(one.times).coordinates.astype(float)
    if name != two.problem.atlas.home:
        moment = two.at(one.times)
        second, _ = converted(
            two.problem, two.problem.atlas.home, name, second, moment.frame_velocity
        )
    steps = second - first
    place = problem.atlas.chart(name)
    angles = _angles(problem, name)
    for k in angles:
        steps[:, k] = np.remainder(steps[:, k] + np.pi, 2 * np.pi) - np.pi
    if place.frame is None:
        return np.linalg.norm(steps, axis=1)
    lengths = []
    for middle, step in zip(first + steps / 2, steps, strict=True):
        point = dict(zip(place.names, map(float, middle), strict=True))
        numbers = {key: float(value) for key, value in problem.parameters.items()}
        lengths.append(np.linalg.norm(place.coframe.at(point | numbers) @ step))
    return np.array(lengths)


def _angles(problem: CurveProblem, chart: str) -> tuple[int, ...]:
    """Coordinates of a chart that count modulo 2 pi, as far as a map into it says so."""
    for other in problem.atlas.names:
        if other != chart:
            route = problem.atlas.route(other, chart)
            if route:
                return route[-1].angles
    return ()
