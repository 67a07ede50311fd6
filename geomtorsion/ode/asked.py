"""Asked: accuracy, times and engine as users give them, checked once."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from geomtorsion import checks
from geomtorsion.errors import AccuracyError, StartError, TimeError

# A motion is divided into so many parts where nobody says how many: samples of a solution that is
# asked for at one time only, pieces that are kept as it goes, places to look at its error between.
PARTS = 64


def checked_accuracy(accuracy: object) -> float:
    """A positive finite number."""
    value = checks.real(accuracy)
    if value is None:
        raise AccuracyError(f"accuracy = {checks.shown(accuracy)} is no number; 1e-10 is usual.")
    if not 0 < value < float("inf"):
        raise AccuracyError(f"accuracy = {value} was given; a positive number is needed.")
    return value


def checked_engine(engine: object) -> None:
    """Refuse what cannot run a motion, such as the name of an engine."""
    if engine is not None and (isinstance(engine, type) or not callable(getattr(engine, "run", 0))):
        raise StartError(
            f"engine = {checks.shown(engine)}: Taylor(), RungeKutta() or Stiff() was needed, or "
            "None, which chooses."
        )


@lru_cache(maxsize=64)
def _samples(last: float) -> np.ndarray:
    """Even samples up to a time; not to be written to."""
    grid = np.linspace(0.0, last, PARTS + 1) if last else np.zeros(1)
    grid.flags.writeable = False
    return grid


def checked_times(t: object) -> tuple[np.ndarray, np.ndarray]:
    """Times to report, and the grid from 0 through them."""
    single = checks.real(t)
    if single is not None:
        if not np.isfinite(single):
            raise TimeError(f"t contains {single}: all times must be finite.")
        return _samples(single), _samples(single)
    if isinstance(t, np.ndarray):
        # An array may show one number very often; it is looked at before it is copied.
        check_memory(t.size, 1)
    # A copy: what becomes of an array later is its owner's business.
    asked = np.array(
        checks.array(
            t,
            "t",
            TimeError,
            message="t = {value}: a number or a list of numbers was needed.",
            infinite=None,
        )
    )
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


def check_memory(times: int, states: int, members: int = 1) -> None:
    """Refuse more states than fit into memory, with those of the finer run beside them."""
    many = f"{members:,} members at " if members > 1 else ""
    checks.check_room(
        2 * times * states * members,
        f"t: {many}{times:,} times of {states} states",
        "Give fewer times, or solve in parts: each from where the one before ended.",
    )


def one_time_only(t: object, times: np.ndarray, grid: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The last time alone, where one was asked for: ensembles keep no samples on the way."""
    if checks.real(t) is not None and len(grid) > 1:
        return times[-1:], np.array([0.0, float(times[-1])])
    return times, grid
