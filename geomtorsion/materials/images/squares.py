"""Squares: windings of phases around all square circuits of one size, by sums along lines."""

from __future__ import annotations

import numpy as np

from geomtorsion.materials.detours import Passages
from geomtorsion.materials.images.circuits import expected_clicks
from geomtorsion.materials.rings import Edges, Rings
from geomtorsion.materials.windows import Windows


def whole_turns(phase: np.ndarray) -> Edges:
    """Whole turns of phases along the steps in x and in y; their sum around a circuit is b."""
    one, two = (
        -np.rint(np.diff(phase, axis=axis) / (2 * np.pi)).astype(np.int64) for axis in (1, 2)
    )
    return one, two


def rings_of(phase: np.ndarray, holes: np.ndarray) -> Rings:
    """Rings around holes without a Burgers vector, around which all circuits may go."""
    rings = Rings.of(holes)
    if not rings.count:
        return rings
    windings = rings.totals_of(rings.steps_of(whole_turns(phase)))
    return rings.only(np.logical_not(np.asarray(windings.any(axis=0))))


def squares_of(
    phase: np.ndarray, ratio: np.ndarray, rings: Rings, blur: float, size: int
) -> tuple[np.ndarray, Passages, np.ndarray]:
    """Windings of phases around all squares, their passages of holes, and expected clicks.

    The cost does not depend on the size, because sums along lines are shared. phase: phase[i, x,
    y]. ratio: the amplitude in units of its noise.
    """
    passages = Passages(rings, Windows((0, 1), (size, size), (False, False)))
    lines, turns = passages.windows, whole_turns(phase)
    clicks = [
        expected_clicks(ratio, np.diff(phase, axis=axis) + 2 * np.pi * whole, blur, axis)
        for axis, whole in zip((1, 2), turns, strict=True)
    ]
    more: np.ndarray | float = 0.0
    if rings.missing.any():
        # A way along a part of a ring has at most the clicks of the whole ring.
        more = passages.around(
            rings.totals_of(rings.steps_of((clicks[0], clicks[1]), signed=False))
        )
        for axis, each in enumerate(clicks):
            absent = rings.missing
            either = absent | np.roll(absent, -1, axis)
            each[:, np.delete(either, -1, axis)] = 0.0
        turns = rings.filled(turns)
    total = lines.sums(*lines.along(clicks[0], clicks[1])) + more
    return lines.rounds(*lines.along(*turns)), passages, np.minimum(total, 1.0)
