"""Measure: area, length and winding of loops, from the loop alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.errors import LoopError
from geomtorsion.loops import intake
from geomtorsion.loops.quadrature import integrate

if TYPE_CHECKING:
    from geomtorsion.loops.loop import Loop


def area(loop: Loop) -> np.ndarray:
    """A^{mn}, shape (n, n); see Loop.area."""

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

    total = 0.0
    for part in loop.parts:
        found = integrate(part.sides, lambda x, v: np.sqrt((v * v).sum(axis=0))[None], 1e-10)
        total += abs(part.times) * part.size * float(found.value[0])
    return total


def winding(loop: Loop, axis: Sequence[float], plane: Any) -> int:
    """Turns round an axis; see Loop.winding."""

    from geomtorsion.loops.turning import turns_round

    place = intake.vector(axis, "axis", loop.dimension)
    rows = np.array(intake.rows(plane, loop.dimension))
    return turns_round(loop, place, rows, "axis", LoopError)
