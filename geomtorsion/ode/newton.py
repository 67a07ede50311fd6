"""Newton: the numbers at the start of a motion for which its end hits a target."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol

import numpy as np

from geomtorsion.ode.system import WorkLimitError

# Newton steps until a shot has hit or is given up.
SHOTS = 40
# Slopes are computed again where a shot misses by more than this part of the last miss.
STALE = 0.05


class Shot(NamedTuple):
    """A motion from a vector of numbers at its start, and its miss.

    gap: components of the miss, as many as of the vector; size: of the miss, at least as long.
    name: from which name of the target the miss is measured.
    """

    vector: np.ndarray
    gap: np.ndarray
    size: float
    name: int = 0


class Target(Protocol):
    """A target of shots."""

    @property
    def rounding(self) -> float:
        """Size of a miss by rounding."""
        ...


class Shooter(Protocol):
    """Motions as a function of a vector of numbers at their start."""

    def shot(self, vector: np.ndarray, aim: Any, /) -> Shot:
        """The motion of a vector, with its miss."""
        ...

    def slopes(self, shot: Shot, aim: Any, /) -> np.ndarray:
        """d gap / d v by central differences."""
        ...

    def difference(self, vector: np.ndarray, aim: Any, /) -> float:
        """The step of these differences."""
        ...


@dataclass(frozen=True, eq=False)
class Hit:
    """A motion that hits: its shot, the target, d v / d gap as last computed, Newton's shots."""

    shot: Shot
    aim: Target
    inverse: np.ndarray | None
    shots: int

    @property
    def vector(self) -> np.ndarray:
        """The numbers at its start."""
        return self.shot.vector

    @property
    def length(self) -> float:
        """The Euclidean length of this vector."""
        return float(lengths_of(self.shot.vector))


@dataclass(frozen=True, eq=False)
class Newton:
    """Newton's iteration on a vector of numbers at the start of a motion.

    shooter: the motions; accuracy: relative to the length of the vector.
    flat: vectors at which the end hardly depended on one direction, as they were met.
    """

    shooter: Shooter
    accuracy: float
    flat: list[np.ndarray] = field(default_factory=list, repr=False)

    def allowed(self, vector: np.ndarray, aim: Target) -> float:
        """The largest miss of a hit."""
        return self.accuracy * float(lengths_of(vector)) + aim.rounding

    def hit(
        self,
        aim: Target,
        first: np.ndarray,
        inverse: np.ndarray | None = None,
        within: float = np.inf,
        enough: float = 0.0,
    ) -> Hit | None:
        """Newton's iteration from a first vector; None if it does not hit.

        inverse: d v / d gap near the first vector, if known. within: a finite largest first miss;
        then each further miss is to be half of the one before. enough: a miss that counts as a hit.
        """
        is_steady = bool(np.isfinite(within))
        vector, miss = first, within
        best, move, is_turned = None, np.zeros_like(first), False
        for count in range(1, SHOTS + 1):
            shot = tried(self.shooter.shot, vector, aim)
            if shot is not None and shot.size <= max(self.allowed(vector, aim), enough):
                return Hit(shot, aim, inverse, count)
            least = miss / 2 if is_steady and best is not None else miss
            if shot is None or shot.size >= least:
                if best is None:
                    return None
                if not is_turned:
                    vector, is_turned = turned(best, move), True
                elif is_steady:
                    return None
                else:
                    move, inverse, is_turned = move / 2, None, False
                    vector = best + move
                if lengths_of(vector - best) < 1e-14 * lengths_of(best):
                    return None
                continue
            # Slopes are used again as long as they lead closer quickly.
            if inverse is None or (best is not None and shot.size > STALE * miss):
                inverse = self.inverse_slopes(shot, aim)
                if inverse is None:
                    return None
            miss, best, is_turned = shot.size, vector, False
            move = -inverse @ shot.gap
            limit = 2 * float(lengths_of(vector))
            move = move * min(1.0, limit / max(float(lengths_of(move)), 1e-300))
            vector = best + move
        return None

    def inverse_slopes(self, shot: Shot, aim: Target) -> np.ndarray | None:
        """d v / d gap; None where the end hardly depends on a direction: near a conjugate point."""
        slopes = tried(self.shooter.slopes, shot, aim)
        if slopes is None or not np.isfinite(slopes).all():
            return None
        u, s, vt = np.linalg.svd(slopes)
        if s[-1] < self.slope_noise(shot.vector, aim):
            self.flat.append(shot.vector)
            return None
        return vt.T @ np.diag(1 / s) @ u.T

    def slope_noise(self, vector: np.ndarray, aim: Target) -> float:
        """Four times the error of slopes by central differences, whose two parts balance."""
        share = self.shooter.difference(vector, aim) / float(lengths_of(vector))
        return (2 * share) ** 2


def turned(vector: np.ndarray, move: np.ndarray) -> np.ndarray:
    """A velocity after a move whose part across it turns it, and does not lengthen it.

    Near a conjugate point velocities of one length lead near to it from all sides.
    """
    there, length = vector + move, float(lengths_of(vector))
    ahead = float(lengths_of(there))
    if not ahead or not length:
        return there
    return (length + float(move @ (vector / length))) / ahead * there


def lengths_of(rows: np.ndarray) -> np.ndarray:
    """Euclidean lengths of rows, without underflow or overflow; infinite where not a number."""
    largest = np.abs(rows).max(axis=-1, keepdims=True)
    scale = np.where((largest > 0) & np.isfinite(largest), largest, 1.0)
    norms = np.linalg.norm(rows / scale, axis=-1) * scale[..., 0]
    return np.where(np.isfinite(norms), norms, np.inf)


def tried(action, *given):
    """The result of an action, or None where a motion or a frame ends, or takes too many steps.

    An engine that cannot follow the motions at all is an error of its own.
    """
    try:
        return action(*given)
    except (ArithmeticError, WorkLimitError, np.linalg.LinAlgError):
        return None
