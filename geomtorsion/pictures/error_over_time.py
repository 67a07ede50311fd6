"""error over time: how error estimate and invariants change along a solved motion."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.motion.compare import pairs
from geomtorsion.motion.system import evaluated

if TYPE_CHECKING:
    from geomtorsion.motion import Solution


def error_over_time(solution: Solution) -> np.ndarray | None:
    """Error estimate at each time, shape (m,): its largest value is `Solution.error`, if that is
    not the rounding of the engine. None if the solution came without a witness.

    Examples
    --------
    >>> from geomtorsion.motion import RungeKutta, geodesic, solve
    >>> from geomtorsion.spaces import load
    >>> p = geodesic(load("s2").frame, [1.0, 0.0], [0.0, 1.0], parameters={"R": 1})
    >>> sol = solve(p, 1.0, engine=RungeKutta())
    >>> bool(abs(error_over_time(sol).max() - sol.error) < 1e-16)
    True
    """
    if solution.witness is None:
        return None
    count = min(solution.journey.count, solution.witness.count)
    found = []
    for first, second, blocks in pairs(solution.journey, solution.witness, count):
        worst = np.zeros(len(first))
        for block in blocks:
            index = list(block)
            size = float(np.abs(first[:, index]).max())
            if index and size > 0:
                gap = np.abs(first[:, index] - second[:, index]).max(axis=1)
                worst = np.maximum(worst, gap.astype(float) / size)
        found.append(worst)
    return solution.share * np.concatenate(found)


def drift_over_time(solution: Solution) -> dict[str, np.ndarray]:
    """Change of each known invariant at each time, relative to the size of its terms.

    The largest value of each is the one in `Solution.drift`.

    Examples
    --------
    >>> from geomtorsion.motion import RungeKutta, geodesic, solve
    >>> from geomtorsion.spaces import load
    >>> p = geodesic(load("s2").frame, [1.0, 0.0], [0.0, 1.0], parameters={"R": 1})
    >>> sol = solve(p, 1.0, engine=RungeKutta()).drift
    >>> sorted(sol)
    ['momentum of phi', 'norm']
    """
    pieces: dict[str, list[Any]] = {}
    segments = [segment for segment in solution.journey.segments if len(segment.states)]
    for number, segment in enumerate(segments):
        for name, values in _segment_drifts(segment).items():
            before = pieces.setdefault(name, [])
            missing = sum(len(other.states) for other in segments[:number])
            if not before and missing:
                before.append(np.full(missing, np.nan))
            before.append(values)
    drifts = {name: np.concatenate(parts) for name, parts in pieces.items()}
    whole = sum(len(segment.states) for segment in segments)
    return {
        name: np.pad(x, (0, whole - len(x)), constant_values=np.nan) for name, x in drifts.items()
    }


def _segment_drifts(segment: Any) -> dict[str, Any]:
    """Drifts on one segment, against its own start."""
    equations = segment.equations
    begin = np.array([[float(x) for x in segment.start]])
    states = np.concatenate((begin, np.asarray(segment.states, dtype=float)))
    values: dict[str, Any] = dict(zip(equations.system.states, states.T, strict=True))
    numbers = [float(x) for x in segment.parameters]
    values |= dict(zip(equations.system.parameters, numbers, strict=True))
    scales = dict(values)
    if equations.moves:
        first, n = equations.width, len(equations.velocities)
        scales |= dict.fromkeys(equations.velocities, np.abs(states[:, first : first + n]).max())
    found = {}
    # On the edge of a chart an invariant may have no value: a gap in the line.
    with np.errstate(all="ignore"):
        for name, products in equations.invariants.items():
            total = np.broadcast_to(evaluated([products], values)[0], len(states))
            size = sum(
                np.abs(evaluated([((element, ()),)], values)[0])
                * np.prod([np.abs(scales[factor]).max() for factor in factors])
                for element, factors in products
            )
            change = np.abs(total - total[0])
            largest = float(np.max(size))
            found[name] = (change / largest if largest else change)[1:]
    return found
