"""Crossing: a state carried from one chart into another, at any precision."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import ChartEdgeError
from geomtorsion.motion.charts import Chart
from geomtorsion.motion.system import evaluated, mpf

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.geometry import Frame
    from geomtorsion.motion.problem import Problem

# A state is (coordinates, velocities in units of the speed, passengers).
State = tuple[list[Any], list[Any], list[Any]]
Entries = Mapping[Any, "Element"]


def moved_over(problem: Problem, source: str, target: str, state: State, bits: int) -> State:
    """A state in another chart; above 53 bits with mpmath numbers throughout."""
    import numpy as np

    if source == target:
        return state
    coordinates, velocities, riders = state
    turning = not same_frame(problem, source, target)
    rates = None
    if turning:
        chart = problem.atlas.chart(source)
        legs = {(mu, i): x for mu, row in enumerate(chart.legs) for i, x in row}
        rates = applied(legs, len(chart.coordinates), chart, coordinates, velocities, problem, bits)
    for change in problem.route(source, target):
        if rates is not None:
            n = len(change.coordinates)
            slopes = {divmod(k, n): x for k, x in enumerate(change.slopes) if not x.is_zero}
            here = problem.atlas.chart(change.source)
            size = len(change.expressions)
            rates = applied(slopes, size, here, coordinates, rates, problem, bits)
        if bits > 53:
            coordinates = change.precisely(coordinates, problem.parameters, bits)
        else:
            numbers = {key: float(value) for key, value in problem.parameters.items()}
            coordinates = list(change([float(x) for x in coordinates], numbers))
    if not np.isfinite([float(x) for x in coordinates]).all():
        raise ChartEdgeError(f"chart {target!r} does not reach this point")
    if rates is not None:
        chart = problem.atlas.chart(target)
        assert chart.frame is not None
        entries, n = chart.frame.coframe.components.nonzero, chart.frame.dimension
        velocities = applied(entries, n, chart, coordinates, rates, problem, bits)
    return coordinates, velocities, riders


def has_value(state: State) -> bool:
    """Whether a motion can begin with a state."""
    return all(math.isfinite(float(x)) for row in state for x in row)


def same_frame(problem: Problem, source: str, target: str) -> bool:
    """Whether two charts have the same legs."""
    return problem.atlas.chart(source).keeps_frame and problem.atlas.chart(target).keeps_frame


def applied(
    entries: Entries,
    rows: int,
    chart: Chart,
    coordinates: Sequence[Any],
    vector: Sequence[Any],
    problem: Problem,
    bits: int,
) -> list[Any]:
    """A sparse matrix of elements, at a point of a chart, times a vector."""
    import mpmath

    parameters = problem.parameters
    if bits <= 53:
        values = {name: float(x) for name, x in zip(chart.names, coordinates, strict=True)}
        values |= {key: float(value) for key, value in parameters.items()}
        numbers = evaluated([((x, ()),) for x in entries.values()], values)
        result = [0.0] * rows
        for (i, j), number in zip(entries, numbers, strict=True):
            result[i] += float(number) * float(vector[j])
        return result
    point = {name: mpf(x, bits) for name, x in zip(chart.names, coordinates, strict=True)}
    point |= {key: mpf(value, bits) for key, value in parameters.items()}
    exact = [mpf(x, bits) for x in vector]
    with mpmath.workprec(bits):
        total = [mpmath.mpf(0)] * rows
        for (i, j), element in entries.items():
            total[i] += element.evaluate(point, bits) * exact[j]
    return total


def legs_at(problem: Problem, chart: Chart, coordinates: Sequence[Any]) -> Any:
    """E[mu, i] at a point."""
    entries = {(mu, i): x for mu, row in enumerate(chart.legs) for i, x in row}
    shape = (len(chart.coordinates), problem.frame.dimension)
    point = dict(zip(chart.names, map(float, coordinates), strict=True))
    return _matrix(entries, shape, point, problem.parameters)


def coframe_at(frame: Frame, point: Mapping[str, float], parameters: Mapping[str, Any]) -> Any:
    """e[i, mu] at a point."""
    shape = (frame.dimension, frame.dimension)
    return _matrix(frame.coframe.components.nonzero, shape, point, parameters)


def _matrix(
    entries: Entries,
    shape: tuple[int, int],
    point: Mapping[str, float],
    parameters: Mapping[str, Any],
) -> Any:
    """An array of a sparse matrix of elements at a point."""
    import numpy as np

    values = dict(point) | {key: float(value) for key, value in parameters.items()}
    numbers = evaluated([((value, ()),) for value in entries.values()], values)
    matrix = np.zeros(shape)
    for index, number in zip(entries, numbers, strict=True):
        matrix[index] = number
    return matrix
