"""Measure: area, length and winding of loops, from the loop alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import LoopError
from geomtorsion.loops import intake
from geomtorsion.loops.quadrature import integrate
from geomtorsion.loops.sides import Straight

if TYPE_CHECKING:
    import numpy as np

    from geomtorsion.loops.loop import Loop, Part

# Points per side at first when turns are counted, and how often they may be doubled.
FIRST_POINTS = 33
DOUBLINGS = 12
# A loop that comes this close to an axis, as share of its size, meets it.
TOUCHES = 1e-13


def area(loop: Loop) -> np.ndarray:
    """A^{mn}, shape (n, n); see Loop.area."""
    import numpy as np

    total = np.zeros((loop.dimension, loop.dimension))
    upper = np.triu_indices(loop.dimension, 1)
    for part in loop.parts:
        found = integrate(part.sides, lambda x, v: _wedge(x, v, upper) / 2, 1e-14)
        total[upper] += part.times * part.size * (part.size * found.value)
    return total - total.T


def _wedge(x: np.ndarray, v: np.ndarray, upper: Any) -> np.ndarray:
    """x^m v^n - x^n v^m for m < n."""
    return x[upper[0]] * v[upper[1]] - x[upper[1]] * v[upper[0]]


def length(loop: Loop) -> float:
    """Length in the Euclidean sense; see Loop.length."""
    import numpy as np

    total = 0.0
    for part in loop.parts:
        found = integrate(part.sides, lambda x, v: np.sqrt((v * v).sum(axis=0))[None], 1e-10)
        total += abs(part.times) * part.size * float(found.value[0])
    return total


def winding(loop: Loop, axis: Sequence[float], plane: Any) -> int:
    """Turns round an axis; see Loop.winding."""
    import numpy as np

    place = np.array(intake.vector(axis, "axis", loop.dimension))
    rows = np.array(intake.rows(plane, loop.dimension))
    turns = 0
    for part in loop.parts:
        offset = rows @ ((np.array(part.centre) - place) / part.size)
        angle = sum(_turned(side, rows, offset, part) for side in part.sides)
        turns += part.times * round(angle / (2 * np.pi))
    return turns


def _turned(side: Any, rows: np.ndarray, offset: np.ndarray, part: Part) -> float:
    """The angle by which one side turns round the axis."""
    import numpy as np

    points = 2 if isinstance(side, Straight) else max(FIRST_POINTS, 8 * side.waves + 1)
    place = 0.0
    for _ in range(DOUBLINGS):
        s = np.linspace(0, 1, points)
        x, y = rows @ side.shape(s)[0] + offset[:, None]
        steps_x, steps_y = np.diff(x), np.diff(y)
        angles = np.arctan2(x[:-1] * y[1:] - y[:-1] * x[1:], x[:-1] * x[1:] + y[:-1] * y[1:])
        # How near each chord comes to the axis.
        chord = np.hypot(steps_x, steps_y)
        ahead = -(x[:-1] * steps_x + y[:-1] * steps_y) / np.where(chord > 0, chord, 1) ** 2
        share = np.clip(np.where(chord > 0, ahead, 0), 0, 1)
        near = np.hypot(x[:-1] + share * steps_x, y[:-1] + share * steps_y)
        nearest = int(near.argmin())
        place = float(s[nearest] + share[nearest] * (s[1] - s[0]))
        if near[nearest] <= TOUCHES * max(1.0, float(np.abs(rows).max())):
            break
        if isinstance(side, Straight) or np.abs(angles).max() < np.pi / 4:
            return float(angles.sum())
        points = 2 * points - 1
    raise _meets(part, side, place)


def _meets(part: Part, side: Any, s: float) -> LoopError:
    """The error for a loop that goes through its axis."""
    from geomtorsion.loops.loop import shown

    place = shown(part.points(side, s)[0][:, 0])
    return LoopError(
        f"the loop meets the axis at {place}: it has no winding number round it. Move the loop "
        "or the axis."
    )
