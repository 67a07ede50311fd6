"""Distance: how far two solved curves are from each other."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.curves.readout import at_times
from geomtorsion.errors import TimeError, UnknownNameError
from geomtorsion.geometry.domain_edges import is_angle
from geomtorsion.support import checks

if TYPE_CHECKING:
    from geomtorsion.curves.problem import CurveProblem
    from geomtorsion.ode.solution import Solution


def distance_apart(
    one: Solution,
    two: Solution,
    chart: str | None = None,
    *,
    angles: Sequence[str] | None = None,
) -> np.ndarray:
    """Distance of two motions at each time of the first.

    Parameters
    ----------
    one, two
        solutions over the same space.
    chart
        chart in whose coordinates to measure; the chart of the problem if not given.
    angles
        names of its coordinates that count modulo 2 pi; None: the angles that the space declares,
        by a map into the chart or by a domain of one turn over which the frame repeats itself.

    Returns
    -------
    Array, shape (m,): the length of e^i_mu (q_two - q_one)^mu, with the coframe half way between;
    where angles wrap, the least of the lengths to all images of the second point, so that nothing
    jumps. With a positive definite metric this is the distance in the metric where the two are
    close. With an indefinite metric all signs are taken as positive. The result is then neither a
    distance nor an invariant, but the size of the difference for observers who carry the frame;
    it is not zero along a null vector.

    Raises
    ------
    TimeError
        the second solution does not reach the times of the first.
    UnknownNameError
        the space has no such chart, or the chart no such coordinate.

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
    last, end = float(one.times[-1]), float(two.times[-1])
    if abs(end) < abs(last) or last * end < 0:
        raise TimeError(
            f"expected solutions to the same time, got one to t = {end:.6g} and one to t = "
            f"{last:.6g}. Solve both to the same time."
        )
    return _gaps(one, two, chart, angles)


def _gaps(
    one: Solution, two: Solution, chart: str | None, angles: Sequence[str] | None
) -> np.ndarray:
    """Lengths of the differences of coordinates at the times of the first solution."""
    problem = one.problem
    name = chart or problem.atlas.home
    place = problem.atlas.chart(name)
    turning = angles_of(problem, name) if angles is None else _places(place.names, angles)
    first = one.in_chart(name).astype(float)
    # Not by way of the home chart: both may be outside it.
    second = at_times(two.problem, two.trajectory, one.times, name).astype(float)
    steps = second - first
    steps[:, turning] = np.remainder(steps[:, turning] + np.pi, 2 * np.pi) - np.pi
    numbers = {key: float(value) for key, value in problem.parameters.items()}
    best = np.full(len(steps), np.inf)
    # The image behind an angle's half turn may be nearer where the metric mixes coordinates.
    for chosen in product((False, True), repeat=len(turning)):
        image = steps.copy()
        for k, is_turned in zip(turning, chosen, strict=True):
            if is_turned:
                image[:, k] -= np.where(image[:, k] < 0, -2 * np.pi, 2 * np.pi)
        if place.frame is None:
            rows = image.T
        else:
            middle = dict(zip(place.names, (first + image / 2).T, strict=True))
            rows = place.coframe.applied(middle | numbers, image.T)
        best = np.fmin(best, np.linalg.norm(rows, axis=0))
    return best


def angles_of(problem: CurveProblem, chart: str) -> list[int]:
    """Coordinates of a chart that count modulo 2 pi, according to maps into it or its domain."""
    angles = set(problem.atlas.angles(problem.atlas.names, chart))
    frame = problem.atlas.chart(chart).frame
    if frame is not None:
        angles |= {k for k, symbol in enumerate(frame.coordinates) if is_angle(frame, symbol)}
    return sorted(angles)


def _places(names: Sequence[str], angles: Sequence[str]) -> list[int]:
    """Which coordinates these are."""
    kind = "coordinates of this chart"
    for name in checks.entries(angles, "angles"):
        checks.known_name(name, names, "angles", UnknownNameError, expected=kind)
    return [names.index(name) for name in angles]
