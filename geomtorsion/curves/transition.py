"""Transition: a moving point carried from one chart into another, at any precision."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from geomtorsion.curves.transported import speed_powers
from geomtorsion.errors import ChartEdgeError
from geomtorsion.ode.numbers import Real, divided

if TYPE_CHECKING:
    from geomtorsion.curves.problem import CurveProblem

# A chart is worth moving to if it is this much further from its edge, in units of its margin.
GAIN = 1.5


class MovingPoint(NamedTuple):
    """Coordinates, velocities u^i in units of the speed, and what is carried along."""

    coordinates: list[Real]
    velocities: list[Real]
    carried: list[Real]

    @property
    def has_value(self) -> bool:
        """Whether a motion can begin here."""
        return all(math.isfinite(float(x)) for row in self for x in row)


def beginning(problem: CurveProblem, precision: int) -> tuple[str, MovingPoint]:
    """The chart in which to begin, and the point there."""
    unit = problem.time_unit
    velocities = [divided(u, unit) for u in _frame_velocity(problem, precision)]
    carried: list[Real] = []
    if problem.carried is not None:
        powers = speed_powers(problem.carried)
        carried = [
            divided(x, unit) if power else x
            for x, power in zip(problem.carried.start, powers, strict=True)
        ]
    if problem.start is None:
        return "", MovingPoint([], velocities, carried)
    home, point = problem.atlas.home, MovingPoint(list(problem.start), velocities, carried)
    name = best_chart(problem, home, point, precision, starting=True)
    if name is None or name == home:
        return home, point
    return name, moved(problem, home, name, point, precision)


def _frame_velocity(problem: CurveProblem, precision: int) -> Sequence[Real]:
    """u^i at the start, worked out from q'^mu where more digits are needed."""
    given = problem.coordinate_velocity
    if precision <= 53 or given is None or problem.start is None:
        return problem.frame_velocity
    chart = problem.atlas.chart(problem.atlas.home)
    point = dict(zip(chart.names, problem.start, strict=True)) | dict(problem.parameters)
    return chart.coframe.precisely(point, given, precision + 20)


def best_chart(
    problem: CurveProblem,
    source: str,
    point: MovingPoint,
    precision: int,
    *,
    starting: bool = False,
) -> str | None:
    """The first chart far from its edge, or else the one that is furthest from it.

    Of those that are far from their edges none in which the motion is much faster than in another:
    behind a horizon, ingoing coordinates run away from what comes out of it, and outgoing ones from
    what falls in.
    """
    best, score = None, 0.0
    far: list[tuple[str, float]] = []
    for name in problem.charts:
        if name == source and not starting:
            continue
        try:
            there = moved(problem, source, name, point, precision)
        except (ChartEdgeError, ArithmeticError, ValueError):
            continue
        if not there.has_value:
            continue
        chart = problem.atlas.chart(name)
        place = dict(zip(chart.names, map(float, there.coordinates), strict=True))
        numbers = {key: float(value) for key, value in problem.parameters.items()}
        distance = chart.distance(place | numbers)
        if distance >= 2 * GAIN:
            far.append((name, math.hypot(*map(float, there.velocities))))
        if distance > score:
            best, score = name, distance
    if far:
        slowest = min(speed for _, speed in far)
        return next(name for name, speed in far if speed <= 2 * GAIN * slowest)
    return best if starting or score > GAIN else None


def moved(
    problem: CurveProblem, source: str, target: str, point: MovingPoint, bits: int
) -> MovingPoint:
    """A moving point in another chart; above 53 bits with mpmath numbers throughout."""
    if source == target:
        return point
    coordinates, velocities, carried = point
    numbers = dict(problem.parameters)
    turning = not same_frame(problem, source, target)
    rates: list[Real] = []
    if turning:
        chart = problem.atlas.chart(source)
        place = dict(zip(chart.names, coordinates, strict=True)) | numbers
        rates = chart.frame_vectors.precisely(place, velocities, bits)
    for change in problem.atlas.route(source, target):
        here = problem.atlas.chart(change.source)
        if turning:
            place = dict(zip(here.names, coordinates, strict=True)) | numbers
            rates = change.slopes.precisely(place, rates, bits)
        if bits > 53:
            coordinates = list(change.precisely(coordinates, numbers, bits))
        else:
            coordinates = change([float(x) for x in coordinates], numbers).tolist()
    if not np.isfinite([float(x) for x in coordinates]).all():
        raise ChartEdgeError(f"chart {target!r} does not reach this point")
    if turning:
        chart = problem.atlas.chart(target)
        place = dict(zip(chart.names, coordinates, strict=True)) | numbers
        velocities = chart.coframe.precisely(place, rates, bits)
    return MovingPoint(coordinates, list(velocities), carried)


def same_frame(problem: CurveProblem, source: str, target: str) -> bool:
    """Whether two charts have the same frame vectors."""
    return problem.atlas.chart(source).keeps_frame and problem.atlas.chart(target).keeps_frame
