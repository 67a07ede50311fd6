"""Member starts: starts of many curves, checked once and laid out for an ensemble."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geomtorsion import checks
from geomtorsion.curves import readout
from geomtorsion.errors import ShapeError, StartError
from geomtorsion.ode.members import Members

if TYPE_CHECKING:
    from geomtorsion.curves.problem import CurveProblem


def start_lists(
    problem: CurveProblem, starts: object, velocities: object, frame_velocities: object
) -> tuple[np.ndarray | None, np.ndarray]:
    """Coordinates (or None) and frame velocities, both with one row per motion."""
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
    if "velocities" not in arrays:
        own = np.tile([float(x) for x in problem.frame_velocity], (number, 1))
        return place, arrays.get("frame_velocities", own)
    if place is None:
        raise StartError("velocities need coordinates; give frame_velocities.")
    chart = problem.atlas.chart(problem.atlas.home)
    point = dict(zip(chart.names, place.T, strict=True))
    numbers = {key: float(value) for key, value in problem.parameters.items()}
    return place, chart.coframe.applied(point | numbers, arrays["velocities"].T).T


def _rows(values: object, n: int, what: str) -> np.ndarray:
    """An array of shape (number, n) of finite numbers."""
    array = checks.array(
        values,
        what,
        StartError,
        shape=(None, n),
        shape_error=ShapeError,
        message=f"{{subject}}: rows of {n} numbers were needed.",
        shaped=f"{{subject}}: shape (number, {n}) was needed, {{came}} came.",
        infinite="{subject}{place} = {value} is not finite.",
    )
    if not len(array):
        raise ShapeError(f"{what}: shape (number, {n}) was needed, {array.shape} came.")
    return array


def laid_out(problem: CurveProblem, place: np.ndarray | None, velocities: np.ndarray) -> Members:
    """Members in the chart of preference, each with a time unit of its own."""
    if problem.carried is not None:
        raise StartError("ensembles carry no vectors along; solve such problems one by one.")
    sizes = np.abs(velocities).max(axis=1)
    units = np.where(sizes > 0, 2.0 ** np.round(np.log2(np.where(sizes > 0, sizes, 1))), 1.0)
    scaled = velocities / units[:, None]
    varied = {"frame_velocity": velocities}
    if place is not None:
        varied["start"] = place
    label = problem.charts[0] if place is not None else ""
    if place is not None and label != problem.atlas.home:
        place, scaled = readout.converted(problem, problem.atlas.home, label, place, scaled)
    equations = problem.equations(label)
    varied["own_velocity"] = scaled * units[:, None]
    parts = [part for part in (place, scaled if equations.moves else None) if part is not None]
    table: dict[str, float | np.ndarray] = {}
    for numbers in (problem.parameters, equations.constants):
        table |= {name: float(value) for name, value in numbers.items()}
    if not equations.moves:
        table |= dict(zip(equations.velocities, scaled.T, strict=True))
    number = len(scaled)
    columns = [np.broadcast_to(table[name], number) for name in equations.parameters]
    parameters = np.array(columns).T if columns else np.zeros((number, 0))
    several = len(problem.charts) > 1
    return Members(
        equations.system if several else equations.system.to_the_end,
        equations.groups,
        np.concatenate(parts, axis=1),
        parameters,
        units,
        np.abs(velocities).sum(axis=1),
        parts=equations.parts if equations.reductions else None,
        label=label,
        varied=varied,
    )
