"""Across: members of a batch that leave the chart of the batch are followed one by one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import ChartEdgeError, GeomtorsionError
from geomtorsion.motion.compare import difference
from geomtorsion.motion.engines import Engine
from geomtorsion.motion.journey import Journey, travel
from geomtorsion.motion.many import Lanes, Show, run_lanes
from geomtorsion.motion.reading import home

if TYPE_CHECKING:
    import numpy as np


@dataclass(frozen=True, eq=False)
class Passage:
    """Many motions, most of them in one chart.

    states: shape (number, times, size), in the chart of the batch; zero for the others.
    finished: shape (number,), which reached the last time.
    journeys: number of a motion -> its journey, for those that went through other charts.
    interrupted: whether it was stopped by Ctrl-C; compile_seconds: what compilation took.
    """

    states: np.ndarray
    finished: np.ndarray
    journeys: Mapping[int, Journey] = field(default_factory=dict)
    interrupted: bool = False
    compile_seconds: float = 0.0


def passage(engine: Engine, lanes: Lanes, grid: Any, tolerance: float, show: Show) -> Passage:
    """Run all lanes in their chart; those that leave it, or stick in it, again with all charts."""
    import numpy as np

    crossed = np.zeros(len(lanes.states), dtype=bool)
    states, finished, interrupted, seconds = run_lanes(
        engine, lanes, grid, tolerance, show, crossed
    )
    journeys: dict[int, Journey] = {}
    states[crossed], finished[crossed] = 0.0, False
    if interrupted:
        return Passage(states, finished, journeys, True, seconds)
    try:
        for k in np.flatnonzero(~finished).tolist():
            try:
                journey = travel(_member(lanes, k), engine, tolerance, grid * lanes.speeds[k])
            except GeomtorsionError:
                continue
            seconds += journey.compile_seconds
            if journey.outcome == "done":
                finished[k] = True
                if [segment.chart for segment in journey.segments] == [lanes.chart]:
                    states[k] = journey.segments[0].states
                else:
                    journeys[k] = journey
    except KeyboardInterrupt:
        interrupted = True
    return Passage(states, finished, journeys, interrupted, seconds)


def _member(lanes: Lanes, k: int) -> Any:
    """One motion of a batch as a problem."""
    place = None if lanes.place is None else tuple(lanes.place[k].tolist())
    return replace(
        lanes.problem,
        start=place,
        frame_velocity=tuple((lanes.own_velocities[k] * lanes.speeds[k]).tolist()),
    )


def apart(lanes: Lanes, one: Passage, two: Passage) -> tuple[float, int]:
    """Largest relative difference of two passages of the same lanes, and how many were compared."""
    import numpy as np

    both = one.finished & two.finished
    single = np.array([k in one.journeys or k in two.journeys for k in range(len(both))], bool)
    together = both & ~single
    worst = 0.0
    first, second = one.states[together], two.states[together]
    for block in lanes.equations.system.blocks if len(first) else ():
        index = slice(block[0], block[-1] + 1)
        size = np.abs(first[..., index]).max(axis=(1, 2))
        gap = np.abs(first[..., index] - second[..., index]).max(axis=(1, 2))
        ratio = gap / np.where(size > 0, size, 1.0)
        worst = max(worst, float(ratio.max()))
    compared = int(together.sum())
    for k in np.flatnonzero(both & single).tolist():
        if k in one.journeys and k in two.journeys:
            gap, count = difference(one.journeys[k], two.journeys[k])
            worst, compared = max(worst, gap), compared + bool(count)
    return worst, compared


def at_home(journey: Journey, skip: int) -> tuple[Any, Any] | None:
    """q and u in the home chart, shapes (m, n), less some first samples; None out of its reach."""
    import numpy as np

    problem = journey.problem
    try:
        parts = [
            home(problem, segment, segment.states, 53)
            for segment in journey.segments
            if len(segment.states)
        ]
    except ChartEdgeError:
        return None
    q, _, u, _ = (np.concatenate(values) for values in zip(*parts, strict=True))
    return q[skip:], u[skip:]
