"""Last place: where a Taylor run that ended in no numbers was still right."""

from __future__ import annotations

from collections import deque
from typing import Any

# Steps before the end that are looked at.
LOOKED_AT = 100_000
# A step that leads back to within this part of where it came from was a good one.
CLOSE = 1e-6
# Steps that the way back of one step may take.
WAY_BACK = 100


def last_regular(integrator: Any, begin: Any, start: Any, end: Any, steps: int) -> tuple[Any, Any]:
    """Time and state before the first step that cannot be taken back.

    A step over a singularity may give finite numbers, from which the series goes on for a while
    before it fails; but the way back over the singularity does not lead to where it came from.
    steps: how many were taken in all.
    """
    import numpy as np

    trail = deque([(begin, start)], maxlen=LOOKED_AT)

    def noted(at: Any) -> bool:
        trail.append((at.time, at.state.copy()))
        return True

    _placed(integrator, begin, start)
    integrator.propagate_until(end, callback=noted, max_steps=steps)
    good = trail.popleft()
    for time, state in trail:
        if not (np.isfinite(float(time)) and np.isfinite(state.astype(float)).all()):
            break
        _placed(integrator, time, state)
        integrator.propagate_until(good[0], max_steps=WAY_BACK)
        gap = np.abs((integrator.state - good[1]).astype(float)).max()
        if not gap <= CLOSE * np.abs(good[1].astype(float)).max():
            break
        good = time, state
    return good


def _placed(integrator: Any, time: Any, state: Any) -> None:
    """The integrator, set to a time and a state."""
    integrator.time = time
    integrator.state[:] = state
    if integrator.with_events:
        integrator.reset_cooldowns()
