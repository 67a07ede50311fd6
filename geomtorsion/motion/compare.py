"""Compare: how far apart two journeys of the same motion are, block by block."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from geomtorsion.motion.crossing import moved_over

if TYPE_CHECKING:
    from geomtorsion.motion.journey import Journey


def difference(one: Journey, two: Journey) -> tuple[float, int]:
    """Largest difference relative to the size of each block, and the samples compared.

    Each block (coordinates, velocities, passengers) is measured in the maximum norm, over all
    samples, in the chart in which the first journey went, from where it entered that chart.
    """
    import numpy as np

    count = min(one.count, two.count)
    if count == 0:
        return float("inf"), 0
    worst = 0.0
    for first, second, blocks, start in _begun(one, two, count):
        second = _alike(first, second)
        largest = np.maximum.reduce
        gaps = largest(np.abs(first - second)).tolist()
        sizes = np.maximum(largest(np.abs(first)), np.abs(start)).tolist()
        for block in blocks:
            index = slice(block[0], block[-1] + 1)
            gap, size = float(max(gaps[index])), float(max(sizes[index]))
            # A gap that is no number need not come out as the largest.
            if not float(sum(gaps[index])) < float("inf"):
                return float("inf"), count
            if gap > 0:
                worst = max(worst, gap / size if size > 0 else float("inf"))
    return worst, count


def _alike(first: Any, second: Any) -> Any:
    """The second array in the kind of the first, where NumPy cannot mix the two."""
    import numpy as np

    if first.dtype == second.dtype or first.dtype != np.longdouble or second.dtype == np.float64:
        return second
    rows = [[np.longdouble(str(x)) for x in row] for row in second]
    return np.array(rows, dtype=np.longdouble)


def pairs(one: Journey, two: Journey, count: int) -> list[tuple[Any, Any, Any]]:
    """Sample arrays of both, chart by chart of the first, with the blocks."""
    return [(first, second, blocks) for first, second, blocks, _ in _begun(one, two, count)]


def _begun(one: Journey, two: Journey, count: int) -> list[tuple[Any, Any, Any, Any]]:
    """The same, with the state at which each chart was entered."""
    import numpy as np

    if len(one.segments) == len(two.segments) == 1:
        segment = one.segments[0]
        other = two.segments[0].states
        if segment.chart == two.segments[0].chart:
            states, blocks = segment.states[:count], segment.equations.system.blocks
            return [(states, other[:count], blocks, segment.run.states[0])]
    found, place = [], 0
    rows = list(_rows(two))
    for segment in one.segments:
        states = segment.states[: max(count - place, 0)]
        if not len(states):
            continue
        others = []
        for name, equations, row, parameters in rows[place : place + len(states)]:
            others.append(_converted(one, segment, name, equations, row, parameters))
        place += len(states)
        blocks = segment.equations.system.blocks
        found.append((states, np.array(others), blocks, segment.run.states[0]))
    return found


def _rows(journey: Journey) -> Any:
    """Samples of a journey one by one, with their chart."""
    for segment in journey.segments:
        for row in segment.states:
            yield segment.chart, segment.equations, row, segment.parameters


def _converted(one: Journey, segment: Any, name: str, equations: Any, row: Any, _: Any) -> Any:
    """A sample of another chart in the chart of a segment, angles near those there."""
    if name == segment.chart:
        return row
    width, n = equations.width, len(equations.velocities)
    values = list(row)
    moving = equations.moves
    velocities = values[width : width + n] if moving else [0.0] * n
    riders = values[width + n :] if moving else values[width:]
    state = (values[:width], velocities, riders)
    q, u, r = moved_over(one.problem, name, segment.chart, state, 53)
    return [*q, *(u if moving else []), *r]
