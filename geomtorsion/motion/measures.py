"""Measures: drifts of invariants, distances and tables of solutions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from geomtorsion.motion.crossing import coframe_at
from geomtorsion.motion.reading import converted, in_chart
from geomtorsion.motion.system import evaluated

if TYPE_CHECKING:
    from geomtorsion.motion.problem import Problem
    from geomtorsion.motion.solution import Solution


def drifts(solution: Solution) -> dict[str, float]:
    """Largest relative change of each invariant, chart by chart."""
    import numpy as np

    found: dict[str, float] = {}
    for segment in solution.journey.segments:
        states = np.asarray(segment.states, dtype=float)
        equations = segment.equations
        if not len(states):
            continue
        start = np.array([[float(x) for x in segment.start]])
        states = np.concatenate((start, states))
        values: dict[str, Any] = dict(zip(equations.system.states, states.T, strict=True))
        numbers = [float(x) for x in segment.parameters]
        values |= dict(zip(equations.system.parameters, numbers, strict=True))
        sizes = dict(values) | _block_sizes(equations, states)
        for name, products in equations.invariants.items():
            total = np.broadcast_to(evaluated([products], values)[0], len(states))
            size = sum(
                np.abs(evaluated([((element, ()),)], values)[0])
                * np.prod([np.abs(sizes[factor]).max() for factor in factors])
                for element, factors in products
            )
            change = float(np.abs(total - total[0]).max())
            size = float(np.max(size))
            found[name] = max(found.get(name, 0.0), change / size if size else change)
    return found


def _block_sizes(equations: Any, states: Any) -> dict[str, Any]:
    """For each velocity the size of all of them, so that a vanishing momentum has a scale."""
    import numpy as np

    if not equations.moves:
        return {}
    first, n = equations.width, len(equations.velocities)
    size = np.abs(states[:, first : first + n]).max()
    return dict.fromkeys(equations.velocities, size)


def columns(solution: Solution) -> dict[str, Any]:
    """Named columns for tables."""
    problem = solution.problem
    table: dict[str, Any] = {"t": solution.times}
    names = problem.coordinates if problem.start is not None else ()
    for k, name in enumerate(names):
        table[name] = solution.coordinates[:, k]
    for k, name in enumerate(names):
        table[f"{name}'"] = solution.velocity[:, k]
    equations = solution.journey.segments[0].equations
    for k, name in enumerate(equations.velocities):
        table[name] = solution.frame_velocity[:, k]
    for k, name in enumerate(equations.passengers):
        table[name] = solution.passengers[:, k]
    return table


def gaps(one: Solution, two: Solution, chart: str | None) -> Any:
    """Lengths of the differences of coordinates at the times of the first solution."""
    import numpy as np

    problem = one.problem
    name = chart or problem.atlas.home
    first = in_chart(one, name).astype(float)
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
        lengths.append(np.linalg.norm(coframe_at(place.frame, point, problem.parameters) @ step))
    return np.array(lengths)


def _angles(problem: Problem, chart: str) -> tuple[int, ...]:
    """Coordinates of a chart that count modulo 2 pi, as far as a map into it says so."""
    for other in problem.atlas.names:
        if other != chart:
            route = problem.route(other, chart)
            if route:
                return route[-1].angles
    return ()
