"""Reading: coordinates, velocities and invariants off the segments of a journey."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from geomtorsion.errors import ChartEdgeError, TimeError
from geomtorsion.motion.crossing import moved_over, same_frame
from geomtorsion.motion.journey import Segment
from geomtorsion.motion.passengers import weights
from geomtorsion.motion.reduced.runs import integrated
from geomtorsion.motion.system import evaluated

if TYPE_CHECKING:
    from geomtorsion.motion.problem import Problem
    from geomtorsion.motion.solution import Moment, Solution


def at_samples(solution: Solution) -> Moment:
    """Everything at the times of a solution."""
    pieces = [(segment, segment.states) for segment in solution.journey.segments]
    return _moment(solution, solution.times, [p for p in pieces if len(p[1])])


def at_times(solution: Solution, time: Any) -> Moment:
    """Everything at any times, by dense output that is computed on first use."""
    import numpy as np

    asked = np.asarray(time, dtype=float)
    flat = np.atleast_1d(asked).ravel()
    pieces = dense_pieces(solution, flat)
    order = np.concatenate([index for _, _, index in pieces])
    moment = _moment(solution, flat, [(segment, states) for segment, states, _ in pieces])
    back = np.argsort(order)
    shape = asked.shape

    def sorted_back(values: Any) -> Any:
        return values[back].reshape((*shape, values.shape[-1]))

    return type(moment)(
        asked if shape else float(asked),
        sorted_back(moment.coordinates),
        sorted_back(moment.velocity),
        sorted_back(moment.frame_velocity),
        sorted_back(moment.passengers),
    )


def dense_pieces(solution: Solution, times: Any) -> list[tuple[Segment, Any, Any]]:
    """For each segment the states at those times that lie in it, and their places."""
    import numpy as np

    journey, speed = solution.journey, solution.problem.speed
    scaled = times * speed
    sign = -1.0 if float(solution.times[-1]) < 0 else 1.0
    end = sign * journey.reached
    bad = ~(np.isfinite(scaled) & (sign * scaled >= 0) & (sign * scaled <= end * (1 + 1e-15)))
    if bad.any():
        raise TimeError(
            f"t = {times[bad][0]:.6g} lies outside of the solution, which runs from 0 to "
            f"{sign * end / speed:.6g}. Solve to a later time, or ask within."
        )
    found = []
    begins = [sign * segment.begin for segment in journey.segments]
    place = np.clip(np.searchsorted(begins, sign * scaled, "right") - 1, 0, None)
    for k, segment in enumerate(journey.segments):
        index = np.flatnonzero(place == k)
        if len(index):
            states = np.asarray(_dense(solution, k)(scaled[index]))
            found.append((segment, states, index))
    return found


def _dense(solution: Solution, k: int) -> Any:
    """Dense output of one segment: the same integration again, keeping every step."""
    import numpy as np

    kept = solution.__dict__.setdefault("_dense", {})
    if k not in kept:
        journey, segment = solution.journey, solution.journey.segments[k]
        system = segment.equations.system.without_edge
        ends = np.array([segment.begin, float(segment.run.reached)])
        if ends[0] == ends[1]:
            last = np.asarray(segment.run.last)
            kept[k] = lambda t: np.broadcast_to(last, (len(t), len(last)))
        else:
            start, equations = (segment.start, segment.parameters), segment.equations
            run = integrated(
                journey.engine, equations, system, *start, ends, journey.tolerance, dense=True
            )
            kept[k] = run.dense
    return kept[k]


def _moment(solution: Solution, times: Any, pieces: list[tuple[Segment, Any]]) -> Moment:
    """Segments' states as coordinates and velocities in the chart of the problem."""
    import numpy as np

    from geomtorsion.motion.solution import Moment

    problem, bits = solution.problem, solution.journey.engine.precision
    parts = [home(problem, segment, states, bits) for segment, states in pieces]
    q, v, u, w = (np.concatenate(values) for values in zip(*parts, strict=True))
    return Moment(times, q, v, u, w)


def home(problem: Problem, segment: Segment, states: Any, bits: int) -> tuple[Any, Any, Any, Any]:
    """(q, q', u, passengers) of one segment in the home chart and frame."""
    import numpy as np

    equations, n = segment.equations, problem.frame.dimension
    width = equations.width
    speed = problem.speed
    if equations.moves:
        u = multiplied(states[:, width : width + n], speed)
        riders = states[:, width + n :].copy()
    else:
        table = dict(zip(equations.system.parameters, segment.parameters, strict=True))
        constant = [table[name] for name in equations.velocities]
        values = np.array([float(x) for x in constant])
        u = np.tile(values * speed, (len(states), 1))
        riders = states[:, width:].copy()
    for k, weight in enumerate(weights(problem)):
        if weight:
            riders[:, k] = multiplied(riders[:, k], speed)
    if not width:
        empty = np.empty((len(states), 0))
        return empty, empty, u, riders
    target = problem.atlas.home
    if segment.chart == target:
        q = states[:, :width]
    else:
        q, u = converted(problem, segment.chart, target, states[:, :width], u, bits)
    return q, velocities(problem, q, u), u, riders


def converted(
    problem: Problem, source: str, target: str, q: Any, u: Any, bits: int = 53
) -> tuple[Any, Any]:
    """Coordinates and frame velocities of many points in another chart.

    Above 53 bits the coordinates are mpmath numbers where the charts share the frame.
    """
    import numpy as np

    if bits > 53 and same_frame(problem, source, target):
        rows = q
        for change in problem.route(source, target):
            rows = [change.precisely(row, problem.parameters, bits) for row in rows]
        return _turned(problem, source, target, np.array(rows, dtype=object)), u
    q, u = np.asarray(q, dtype=float), np.asarray(u, dtype=float)
    if not same_frame(problem, source, target):
        rows = [
            moved_over(problem, source, target, (list(a), list(b), []), 53)
            for a, b in zip(q, u, strict=True)
        ]
        there, turned = np.array([row[0] for row in rows]), np.array([row[1] for row in rows])
    else:
        numbers = {key: float(value) for key, value in problem.parameters.items()}
        there, turned = q.T, u
        for change in problem.route(source, target):
            there = change(there, numbers)
        there = np.asarray(there).T
    if not np.isfinite(there).all():
        bad = int(np.argmin(np.isfinite(there).all(axis=1)))
        place = ", ".join(f"{x:.6g}" for x in q[bad])
        raise ChartEdgeError(
            f"the motion passes ({place}) of chart {source!r}, where chart {target!r} does not "
            f"reach. Use solution.in_chart({source!r})."
        )
    return _turned(problem, source, target, there), turned


def _turned(problem: Problem, source: str, target: str, q: Any) -> Any:
    """Angles of the home chart shifted to within half a turn of the start."""
    import mpmath
    import numpy as np

    route = problem.route(source, target)
    if target != problem.atlas.home or problem.start is None or not route:
        return q
    q = q.copy()
    for k in route[-1].angles:
        centre = float(problem.start[k])
        turns = np.round((q[:, k].astype(float) - centre) / (2 * np.pi))
        if q.dtype != object:
            q[:, k] -= 2 * np.pi * turns
            continue
        with mpmath.workprec(1000):
            q[:, k] = [
                x - 2 * mpmath.pi * int(turn) for x, turn in zip(q[:, k], turns, strict=True)
            ]
    return q


def multiplied(values: Any, factor: float) -> Any:
    """Values of any precision times a power of two, at their own precision."""
    import numpy as np

    if factor == 1.0:
        return values.copy()
    if values.dtype.type in (np.float64, np.longdouble):
        return values * factor
    return values * np.full(values.shape, values.dtype.type(factor), dtype=values.dtype)


def velocities(problem: Problem, q: Any, u: Any) -> Any:
    """q'^mu = E_i^mu u^i at many points of the home chart."""
    import numpy as np

    chart = problem.atlas.chart(problem.atlas.home)
    names = [f"\x00u{k}" for k in range(problem.frame.dimension)]
    values: dict[str, Any] = dict(zip(chart.names, np.asarray(q, float).T, strict=True))
    values |= {key: float(value) for key, value in problem.parameters.items()}
    values |= dict(zip(names, np.asarray(u, float).T, strict=True))
    rows = [tuple((value, (names[i],)) for i, value in row) for row in chart.legs]
    with np.errstate(all="ignore"):
        found = [np.broadcast_to(x, len(q)) for x in evaluated(rows, values)]
    return np.array(found).T


def in_chart(solution: Solution, name: str) -> Any:
    """Coordinates of all samples in a chart."""
    import numpy as np

    problem, found = solution.problem, []
    for segment in solution.journey.segments:
        if len(segment.states):
            q, _, u, _ = _own(problem, segment)
            if segment.chart != name:
                q, u = converted(problem, segment.chart, name, q, u)
            found.append(q)
    return np.concatenate(found)


def _own(problem: Problem, segment: Segment) -> tuple[Any, Any, Any, Any]:
    """Coordinates and scaled velocities of a segment in its own chart."""
    import numpy as np

    width, n = segment.equations.width, problem.frame.dimension
    states = segment.states
    if segment.equations.moves:
        return (
            states[:, :width],
            None,
            multiplied(states[:, width : width + n], problem.speed),
            None,
        )
    return states[:, :width], None, np.zeros((len(states), n)), None
