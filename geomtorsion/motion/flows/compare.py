"""Compare: how far apart two trips of the same flow are, block by block."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from geomtorsion.motion.flows.adjust import unit_rows
from geomtorsion.motion.flows.reading import arguments

if TYPE_CHECKING:
    from geomtorsion.motion.flows.travel import Trip

# A state is nothing but rounding if it is less than this many roundings of its rate's terms.
NOISE = 100.0


def difference(one: Trip, two: Trip) -> tuple[float, int]:
    """Largest difference of two trips, relative to the size of each block; samples compared.

    Where both were stopped, by when and where that was.
    """
    import numpy as np

    flow = one.flow
    count = min(one.count, two.count)
    if not count or (one.outcome != two.outcome and "stopped" in (one.outcome, two.outcome)):
        return math.inf, 0
    first, second = _rows(one, count), _rows(two, count)
    worst = 0.0
    if one.outcome == two.outcome == "stopped":
        gap = abs(float(one.pieces[-1].run.reached - two.pieces[-1].run.reached))
        worst = gap / abs(one.reached) if gap else 0.0
    gaps = np.abs(first - second).max(axis=0)
    if not np.isfinite(gaps).all():
        return math.inf, count
    sizes = np.maximum(np.abs(first).max(axis=0), np.abs(flow.start_floats))
    for block in flow.system.blocks:
        index = [k for k in block if k < flow.size]
        gap = float(gaps[index].max()) if index else 0.0
        if gap > 0:
            size = float(sizes[index].max())
            part = gap / size if size > 0 else math.inf
            if part > worst and is_noise(one, index, part, size):
                continue
            worst = max(worst, part)
    return worst, count


def is_noise(trip: Trip, index: Sequence[int], part: float, size: float) -> bool:
    """Whether states that differ by a part of their size are nothing but rounding.

    Rounding the terms of their rates may have made them, where they should vanish.
    """
    import numpy as np

    if part <= 1 / NOISE:
        return False
    flow = trip.flow
    times = np.concatenate([np.asarray(piece.times, dtype=float) for piece in trip.pieces])
    rows = np.asarray(trip.states, dtype=float)
    terms = flow.rate_tape.sizes(arguments(flow, times, rows))
    largest = max(float(np.max(terms[k])) for k in index)
    return size <= NOISE * 2.0**-trip.engine.precision * largest * abs(float(times[-1]))


def _rows(trip: Trip, count: int) -> Any:
    """Samples of a trip, and where it was stopped."""
    import numpy as np

    states = np.asarray(trip.states)[:count]
    if trip.outcome == "stopped":
        last = np.asarray(trip.pieces[-1].run.last)[None, : trip.flow.size]
        states = np.concatenate((states, last))
    return unit_rows(trip.flow, states) if trip.engine.precision <= 64 else states
