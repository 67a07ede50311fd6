"""Drifts: how far the known invariants of a scene have changed, at each time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.motion.flows import reading

if TYPE_CHECKING:
    from geomtorsion.scenes.result import SceneResult


def states_of(result: SceneResult) -> np.ndarray | None:
    """States of the flow at the times of a result, shape (m, size); None if it was loaded."""
    if result.form is not None:
        return np.asarray(result.form.states(result.times), dtype=float)
    if result.solved is not None:
        return np.asarray(result.solved.states, dtype=float)
    return None


def drifts_over_time(result: SceneResult) -> dict[str, np.ndarray]:
    """Change of each invariant since the start (since the last switch), relative to its terms.

    The largest value of each is the one in `SceneResult.drift`; a result from a file has none.

    Examples
    --------
    >>> from geomtorsion.scenes import load
    >>> result = load("lagrange_cusp").run()
    >>> drifts = drifts_over_time(result)
    >>> all(float(drifts[name].max()) == result.drift[name] for name in result.drift)
    True
    """
    states = states_of(result)
    if states is None or result.scene is None:
        return {}
    flow, times = result.scene.flow, result.times
    values = reading.arguments(flow, times, states)
    skip = sum(max(parts, 1) for _, parts in flow.shapes(flow.outputs))
    rows = [np.broadcast_to(x, len(times)) for x in flow.tape.arrays(values)[skip:]]
    sizes = [np.broadcast_to(x, len(times)) for x in flow.tape.sizes(values)[skip:]]
    marks = [at for at, _ in flow.switches]
    leg = np.searchsorted(marks, times, "right") if marks else np.zeros(len(times), dtype=int)
    first = np.searchsorted(leg, leg)
    place, table = 0, {}
    for name, parts in flow.shapes(flow.invariants):
        count = max(parts, 1)
        total = np.array(rows[place : place + count])
        size = float(np.abs(np.array(sizes[place : place + count])).max())
        change = np.abs(total - total[:, first]).max(axis=0)
        table[name] = change / size if size else change
        place += count
    return table
