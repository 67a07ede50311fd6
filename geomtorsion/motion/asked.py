"""Asked: accuracy and times as users give them, checked once at the door."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import AccuracyError, TimeError

if TYPE_CHECKING:
    import numpy as np

# Samples of a solution that is asked for at one time only.
SAMPLES = 65


def checked_accuracy(accuracy: Any) -> float:
    """A positive finite number."""
    try:
        value = float(accuracy)
    except (TypeError, ValueError):
        raise AccuracyError(f"accuracy = {accuracy!r} is no number; 1e-10 is usual.") from None
    if not (math.isfinite(value) and value > 0):
        raise AccuracyError(f"accuracy = {value} was given; a positive number is needed.")
    return value


@lru_cache(maxsize=64)
def _samples(last: float) -> np.ndarray:
    """Even samples up to a time; not to be written to."""
    import numpy as np

    grid = np.linspace(0.0, last, SAMPLES) if last else np.zeros(1)
    grid.flags.writeable = False
    return grid


def checked_times(t: Any) -> tuple[np.ndarray, np.ndarray]:
    """Times to report, and the grid from 0 through them."""
    import numpy as np

    if type(t) is float and math.isfinite(t):
        return _samples(t), _samples(t)
    try:
        # A copy: what becomes of an array later is its owner's business.
        asked = np.array(t, dtype=float)
    except (TypeError, ValueError):
        raise TimeError(f"t = {t!r}: a number or a list of numbers was needed.") from None
    if asked.size == 0 or asked.ndim > 1:
        raise TimeError(f"t has shape {asked.shape}: a number or a list of times was needed.")
    if not np.isfinite(asked).all():
        bad = asked if asked.ndim == 0 else asked[~np.isfinite(asked)][0]
        raise TimeError(f"t contains {bad}: all times must be finite.")
    if asked.ndim == 0:
        grid = _samples(float(asked))
        return grid, grid
    steps = np.diff(asked)
    if (steps == 0).any():
        k = int(np.flatnonzero(steps == 0)[0])
        raise TimeError(f"time {asked[k]:.6g} is repeated at [{k}] and [{k + 1}]. Give it once.")
    rising = asked[-1] > 0
    if not ((steps > 0).all() if rising else (steps < 0).all()):
        raise TimeError("times are not sorted. Sort them away from the start at t = 0.")
    if (asked[0] < 0) if rising else (asked[0] > 0):
        raise TimeError(
            f"times run from {asked[0]:.6g} to {asked[-1]:.6g}, but the motion starts at t = 0. "
            "Solve forwards and backwards apart."
        )
    if asked[0] != 0:
        return asked, np.concatenate(([0.0], asked))
    return asked, asked
