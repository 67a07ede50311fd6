"""Lists: starts of many motions, checked once at the door."""

from __future__ import annotations

from typing import Any

from geomtorsion.errors import ShapeError, StartError
from geomtorsion.motion.problem import Problem
from geomtorsion.motion.system import evaluated


def start_lists(problem: Problem, starts: Any, velocities: Any, frame_velocities: Any) -> Any:
    """Coordinates (or None) and frame velocities, both with one row per motion."""
    import numpy as np

    n = problem.frame.dimension
    given = {"starts": starts, "velocities": velocities, "frame_velocities": frame_velocities}
    if velocities is not None and frame_velocities is not None:
        raise StartError("velocities and frame_velocities were both given; give one of them.")
    arrays = {key: _rows(value, n, key) for key, value in given.items() if value is not None}
    if not arrays:
        raise StartError("give starts, velocities or frame_velocities: one row per motion.")
    counts = {key: len(value) for key, value in arrays.items()}
    if len(set(counts.values())) > 1:
        raise ShapeError(f"lists of different length came: {counts}. Give one row per motion.")
    number = next(iter(counts.values()))
    place = arrays.get("starts")
    if problem.start is None and place is not None:
        raise StartError("the problem follows velocities alone; make it with a start.")
    if place is None and problem.start is not None:
        place = np.tile([float(x) for x in problem.start], (number, 1))
    if "velocities" in arrays:
        if place is None:
            raise StartError("velocities need coordinates; give frame_velocities.")
        speed = _in_frame(problem, place, arrays["velocities"])
    else:
        own = np.tile([float(x) for x in problem.frame_velocity], (number, 1))
        speed = arrays.get("frame_velocities", own)
    return place, speed


def _rows(values: Any, n: int, what: str) -> Any:
    """An array of shape (number, n) of finite numbers."""
    import numpy as np

    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise ShapeError(f"{what}: rows of {n} numbers were needed.") from None
    if array.ndim != 2 or array.shape[1] != n or not len(array):
        raise ShapeError(f"{what}: shape (number, {n}) was needed, {array.shape} came.")
    if not np.isfinite(array).all():
        row, column = (int(k) for k in np.argwhere(~np.isfinite(array))[0])
        raise StartError(f"{what}[{row}, {column}] = {array[row, column]} is not finite.")
    return array


def _in_frame(problem: Problem, place: Any, rates: Any) -> Any:
    """u^i = e^i_mu q'^mu for many points."""
    import numpy as np

    values: dict[str, Any] = dict(zip(problem.coordinates, place.T, strict=True))
    values |= {key: float(value) for key, value in problem.parameters.items()}
    result = np.zeros(place.shape)
    for (i, mu), value in problem.frame.coframe.components.nonzero.items():
        result[:, i] += evaluated([((value, ()),)], values)[0] * rates[:, mu]
    return result
