"""Disturbed: runs whose states are moved on the way, to show how rounding grows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from geomtorsion.motion.engines.protocol import Engine, Run
from geomtorsion.motion.equations import Equations
from geomtorsion.motion.reduced.runs import integrated
from geomtorsion.motion.system import System, mpf


def interrupted(
    engine: Engine,
    law: tuple[Equations, System],
    start: tuple[Sequence[Any], Sequence[Any]],
    times: Any,
    tolerance: float,
    moved: float,
    at: int,
) -> Run:
    """One run whose state is moved at a sample on the way."""
    import numpy as np

    (equations, system), (vector, parameters) = law, start
    one = integrated(engine, equations, system, vector, parameters, times[: at + 1], tolerance)
    if one.outcome != "done":
        return one
    middle = moved_start(equations, one.last, moved, engine.precision)
    two = integrated(engine, equations, system, middle, parameters, times[at:], tolerance)
    return replace(
        two,
        times=np.concatenate((one.times, two.times[1:])),
        states=np.concatenate((one.states, two.states[1:])),
        steps=one.steps + two.steps,
        evaluations=one.evaluations + two.evaluations,
        compile_seconds=one.compile_seconds + two.compile_seconds,
        run_seconds=one.run_seconds + two.run_seconds,
    )


def moved_start(equations: Equations, vector: Sequence[Any], part: float, precision: int) -> Any:
    """States moved a little, up and down by turns; what is exactly zero stays so.

    Frame velocities are moved by a part of the largest of them, as each is a sum of products with
    the others; coordinates, which may be of any sizes, by a part of their own.
    """
    import numpy as np

    floats = np.array([float(x) for x in vector]) if precision != 53 else np.asarray(vector, float)
    sizes = steps_of(equations, floats) * part
    if precision == 53:
        return floats + sizes
    return tuple(_sum(x, float(step), precision) for x, step in zip(vector, sizes, strict=True))


def steps_of(equations: Equations, floats: Any) -> Any:
    """The steps by which states are moved, for a part of one."""
    import numpy as np

    sizes = np.abs(floats)
    if equations.moves:
        own = sizes[equations.width : equations.width + len(equations.velocities)]
        own[own > 0] = own.max()
    sizes[::2] *= -1.0
    return sizes


def _sum(value: Any, step: float, precision: int) -> Any:
    """A number and a small step at more than double precision."""
    import mpmath

    with mpmath.workprec(precision + 20):
        return mpf(value, precision + 20) + mpmath.mpf(step)


def busiest(samples: Any, blocks: Sequence[Sequence[int]]) -> int:
    """The first sample at which much happens: what is rounded there is not undone.

    Near an equilibrium, where motions linger, a small step of the state changes next to nothing.
    """
    import numpy as np

    states = np.asarray(samples, dtype=float)
    if len(states) < 3:
        return 0
    steps = np.abs(states[1:] - states[:-1])
    best, place = -1.0, 0
    for block in blocks:
        changes = np.add.reduce(steps[:, block[0] : block[-1] + 1], 1)
        largest, total = float(changes.max()), float(np.add.reduce(changes))
        # The block that moves by fits and starts, if there is one.
        if total > 0 and largest / total > best:
            best, place = largest / total, int((changes >= 0.5 * largest).argmax()) + 1
    return place
