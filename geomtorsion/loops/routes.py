"""Routes: the developments of the parts of a loop, repeated, joined and compared."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from geomtorsion.loops.affine import AffineForm
from geomtorsion.loops.cone import line_rate
from geomtorsion.loops.loop import Part
from geomtorsion.loops.transport import EPS, Transported, transported

# Two routes disagree when they differ by more than this many times their errors together.
DISAGREE = 30


def along_line(form: AffineForm, part: Part, accuracy: float) -> Transported:
    """The development once round along the line, with what rounding of the points does."""

    found = transported(part.sides, line_rate(form, part), accuracy)
    place = np.abs(np.array(part.centre)).max() / part.size
    noise = 2 * EPS * found.scale * (1 + min(place, 4.0))
    return Transported(
        found.motion, found.error + noise, found.turn_error, found.scale, found.points
    )


def repeated(once: Transported, times: int) -> Transported:
    """The same path several times, or backwards."""
    motion = once.motion if times > 0 else once.motion.inverse
    total = motion
    for _ in range(abs(times) - 1):
        total = total @ motion
    share = abs(times)
    return Transported(
        total, share * once.error, share * once.turn_error, share * once.scale, once.points
    )


def joined(parts: Sequence[Transported]) -> Transported:
    """One path after the other."""
    total = parts[0]
    for part in parts[1:]:
        total = Transported(
            total.motion @ part.motion,
            total.error + part.error + total.turn_error * part.scale,
            total.turn_error + part.turn_error,
            total.scale + part.scale,
            total.points + part.points,
        )
    return total


def agree(line: Transported, cone: Transported) -> bool:
    """Whether both routes give the same motion within their errors."""

    apart = np.abs(line.motion.increment - cone.motion.increment)
    shift = float(apart[:-1, -1].max()) <= DISAGREE * (line.error + cone.error)
    turn = float(apart[:-1, :-1].max()) <= DISAGREE * (line.turn_error + cone.turn_error)
    return shift and turn


def better(cone: Transported, line: Transported) -> bool:
    """Whether the cone has the smaller error of the translation."""
    return cone.error <= line.error
